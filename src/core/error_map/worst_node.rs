//! Search for the worst node of an operation that happens at every node. If the operation has spin families
//! (see `spin_families`), the search excludes most nodes by bounds. The search then computes no values of
//! these nodes.
//!
//! A node whose error is certainly below the greatest error found cannot be the worst node. For such a node,
//! the search only needs a usable posture whose value has an upper bound below that error. The search tries
//! such upper bounds only for the members of spin families. Without spin families, the search judges every
//! node. The nodes far from the base come first, because their errors are usually the greatest.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::every_node::UnreachedNodes;
use super::family_queue::SpinFamily;
use super::outcome::{Outcome, Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};

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
        let mut nodes = Vec::with_capacity(query.setup.grid.count());
        query.setup.grid.targets(&query.at, |node, target| nodes.push((node, target)));
        nodes.sort_by(|(_, a), (_, b)| b.norm_squared().total_cmp(&a.norm_squared()));
        let (mut missed, mut worst, mut failed) = (Vec::new(), None::<Spot>, None::<(usize, Outcome)>);
        for (node, target) in nodes {
            // Only the first node that fails is reported. Nodes after it matter only if they cannot be
            // reached.
            let is_before = failed.as_ref().is_none_or(|(first, _)| node < *first);
            let judged = match missed.is_empty() && is_before && query.context.is_ok() {
                true => {
                    let floor = worst.map(|worst| worst.value).filter(|_| has_families);
                    query.judged_node(node, target, has_families, floor, &mut memory)
                }
                false => query.reached(&target, memory.postures).map(|()| None),
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

impl OperationQuery<'_> {
    /// Returns whether one of the families with the least bounds has a usable member whose value is certainly
    /// below `floor`.
    pub(super) fn has_spot_below(
        &self,
        floor: f64,
        families: &mut [SpinFamily],
        memory: &mut PostureMemory,
    ) -> bool {
        let Ok(context) = &self.context else { return false };
        families.sort_by(|a, b| b.cmp(a));
        let (inverse, chain) = (&self.placed.mapper.arm.inverse, &self.placed.mapper.arm.chain);
        let mut members = std::mem::take(&mut memory.members);
        let mut tried = 0;
        let found = families.iter().take_while(|family| family.bound < floor).any(|family| {
            let SpinFamily { node, branch, first, target, .. } = *family;
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
