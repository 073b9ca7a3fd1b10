//! Usable spots of an operation in ascending order of value, for the robust search.

use super::candidate::PostureCandidate;
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::MapperWorkspace;
use std::collections::BinaryHeap;

impl PlacedLayout<'_> {
    /// Calls `take` for each usable node, in ascending order of value, until `take` returns false. The
    /// argument of `take` is the node with its best usable posture.
    ///
    /// The first spot is the spot that [`Self::least_error`] finds.
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
            let found = query.first_free(memory, |_| std::iter::from_fn(|| heap.pop()).find(is_new));
            let Some(PostureCandidate { spot, .. }) = found.free else { return };
            taken[spot.node] = true;
            if !take(spot) {
                return;
            }
        }
    }
}
