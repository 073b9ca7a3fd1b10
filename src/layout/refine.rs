//! The operation spot between the nodes: from the best nodes on, a pattern search over the surface.
//!
//! Eight directions are polled at one distance, turned by the golden angle from poll to poll so that no
//! edge of the usable area is met at one angle only; the best that gains is taken, and if none does the
//! distance is halved, from half the spacing of the nodes down to a micrometre (compass search: Kolda,
//! Lewis and Torczon, SIAM Review 45 (2003) 385-482). Nothing but gains is taken, so the spot is never
//! worse than the node. The posture is kept on the
//! way, and every one of the point where it ends is judged, as at a node: if another is better there, it
//! goes on with that. The other operations stay at their nodes:
//! what is relative to a pick is relative to the pick's node.

use super::Workcell;
use crate::cell::{JointVector, Layout, Place, Rectangle};
use crate::clearance::PlacedSolids;
use crate::error_map::{Kept, OperationMap, PointSpot, Probe, Status};
use nalgebra::Vector3;

/// Nodes from which the search starts, at most.
const STARTS: usize = 4;
/// Starts are so many nodes apart along x or y.
const APART: usize = 3;
const DIRECTIONS: usize = 8;
/// What is left of a turn after the golden section, rad.
const GOLDEN: f64 = 2.399_963_229_728_653;
/// Last distance of the search, m.
const FINEST: f64 = 1e-6;
/// Gains below this share are rounding.
const GAIN: f64 = 1e-9;
/// Postures tried one after the other from one start.
const POSTURES: usize = 4;
/// Polls of one search at most: some hundred are usual.
const POLLS: usize = 1000;

/// The spot of an operation between the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// In the frame of the equipment, m.
    pub at: (f64, f64),
    /// The best node there.
    pub node_at: (f64, f64),
    /// TCP, world, m.
    pub position: Vector3<f64>,
    pub branch: u32,
    pub joints: JointVector,
    pub value: f64,
    /// That of the best node: never less.
    pub node_value: f64,
}

impl Refined {
    /// How much less the value is than at the node, as a share.
    pub fn gain(&self) -> f64 {
        if self.node_value > 0.0 { (self.node_value - self.value) / self.node_value } else { 0.0 }
    }
}

impl Workcell {
    /// The refined spot of every operation; None of one that has no spot, or none to choose.
    pub fn refined(&self, layout: &Layout, maps: &[OperationMap]) -> Vec<Option<Refined>> {
        let mut placed = PlacedSolids::default();
        self.scene.place(layout, &mut placed);
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let refine = |map: &OperationMap| {
            let operation = &self.cell.operations[map.operation];
            let Place::Grid { area, divisions } = &operation.place else { return None };
            if operation.over.takes_all() {
                return None;
            }
            let station = (&self.mapper, &*self.scene, &placed);
            let probe = Probe::new(station, map.operation, layout, &spots).ok()?;
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
        let node_at = self.mapper.local(map.operation, node.node);
        let spacing = (area.size.0 / divisions.0 as f64, area.size.1 / divisions.1 as f64);
        // What is left at a point that was touched is nothing by the rule of its frame, and little beside
        // it: that says nothing of the surface.
        let apart = probe.from_touched(node_at).min(spacing.0.min(spacing.1)) - FINEST;
        let mut best = PointSpot { at: node_at, branch: node.branch, value: node.value };
        for start in starts(map) {
            let at = self.mapper.local(map.operation, start);
            let Ok(mut from) = probe.best(at) else { continue };
            let step = spacing.0.max(spacing.1) / 2.0;
            for _ in 0..POSTURES {
                let Some(joints) = probe.joints(from.at, from.branch) else { break };
                let branch = from.branch;
                let found = descend(from, area, step, |at| {
                    let is_apart = probe.from_touched(at) >= apart;
                    let value =
                        is_apart.then(|| probe.keeping(&Kept { at, branch, joints }).ok()).flatten()?;
                    Some(PointSpot { at, branch, value })
                });
                if found.value < best.value {
                    best = found;
                }
                match probe.best(found.at) {
                    Ok(other) if other.value < found.value * (1.0 - GAIN) => from = other,
                    _ => break,
                }
            }
        }
        let PointSpot { at, branch, value } = best;
        let (position, joints) = (probe.position(at), probe.joints(at, branch)?);
        Some(Refined { at, node_at, position, branch, joints, value, node_value: node.value })
    }
}

/// The best usable nodes, of those that lie together the best.
fn starts(map: &OperationMap) -> Vec<usize> {
    let usable = |k: &usize| map.nodes[*k].status == Status::Ok;
    let value = |k: usize| map.nodes[k].posture.as_ref().filter(|p| !p.touched).map(|p| (p.value, k));
    let mut nodes: Vec<_> = (0..map.nodes.len()).filter(usable).filter_map(value).collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut starts: Vec<usize> = map.best.into_iter().collect();
    for (_, k) in nodes {
        let far = |s: &usize| {
            let (a, b) = (&map.nodes[*s], &map.nodes[k]);
            a.i.abs_diff(b.i).max(a.j.abs_diff(b.j)) >= APART
        };
        if starts.len() < STARTS && starts.iter().all(far) {
            starts.push(k);
        }
    }
    starts
}

fn descend(
    from: PointSpot,
    area: &Rectangle,
    mut step: f64,
    mut judge: impl FnMut((f64, f64)) -> Option<PointSpot>,
) -> PointSpot {
    let inside = |v: f64, centre: f64, size: f64| v.clamp(centre - size / 2.0, centre + size / 2.0);
    let mut best = from;
    for poll in 0..POLLS {
        if step < FINEST {
            break;
        }
        let candidates = (0..DIRECTIONS).filter_map(|k| {
            let turn = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = (GOLDEN * poll as f64 + turn).sin_cos();
            let x = inside(best.at.0 + step * cos, area.centre.0, area.size.0);
            let y = inside(best.at.1 + step * sin, area.centre.1, area.size.1);
            judge((x, y))
        });
        let least = candidates.min_by(|a, b| a.value.total_cmp(&b.value));
        match least.filter(|c| c.value < best.value - GAIN * best.value.abs()) {
            Some(better) => best = better,
            None => step /= 2.0,
        }
    }
    best
}
