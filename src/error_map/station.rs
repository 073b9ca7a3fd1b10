//! One operation made ready: its grid, its approach, its gauge, and what it depends on in a layout.

use super::grid::Grid;
use super::outcome::Unjudged;
use crate::cell::{Attitude, Cell, Operation, Over, Placement, Registration, TEACH_HEIGHT};
use crate::clearance::{PlacedSolids, Scene};
use crate::reach::{Inverse, ToolAttitudes};
use crate::reading::{ErrorEvaluator, Taught, WorkFrame};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// One operation made ready.
pub struct Station {
    pub equipment: usize,
    pub grid: Grid,
    pub over: Over,
    pub gauge: ErrorEvaluator,
    pub relative_to: Option<usize>,
    /// Nodes to touch, in the order of trying, for each of three points (if those lie in a line: the
    /// widest triangle of all that can be touched); or points given by the user
    /// (frame of the equipment, m).
    teach: Teach,
}

enum Teach {
    No,
    Nodes([Vec<usize>; 3]),
    Points([(f64, f64); 3]),
}

/// How an operation stands in one layout.
pub struct Stand<'l> {
    /// Its equipment in the base frame.
    pub at: Placement,
    pub attitude: &'l Attitude,
    /// Turns world axes into the base frame.
    pub world: Matrix3<f64>,
}

impl Stand<'_> {
    /// The ways to hold the tool.
    pub fn approach(&self, arm: &Arm) -> ToolAttitudes {
        arm.inverse.tool_attitudes(self.attitude, self.at.yaw)
    }
}

/// The robot's side of a station.
pub struct Arm {
    pub chain: Chain,
    pub inverse: Inverse,
}

impl Arm {
    /// The frames of one branch at a target.
    pub fn frames(&self, target: &Vector3<f64>, approach: &ToolAttitudes, wanted: u32) -> Option<Frames> {
        self.inverse.posture(target, approach, wanted).map(|posture| self.chain.frames(&posture))
    }

    /// The frames of the first branch at a target that touches nothing, with empty hands.
    fn first_free(
        &self,
        target: &Vector3<f64>,
        approach: &ToolAttitudes,
        scene: &Scene,
        placed: &PlacedSolids,
    ) -> Option<Frames> {
        let mut found = None;
        self.inverse.visit(target, approach, &mut self.inverse.scratch(), |_, posture| {
            if found.is_none() {
                let frames = self.chain.frames(posture);
                found = scene.hit(placed, &frames.links, None).is_none().then_some(frames);
            }
        });
        found
    }
}

impl Station {
    pub fn new(cell: &Cell, operation: &Operation) -> Self {
        let grid = Grid::new(operation);
        let teach = match (cell.registration, operation.teach) {
            (Registration::Taught, Some(points)) => Teach::Points(points),
            (Registration::Taught, None) => Teach::Nodes(from_corners(&grid)),
            _ => Teach::No,
        };
        Self {
            equipment: operation.equipment,
            over: operation.over,
            gauge: ErrorEvaluator::new(cell, operation),
            relative_to: operation.relative_to,
            grid,
            teach,
        }
    }

    /// The work as it stands, seen by the sources of `gauge`.
    pub fn site(
        &self,
        gauge: &ErrorEvaluator,
        stand: &Stand<'_>,
        arm: &Arm,
        scene: &Scene,
        placed: &PlacedSolids,
    ) -> Result<WorkFrame, Unjudged> {
        let taught = match self.touched(stand, arm, scene, placed) {
            Some(postures) => {
                let postures = postures.ok_or(Unjudged::NotTaught)?;
                Some(Box::new(Taught::new(&arm.chain, &gauge.sources, postures, gauge.takes_mean())))
            }
            None => None,
        };
        Ok(WorkFrame { equipment: self.equipment, work: stand.at.pose(), world: stand.world, taught })
    }

    /// The touching postures; None if nothing is taught, Some(None) if it cannot be.
    fn touched(
        &self,
        stand: &Stand<'_>,
        arm: &Arm,
        scene: &Scene,
        placed: &PlacedSolids,
    ) -> Option<Option<[Frames; 3]>> {
        if matches!(self.teach, Teach::No) {
            return None;
        }
        let (at, approach) = (&stand.at, stand.approach(arm));
        let touch = |target| arm.first_free(&target, &approach, scene, placed);
        let point = |k: usize| match &self.teach {
            Teach::No => None,
            Teach::Nodes(orders) => orders[k].iter().find_map(|&node| touch(self.grid.target(at, node))),
            Teach::Points(points) => touch(self.grid.point(at, points[k])),
        };
        let postures = point(0).zip(point(1)).zip(point(2)).map(|((a, b), c)| [a, b, c]);
        let postures = postures.filter(|p| height(p) > TEACH_HEIGHT);
        if postures.is_some() || matches!(self.teach, Teach::Points(_)) {
            return Some(postures);
        }
        let mut all = Vec::new();
        self.grid.targets(at, |_, target| all.extend(touch(target)));
        Some(widest(&all).filter(|p| height(p) > TEACH_HEIGHT))
    }
}

/// Height of the triangle over its longest side, m.
fn height(p: &[Frames; 3]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| p[k].tcp.translation);
    let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
    (b - a).cross(&(c - a)).norm() / longest.max(f64::MIN_POSITIVE)
}

/// Of many postures the first, the farthest from it, and the farthest from the line of the two.
fn widest(all: &[Frames]) -> Option<[Frames; 3]> {
    let first = all.first()?;
    let from = |f: &Frames| (f.tcp.translation - first.tcp.translation).norm();
    let second = all.iter().max_by(|a, b| from(a).total_cmp(&from(b)))?;
    let along = second.tcp.translation - first.tcp.translation;
    let beside = |f: &Frames| along.cross(&(f.tcp.translation - first.tcp.translation)).norm();
    let third = all.iter().max_by(|a, b| beside(a).total_cmp(&beside(b)))?;
    Some([*first, *second, *third])
}

/// Nodes by their distance from the low corner, the corner along x and the corner along y.
fn from_corners(grid: &Grid) -> [Vec<usize>; 3] {
    let [(left, right), (low, high)] = grid.extent();
    [(left, low), (right, low), (left, high)].map(|corner| {
        let mut nodes: Vec<usize> = (0..grid.count()).collect();
        let distance = |k: &usize| (grid.local(*k).0 - corner.0).hypot(grid.local(*k).1 - corner.1);
        nodes.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
        nodes
    })
}
