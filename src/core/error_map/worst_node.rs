//! Search for the worst node of an operation that happens at every node. If the operation has spin families
//! (see `spin_families`), the search excludes most nodes by bounds. The search then computes no values of
//! these nodes.
//!
//! A node whose error is certainly below the greatest error found cannot be the worst node. For such a node,
//! the search only needs a usable posture whose value has an upper bound below that error. The search tries
//! such upper bounds only for the members of spin families. Without spin families, the search judges every
//! node, first the nodes far from the base, because their errors are usually the greatest. With spin
//! families, the nodes whose leading family has the greatest lower bound come first. The leading family has
//! the branch that had the least bound at an earlier node. Neighbouring nodes usually have their least error
//! with the same branch, so the bounds of most other families are never needed.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::every_node::UnreachedNodes;
use super::family_queue::SpinFamily;
use super::outcome::{Outcome, Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::spin_families::FamilyBounds;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory, WalkMemory};
use crate::reach::Gap;
use nalgebra::Vector3;
use std::ops::Range;

/// Largest number of postures of one node whose upper bounds are tried.
const TRIED: usize = 6;

impl PlacedLayout<'_> {
    /// Finds the worst node of an operation, or the reason why a node cannot be used. The result equals the
    /// result of [`Self::every_free`] and [`Self::value_of_all`], bit for bit.
    pub(super) fn worst_node(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Outcome {
        let query = OperationQuery::new(self, operation, spots);
        let mut memory = workspace.of(self.mapper, operation);
        let has_families = self.mapper.lacks_families(operation, &query.attitudes).is_none();
        let (mut missed, mut worst, mut failed) = (Vec::new(), None::<Spot>, None::<(usize, Outcome)>);
        for BoundedNode { node, target, families, .. } in
            query.bounded_nodes(has_families, &mut missed, &mut memory)
        {
            // Only the first node that fails is reported. Nodes after it matter only if they cannot be
            // reached.
            let is_before = failed.as_ref().is_none_or(|(first, _)| node < *first);
            let judged = match (missed.is_empty() && is_before && query.context.is_ok(), families) {
                (false, _) => query.reached(&target, memory.postures).map(|()| None),
                (true, None) => query.judged_node(node, target, has_families, &mut memory),
                (true, Some(families)) => query.judged_unless_below(worst, &target, families, &mut memory),
            };
            match judged {
                Err(gap) => missed.push((node, gap)),
                Ok(Some(Outcome::Found(spot))) => {
                    // The first of several equally bad nodes is the worst.
                    let is_worse = |worst: &Spot| match spot.value.total_cmp(&worst.value) {
                        std::cmp::Ordering::Equal => node < worst.node,
                        order => order.is_gt(),
                    };
                    if worst.as_ref().is_none_or(is_worse) {
                        worst = Some(spot);
                    }
                }
                Ok(Some(other)) => failed = Some((node, other)),
                Ok(None) => {}
            }
        }
        missed.sort_by_key(|(node, _)| *node);
        let mut unreached = UnreachedNodes::default();
        missed.iter().for_each(|(_, gap)| unreached.note(gap));
        if let Some(gap) = unreached.gap(query.setup.grid.count()) {
            return Outcome::Unreachable { gap };
        }
        match (query.context, failed, worst) {
            (Err(why), ..) => Outcome::Unjudged(why),
            (_, Some((_, why)), _) => why,
            (_, None, Some(worst)) => Outcome::Found(worst),
            (_, None, None) => Outcome::Unjudged(Unjudged::OnlyTouched),
        }
    }
}

/// Node of an operation that happens at every node.
struct BoundedNode {
    node: usize,
    /// Target position of the TCP, in the base frame, m.
    target: Vector3<f64>,
    /// Lower bound of the value of the node, m or rad. Without spin families, the squared distance from the
    /// base.
    rank: f64,
    /// Indices of the spin families of the node in [`PostureMemory::collected`]; None if the postures of the
    /// node were not collected.
    families: Option<Range<usize>>,
}

impl OperationQuery<'_> {
    /// Returns the nodes in the order in which they are judged, and collects their spin families.
    fn bounded_nodes(
        &self,
        has_families: bool,
        missed: &mut Vec<(usize, Gap)>,
        memory: &mut WalkMemory<'_>,
    ) -> Vec<BoundedNode> {
        memory.postures.collected.clear();
        memory.postures.firsts.clear();
        let (mut nodes, mut leading) = (Vec::with_capacity(self.setup.grid.count()), None);
        self.setup.grid.targets(&self.at, |node, target| {
            let mut bounded = BoundedNode { node, target, rank: target.norm_squared(), families: None };
            if has_families && missed.is_empty() && self.context.is_ok() {
                let collected = self.collect_postures(node, target, Some(FamilyBounds::Later), memory);
                let WalkMemory { candidates, families, postures, .. } = memory;
                if let Err(gap) = collected {
                    missed.push((node, gap));
                    return;
                }
                bounded.rank = f64::INFINITY;
                if candidates.is_empty() {
                    bounded.rank = self.put_leading_first(families, &mut leading, postures);
                    let first = postures.collected.len();
                    postures.collected.append(families);
                    bounded.families = Some(first..postures.collected.len());
                }
            }
            nodes.push(bounded);
        });
        nodes.sort_by(|a, b| b.rank.total_cmp(&a.rank));
        nodes
    }

    /// Puts the leading family of a node first, and returns its bound. The leading family has the branch
    /// `leading`, which had the least bound at an earlier node. If the node has no such family, the family
    /// with the least bound becomes the leading one.
    fn put_leading_first(
        &self,
        families: &mut [SpinFamily],
        leading: &mut Option<u64>,
        memory: &mut PostureMemory,
    ) -> f64 {
        match families.iter().position(|family| Some(family.branch) == *leading) {
            Some(k) => {
                families.swap(0, k);
                self.bound_families(&mut families[..1], memory);
            }
            None => {
                self.bound_families(families, memory);
                families.sort_by(|a, b| b.cmp(a));
            }
        }
        let first = families.first();
        *leading = first.map(|family| family.branch);
        first.map_or(f64::INFINITY, |family| family.bound)
    }

    /// Returns the outcome at a node with the collected spin families `families`. Returns None if a usable
    /// posture of the node has a value below the value of `worst`, or if the robot touches the node to teach
    /// the frame.
    ///
    /// # Errors
    /// Returns how far the node is from having a usable posture ([`Gap`]) if no posture reaches it.
    fn judged_unless_below(
        &self,
        worst: Option<Spot>,
        target: &Vector3<f64>,
        families: Range<usize>,
        memory: &mut WalkMemory<'_>,
    ) -> Result<Option<Outcome>, Gap> {
        let WalkMemory { candidates, families: own, postures, .. } = memory;
        candidates.clear();
        own.clear();
        own.extend_from_slice(&postures.collected[families]);
        if let Some(worst) = worst {
            let count = own.len().min(1);
            let (leading, others) = own.split_at_mut(count);
            if self.has_spot_below(worst.value, leading, postures) {
                return Ok(None);
            }
            self.bound_families(others, postures);
            if self.has_spot_below(worst.value, others, postures) {
                return Ok(None);
            }
        }
        self.judge_collected(target, true, memory)
    }

    /// Returns whether one of the families with the least bounds has a usable member whose value is certainly
    /// below `floor`.
    fn has_spot_below(&self, floor: f64, families: &mut [SpinFamily], memory: &mut PostureMemory) -> bool {
        let Ok(context) = &self.context else { return false };
        families.sort_by(|a, b| b.cmp(a));
        let (inverse, chain) = (&self.placed.mapper.arm.inverse, &self.placed.mapper.arm.chain);
        let mut members = std::mem::take(&mut memory.members);
        let mut tried = 0;
        let found = families.iter().take_while(|family| family.bound < floor).any(|family| {
            let SpinFamily { node, branch, first, .. } = *family;
            let target = self.node_target(node);
            let of_family = (branch, &memory.firsts[first]);
            members.clear();
            inverse.members(&target, &self.attitudes, &mut memory.posture, of_family, |branch, posture| {
                members.push((branch, *posture));
            });
            members.iter().any(|(branch, posture)| {
                tried += 1;
                if tried > TRIED {
                    return false;
                }
                let PostureMemory { scratch, frames, .. } = memory;
                chain.place(posture, frames);
                let value = self.setup.evaluator.most(context, frames, &mut scratch.evaluator);
                value.is_some_and(|value| {
                    let spot = Spot { node, branch: *branch, value };
                    let (contact, certainty) = (ArmContact::Unknown, Certainty::Value);
                    let candidate = PostureCandidate { spot, target, contact, certainty, first: Some(first) };
                    value < floor && self.is_usable(&candidate, memory)
                })
            })
        });
        memory.members = members;
        found
    }
}
