//! Search for the least-error spot by spin families.
//!
//! A tool that may spin freely gives each solution of the inverse kinematics a dozen postures that differ in the last
//! joint alone. Each such family has a lower bound of its values, and its members are judged only while this bound can
//! still win. The solids before the last joint are checked for contact once per family. The spot is bit-identical to
//! the one that judging every posture finds.

use super::candidate::{ArmContact, PostureCandidate};
use super::outcome::{Outcome, Spot};
use super::walk::OperationQuery;
use super::workspace::{PostureMemory, WalkMemory};
use crate::clearance::ArmPart;
use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Spin family at one node. [`Ord`] ranks the family with the least bound as the greatest.
#[derive(Clone, Copy)]
pub struct SpinFamily {
    /// Lower bound of the values of the members.
    bound: f64,
    node: usize,
    /// Branch index of the first member.
    first: u32,
    /// TCP target, base frame, m.
    target: Vector3<f64>,
}

impl PartialEq for SpinFamily {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for SpinFamily {}
impl PartialOrd for SpinFamily {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for SpinFamily {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |f: &Self| (f.node, f.first);
        other.bound.total_cmp(&self.bound).then_with(|| key(other).cmp(&key(self)))
    }
}

impl OperationQuery<'_> {
    /// Finds the spot by spin families.
    ///
    /// Returns None if the families have no known bound, no node can be reached or the errors cannot be computed.
    pub(super) fn by_spin_families(&self, memory: &mut WalkMemory<'_>) -> Option<Outcome> {
        let inverse = &self.placed.mapper.arm.inverse;
        let is_bounded = self.placed.mapper.ranks && self.setup.evaluator.has_spin_bound();
        if !is_bounded || !inverse.has_spin_families() || self.context.is_err() {
            return None;
        }
        let WalkMemory { candidates, families, postures, .. } = memory;
        candidates.clear();
        families.clear();
        self.setup.grid.targets(&self.at, |node, target| {
            self.visit_families(node, target, postures, families, candidates);
        });
        let mut open = BinaryHeap::from(std::mem::take(*families));
        let mut judged = BinaryHeap::from(std::mem::take(*candidates));
        let mut is_nearest_known = false;
        let found = self.first_free(postures, |memory| {
            while let Some(family) = open.peek() {
                if judged.peek().is_some_and(|best| best.spot.value < family.bound) {
                    break;
                }
                let Some(family) = open.pop() else { break };
                self.open(&family, is_nearest_known, memory, &mut judged);
            }
            let next = judged.pop();
            is_nearest_known = is_nearest_known || next.is_some();
            next
        });
        (**families, **candidates) = (open.into_vec(), judged.into_vec());
        found.outcome()
    }

    /// Collects the spin families of one node, and the candidates that belong to no family.
    fn visit_families(
        &self,
        node: usize,
        target: Vector3<f64>,
        memory: &mut PostureMemory,
        families: &mut Vec<SpinFamily>,
        candidates: &mut Vec<PostureCandidate>,
    ) {
        let arm = &self.placed.mapper.arm;
        let Some(context) = self.context.as_ref().ok().filter(|context| !context.touches(&target)) else {
            return;
        };
        let PostureMemory { scratch, frames, posture, .. } = memory;
        let (evaluator, count) = (&self.setup.evaluator, families.len());
        let is_reached = arm.inverse.visit_families(&target, &self.attitudes, posture, |first, posture| {
            arm.chain.place(posture, frames);
            let bound = evaluator.least_over_spins(context, frames, scratch);
            families.push(SpinFamily { bound, node, first, target });
        });
        if !is_reached {
            families.truncate(count);
            self.visit(node, target, memory, candidates);
        }
    }

    /// Judges the members of a family. If all of them collide, they are left out unless `judged` needs the nearest
    /// candidate of all.
    fn open(
        &self,
        family: &SpinFamily,
        is_nearest_known: bool,
        memory: &mut PostureMemory,
        judged: &mut BinaryHeap<PostureCandidate>,
    ) {
        let Ok(context) = &self.context else { return };
        let mapper = self.placed.mapper;
        let SpinFamily { node, first, target, .. } = *family;
        let PostureMemory { scratch, frames, posture, contacts, .. } = memory;
        let mut contact = ArmContact::Unknown;
        mapper.arm.inverse.members(&target, &self.attitudes, posture, first, |branch, posture| {
            if contact == ArmContact::BeforeLastJoint && is_nearest_known {
                return;
            }
            mapper.arm.chain.place(posture, frames);
            if contact == ArmContact::Unknown {
                let (part, operation) = (ArmPart::BeforeLastJoint, Some(self.operation));
                let solids = &self.placed.solids;
                contact = match mapper.scene.is_part_free(part, solids, &frames.links, operation, contacts) {
                    true => ArmContact::OnlyBehindLastJoint,
                    false => ArmContact::BeforeLastJoint,
                };
                if contact == ArmContact::BeforeLastJoint && is_nearest_known {
                    return;
                }
            }
            let value = self.setup.evaluator.value(context, frames, scratch);
            judged.push(PostureCandidate { spot: Spot { node, branch, value }, target, contact });
        });
    }
}
