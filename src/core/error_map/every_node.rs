//! Operations that happen at every one of their nodes: all nodes must be usable, and their values combine
//! into one.

use super::candidate::PostureCandidate;
use super::outcome::{Outcome, Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::walk::{OperationQuery, PostureVisitor, VisitedNode};
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::reach::Gap;

/// Candidates of all nodes, and the sums of the [`Gap`]s of the nodes that cannot be reached.
///
/// The candidates are sorted by node; those of one node are sorted from best to worst.
#[derive(Default)]
struct CandidatesByNode {
    candidates: Vec<PostureCandidate>,
    /// Index of the first candidate of the current node.
    first: usize,
    unreached: UnreachedNodes,
}

impl PostureVisitor for CandidatesByNode {
    fn candidate(&mut self, candidate: PostureCandidate) {
        self.candidates.push(candidate);
    }

    fn end_of_node(&mut self, _: &OperationQuery<'_>, node: &VisitedNode, _: &mut PostureMemory) {
        if let Some(gap) = &node.missed {
            self.unreached.note(gap);
        }
        self.candidates[self.first..].sort_by(|a, b| b.cmp(a));
        self.first = self.candidates.len();
    }
}

/// Sums of the gaps ([`Gap`]) of the nodes that cannot be reached.
#[derive(Default)]
struct UnreachedNodes {
    out_of_reach: usize,
    reach: f64,
    beyond_limits: usize,
    limits: f64,
}

impl UnreachedNodes {
    fn note(&mut self, gap: &Gap) {
        if gap.reach > 0.0 {
            self.out_of_reach += 1;
            self.reach += gap.reach;
        } else {
            self.beyond_limits += 1;
            self.limits += gap.limits;
        }
    }

    /// Returns the mean [`Gap`] over all nodes; None if all nodes are reached.
    ///
    /// If any node is out of reach, only distances from the reach count, and violations of limits do not. The
    /// mean then decreases whenever an unreached node comes nearer to the reach of the arm.
    fn gap(&self, nodes: usize) -> Option<Gap> {
        if self.out_of_reach > 0 {
            let reach = (self.reach / nodes as f64).max(f64::MIN_POSITIVE);
            return Some(Gap { reach, limits: 0.0 });
        }
        (self.beyond_limits > 0).then(|| Gap { reach: 0.0, limits: self.limits / nodes as f64 })
    }
}

impl PlacedLayout<'_> {
    /// Finds the spot of an operation and its value.
    ///
    /// For an operation at every node, the value combines all nodes, and the spot is the worst node.
    ///
    /// `spots` holds the spots of the earlier operations.
    pub fn outcome(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Outcome {
        if !self.mapper.setups[operation].over.needs_every_node() {
            return self.least_error(operation, spots, workspace);
        }
        self.every_free(operation, spots, workspace)
            .map_or_else(|why| why, |free| self.value_of_all(operation, &free))
    }

    /// Combines the values of all nodes; the spot is the worst node, or the first of several equally bad
    /// nodes.
    fn value_of_all(&self, operation: usize, free: &[Spot]) -> Outcome {
        let by_value = |a: &&Spot, b: &&Spot| a.value.total_cmp(&b.value);
        let Some(worst) = free.iter().rev().max_by(by_value) else {
            return Outcome::Unjudged(Unjudged::OnlyTouched);
        };
        let mut values: Vec<f64> = free.iter().map(|spot| spot.value).collect();
        let value = self.mapper.setups[operation].over.of(&mut values);
        Outcome::Found(Spot { value, ..*worst })
    }

    /// Finds the least-error usable spot of every node, in the order of the nodes; nodes touched to teach the
    /// frame are left out.
    ///
    /// # Errors
    /// Returns the outcome if some node has no usable spot.
    pub fn every_free(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Result<Vec<Spot>, Outcome> {
        let query = OperationQuery::new(self, operation, spots);
        let memory = workspace.of(self.mapper, operation).postures;
        let mut nodes = CandidatesByNode::default();
        query.walk(memory, &mut nodes);
        if let Some(gap) = nodes.unreached.gap(query.setup.grid.count()) {
            return Err(Outcome::Unreachable { gap });
        }
        if let Err(why) = query.context {
            return Err(Outcome::Unjudged(why));
        }
        let mut all = Vec::new();
        for of_node in nodes.candidates.chunk_by(|a, b| a.spot.node == b.spot.node) {
            let mut next = of_node.iter().copied();
            match query.first_free(memory, |_| next.next()).outcome() {
                Some(Outcome::Found(spot)) => all.push(spot),
                Some(why) => return Err(why),
                None => {}
            }
        }
        Ok(all)
    }
}
