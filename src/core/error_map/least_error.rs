//! Search for the least-error spot of an operation. The search runs once for every layout.
//!
//! Cheap tests come first: geometry, limits, error. Collisions are checked only for candidates that can still
//! be the spot.

use super::candidate::{Certainty, PostureCandidate};
use super::first_free::FirstFree;
use super::node_ranking::NodeRanking;
use super::outcome::{Outcome, Spot, Unjudged};
use super::placed_layout::{PlacedLayout, PlacedSurface};
use super::value_field::ValueField;
use super::walk::{OperationQuery, PostureVisitor};
use super::workspace::{MapperWorkspace, PostureMemory, WalkMemory};
use crate::reach::{Gap, ToolAttitudes};
use std::collections::BinaryHeap;

/// Candidates of all nodes, and the least [`Gap`] of the nodes that cannot be reached.
struct AllCandidates<'c> {
    candidates: &'c mut Vec<PostureCandidate>,
    is_reached: bool,
    gap: Gap,
}

impl PostureVisitor for AllCandidates<'_> {
    const TAKES_BOUNDS: bool = true;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.candidates.push(candidate);
    }

    fn end_of_node(&mut self, missed: Option<Gap>) {
        match missed {
            None => self.is_reached = true,
            Some(gap) if gap.is_less(&self.gap) => self.gap = gap,
            Some(_) => {}
        }
    }
}

/// Candidates whose values may be lower bounds.
struct BoundedCandidates<'h>(&'h mut BinaryHeap<PostureCandidate>);

impl PostureVisitor for BoundedCandidates<'_> {
    const NEEDS_GAP: bool = false;
    const TAKES_BOUNDS: bool = true;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.0.push(candidate);
    }
}

impl PlacedLayout<'_> {
    /// Finds the least-error usable spot of an operation. `spots` holds the spots of the earlier
    /// operations.
    pub fn least_error(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Outcome {
        let surface = self.surface(operation);
        if let Some(gap) = self.beyond_reach(&surface, &mut workspace.attitudes) {
            return Outcome::Unreachable { gap };
        }
        let attitudes = std::mem::take(&mut workspace.attitudes);
        let query = OperationQuery::reusing(self, &surface, spots, attitudes);
        let mut memory = workspace.of(self.mapper, operation);
        let outcome = query.ranked(&mut memory);
        let outcome = outcome.or_else(|| query.by_spin_families(&mut memory));
        let outcome = outcome.or_else(|| query.by_value_field(&mut memory));
        let outcome = outcome.unwrap_or_else(|| query.judged(&mut memory));
        workspace.attitudes = query.attitudes;
        outcome
    }

    /// Returns the [`Gap`] of the layout if the link lengths alone show that no node is in reach; otherwise
    /// None.
    ///
    /// Inverse kinematics computes the gap for the node nearest to the reach of the arm. A
    /// [walk](OperationQuery::walk) over all nodes finds the same gap. The penalty of the layout is therefore
    /// the same with and without this shortcut.
    fn beyond_reach(&self, surface: &PlacedSurface<'_>, attitudes: &mut ToolAttitudes) -> Option<Gap> {
        let shell = self.mapper.shells[surface.operation].as_ref()?;
        let (grid, inverse) = (self.mapper.grid(surface.operation), self.mapper.inverse());
        let range = grid.distances(&surface.at, &shell.centre);
        if shell.gap(range.0, range.1) == 0.0 {
            return None;
        }
        let distance = |node: &usize| (self.target(surface, *node) - shell.centre).norm();
        let order = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        let (nodes, is_outside) = (0..grid.count(), range.0 > shell.outer);
        let nearest = if is_outside { nodes.min_by(order) } else { nodes.max_by(order) }?;
        inverse.set_attitudes(attitudes, surface.attitude, surface.at.yaw);
        Some(inverse.visit(&self.target(surface, nearest), attitudes, &mut inverse.scratch(), |_, _| ()))
    }
}

impl OperationQuery<'_> {
    /// Finds the spot by judging every node.
    fn judged(&self, memory: &mut WalkMemory<'_>) -> Outcome {
        let WalkMemory { candidates, postures, .. } = memory;
        candidates.clear();
        let mut all = AllCandidates { candidates, is_reached: false, gap: Gap::ALL };
        self.walk(postures, &mut all);
        let AllCandidates { is_reached, gap, .. } = all;
        match &self.context {
            _ if !is_reached => return Outcome::Unreachable { gap },
            Err(why) => return Outcome::Unjudged(*why),
            Ok(_) => {}
        }
        let mut heap = BinaryHeap::from(std::mem::take(*candidates));
        let found = self.first_free_of_bounds(&mut heap, &mut NodeRanking::default(), postures);
        **candidates = heap.into_vec();
        found.outcome().unwrap_or(Outcome::Unjudged(Unjudged::OnlyTouched))
    }

    /// Finds the spot, but judges only nodes whose bound in the value field is at most the least value found.
    ///
    /// Returns None if the operation has spin families or no field, if no node can be reached, or if the
    /// errors cannot be computed. The spot is bit-identical to the spot that [`Self::judged`] finds.
    fn by_value_field(&self, memory: &mut WalkMemory<'_>) -> Option<Outcome> {
        let WalkMemory { candidates, ranking, postures, .. } = memory;
        let lacks_families = self.placed.mapper.lacks_families(self.operation, &self.attitudes);
        if lacks_families.is_none() || self.context.is_err() || self.rank_by_field(ranking).is_none() {
            return None;
        }
        candidates.clear();
        let mut heap = BinaryHeap::from(std::mem::take(*candidates));
        let found = self.first_free_of_bounds(&mut heap, ranking, postures);
        **candidates = heap.into_vec();
        found.outcome()
    }

    /// Ranks the nodes by the value field of the operation, and returns this field. If no field covers the
    /// height of the nodes and the elevation of the tool, the function removes all nodes from `ranking`.
    pub(super) fn rank_by_field(&self, ranking: &mut NodeRanking) -> Option<&ValueField> {
        let (grid, mapper) = (&self.setup.grid, self.placed.mapper);
        ranking.clear();
        let elevation = self.placed.layout.attitudes[self.operation].elevation;
        let field = mapper.value_field(self.operation, self.at.z + grid.standoff(), elevation)?;
        ranking.set(grid.count(), |bounds| {
            grid.targets(&self.at, |node, target| bounds[node] = field.bound(&target));
        });
        Some(field)
    }

    /// Checks candidates in ascending order of their values or bounds, until a candidate can be used. A bound
    /// is sharpened when its candidate comes first. A node in `ranking` is visited when its bound does not
    /// exceed the least value or bound of the candidates.
    pub(super) fn first_free_of_bounds(
        &self,
        heap: &mut BinaryHeap<PostureCandidate>,
        ranking: &mut NodeRanking,
        postures: &mut PostureMemory,
    ) -> FirstFree {
        // A value that is not the least one need not be known exactly.
        let (mut is_nearest_known, mut least) = (false, f64::INFINITY);
        self.first_free(postures, |memory| {
            loop {
                while heap.peek().is_none_or(|best| best.spot.value >= ranking.bound()) {
                    let Some(node) = ranking.pop() else { break };
                    self.visit(node, self.node_target(node), memory, &mut BoundedCandidates(heap));
                }
                let candidate = heap.pop()?;
                // A posture that cannot be used needs no value, unless it is the candidate with the least
                // value.
                let is_last = match candidate.certainty {
                    Certainty::Value => true,
                    Certainty::Bound if self.setup.is_priced => !self.is_usable(&candidate, memory),
                    Certainty::Bound | Certainty::SharpBound => {
                        is_nearest_known && !self.is_free(&candidate, memory)
                    }
                    Certainty::RoughBound => false,
                };
                if is_last {
                    is_nearest_known = true;
                    return Some(candidate);
                }
                let sharpened = self.sharpened(&candidate, least, memory);
                if let Some(PostureCandidate { spot, certainty: Certainty::Value, .. }) = &sharpened {
                    least = least.min(spot.value);
                }
                heap.extend(sharpened);
            }
        })
    }

    /// Finds the spot, but judges only nodes whose lower bound of the error is at most the least error found.
    ///
    /// Returns None if the nodes cannot be ranked, if no node can be reached, or if the errors cannot be
    /// computed.
    ///
    /// The spot is bit-identical to the spot that [`Self::judged`] finds.
    fn ranked(&self, memory: &mut WalkMemory<'_>) -> Option<Outcome> {
        let ranker = self.placed.mapper.rankers[self.operation].as_ref()?;
        let context = self.context.as_ref().ok()?;
        if !ranker.takes(&self.attitudes) {
            return None;
        }
        let WalkMemory { candidates, ranking, postures, .. } = memory;
        ranker.rank(&self.at, &context.site.world, &self.attitudes, ranking);
        candidates.clear();
        let mut heap = BinaryHeap::from(std::mem::take(*candidates));
        let found = self.first_free(postures, |memory| {
            // If the best value equals a bound, the node of this bound may have the same value and a
            // smaller index. This node is therefore also judged.
            while heap.peek().is_none_or(|best| best.spot.value >= ranking.bound()) {
                let Some(node) = ranking.pop() else { break };
                self.visit(node, self.node_target(node), memory, &mut heap);
            }
            heap.pop()
        });
        **candidates = heap.into_vec();
        found.outcome()
    }
}
