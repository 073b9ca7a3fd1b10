//! From a placed surface to its least-error spot, or to its whole map.

use super::grid::Grid;
use super::node::{NodeRecord, OperationMap, PostureRecord, Status};
use crate::cell::{Cell, Layout, MAX_JOINTS, Model, Placement, Sense};
use crate::clearance::{Hit, Placed, Scene};
use crate::kinematic_error::{Perturbation, pose_error, position_error};
use crate::pose::Pose;
use crate::reach::{Approach, Branch, Gap, PlanarArm, Reach};
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// One operation made ready.
struct Station {
    equipment: usize,
    grid: Grid,
    approach: Approach,
    sense: Sense,
}

/// Robot, errors and operations of a cell, made ready for the node loop.
pub struct Mapper {
    chain: Chain,
    errors: Perturbation,
    arm: PlanarArm,
    model: Model,
    base: Placement,
    stations: Vec<Station>,
}

/// The spot chosen for an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Number of the node.
    pub node: usize,
    pub branch: u8,
    /// Error in the sense of the operation, m.
    pub in_sense: f64,
}

/// What one operation gets from one layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    Found(Spot),
    /// Postures within limits exist, all of them touch something; the least-error one of them.
    AllCollide {
        nearest: Spot,
    },
    /// No node has a posture within the limits.
    Unreachable {
        gap: Gap,
    },
}

/// A posture that might be the spot, ordered by error, then node, then branch (reversed: the heap
/// gives the greatest first).
#[derive(Clone, Copy)]
struct Candidate {
    spot: Spot,
    target: Vector3<f64>,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |c: &Self| (c.spot.node, c.spot.branch);
        other.spot.in_sense.total_cmp(&self.spot.in_sense).then_with(|| key(other).cmp(&key(self)))
    }
}

/// Memory reused from layout to layout.
#[derive(Default)]
pub struct Scratch {
    candidates: Vec<Candidate>,
}

impl Mapper {
    /// # Errors
    /// Why the robot has no inverse kinematics here.
    pub fn new(cell: &Cell) -> Result<Self, String> {
        let chain = Chain::new(&cell.robot);
        let arm = PlanarArm::new(&chain)?;
        let errors = Perturbation::new(&chain, cell.signed_errors());
        let station = |o: &crate::cell::Operation| {
            let surface = cell.equipment[o.equipment].surface?;
            let (grid, approach) = (Grid::new(&surface, o), arm.approach(o.bend));
            Some(Station { equipment: o.equipment, grid, approach, sense: o.sense })
        };
        let stations = cell.operations.iter().filter_map(station).collect();
        Ok(Self { chain, errors, arm, model: cell.model, base: cell.base, stations })
    }

    /// The least-error spot of an operation that touches nothing. Cheap tests first: geometry,
    /// limits, error; collision only for candidates that can still win.
    pub fn least_error(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut Placed,
        scratch: &mut Scratch,
    ) -> Outcome {
        let station = &self.stations[operation];
        let at = self.in_base(&layout.placements[station.equipment]);
        let mut posture = self.arm.scratch();
        let mut gap = Gap { reach: f64::INFINITY, limits: f64::INFINITY };
        let candidates = &mut scratch.candidates;
        candidates.clear();
        station.grid.targets(&at, |node, target| {
            let missed = self.arm.visit(&target, &station.approach, &mut posture, |branch, posture| {
                let e = self.world(position_error(&self.chain, &self.errors, posture, self.model));
                let spot = Spot { node, branch, in_sense: station.sense.of(&e) };
                candidates.push(Candidate { spot, target });
            });
            if (missed.reach, missed.limits) < (gap.reach, gap.limits) {
                gap = missed;
            }
        });
        if candidates.is_empty() {
            return Outcome::Unreachable { gap };
        }
        let mut heap = BinaryHeap::from(std::mem::take(candidates));
        let nearest = heap.peek().map(|c| c.spot);
        let mut found = None;
        while let Some(candidate) = heap.pop() {
            if self.is_free(&candidate, &station.approach, scene, placed) {
                found = Some(candidate.spot);
                break;
            }
        }
        *candidates = heap.into_vec();
        match (found, nearest) {
            (Some(spot), _) => Outcome::Found(spot),
            (None, Some(nearest)) => Outcome::AllCollide { nearest },
            (None, None) => Outcome::Unreachable { gap },
        }
    }

    /// Solves the candidate's target again for its one posture: dearer than keeping it, but few
    /// candidates ever come here and all of them would have to be stored.
    fn is_free(
        &self,
        candidate: &Candidate,
        approach: &Approach,
        scene: &Scene,
        placed: &mut Placed,
    ) -> bool {
        let mut free = false;
        self.arm.visit(&candidate.target, approach, &mut self.arm.scratch(), |branch, posture| {
            if branch == candidate.spot.branch {
                let mut frames = [Pose::identity(); MAX_JOINTS + 1];
                self.chain.frames(posture, &mut frames);
                free = scene.is_free(placed, &frames);
            }
        });
        free
    }

    fn hit(&self, posture: &Posture, scene: &Scene, placed: &Placed) -> Option<Hit> {
        let mut frames = [Pose::identity(); MAX_JOINTS + 1];
        self.chain.frames(posture, &mut frames);
        scene.hit(placed, &frames)
    }

    /// The whole map of an operation.
    pub fn map(&self, operation: usize, layout: &Layout, scene: &Scene, placed: &Placed) -> OperationMap {
        let station = &self.stations[operation];
        let at = self.in_base(&layout.placements[station.equipment]);
        let mut nodes = Vec::with_capacity(station.grid.count());
        station.grid.targets(&at, |k, target| {
            let (i, j) = station.grid.index(k);
            let position = self.base.pose().transform(&target);
            let (status, posture) = self.judge(&target, station, scene, placed);
            nodes.push(NodeRecord { i, j, position, status, posture });
        });
        let usable =
            |n: &NodeRecord| n.posture.as_ref().filter(|_| n.status == Status::Ok).map(|p| p.in_sense);
        let errors = nodes.iter().enumerate().filter_map(|(k, n)| Some((k, usable(n)?)));
        let best = errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        OperationMap { operation, nodes, best }
    }

    fn judge(
        &self,
        target: &Vector3<f64>,
        station: &Station,
        scene: &Scene,
        placed: &Placed,
    ) -> (Status, Option<PostureRecord>) {
        let branches = match self.arm.branches(target, &station.approach) {
            Reach::OutOfReach { by } => return (Status::OutOfReach { by }, None),
            Reach::Branches(branches) => branches,
        };
        let mut within: Vec<_> = branches
            .iter()
            .filter(|b| b.violation.is_none())
            .map(|b| self.record(b, station.sense))
            .collect();
        within.sort_by(|a, b| a.0.in_sense.total_cmp(&b.0.in_sense).then(a.0.branch.cmp(&b.0.branch)));
        let mut first_hit = None;
        for (record, posture) in &within {
            match self.hit(posture, scene, placed) {
                None => return (Status::Ok, Some(record.clone())),
                Some(hit) => first_hit = first_hit.or(Some(hit)),
            }
        }
        match (first_hit, within.into_iter().next()) {
            (Some(hit), Some((record, _))) => (Status::Collision { hit }, Some(record)),
            _ => (least_violation(&branches), None),
        }
    }

    fn record(&self, branch: &Branch, sense: Sense) -> (PostureRecord, Posture) {
        let of = |model| {
            let e = pose_error(&self.chain, &self.errors, &branch.posture, model);
            (self.world(e.position), self.world(e.rotation))
        };
        let (nonlinear, nonlinear_rotation) = of(Model::Nonlinear);
        let (linear, linear_rotation) = of(Model::Linear);
        let (error, rotation) = match self.model {
            Model::Nonlinear => (nonlinear, nonlinear_rotation),
            Model::Linear => (linear, linear_rotation),
        };
        let (branch, joints, posture) = (branch.index, branch.joints, branch.posture);
        (
            PostureRecord { branch, joints, error, rotation, nonlinear, linear, in_sense: sense.of(&error) },
            posture,
        )
    }

    /// A placement in the frame of the robot base.
    fn in_base(&self, at: &Placement) -> Placement {
        let (dx, dy) = (at.x - self.base.x, at.y - self.base.y);
        let (s, c) = self.base.yaw.sin_cos();
        Placement {
            x: c * dx + s * dy,
            y: c * dy - s * dx,
            z: at.z - self.base.z,
            yaw: at.yaw - self.base.yaw,
        }
    }

    /// A vector of the base frame in the world.
    fn world(&self, v: Vector3<f64>) -> Vector3<f64> {
        if self.base.yaw == 0.0 {
            return v;
        }
        let (s, c) = self.base.yaw.sin_cos();
        Vector3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
    }
}

/// The joint limit that the most nearly allowed branch passes.
fn least_violation(branches: &[Branch]) -> Status {
    let passed = branches.iter().filter_map(|b| b.violation.map(|v| (v, b.joints[v.joint])));
    let least = passed.min_by(|a, b| a.0.by.total_cmp(&b.0.by));
    least.map_or(Status::OutOfReach { by: 0.0 }, |(violation, needs)| Status::JointLimit { violation, needs })
}
