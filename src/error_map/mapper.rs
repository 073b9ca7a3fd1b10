//! From a placed surface to its least-error spot.

use super::outcome::{Candidate, Outcome, Spot, Unjudged};
use super::ranking::{Ranker, Ranking};
use super::station::{Arm, Stand, Station};
use crate::cell::{Cell, Coordinate, JointVector, Layout, Operation};
use crate::clearance::{PlacedSolids, Scene};
use crate::files::shown;
use crate::motion::Guard;
use crate::reach::{Cost, Gap, Inverse, Shell, ToolAttitudes};
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::robot::{Chain, Frames};
use std::collections::BinaryHeap;

/// Robot, errors and operations of a cell, made ready for the node loop.
pub struct Mapper {
    pub(super) arm: Arm,
    pub(super) stations: Vec<Station>,
    /// None: nothing is asked of motion.
    pub(super) guard: Option<Guard>,
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
    pub(super) approach: ToolAttitudes,
    /// One per operation.
    pub(super) memories: Vec<EvaluatorScratch>,
    pub(super) ranking: Ranking,
}

impl Scratch {
    /// The memory of an operation, and frames.
    pub(super) fn of(&mut self, mapper: &Mapper, operation: usize) -> (&mut EvaluatorScratch, &mut Frames) {
        for missing in self.memories.len()..=operation {
            self.memories.push(mapper.stations[missing].gauge.memory());
        }
        (&mut self.memories[operation], &mut self.frames)
    }
}

impl Mapper {
    /// # Errors
    /// What an operation asks of the tool and the robot cannot do by its build.
    pub fn new(cell: &Cell) -> Result<Self, String> {
        let chain = Chain::with_margins(&cell.robot, &cell.margins);
        let inverse = Inverse::new(&chain);
        for operation in &cell.operations {
            if let Some(why) = inverse.refusal(&operation.attitude) {
                return Err(format!("operation {}: {why}", shown(&operation.name)));
            }
        }
        let arm = Arm { chain, inverse };
        let stations: Vec<_> = cell.operations.iter().map(|o| Station::new(cell, o)).collect();
        let shell = |o: &Operation| {
            // An attitude that is searched has a shell for each of its values.
            let is_fixed = !o.angles.iter().flatten().any(Coordinate::is_free);
            let pays = arm.inverse.cost() != Cost::Low && is_fixed;
            pays.then(|| arm.inverse.shell(&o.attitude))
        };
        let shells = cell.operations.iter().map(shell).collect();
        let ranker = |s: &Station| Ranker::new(&arm.chain, &arm.inverse, &s.gauge, &s.grid);
        let rankers = stations.iter().map(ranker).collect();
        Ok(Self { arm, stations, guard: Guard::new(cell), rankers, shells })
    }

    pub fn inverse(&self) -> &Inverse {
        &self.arm.inverse
    }

    /// What is missing if no node of an operation can be in reach by the length of the links alone: the
    /// gap of the node nearest to reach, so that it falls into that of the whole loop on the way there.
    fn beyond_reach(&self, operation: usize, stand: &Stand<'_>, approach: &mut ToolAttitudes) -> Option<Gap> {
        let at = &stand.at;
        let (station, shell) = (&self.stations[operation], self.shells[operation].as_ref()?);
        let range = station.grid.distances(at, &shell.centre);
        if shell.gap(range.0, range.1) == 0.0 {
            return None;
        }
        let distance = |node: &usize| (station.grid.target(at, *node) - shell.centre).norm();
        let outside = range.0 > shell.outer;
        let order = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        let nodes = 0..station.grid.count();
        let nearest = if outside { nodes.min_by(order) } else { nodes.max_by(order) }?;
        self.arm.inverse.set_attitudes(approach, stand.attitude, at.yaw);
        let target = station.grid.target(at, nearest);
        Some(self.arm.inverse.visit(&target, approach, &mut self.arm.inverse.scratch(), |_, _| ()))
    }

    /// From now on maps tell of the own sense of their operation alone.
    pub fn report_own_senses(&mut self) {
        self.stations.iter_mut().for_each(|station| station.gauge.report_own_sense());
    }

    /// How an operation judges postures.
    pub fn gauge(&self, operation: usize) -> &ErrorEvaluator {
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
        placed: &PlacedSolids,
        spots: &[Option<Spot>],
    ) -> Result<WorkContext, Unjudged> {
        let station = &self.stations[operation];
        let stand = self.stand(operation, layout);
        let site = station.site(&station.gauge, &stand, &self.arm, scene, placed)?;
        let Some(other) = station.relative_to else { return Ok(WorkContext { site, reference: None }) };
        let spot = spots.get(other).copied().flatten().ok_or(Unjudged::NoPick)?;
        let (pick, stand) = (&self.stations[other], self.stand(other, layout));
        let target = pick.grid.target(&stand.at, spot.node);
        let approach = stand.approach(&self.arm);
        let frames = self.arm.frames(&target, &approach, spot.branch).ok_or(Unjudged::NoPick)?;
        let site_of_pick = pick.site(&station.gauge, &stand, &self.arm, scene, placed)?;
        let reference = station.gauge.pick_reference(site_of_pick, frames);
        Ok(WorkContext { site, reference: Some(Box::new(reference)) })
    }

    /// The least-error spot of an operation that touches nothing; `spots` are those of the
    /// operations before it. Cheap tests first: geometry, limits, error; collision only for
    /// candidates that can still win.
    pub fn least_error(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut PlacedSolids,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
    ) -> Outcome {
        let station = &self.stations[operation];
        let stand = self.stand(operation, layout);
        if let Some(gap) = self.beyond_reach(operation, &stand, &mut scratch.approach) {
            return Outcome::Unreachable { gap };
        }
        let situation = self.situation(operation, layout, scene, placed, spots);
        scratch.of(self, operation);
        self.arm.inverse.set_attitudes(&mut scratch.approach, stand.attitude, stand.at.yaw);
        if let Ok(situation) = &situation
            && let Some(outcome) = self.ranked((operation, &stand.at), situation, scene, placed, scratch)
        {
            return outcome;
        }
        let Scratch { candidates, frames, approach, memories, .. } = scratch;
        let memory = &mut memories[operation];
        let mut posture = self.arm.inverse.scratch();
        let mut gap = Gap::ALL;
        candidates.clear();
        let mut reached = false;
        station.grid.targets(&stand.at, |node, target| {
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
        (operation, approach): (usize, &ToolAttitudes),
        scene: &Scene,
        placed: &mut PlacedSolids,
        candidates: &mut Vec<Candidate>,
        frames: &mut Frames,
    ) -> Outcome {
        let mut heap = BinaryHeap::from(std::mem::take(candidates));
        let nearest = heap.peek().map(|c| c.spot);
        let (mut found, mut refused) = (None, None);
        while let Some(Candidate { spot, target }) = heap.pop() {
            let Some(posture) = self.arm.inverse.posture(&target, approach, spot.branch) else { continue };
            self.arm.chain.place(&posture, frames);
            if !scene.is_free(placed, &frames.links, Some(operation)) {
                continue;
            }
            match self.refusal((operation, approach), (&target, spot.branch), scene, placed) {
                None => {
                    found = Some(spot);
                    break;
                }
                Some(refusal) => refused = refused.or(Some((spot, refusal))),
            }
        }
        *candidates = heap.into_vec();
        if let (None, Some((nearest, refusal))) = (found, refused) {
            return Outcome::Refused { nearest, refusal };
        }
        match (found, nearest) {
            (Some(spot), _) => Outcome::Found(spot),
            (None, Some(nearest)) => Outcome::AllCollide { nearest },
            (None, None) => Outcome::Unjudged(Unjudged::OnlyTouched),
        }
    }

    /// How an operation stands in a layout.
    pub(super) fn stand<'l>(&self, operation: usize, layout: &'l Layout) -> Stand<'l> {
        let at = layout.placements[self.stations[operation].equipment].seen_from(&layout.base);
        Stand { at, attitude: &layout.attitudes[operation], world: layout.base.from_world() }
    }
}
