//! From a placed surface to its whole map: every node with its posture and errors, or why it has none.

use super::at_point::unreached;
use super::mapper::Mapper;
use super::node::{NodeRecord, OperationMap, PostureRecord, Status};
use super::outcome::{Spot, Unjudged};
use super::station::Station;
use crate::cell::{Layout, Over};
use crate::clearance::{PlacedSolids, Scene};
use crate::kinematic_error::deviation;
use crate::pose::Displacement;
use crate::reach::{Branch, ToolAttitudes};
use crate::reading::{EvaluatorScratch, WorkContext};
use crate::robot::Frames;
use nalgebra::Vector3;

impl Mapper {
    /// The whole map of an operation; `spots` are those of the operations before it.
    pub fn map(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &PlacedSolids,
        spots: &[Option<Spot>],
    ) -> OperationMap {
        let station = &self.stations[operation];
        let situation = self.situation(operation, layout, scene, placed, spots);
        let stand = self.stand(operation, layout);
        let mut memory = station.gauge.memory();
        let approach = stand.approach(&self.arm);
        let mut nodes = Vec::with_capacity(station.grid.count());
        station.grid.targets(&stand.at, |k, target| {
            let (i, j) = station.grid.index(k);
            let position = layout.base.pose().transform(&target);
            let (status, posture) =
                self.judge(&target, (operation, &approach), &situation, scene, placed, &mut memory);
            nodes.push(NodeRecord { i, j, position, status, posture });
        });
        let free = |p: &&PostureRecord| !p.touched;
        let usable = |n: &NodeRecord| {
            n.posture.as_ref().filter(|_| n.status == Status::Ok).filter(free).map(|p| p.value)
        };
        let values: Vec<_> = nodes.iter().enumerate().filter_map(|(k, n)| Some((k, usable(n)?))).collect();
        let (best, value) = chosen(station.over, &values, nodes.iter().all(|n| n.status == Status::Ok));
        OperationMap { operation, senses: station.gauge.reported.clone(), nodes, best, value }
    }

    fn judge(
        &self,
        target: &Vector3<f64>,
        (operation, approach): (usize, &ToolAttitudes),
        situation: &Result<WorkContext, Unjudged>,
        scene: &Scene,
        placed: &PlacedSolids,
        memory: &mut EvaluatorScratch,
    ) -> (Status, Option<PostureRecord>) {
        let station = &self.stations[operation];
        let branches = match unreached(self.arm.inverse.branches(target, approach)) {
            Ok(branches) => branches,
            Err(status) => return (status, None),
        };
        let allowed = branches.iter().filter(|b| b.is_usable());
        let situation = match situation {
            Ok(situation) => situation,
            Err(why) if allowed.clone().next().is_some() => return (Status::Unjudged(*why), None),
            Err(_) => return (least_violation(&branches), None),
        };
        let mut within: Vec<(f64, Frames, &Branch)> = allowed
            .map(|branch| {
                let frames = self.arm.chain.frames(&branch.posture);
                (station.gauge.value(situation, &frames, memory), frames, branch)
            })
            .collect();
        within.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.index.cmp(&b.2.index)));
        let mut first_trouble = None;
        for (_, frames, branch) in &within {
            match self.trouble(operation, (frames, &branch.joints), scene, placed) {
                None => {
                    return (
                        Status::Ok,
                        Some(self.record(station, situation, (target, frames), branch, memory)),
                    );
                }
                Some(trouble) => first_trouble = first_trouble.or(Some(trouble)),
            }
        }
        match (first_trouble, within.first()) {
            (Some(trouble), Some((_, frames, branch))) => {
                (trouble, Some(self.record(station, situation, (target, frames), branch, memory)))
            }
            _ => (least_violation(&branches), None),
        }
    }

    fn record(
        &self,
        station: &Station,
        situation: &WorkContext,
        (target, frames): (&Vector3<f64>, &Frames),
        branch: &Branch,
        memory: &mut EvaluatorScratch,
    ) -> PostureRecord {
        let judged = station.gauge.judge(situation, frames, memory);
        let to_world = situation.site.world.transpose();
        let world = |d: &Displacement| d.turned(&to_world);
        let off = |model: &Displacement| deviation(&judged.nonlinear.position, &model.position);
        let error = world(&judged.error);
        PostureRecord {
            branch: branch.index,
            joints: branch.joints,
            error: error.position,
            rotation: error.rotation,
            nonlinear: world(&judged.nonlinear).position,
            linear: world(&judged.linear).position,
            linear_off: off(&judged.linear),
            second_order_off: off(&judged.second_order),
            touched: situation.touches(target),
            value: judged.value,
            figures: judged.figures,
            success: judged.success,
        }
    }
}

/// Of the nodes that count, with their values: the node that is shown as the spot, and what the
/// operation is worth.
fn chosen(over: Over, values: &[(usize, f64)], all_usable: bool) -> (Option<usize>, Option<f64>) {
    let by_value = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
    if !over.takes_all() {
        let best = values.iter().min_by(by_value);
        return (best.map(|b| b.0), best.map(|b| b.1));
    }
    // The first of several that are worst.
    let worst = values.iter().rev().max_by(by_value).filter(|_| all_usable);
    let mut all: Vec<f64> = values.iter().map(|v| v.1).collect();
    (worst.map(|w| w.0), worst.map(|_| over.of(&mut all)))
}

/// The joint limit that the most nearly allowed branch passes, or the attitude that it misses.
pub(super) fn least_violation(branches: &[Branch]) -> Status {
    let passed = branches.iter().filter_map(|b| b.violation.map(|v| (v, b.joints[v.joint])));
    let least = passed.min_by(|a, b| a.0.by.total_cmp(&b.0.by));
    let off = branches.iter().filter(|b| b.violation.is_none()).map(|b| b.off).reduce(f64::min);
    match (off, least) {
        (Some(by), _) => Status::Attitude { by, joint: None },
        (None, Some((violation, needs))) => Status::JointLimit { violation, needs },
        (None, None) => Status::OutOfReach { by: 0.0 },
    }
}
