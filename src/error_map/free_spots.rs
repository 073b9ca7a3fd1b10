//! The spots of an operation that touch nothing, from the least value up.

use super::mapper::{Mapper, Scratch};
use super::outcome::{Candidate, Spot};
use crate::cell::Layout;
use crate::clearance::{PlacedSolids, Scene};
use crate::robot::Frames;
use std::collections::BinaryHeap;

impl Mapper {
    /// Calls `take` with the free spots of an operation in ascending order of value, the best of each
    /// node, until it returns false. The first is that of [`Self::least_error`].
    pub fn free_spots(
        &self,
        (operation, layout): (usize, &Layout),
        scene: &Scene,
        placed: &mut PlacedSolids,
        spots: &[Option<Spot>],
        scratch: &mut Scratch,
        mut take: impl FnMut(Spot) -> bool,
    ) {
        let (station, stand) = (&self.stations[operation], self.stand(operation, layout));
        let Ok(situation) = self.situation(operation, layout, scene, placed, spots) else { return };
        let (memory, frames) = scratch.of(self, operation);
        let approach = stand.approach(&self.arm);
        let mut posture = self.arm.inverse.scratch();
        let mut candidates = Vec::new();
        station.grid.targets(&stand.at, |node, target| {
            if situation.touches(&target) {
                return;
            }
            self.arm.inverse.visit(&target, &approach, &mut posture, |branch, posture| {
                self.arm.chain.place(posture, frames);
                let value = station.gauge.value(&situation, frames, memory);
                candidates.push(Candidate { spot: Spot { node, branch, value }, target });
            });
        });
        let mut taken = vec![false; station.grid.count()];
        let (mut heap, mut frames) = (BinaryHeap::from(candidates), Frames::default());
        while let Some(candidate) = heap.pop() {
            let node = candidate.spot.node;
            if taken[node] || !self.is_free((operation, &approach), &candidate, scene, placed, &mut frames) {
                continue;
            }
            let posture = (&candidate.target, candidate.spot.branch);
            if self.refusal((operation, &approach), posture, scene, placed).is_some() {
                continue;
            }
            taken[node] = true;
            if !take(candidate.spot) {
                return;
            }
        }
    }
}
