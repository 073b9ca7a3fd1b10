//! Refined spot of an operation between the nodes, by compass search over the surface from the best nodes.
//!
//! A poll tries eight points at one distance around the present point. The search moves to the point with the
//! largest gain. After several successive polls without a gain, the distance is halved. The distance starts
//! at half the spacing of the nodes and ends at a micrometre (Kolda, Lewis and Torczon, SIAM Review 45 (2003)
//! 385-482). The eight directions to these points rotate by the golden angle from poll to poll. The
//! directions therefore meet an edge of the usable area at many angles. Only gains are accepted, so the
//! refined spot is never worse than the best node. If the layout must work at every misplacement inside the
//! placement tolerances, only certified spots are accepted.
//!
//! The redundant joint of an arm and a free spin are refined, too. Each poll also tries a smaller and a
//! larger value of these coordinates. The first change is half the distance between the sampled values. A
//! search keeps all other parts of the branch index. At the end point, every branch is judged, as at a node.
//! If another branch is better there, a search with that branch follows. Only one operation is refined at a
//! time, and all other operations keep their best nodes. An operation that places a part therefore assumes
//! that the part was picked at the best node of the pick, not at the refined spot.

use super::workcell::Workcell;
use crate::cell::{JointVector, Layout, Place, Rectangle};
use crate::certificate::Misplacements;
use crate::error_map::{HeldPosture, MapperWorkspace, OperationMap, PointSpot, Probe, Status};
use crate::low_discrepancy::GOLDEN_ANGLE;
use nalgebra::Vector3;

/// Greatest number of nodes from which the searches of one operation start.
const MAX_STARTS: usize = 4;
/// Least distance between two start nodes along x or along y, in divisions of the grid.
const START_SPACING: usize = 3;
/// Number of points around the present point that one poll tries, each in another direction.
const DIRECTIONS: usize = 8;
/// Least distance of the points of a poll from the present point, m.
const LEAST_STEP: f64 = 1e-6;
/// Least gain that counts, as a share of the value. Smaller gains are rounding errors.
const LEAST_GAIN: f64 = 1e-9;
/// Greatest number of postures tried one after the other from one start node.
const MAX_POSTURES: usize = 4;
/// Number of polls without a gain after which the distance is halved.
///
/// The worst-case error has narrow curved valleys with a kink along them. In such a valley, one poll often
/// finds no gain.
const MAX_FAILURES: usize = 3;
/// Greatest number of polls of one search. A few hundred are usual.
const MAX_POLLS: usize = 1000;

/// Spot of an operation, refined between the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// Coordinates x and y of the refined spot in the frame of the equipment, m.
    pub at: (f64, f64),
    /// Coordinates x and y of the best node in the frame of the equipment, m.
    pub node_at: (f64, f64),
    /// Position of the TCP at the refined spot, in the world frame, m.
    pub position: Vector3<f64>,
    pub branch: u64,
    pub joints: JointVector,
    /// Value of the operation at the refined spot.
    pub value: f64,
    /// Upper bound of the value over all misplacements inside the placement tolerances. None if the layout
    /// need not withstand misplacements, or if no bound is known.
    pub most: Option<f64>,
    /// Value of the best node, never less than `value`.
    pub node_value: f64,
}

impl Refined {
    /// Returns the reduction of the value from the best node to the refined spot, as a share of the value at
    /// the node.
    pub fn gain(&self) -> f64 {
        if self.node_value > 0.0 { (self.node_value - self.value) / self.node_value } else { 0.0 }
    }
}

impl Workcell {
    /// Refines the spot of every operation.
    ///
    /// The entry of an operation is None if the operation has no spot, has listed points, or happens at every
    /// node. All entries are None if the layout does not belong to the cell.
    pub fn refined(&self, layout: &Layout, maps: &[OperationMap]) -> Vec<Option<Refined>> {
        if self.cell.misfit(layout).is_some() {
            return vec![None; maps.len()];
        }
        let mut misplacements = Misplacements::default();
        misplacements.set(&self.cell, layout, self.cell.robot.reach());
        let demand = self.certifies().then(|| self.demand(&misplacements));
        let placed = self.placed(layout).demanding(demand);
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let mut memory = MapperWorkspace::default();
        let refine = |map: &OperationMap| {
            let operation = &self.cell.operations[map.operation];
            let Place::Grid { area, divisions } = &operation.place else { return None };
            if operation.over.needs_every_node() {
                return None;
            }
            let probe = Probe::new(&placed, map.operation, &spots, &mut memory).ok()?;
            self.refine(map, probe, area, *divisions)
        };
        maps.iter().map(refine).collect()
    }

    fn refine(
        &self,
        map: &OperationMap,
        mut probe: Probe<'_>,
        area: &Rectangle,
        divisions: (usize, usize),
    ) -> Option<Refined> {
        let node = map.spot()?;
        let node_at = self.mapper.grid(map.operation).local(node.node);
        let spacing = (area.size.0 / divisions.0 as f64, area.size.1 / divisions.1 as f64);
        // Teaching the frame removes most of the error at and near the touched points. The value at such a
        // point is not representative of the surface.
        let apart = probe.distance_from_touched(node_at).min(spacing.0.min(spacing.1)) - LEAST_STEP;
        let mut best = PointSpot { posture: probe.hold(node_at, node.branch)?, value: node.value };
        for start in starts(map) {
            let at = self.mapper.grid(map.operation).local(start);
            let Ok(mut from) = probe.best(at) else { continue };
            let step = spacing.0.max(spacing.1) / 2.0;
            for _ in 0..MAX_POSTURES {
                let found = descend(from, area, step, &mut probe, apart);
                if found.value < best.value {
                    best = found;
                }
                match probe.best(found.posture.at) {
                    Ok(other) if other.value < found.value * (1.0 - LEAST_GAIN) => from = other,
                    _ => break,
                }
            }
        }
        let PointSpot { posture, value } = best;
        let HeldPosture { at, branch, .. } = posture;
        let (position, joints) = (probe.position(at), probe.joints(&posture)?);
        let most = probe.certificate(&posture, Some(&self.value_bounds[map.operation])).ok().flatten();
        Some(Refined { at, node_at, position, branch, joints, value, most, node_value: node.value })
    }
}

/// Picks the best usable nodes that are at least [`START_SPACING`] apart.
fn starts(map: &OperationMap) -> Vec<usize> {
    let usable = |k: &usize| map.nodes[*k].status == Status::Ok;
    let value = |k: usize| map.nodes[k].posture.as_ref().filter(|p| !p.touched).map(|p| (p.value, k));
    let mut nodes: Vec<_> = (0..map.nodes.len()).filter(usable).filter_map(value).collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut starts: Vec<usize> = map.best.into_iter().collect();
    for (_, k) in nodes {
        let far = |s: &usize| {
            let (a, b) = (&map.nodes[*s], &map.nodes[k]);
            a.i.abs_diff(b.i).max(a.j.abs_diff(b.j)) >= START_SPACING
        };
        if starts.len() < MAX_STARTS && starts.iter().all(far) {
            starts.push(k);
        }
    }
    starts
}

/// Runs one compass search on the points at which the posture of `from` can be held and is certified.
///
/// A certificate is expensive, so only points that improve the value are certified. The search skips points
/// nearer than `apart` (m) to a point that the robot touches to teach the frame.
fn descend(
    from: PointSpot,
    area: &Rectangle,
    first_step: f64,
    probe: &mut Probe<'_>,
    apart: f64,
) -> PointSpot {
    let inside = |v: f64, centre: f64, size: f64| v.clamp(centre - size / 2.0, centre + size / 2.0);
    let (mut best, mut step, mut failures) = (from, first_step, 0);
    for poll in 0..MAX_POLLS {
        if step < LEAST_STEP {
            break;
        }
        let gained = |value: f64| value < best.value - LEAST_GAIN * best.value.abs();
        let around = |k: usize| {
            let turn = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = (GOLDEN_ANGLE * poll as f64 + turn).sin_cos();
            let x = inside(best.posture.at.0 + step * cos, area.centre.0, area.size.0);
            let y = inside(best.posture.at.1 + step * sin, area.centre.1, area.size.1);
            probe.moved(&best.posture, (x, y))
        };
        let around: Vec<HeldPosture> = (0..DIRECTIONS).filter_map(around).collect();
        let beside = probe.beside(&best.posture, step / first_step / 2.0);
        let candidates = around.into_iter().chain(beside).filter_map(|posture| {
            let is_apart = probe.distance_from_touched(posture.at) >= apart;
            let value = is_apart.then(|| probe.holding(&posture).ok()).flatten()?;
            Some(PointSpot { posture, value }).filter(|_| gained(value))
        });
        let mut better: Vec<PointSpot> = candidates.collect();
        better.sort_by(|a, b| a.value.total_cmp(&b.value));
        match better.into_iter().find(|c| probe.certificate(&c.posture, None).is_ok()) {
            Some(better) => (best, failures) = (better, 0),
            None if failures + 1 < MAX_FAILURES => failures += 1,
            None => (step, failures) = (step / 2.0, 0),
        }
    }
    best
}
