//! An operation that happens at every one of its nodes: all of them must be usable, and their values
//! make one.

use super::mapper::{Mapper, Scratch};
use super::outcome::{Candidate, Outcome, Spot, Unjudged};
use crate::cell::Layout;
use crate::clearance::{PlacedSolids, Scene};
use crate::reach::{Gap, ToolAttitudes};
use crate::reading::WorkContext;
use crate::robot::Frames;

/// How far the nodes that cannot be reached are from it.
#[derive(Default)]
struct Missing {
    out_of_reach: usize,
    reach: f64,
    beyond_limits: usize,
    limits: f64,
}

impl Missing {
    fn note(&mut self, gap: &Gap) {
        if gap.reach > 0.0 {
            self.out_of_reach += 1;
            self.reach += gap.reach;
        } else {
            self.beyond_limits += 1;
            self.limits += gap.limits;
        }
    }

    /// The mean over all nodes: it falls with every node that comes nearer. None if nothing is missing.
    fn gap(&self, nodes: usize) -> Option<Gap> {
        if self.out_of_reach > 0 {
            let reach = (self.reach / nodes as f64).max(f64::MIN_POSITIVE);
            return Some(Gap { reach, limits: 0.0 });
        }
        (self.beyond_limits > 0).then(|| Gap { reach: 0.0, limits: self.limits / nodes as f64 })
    }
}

impl Mapper {
    /// What an operation gets: its least-error spot, or the value of all its nodes; `spots` are those
    /// of the operations before it.
    pub fn outcome(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut PlacedSolids,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
    ) -> Outcome {
        if self.stations[operation].over.takes_all() {
            self.every_node(operation, layout, scene, placed, spots, scratch)
        } else {
            self.least_error(operation, layout, scene, placed, spots, scratch)
        }
    }

    /// The value of all nodes, and the worst of them as the spot.
    fn every_node(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut PlacedSolids,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
    ) -> Outcome {
        match self.every_free(operation, layout, scene, placed, spots, scratch) {
            Err(outcome) => outcome,
            Ok(free) => {
                // The first of several that are worst.
                let by_value = |a: &&Spot, b: &&Spot| a.value.total_cmp(&b.value);
                let Some(worst) = free.iter().rev().max_by(by_value) else {
                    return Outcome::Unjudged(Unjudged::OnlyTouched);
                };
                let mut values: Vec<f64> = free.iter().map(|spot| spot.value).collect();
                let value = self.stations[operation].over.of(&mut values);
                Outcome::Found(Spot { value, ..*worst })
            }
        }
    }

    /// The least-error free spot of every node, in their order; or why one has none.
    pub fn every_free(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        placed: &mut PlacedSolids,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
    ) -> Result<Vec<Spot>, Outcome> {
        let situation = self.situation(operation, layout, scene, placed, spots);
        let candidates = match self.candidates(operation, layout, situation.as_ref().ok(), scratch) {
            Ok(candidates) => candidates,
            Err(gap) => return Err(Outcome::Unreachable { gap }),
        };
        if let Err(why) = situation {
            return Err(Outcome::Unjudged(why));
        }
        let approach = self.stand(operation, layout).approach(&self.arm);
        let mut frames = Frames::default();
        let mut all = Vec::new();
        for of_node in candidates.chunk_by(|a, b| a.spot.node == b.spot.node) {
            let mut refused = None;
            let free = of_node.iter().find(|c| {
                let is_free = self.is_free((operation, &approach), c, scene, placed, &mut frames);
                let posture = (&c.target, c.spot.branch);
                let refusal = is_free.then(|| self.refusal((operation, &approach), posture, scene, placed));
                refused = refused.or(refusal.flatten());
                refusal == Some(None)
            });
            let nearest = of_node[0].spot;
            match (free, refused) {
                (Some(free), _) => all.push(free.spot),
                (None, Some(refusal)) => return Err(Outcome::Refused { nearest, refusal }),
                (None, None) => return Err(Outcome::AllCollide { nearest }),
            }
        }
        Ok(all)
    }

    /// The postures of every node, node by node, each from its least value up; or how much is missing
    /// to reach them all.
    fn candidates(
        &self,
        operation: usize,
        layout: &Layout,
        situation: Option<&WorkContext>,
        scratch: &mut Scratch,
    ) -> Result<Vec<Candidate>, Gap> {
        let (station, stand) = (&self.stations[operation], self.stand(operation, layout));
        let (memory, frames) = scratch.of(self, operation);
        let approach = stand.approach(&self.arm);
        let mut posture = self.arm.inverse.scratch();
        let (mut candidates, mut missing) = (Vec::<Candidate>::new(), Missing::default());
        station.grid.targets(&stand.at, |node, target| {
            let first = candidates.len();
            let mut reached = false;
            let gap = self.arm.inverse.visit(&target, &approach, &mut posture, |branch, posture| {
                reached = true;
                if let Some(situation) = situation.filter(|s| !s.touches(&target)) {
                    self.arm.chain.place(posture, frames);
                    let value = station.gauge.value(situation, frames, memory);
                    candidates.push(Candidate { spot: Spot { node, branch, value }, target });
                }
            });
            if !reached {
                missing.note(&gap);
            }
            // A candidate is greater the less its value.
            candidates[first..].sort_by(|a, b| b.cmp(a));
        });
        missing.gap(station.grid.count()).map_or(Ok(candidates), Err)
    }

    /// Whether the posture of a candidate touches nothing.
    pub(super) fn is_free(
        &self,
        (operation, approach): (usize, &ToolAttitudes),
        candidate: &Candidate,
        scene: &Scene,
        placed: &mut PlacedSolids,
        frames: &mut Frames,
    ) -> bool {
        let posture = self.arm.inverse.posture(&candidate.target, approach, candidate.spot.branch);
        posture.is_some_and(|posture| {
            self.arm.chain.place(&posture, frames);
            scene.is_free(placed, &frames.links, Some(operation))
        })
    }
}
