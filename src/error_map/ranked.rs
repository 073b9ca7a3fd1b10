//! The least-error spot of an operation whose nodes can be ranked: few nodes are judged at all.

use super::mapper::{Mapper, Scratch};
use super::outcome::{Candidate, Outcome, Spot};
use crate::cell::Placement;
use crate::clearance::{PlacedSolids, Scene};
use crate::reading::WorkContext;
use std::collections::BinaryHeap;

impl Mapper {
    /// From now on every node is judged.
    pub fn forget_ranks(&mut self) {
        self.rankers.fill(None);
    }

    /// Whether every operation can be ranked.
    pub fn is_ranked(&self) -> bool {
        self.rankers.iter().all(Option::is_some)
    }

    /// The outcome of [`Mapper::least_error`] to the bit, of a surface placed at `at` (base frame); None
    /// if the nodes cannot be ranked or none can be reached.
    pub(super) fn ranked(
        &self,
        (operation, at): (usize, &Placement),
        situation: &WorkContext,
        scene: &Scene,
        placed: &mut PlacedSolids,
        scratch: &mut Scratch,
    ) -> Option<Outcome> {
        let (station, ranker) = (&self.stations[operation], self.rankers[operation].as_ref()?);
        let Scratch { candidates, frames, approach, memories, ranking } = scratch;
        if !ranker.takes(approach) {
            return None;
        }
        ranker.rank(at, &situation.site.world, approach, ranking);
        let (memory, mut posture) = (&mut memories[operation], self.arm.inverse.scratch());
        candidates.clear();
        let mut heap = BinaryHeap::from(std::mem::take(candidates));
        let (mut nearest, mut found, mut refused) = (None, None, None);
        while found.is_none() {
            // A value equal to a bound may have an equal beside it with a smaller number.
            while heap.peek().is_none_or(|c: &Candidate| c.spot.value >= ranking.bound()) {
                let Some(node) = ranking.pop() else { break };
                let target = station.grid.target(at, node);
                self.arm.inverse.visit(&target, approach, &mut posture, |branch, posture| {
                    self.arm.chain.place(posture, frames);
                    let value = station.gauge.value(situation, frames, memory);
                    heap.push(Candidate { spot: Spot { node, branch, value }, target });
                });
            }
            let Some(Candidate { spot, target }) = heap.pop() else { break };
            nearest.get_or_insert(spot);
            let Some(posture) = self.arm.inverse.posture(&target, approach, spot.branch) else { continue };
            self.arm.chain.place(&posture, frames);
            if !scene.is_free(placed, &frames.links, Some(operation)) {
                continue;
            }
            match self.refusal((operation, approach), (&target, spot.branch), scene, placed) {
                None => found = Some(spot),
                Some(refusal) => refused = refused.or(Some((spot, refusal))),
            }
        }
        *candidates = heap.into_vec();
        match (found, refused) {
            (Some(spot), _) => Some(Outcome::Found(spot)),
            (None, Some((nearest, refusal))) => Some(Outcome::Refused { nearest, refusal }),
            (None, None) => nearest.map(|nearest| Outcome::AllCollide { nearest }),
        }
    }
}
