//! Search for the least-error spot by spin families.
//!
//! If a tool may spin freely, each solution of the inverse kinematics has a dozen postures that differ in
//! the last joint alone. These postures form a spin family, and one lower bound holds for the values of all
//! members. The members are judged only if this bound does not exceed the best value found. The solids before
//! the last joint are checked for contact once per family. The spot is bit-identical to the spot found by
//! judging every posture.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::family_queue::{FamilyQueue, SpinFamily};
use super::first_free::FirstFree;
use super::node_ranking::NodeRanking;
use super::outcome::{Outcome, Spot};
use super::walk::{OperationQuery, PostureVisitor};
use super::workspace::{PostureMemory, WalkMemory};
use crate::clearance::ArmPart;
use crate::reach::FamilyReach;
use nalgebra::Vector3;
use std::collections::BinaryHeap;

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
        if !self.rank_by_field(ranking) {
            self.setup.grid.targets(&self.at, |node, target| {
                self.visit_families(node, target, postures, families, *candidates);
            });
        }
        let mut queue = FamilyQueue {
            families: BinaryHeap::from(std::mem::take(*families)),
            judged: BinaryHeap::from(std::mem::take(*candidates)),
            is_nearest_known: false,
        };
        let found = self.first_free_of_families(&mut queue, ranking, postures);
        (**families, **candidates) = (queue.families.into_vec(), queue.judged.into_vec());
        found.outcome()
    }

    /// Checks the members of families in ascending order of their values or bounds, until a member can be
    /// used. A node in `ranking` is visited when its bound does not exceed the least bound in the queue.
    pub(super) fn first_free_of_families(
        &self,
        queue: &mut FamilyQueue,
        ranking: &mut NodeRanking,
        postures: &mut PostureMemory,
    ) -> FirstFree {
        self.first_free(postures, |memory| {
            loop {
                let ranked = if ranking.bound() <= queue.least() { ranking.pop() } else { None };
                if let Some(node) = ranked {
                    let (target, mut found) = (self.node_target(node), std::mem::take(&mut memory.opened));
                    self.visit_families(node, target, memory, &mut found, &mut queue.judged);
                    queue.families.extend(found.drain(..));
                    memory.opened = found;
                } else if let Some(family) = queue.next_family() {
                    self.open(&family, queue, memory);
                } else {
                    break;
                }
            }
            let next = queue.judged.pop();
            queue.is_nearest_known = queue.is_nearest_known || next.is_some();
            next
        })
    }

    /// Collects the spin families of one node, and the candidates that belong to no family.
    pub(super) fn visit_families<V: PostureVisitor>(
        &self,
        node: usize,
        target: Vector3<f64>,
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
        let reach = arm.inverse.visit_families(&target, &self.attitudes, posture, |branch, posture| {
            counts.postures += 1;
            arm.chain.place(posture, frames);
            let bound = evaluator.least_over_spins(context, frames, spins, &mut scratch.evaluator);
            families.push(SpinFamily { bound, node, branch, first: firsts.len(), member: None, target });
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

    /// Opens a family: computes a lower bound for each member. If values take little computing time, the
    /// function computes them instead. A single member is judged, or its bound is sharpened.
    ///
    /// If `queue.is_nearest_known` is true, members whose arm collides are left out. Such a member cannot be
    /// the spot. The search does not need it as the first candidate ([`FirstFree::nearest`]) either, because
    /// that candidate is already known.
    fn open(&self, family: &SpinFamily, queue: &mut FamilyQueue, memory: &mut PostureMemory) {
        let Ok(context) = &self.context else { return };
        let (mapper, evaluator) = (self.placed.mapper, &self.setup.evaluator);
        let SpinFamily { node, branch, first, target, .. } = *family;
        if let Some(member) = family.as_candidate().filter(|_| queue.is_nearest_known) {
            // A posture that collides needs no value. Computing a value takes much longer than checking for
            // collisions.
            let is_dear = matches!(member.certainty, Certainty::Bound | Certainty::SharpBound);
            if is_dear && !self.is_free(&member, memory) {
                return;
            }
        }
        let PostureMemory { scratch, frames, posture, contacts, firsts, counts, .. } = memory;
        let is_useless = |contact| contact == ArmContact::BeforeLastJoint && queue.is_nearest_known;
        let judged = |spot, contact| PostureCandidate {
            spot,
            target,
            contact,
            certainty: Certainty::Value,
            first: Some(first),
        };
        let (inverse, chain) = (&mapper.arm.inverse, &mapper.arm.chain);
        if let Some((contact, certainty)) = family.member {
            if is_useless(contact) {
                return;
            }
            let Some(posture) = inverse.member(&target, &self.attitudes, branch, &firsts[first]) else {
                return;
            };
            counts.postures += 1;
            chain.place(&posture, frames);
            let (value, certainty) = self.setup.sharpened(certainty, context, frames, scratch);
            if certainty == Certainty::Value {
                queue.judged.push(judged(Spot { node, branch, value }, contact));
            } else {
                let member = Some((contact, certainty));
                queue.families.push(SpinFamily { bound: value.max(family.bound), member, ..*family });
            }
            return;
        }
        // The members differ in the last joint alone.
        counts.contacts += 1;
        chain.place(&firsts[first], frames);
        let (part, solids) = (ArmPart::BeforeLastJoint, &self.placed.solids);
        let contact =
            match mapper.scene.is_part_free(part, solids, &frames.links, Some(self.operation), contacts) {
                true => ArmContact::OnlyBehindLastJoint,
                false => ArmContact::BeforeLastJoint,
            };
        if is_useless(contact) {
            return;
        }
        let (begin, family) = (&firsts[first], (branch, &firsts[first]));
        let bounds = match evaluator.has_one_value_over_spins() {
            true => None,
            false => evaluator.bounds_over_spins(context, frames, &mut scratch.evaluator),
        };
        if let Some(bounds) = bounds {
            inverse.members(&target, &self.attitudes, posture, family, |branch, posture| {
                counts.postures += 1;
                let bound = bounds.at(chain.spin_between(begin, posture));
                let member = Some((contact, Certainty::RoughBound));
                queue.families.push(SpinFamily { bound, node, branch, first, member, target });
            });
            return;
        }
        let mut before = None;
        inverse.members(&target, &self.attitudes, posture, family, |branch, posture| {
            counts.postures += 1;
            chain.place(posture, frames);
            let value = match before {
                Some((spun, value)) if self.differs_in_spin(&spun, frames) => value,
                _ => evaluator.value(context, frames, &mut scratch.evaluator),
            };
            before = evaluator.ignores_spin().then_some((*frames, value));
            queue.judged.push(judged(Spot { node, branch, value }, contact));
        });
    }
}
