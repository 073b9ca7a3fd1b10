//! Operations that happen at every one of their nodes: all nodes must be usable, and their values are
//! combined into one value.

use super::candidate::PostureCandidate;
use super::family_queue::FamilyQueue;
use super::node_ranking::NodeRanking;
use super::outcome::{Outcome, Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::spin_families::FamilyBounds;
use super::walk::{OperationQuery, PostureVisitor};
use super::workspace::{MapperWorkspace, PostureMemory, WalkMemory};
use crate::cell::NodeAggregation;
use crate::reach::{Cost, Gap};
use nalgebra::Vector3;
use std::collections::BinaryHeap;

/// Candidates of one node, and a measure of how far an unreached node is from a usable posture ([`Gap`]).
///
/// `BOUNDS` states whether candidates may carry a lower bound of their value.
struct NodeCandidates<'c, const BOUNDS: bool> {
    candidates: &'c mut Vec<PostureCandidate>,
    missed: Option<Gap>,
}

impl<const BOUNDS: bool> PostureVisitor for NodeCandidates<'_, BOUNDS> {
    const TAKES_BOUNDS: bool = BOUNDS;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.candidates.push(candidate);
    }

    fn end_of_node(&mut self, missed: Option<Gap>) {
        self.missed = missed;
    }
}

/// Counts of the nodes that cannot be reached, and sums of their gaps ([`Gap`]).
#[derive(Default)]
pub(super) struct UnreachedNodes {
    out_of_reach: usize,
    reach: f64,
    beyond_limits: usize,
    limits: f64,
}

impl UnreachedNodes {
    pub fn is_empty(&self) -> bool {
        self.out_of_reach == 0 && self.beyond_limits == 0
    }

    pub fn note(&mut self, gap: &Gap) {
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
    /// If any node is out of reach, the mean includes only the distances of nodes from the arm's reach.
    /// Violations of joint limits are then left out. The mean then decreases whenever an unreached node comes
    /// nearer to the reach of the arm.
    pub fn gap(&self, nodes: usize) -> Option<Gap> {
        if self.out_of_reach > 0 {
            let reach = (self.reach / nodes as f64).max(f64::MIN_POSITIVE);
            return Some(Gap { reach, limits: 0.0 });
        }
        (self.beyond_limits > 0).then(|| Gap { reach: 0.0, limits: self.limits / nodes as f64 })
    }
}

impl PlacedLayout<'_> {
    /// Finds the spot of an operation, and computes the value of the operation.
    ///
    /// If the operation happens at every node, the value combines the values of all nodes, and the spot is
    /// the worst node.
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
        if self.mapper.ranks && self.mapper.setups[operation].over == NodeAggregation::Max {
            return self.worst_node(operation, spots, workspace);
        }
        self.every_free(operation, spots, workspace)
            .map_or_else(|why| why, |free| self.value_of_all(operation, &free))
    }

    /// Combines the values of all nodes. The spot in the returned outcome is the worst node, or the first of
    /// several equally bad nodes.
    pub fn value_of_all(&self, operation: usize, free: &[Spot]) -> Outcome {
        let by_value = |a: &&Spot, b: &&Spot| a.value.total_cmp(&b.value);
        let Some(worst) = free.iter().rev().max_by(by_value) else {
            return Outcome::Unjudged(Unjudged::OnlyTouched);
        };
        let mut values: Vec<f64> = free.iter().map(|spot| spot.value).collect();
        let value = self.mapper.setups[operation].over.of(&mut values);
        Outcome::Found(Spot { value, ..*worst })
    }

    /// Finds the least-error usable posture of every node, in the order of the nodes. Nodes that the robot
    /// touches to teach the frame are left out.
    ///
    /// # Errors
    /// Returns the reason as an [`Outcome`] if any node is unusable or its error cannot be computed.
    pub fn every_free(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Result<Vec<Spot>, Outcome> {
        let query = OperationQuery::new(self, operation, spots);
        let mut memory = workspace.of(self.mapper, operation);
        let has_families = self.mapper.lacks_families(operation, &query.attitudes).is_none();
        let (mut unreached, mut all, mut why) = (UnreachedNodes::default(), Vec::new(), None);
        if query.is_reach_cheaper() {
            query.setup.grid.targets(&query.at, |_, target| {
                if let Err(gap) = query.reached(&target, memory.postures) {
                    unreached.note(&gap);
                }
            });
            if let Some(gap) = unreached.gap(query.setup.grid.count()) {
                return Err(Outcome::Unreachable { gap });
            }
        }
        query.setup.grid.targets(&query.at, |node, target| {
            memory.postures.firsts.clear();
            // Once a node has failed, the remaining nodes matter only if they cannot be reached.
            let is_judged = unreached.is_empty() && why.is_none() && query.context.is_ok();
            let judged = match is_judged {
                true => query.judged_node(node, target, has_families, &mut memory),
                false => query.reached(&target, memory.postures).map(|()| None),
            };
            match judged {
                Err(gap) => unreached.note(&gap),
                Ok(Some(Outcome::Found(spot))) => all.push(spot),
                Ok(Some(other)) => why = Some(other),
                Ok(None) => {}
            }
        });
        if let Some(gap) = unreached.gap(query.setup.grid.count()) {
            return Err(Outcome::Unreachable { gap });
        }
        if let Err(why) = query.context {
            return Err(Outcome::Unjudged(why));
        }
        why.map_or(Ok(all), Err)
    }
}

impl OperationQuery<'_> {
    /// Returns whether the inverse kinematics of a node costs far less than the checks of its postures.
    ///
    /// The motion rules and the certificates of a posture take several microseconds.
    fn is_reach_cheaper(&self) -> bool {
        let is_fast = matches!(self.placed.mapper.arm.inverse.cost(), Cost::Low | Cost::Middle);
        is_fast && (self.asks_postures() || self.placed.demand.is_some())
    }

    /// Returns the outcome at one node: the least-error usable posture, or the reason why there is none.
    /// Returns None if the robot touches the node to teach the frame.
    ///
    /// # Errors
    /// Returns how far the node is from having a usable posture ([`Gap`]) if no posture reaches it.
    pub(super) fn judged_node(
        &self,
        node: usize,
        target: Vector3<f64>,
        has_families: bool,
        memory: &mut WalkMemory<'_>,
    ) -> Result<Option<Outcome>, Gap> {
        self.collect_postures(node, target, has_families.then_some(FamilyBounds::Posture), memory)?;
        self.judge_collected(&target, has_families, memory)
    }

    /// Collects the spin families of one node, and the candidates that belong to no family. The first members
    /// of the families are added to [`PostureMemory::firsts`]. The families get bounds from `bounds`; without
    /// it, every posture is a candidate of its own.
    ///
    /// # Errors
    /// Returns how far the node is from having a usable posture ([`Gap`]) if no posture reaches it.
    pub(super) fn collect_postures(
        &self,
        node: usize,
        target: Vector3<f64>,
        bounds: Option<FamilyBounds<'_>>,
        memory: &mut WalkMemory<'_>,
    ) -> Result<(), Gap> {
        let WalkMemory { candidates, families, postures, .. } = memory;
        candidates.clear();
        families.clear();
        let missed = if let Some(bounds) = bounds {
            let mut others = NodeCandidates::<false> { candidates, missed: None };
            self.visit_families(node, target, bounds, postures, families, &mut others);
            others.missed
        } else {
            let mut all = NodeCandidates::<true> { candidates, missed: None };
            self.visit(node, target, postures, &mut all);
            all.missed
        };
        missed.map_or(Ok(()), Err)
    }

    /// Returns the outcome at the node whose postures were collected: the least-error usable posture, or the
    /// reason why there is none. Returns None if the robot touches the node to teach the frame.
    ///
    /// # Errors
    /// Returns how far the node is from having a usable posture ([`Gap`]) if no posture reaches it.
    pub(super) fn judge_collected(
        &self,
        target: &Vector3<f64>,
        has_families: bool,
        memory: &mut WalkMemory<'_>,
    ) -> Result<Option<Outcome>, Gap> {
        let WalkMemory { candidates, families, postures, .. } = memory;
        let (mut heap, mut no_others) =
            (BinaryHeap::from(std::mem::take(*candidates)), NodeRanking::default());
        let found = match has_families {
            true => {
                let waiting = BinaryHeap::from(std::mem::take(*families));
                let mut queue = FamilyQueue { field: None, families: waiting, judged: heap, last: None };
                let found = self.first_free_of_families(&mut queue, &mut no_others, postures);
                (**families, heap) = (queue.families.into_vec(), queue.judged);
                found
            }
            false => self.first_free_of_bounds(&mut heap, &mut no_others, postures),
        };
        **candidates = heap.into_vec();
        // Without a usable posture, the node may be out of reach. Spin families do not report this case.
        match found.outcome() {
            None => self.reached(target, postures).map(|()| None),
            found => Ok(found),
        }
    }

    /// Solves the inverse kinematics of a target, without judging its postures.
    ///
    /// # Errors
    /// Returns how far the target is from having a usable posture ([`Gap`]) if no posture reaches it.
    pub(super) fn reached(&self, target: &Vector3<f64>, memory: &mut PostureMemory) -> Result<(), Gap> {
        let mut is_reached = false;
        let inverse = &self.placed.mapper.arm.inverse;
        let gap = inverse.visit(target, &self.attitudes, &mut memory.posture, |_, _| is_reached = true);
        if is_reached { Ok(()) } else { Err(gap) }
    }
}
