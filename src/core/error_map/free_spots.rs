//! Usable spots of an operation in ascending order of value, for the robust search.

use super::candidate::PostureCandidate;
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};
use std::collections::BinaryHeap;

impl PlacedLayout<'_> {
    /// Calls `take` for each usable node until `take` returns false. The argument of `take` is the node with
    /// its best usable posture.
    ///
    /// The nodes come in ascending order of the least value among their usable sampled postures. Before each
    /// call, the posture with the least value is refined along its redundant coordinates. The refinement can
    /// decrease the value.
    pub fn free_spots(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
        mut take: impl FnMut(Spot) -> bool,
    ) {
        let query = OperationQuery::new(self, operation, spots);
        let memory = workspace.of(self.mapper, operation).postures;
        let mut candidates = Vec::new();
        query.walk(memory, &mut candidates);
        let mut heap = BinaryHeap::from(candidates);
        let mut taken = vec![false; query.setup.grid.count()];
        loop {
            let is_new = |candidate: &PostureCandidate| !taken[candidate.spot.node];
            let next = |_: &mut PostureMemory| std::iter::from_fn(|| heap.pop()).find(is_new);
            let Some(sample) = query.first_free_sample(memory, next).free else { return };
            let PostureCandidate { spot, .. } = query.refined_alone(sample, memory);
            taken[spot.node] = true;
            if !take(spot) {
                return;
            }
        }
    }
}
