//! From a placed surface to its least-error spot, or to its whole map.

use super::node::{NodeRecord, OperationMap, PostureRecord, Status};
use super::outcome::{Candidate, Outcome, Spot, Unjudged};
use super::ranking::{Ranker, Ranking};
use super::station::{Arm, Station};
use crate::cell::{Cell, JointVector, Layout, Placement, shown};
use crate::clearance::{Placed, Scene};
use crate::kinematic_error::deviation;
use crate::pose::Displacement;
use crate::reach::{Approach, Branch, Cost, Gap, Inverse, Reach, Shell};
use crate::reading::{Gauge, Memory, Reference, Situation};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;
use std::collections::BinaryHeap;

/// Robot, errors and operations of a cell, made ready for the node loop.
pub struct Mapper {
    pub(super) arm: Arm,
    base: Placement,
    pub(super) stations: Vec<Station>,
    /// One per operation whose nodes can be ranked.
    pub(super) rankers: Vec<Option<Ranker>>,
    /// One per operation: what may be reached at all, where asking a node is dear.
    shells: Vec<Option<Shell>>,
}

/// Memory reused from layout to layout.
#[derive(Default)]
pub struct Scratch {
    pub(super) candidates: Vec<Candidate>,
    pub(super) frames: Frames,
    pub(super) approach: Approach,
    /// One per operation.
    pub(super) memories: Vec<Memory>,
    pub(super) ranking: Ranking,
}

impl Mapper {
    /// # Errors
    /// What an operation asks of the tool and the robot cannot do by its build.
    pub fn new(cell: &Cell) -> Result<Self, String> {
        let chain = Chain::new(&cell.robot);
        let inverse = Inverse::new(&chain);
        for operation in &cell.operations {
            if let Some(why) = inverse.refusal(&operation.attitude) {
                return Err(format!("operation {}: {why}", shown(&operation.name)));
            }
        }
        let arm = Arm { chain, inverse };
        let stations: Vec<_> = cell.operations.iter().filter_map(|o| Station::new(cell, o)).collect();
        let shell = |s: &Station| (arm.inverse.cost() != Cost::Low).then(|| arm.inverse.shell(&s.attitude));
        let shells = stations.iter().map(shell).collect();
        let ranker = |s: &Station| Ranker::new(&arm.chain, &arm.inverse, &s.gauge, &s.grid);
        let rankers = stations.iter().map(ranker).collect();
        Ok(Self { arm, base: cell.base, stations, rankers, shells })
    }

    pub fn inverse(&self) -> &Inverse {
        &self.arm.inverse
    }

    /// What is missing if no node of an operation can be in reach by the length of the links alone: the
    /// gap of the node nearest to reach, so that it falls into that of the whole loop on the way there.
    fn beyond_reach(&self, operation: usize, at: &Placement, approach: &mut Approach) -> Option<Gap> {
        let (station, shell) = (&self.stations[operation], self.shells[operation].as_ref()?);
        let range = station.grid.distances(at, &shell.centre);
        if shell.gap(range) == 0.0 {
            return None;
        }
        let distance = |node: &usize| (station.grid.target(at, *node) - shell.centre).norm();
        let outside = range.0 > shell.outer;
        let order = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        let nodes = 0..station.grid.count();
        let nearest = if outside { nodes.min_by(order) } else { nodes.max_by(order) }?;
        self.arm.inverse.set(approach, &station.attitude, at.yaw);
        let target = station.grid.target(at, nearest);
        Some(self.arm.inverse.visit(&target, approach, &mut self.arm.inverse.scratch(), |_, _| ()))
    }

    /// How an operation judges postures.
    pub fn gauge(&self, operation: usize) -> &Gauge {
        &self.stations[operation].gauge
    }

    /// The frames at joint coordinates.
    pub fn frames(&self, joints: &JointVector) -> Frames {
        self.arm.chain.frames(&self.arm.chain.posture(joints))
    }

    /// What an operation depends on besides its own posture; `spots` are those of the operations
    /// before it.
    ///
    /// # Errors
    /// What is missing.
    pub fn situation(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &Placed,
        spots: &[Option<Spot>],
    ) -> Result<Situation, Unjudged> {
        let station = &self.stations[operation];
        let at = |s: &Station| self.in_base(&layout.placements[s.equipment]);
        let site = station.site(&station.gauge, &at(station), &self.arm, scene, placed)?;
        let Some(other) = station.relative_to else { return Ok(Situation { site, reference: None }) };
        let spot = spots.get(other).copied().flatten().ok_or(Unjudged::NoPick)?;
        let pick = &self.stations[other];
        let target = pick.grid.target(&at(pick), spot.node);
        let approach = pick.approach(&self.arm, &at(pick));
        let frames = self.arm.frames(&target, &approach, spot.branch).ok_or(Unjudged::NoPick)?;
        let site_of_pick = pick.site(&station.gauge, &at(pick), &self.arm, scene, placed)?;
        let reference = Reference::new(&station.gauge, site_of_pick, frames);
        Ok(Situation { site, reference: Some(Box::new(reference)) })
    }

    /// The least-error spot of an operation that touches nothing; `spots` are those of the
    /// operations before it. Cheap tests first: geometry, limits, error; collision only for
    /// candidates that can still win.
    pub fn least_error(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut Placed,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
    ) -> Outcome {
        let station = &self.stations[operation];
        let at = self.in_base(&layout.placements[station.equipment]);
        if let Some(gap) = self.beyond_reach(operation, &at, &mut scratch.approach) {
            return Outcome::Unreachable { gap };
        }
        let situation = self.situation(operation, layout, scene, placed, spots);
        for missing in scratch.memories.len()..=operation {
            scratch.memories.push(self.stations[missing].gauge.memory());
        }
        self.arm.inverse.set(&mut scratch.approach, &station.attitude, at.yaw);
        if let Ok(situation) = &situation
            && let Some(outcome) = self.ranked((operation, &at), situation, scene, placed, scratch)
        {
            return outcome;
        }
        let Scratch { candidates, frames, approach, memories, .. } = scratch;
        let memory = &mut memories[operation];
        let mut posture = self.arm.inverse.scratch();
        let mut gap = Gap::ALL;
        candidates.clear();
        let mut reached = false;
        station.grid.targets(&at, |node, target| {
            let missed = self.arm.inverse.visit(&target, approach, &mut posture, |branch, posture| {
                reached = true;
                let judged = situation.as_ref().ok().filter(|s| !s.touches(&target));
                if let Some(situation) = judged {
                    self.arm.chain.place(posture, frames);
                    let value = station.gauge.value(situation, frames, memory);
                    candidates.push(Candidate { spot: Spot { node, branch, value }, target });
                }
            });
            if missed.is_less(&gap) {
                gap = missed;
            }
        });
        match situation {
            _ if !reached => Outcome::Unreachable { gap },
            Err(why) => Outcome::Unjudged(why),
            Ok(_) if candidates.is_empty() => Outcome::Unjudged(Unjudged::OnlyTouched),
            Ok(_) => self.first_free((operation, approach), scene, placed, candidates, frames),
        }
    }

    /// The least-error candidate that touches nothing. Its target is solved again for its one
    /// posture: dearer than keeping it, but few candidates ever come here and all of them would have
    /// to be stored.
    fn first_free(
        &self,
        (operation, approach): (usize, &Approach),
        scene: &Scene,
        placed: &mut Placed,
        candidates: &mut Vec<Candidate>,
        frames: &mut Frames,
    ) -> Outcome {
        let mut heap = BinaryHeap::from(std::mem::take(candidates));
        let nearest = heap.peek().map(|c| c.spot);
        let mut found = None;
        while let Some(Candidate { spot, target }) = heap.pop() {
            let Some(posture) = self.arm.inverse.posture(&target, approach, spot.branch) else { continue };
            self.arm.chain.place(&posture, frames);
            if scene.is_free(placed, &frames.links, Some(operation)) {
                found = Some(spot);
                break;
            }
        }
        *candidates = heap.into_vec();
        match (found, nearest) {
            (Some(spot), _) => Outcome::Found(spot),
            (None, Some(nearest)) => Outcome::AllCollide { nearest },
            (None, None) => Outcome::Unjudged(Unjudged::OnlyTouched),
        }
    }

    /// The whole map of an operation; `spots` are those of the operations before it.
    pub fn map(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &Placed,
        spots: &[Option<Spot>],
    ) -> OperationMap {
        let station = &self.stations[operation];
        let situation = self.situation(operation, layout, scene, placed, spots);
        let at = self.in_base(&layout.placements[station.equipment]);
        let mut memory = station.gauge.memory();
        let approach = station.approach(&self.arm, &at);
        let mut nodes = Vec::with_capacity(station.grid.count());
        station.grid.targets(&at, |k, target| {
            let (i, j) = station.grid.index(k);
            let position = self.base.pose().transform(&target);
            let (status, posture) =
                self.judge(&target, (operation, &approach), &situation, scene, placed, &mut memory);
            nodes.push(NodeRecord { i, j, position, status, posture });
        });
        let free = |p: &&PostureRecord| !p.touched;
        let usable = |n: &NodeRecord| {
            n.posture.as_ref().filter(|_| n.status == Status::Ok).filter(free).map(|p| p.value)
        };
        let errors = nodes.iter().enumerate().filter_map(|(k, n)| Some((k, usable(n)?)));
        let best = errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        OperationMap { operation, senses: station.gauge.reported.clone(), nodes, best }
    }

    fn judge(
        &self,
        target: &Vector3<f64>,
        (operation, approach): (usize, &Approach),
        situation: &Result<Situation, Unjudged>,
        scene: &Scene,
        placed: &Placed,
        memory: &mut Memory,
    ) -> (Status, Option<PostureRecord>) {
        let station = &self.stations[operation];
        let branches = match self.arm.inverse.branches(target, approach) {
            Reach::OutOfReach { by } => return (Status::OutOfReach { by }, None),
            Reach::Attitude { by, joint } => return (Status::Attitude { by, joint }, None),
            Reach::NotConverged { position, angle } => {
                return (Status::NotConverged { position, angle }, None);
            }
            Reach::Branches(branches) => branches,
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
        let mut first_hit = None;
        for (_, frames, branch) in &within {
            match scene.hit(placed, &frames.links, Some(operation)) {
                None => {
                    return (
                        Status::Ok,
                        Some(self.record(station, situation, (target, frames), branch, memory)),
                    );
                }
                Some(hit) => first_hit = first_hit.or(Some(hit)),
            }
        }
        match (first_hit, within.first()) {
            (Some(hit), Some((_, frames, branch))) => (
                Status::Collision { hit },
                Some(self.record(station, situation, (target, frames), branch, memory)),
            ),
            _ => (least_violation(&branches), None),
        }
    }

    fn record(
        &self,
        station: &Station,
        situation: &Situation,
        (target, frames): (&Vector3<f64>, &Frames),
        branch: &Branch,
        memory: &mut Memory,
    ) -> PostureRecord {
        let judged = station.gauge.judge(situation, frames, memory);
        let to_world = station.gauge.world.transpose();
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
}

/// The joint limit that the most nearly allowed branch passes, or the attitude that it misses.
fn least_violation(branches: &[Branch]) -> Status {
    let passed = branches.iter().filter_map(|b| b.violation.map(|v| (v, b.joints[v.joint])));
    let least = passed.min_by(|a, b| a.0.by.total_cmp(&b.0.by));
    let off = branches.iter().filter(|b| b.violation.is_none()).map(|b| b.off).reduce(f64::min);
    match (off, least) {
        (Some(by), _) => Status::Attitude { by, joint: None },
        (None, Some((violation, needs))) => Status::JointLimit { violation, needs },
        (None, None) => Status::OutOfReach { by: 0.0 },
    }
}
