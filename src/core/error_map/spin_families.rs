//! Search for the least-error spot by spin families.
//!
//! If a tool may spin freely, each solution of the inverse kinematics has a dozen postures that differ in
//! the last joint alone. These postures form a spin family, and one lower bound holds for the values of all
//! members. The members are judged only if this bound does not exceed the best value found. The solids before
//! the last joint are checked for contact once per family. The spot is bit-identical to the spot found by
//! judging every posture.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::family_queue::{FamilyQueue, FamilyStage, SpinFamily};
use super::first_free::FirstFree;
use super::node_ranking::NodeRanking;
use super::outcome::{Outcome, Spot};
use super::value_field::ValueField;
use super::walk::{OperationQuery, PostureVisitor};
use super::workspace::{PostureMemory, WalkMemory};
use crate::cell::Reading;
use crate::clearance::{ArmPart, ContactMemory};
use crate::reach::FamilyReach;
use crate::reading::WorkContext;
use crate::robot::Frames;
use nalgebra::Vector3;
use std::collections::BinaryHeap;

/// Source of the lower bounds of the spin families at a node.
pub(super) enum FamilyBounds<'f> {
    /// The value field. A family without a bound in the field is bounded at its posture.
    Field(&'f ValueField),
    /// A computation at the posture of each family, which takes longer.
    Posture,
    /// No source: every bound is 0 until it is needed.
    Later,
}

impl OperationQuery<'_> {
    /// Finds the spot by spin families.
    ///
    /// Returns None if the families have no known bound, if no node can be reached, or if the errors cannot
    /// be computed.
    pub(super) fn by_spin_families(&self, memory: &mut WalkMemory<'_>) -> Option<Outcome> {
        let lacks_families = self.placed.mapper.lacks_families(self.operation, &self.attitudes);
        if lacks_families.is_some() || self.context.is_err() {
            return None;
        }
        let WalkMemory { candidates, families, ranking, postures } = memory;
        candidates.clear();
        families.clear();
        postures.firsts.clear();
        let field = self.rank_by_field(ranking);
        if field.is_none() {
            self.setup.grid.targets(&self.at, |node, target| {
                self.visit_families(node, target, FamilyBounds::Posture, postures, families, *candidates);
            });
        }
        let mut queue = FamilyQueue {
            field,
            families: BinaryHeap::from(std::mem::take(*families)),
            judged: BinaryHeap::from(std::mem::take(*candidates)),
            last: None,
        };
        let found = self.first_free_of_families(&mut queue, ranking, postures);
        (**families, **candidates) = (queue.families.into_vec(), queue.judged.into_vec());
        found.outcome()
    }

    /// Checks the members of families in ascending order of their values or bounds, until a member can be
    /// used. A node in `ranking` is visited when its bound does not exceed the least bound in the queue.
    pub(super) fn first_free_of_families(
        &self,
        queue: &mut FamilyQueue<'_>,
        ranking: &mut NodeRanking,
        postures: &mut PostureMemory,
    ) -> FirstFree {
        let has_one_value = self.has_one_value_per_family();
        self.first_free(postures, |memory| {
            if let Some(last) = queue.last.filter(|last| has_one_value && last.contact.may_be_free()) {
                self.add_next_member(&last, queue, memory);
            }
            loop {
                let ranked = if ranking.bound() <= queue.least() { ranking.pop() } else { None };
                if let Some(node) = ranked {
                    let (target, mut found) = (self.node_target(node), std::mem::take(&mut memory.opened));
                    let bounds = queue.field.map_or(FamilyBounds::Posture, FamilyBounds::Field);
                    self.visit_families(node, target, bounds, memory, &mut found, &mut queue.judged);
                    // The family with the least bound comes first. The others then often join the queue.
                    let least = (0..found.len()).min_by(|a, b| found[*a].bound.total_cmp(&found[*b].bound));
                    if let Some(least) = least {
                        found.swap(0, least);
                    }
                    found.drain(..).for_each(|family| self.enqueue(family, queue, memory));
                    memory.opened = found;
                } else if let Some(family) = queue.next_family() {
                    self.open(&family, queue, memory);
                } else {
                    break;
                }
            }
            let next = queue.judged.pop();
            queue.last = next.or(queue.last);
            next
        })
    }

    /// Collects the spin families of one node, and the candidates that belong to no family.
    ///
    /// Each family gets a bound from `bounds`.
    pub(super) fn visit_families<V: PostureVisitor>(
        &self,
        node: usize,
        target: Vector3<f64>,
        bounds: FamilyBounds<'_>,
        memory: &mut PostureMemory,
        families: &mut Vec<SpinFamily>,
        others: &mut V,
    ) {
        let arm = &self.placed.mapper.arm;
        let Some(context) = self.context.as_ref().ok().filter(|context| !context.touches(&target)) else {
            return;
        };
        let PostureMemory { scratch, frames, posture, firsts, counts, .. } = memory;
        let (evaluator, count) = (&self.setup.evaluator, families.len());
        let spins = self.attitudes.spin_rotations();
        let of_field = match bounds {
            FamilyBounds::Field(field) => field.posture_bounds(&target),
            _ => None,
        };
        let reach = arm.inverse.visit_families(&target, &self.attitudes, posture, |branch, posture| {
            let (bound, stage) = match (&of_field, &bounds) {
                (Some(of_field), _) => (of_field.of(posture), FamilyStage::Preliminary),
                (None, FamilyBounds::Later) => (0.0, FamilyStage::Preliminary),
                (None, _) => {
                    counts.postures += 1;
                    arm.chain.place(posture, frames);
                    let bound = evaluator.least_over_spins(context, frames, spins, &mut scratch.evaluator);
                    (bound, FamilyStage::Bounded)
                }
            };
            let (first, contact) = (firsts.len(), ArmContact::Unknown);
            families.push(SpinFamily { bound, node, branch, first, contact, stage });
            firsts.push(*posture);
        });
        if let FamilyReach::OnlyBetweenSamples { .. } = reach {
            families.truncate(count);
            let known = if V::NEEDS_GAP { FamilyReach::Complete } else { reach };
            self.visit_branches(known, node, target, memory, others);
        } else {
            counts.nodes += 1;
        }
    }

    /// Opens an entry at once if its bound is at most the least bound in the queue. Otherwise, the entry
    /// joins the queue.
    fn enqueue(&self, entry: SpinFamily, queue: &mut FamilyQueue<'_>, memory: &mut PostureMemory) {
        match entry.bound <= queue.least() {
            true => self.open(&entry, queue, memory),
            false => queue.families.push(entry),
        }
    }

    /// Opens an entry of the queue: it is replaced by entries with sharper bounds, or by judged postures.
    fn open(&self, family: &SpinFamily, queue: &mut FamilyQueue<'_>, memory: &mut PostureMemory) {
        match family.stage {
            FamilyStage::Preliminary => self.open_preliminary(family, queue, memory),
            FamilyStage::Bounded => self.open_bounded(family, queue, memory),
            FamilyStage::Member(certainty) => self.open_member(certainty, family, queue, memory),
        }
    }

    /// Computes the bound of a family at its posture.
    ///
    /// If the nearest candidate is known, a family whose arm collides is left out. None of its members can
    /// be the spot. The search does not need them as the first candidate ([`FirstFree::nearest`]) either,
    /// because that candidate is already known.
    fn open_preliminary(&self, family: &SpinFamily, queue: &mut FamilyQueue<'_>, memory: &mut PostureMemory) {
        let Ok(context) = &self.context else { return };
        let (mapper, evaluator) = (self.placed.mapper, &self.setup.evaluator);
        let PostureMemory { frames, contacts, firsts, counts, .. } = &mut *memory;
        mapper.arm.chain.place(&firsts[family.first], frames);
        let mut contact = family.contact;
        if queue.is_nearest_known() {
            counts.contacts += 1;
            // The error of a signed sample takes less computing time than the check of the whole arm.
            contact = match evaluator.reading {
                Reading::Signed => self.contact_again(frames, contacts),
                _ => self.contact_before_last_joint(frames, contacts),
            };
            if !contact.may_be_free() {
                return;
            }
        }
        queue.families.push(SpinFamily { contact, ..self.bounded(family, context, memory) });
    }

    /// Computes the bounds of those families that were not bounded at their postures.
    pub(super) fn bound_families(&self, families: &mut [SpinFamily], memory: &mut PostureMemory) {
        let Ok(context) = &self.context else { return };
        for family in families.iter_mut().filter(|family| family.stage == FamilyStage::Preliminary) {
            let PostureMemory { frames, firsts, .. } = memory;
            self.placed.mapper.arm.chain.place(&firsts[family.first], frames);
            *family = self.bounded(family, context, memory);
        }
    }

    /// Returns a family with the bound computed at its posture, whose frames must be in `memory`.
    fn bounded(&self, family: &SpinFamily, context: &WorkContext, memory: &mut PostureMemory) -> SpinFamily {
        let (evaluator, spins) = (&self.setup.evaluator, self.attitudes.spin_rotations());
        let PostureMemory { scratch, frames, counts, .. } = memory;
        counts.postures += 1;
        let bound = evaluator.least_over_spins(context, frames, spins, &mut scratch.evaluator);
        SpinFamily { bound: bound.max(family.bound), stage: FamilyStage::Bounded, ..*family }
    }

    /// Checks the solids before the last joint for contact.
    fn contact_before_last_joint(&self, frames: &Frames, memory: &mut ContactMemory) -> ArmContact {
        let (scene, solids) = (&self.placed.mapper.scene, &self.placed.solids);
        let (part, operation) = (ArmPart::BeforeLastJoint, Some(self.operation));
        match scene.is_part_free(part, solids, &frames.links, operation, memory) {
            true => ArmContact::OnlyBehindLastJoint,
            false => ArmContact::BeforeLastJoint,
        }
    }

    /// Checks the solids before the last joint only for the contact that was found last.
    fn contact_again(&self, frames: &Frames, memory: &ContactMemory) -> ArmContact {
        let (scene, solids) = (&self.placed.mapper.scene, &self.placed.solids);
        let (part, operation) = (ArmPart::BeforeLastJoint, Some(self.operation));
        match scene.touches_again(part, solids, &frames.links, operation, memory) {
            true => ArmContact::BeforeLastJoint,
            false => ArmContact::Unknown,
        }
    }

    /// Computes a lower bound for each member of a family. If values take little computing time, the function
    /// computes them instead.
    ///
    /// If the nearest candidate is known, a family whose arm collides is left out.
    fn open_bounded(&self, family: &SpinFamily, queue: &mut FamilyQueue<'_>, memory: &mut PostureMemory) {
        let Ok(context) = &self.context else { return };
        let (mapper, evaluator) = (self.placed.mapper, &self.setup.evaluator);
        let (inverse, chain) = (&mapper.arm.inverse, &mapper.arm.chain);
        let SpinFamily { node, branch, first, .. } = *family;
        let target = self.node_target(node);
        let PostureMemory { scratch, frames, posture, contacts, firsts, counts, .. } = memory;
        chain.place(&firsts[first], frames);
        let mut contact = family.contact;
        if contact == ArmContact::Unknown {
            // The members differ in the last joint alone.
            counts.contacts += 1;
            contact = self.contact_before_last_joint(frames, contacts);
        }
        if is_useless(contact, queue) {
            return;
        }
        let (begin, of_family) = (&firsts[first], (branch, &firsts[first]));
        if self.has_one_value_per_family() {
            let member = inverse.first_member(&target, &self.attitudes, of_family);
            if let Some((branch, posture)) = member {
                counts.postures += 1;
                chain.place_last(&posture, frames);
                let value = evaluator.value(context, frames, &mut scratch.evaluator);
                let (spot, certainty) = (Spot { node, branch, value }, Certainty::Value);
                queue.judged.push(PostureCandidate { spot, target, contact, certainty, first: Some(first) });
            }
            return;
        }
        let bounds = match evaluator.has_one_value_over_spins() {
            true => None,
            false => evaluator.bounds_over_spins(context, frames, &mut scratch.evaluator),
        };
        if let Some(bounds) = bounds {
            inverse.members(&target, &self.attitudes, posture, of_family, |branch, posture| {
                counts.postures += 1;
                let bound = bounds.at(chain.spin_between(begin, posture));
                let stage = FamilyStage::Member(Certainty::RoughBound);
                queue.families.push(SpinFamily { bound, branch, contact, stage, ..*family });
            });
            return;
        }
        let mut before = None;
        inverse.members(&target, &self.attitudes, posture, of_family, |branch, posture| {
            counts.postures += 1;
            chain.place_last(posture, frames);
            let tcp = frames.tcp.translation;
            let value = match before {
                // If the value ignores the spin, it is the same at the same TCP position, bit for bit.
                Some((at, value)) if at == tcp => value,
                _ => evaluator.value(context, frames, &mut scratch.evaluator),
            };
            before = evaluator.ignores_spin().then_some((tcp, value));
            let (spot, certainty) = (Spot { node, branch, value }, Certainty::Value);
            queue.judged.push(PostureCandidate { spot, target, contact, certainty, first: Some(first) });
        });
    }

    /// Adds the usable member of a family that comes after the member `last`, whose value it has.
    fn add_next_member(&self, last: &PostureCandidate, queue: &mut FamilyQueue<'_>, memory: &PostureMemory) {
        let Some(first) = last.first else { return };
        let family = (last.spot.branch, &memory.firsts[first]);
        let next = self.placed.mapper.arm.inverse.next_member(&last.target, &self.attitudes, family);
        queue.judged.extend(next.map(|(branch, _)| {
            let spot = Spot { branch, ..last.spot };
            PostureCandidate { spot, ..*last }
        }));
    }

    /// Returns whether all members of a family certainly have the same value, bit for bit, and the value
    /// takes less computing time than bounds. Only one member of a family is then in the queue at a time.
    fn has_one_value_per_family(&self) -> bool {
        self.setup.evaluator.has_one_value_over_spins() && self.placed.mapper.arm.chain.keeps_tcp_exactly()
    }

    /// Judges a single member, or sharpens its bound.
    ///
    /// If the nearest candidate is known, a member whose arm collides is left out.
    fn open_member(
        &self,
        certainty: Certainty,
        member: &SpinFamily,
        queue: &mut FamilyQueue<'_>,
        memory: &mut PostureMemory,
    ) {
        let Ok(context) = &self.context else { return };
        let SpinFamily { node, branch, first, contact, .. } = *member;
        let target = self.node_target(node);
        if let Some(candidate) = member.as_candidate(target).filter(|_| queue.is_nearest_known()) {
            // A posture that collides needs no value. Computing a value takes much longer than checking for
            // collisions.
            let is_dear = matches!(certainty, Certainty::Bound | Certainty::SharpBound);
            if is_useless(contact, queue) || is_dear && !self.is_free(&candidate, memory) {
                return;
            }
        }
        let PostureMemory { scratch, frames, firsts, counts, .. } = memory;
        let (inverse, chain) = (&self.placed.mapper.arm.inverse, &self.placed.mapper.arm.chain);
        let Some(posture) = inverse.member(&target, &self.attitudes, branch, &firsts[first]) else {
            return;
        };
        counts.postures += 1;
        chain.place(&posture, frames);
        let enough = queue.judged.peek().map_or(f64::INFINITY, |best| best.spot.value);
        let (value, certainty) = self.setup.sharpened(certainty, context, frames, enough, scratch);
        if certainty == Certainty::Value {
            let spot = Spot { node, branch, value };
            queue.judged.push(PostureCandidate { spot, target, contact, certainty, first: Some(first) });
        } else {
            let (bound, stage) = (value.max(member.bound), FamilyStage::Member(certainty));
            queue.families.push(SpinFamily { bound, stage, ..*member });
        }
    }
}

/// Returns whether the members of a family cannot be the spot, and are not needed as the first candidate.
fn is_useless(contact: ArmContact, queue: &FamilyQueue<'_>) -> bool {
    !contact.may_be_free() && queue.is_nearest_known()
}
