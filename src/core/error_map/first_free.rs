//! Check of the candidates one after the other, best first, until a candidate can be used.

use super::candidate::{ArmContact, PostureCandidate};
use super::node_record::Status;
use super::outcome::{Outcome, Spot};
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::PostureMemory;
use crate::certificate::NotCertified;
use crate::clearance::ArmPart;
use crate::motion::{LineEnds, PostureRefusal};
use crate::reach::{Branch, Cost};
use crate::robot::Posture;
use nalgebra::Vector3;

/// Returns the largest number of uncertified candidates that the search tries before it gives up.
///
/// A certificate takes about a microsecond. This time matters only for an arm whose inverse kinematics is
/// fast ([`Cost::Low`]). The limit is 16 candidates for such an arm. The limit is also 16 candidates for
/// numeric inverse kinematics, which takes about a millisecond per target. The limit is 256 candidates
/// for all other arms.
fn most_uncertain(cost: Cost) -> usize {
    match cost {
        Cost::Low | Cost::Numeric => 16,
        Cost::Middle | Cost::High => 256,
    }
}

/// Result of checking candidates, best first, until a candidate can be used.
#[derive(Default)]
pub struct FirstFree {
    /// The first candidate that can be used.
    pub free: Option<PostureCandidate>,
    /// The first candidate, usable or not.
    pub nearest: Option<PostureCandidate>,
    /// The first collision-free candidate that the motion rules refuse, and the reason.
    pub refused: Option<(Spot, PostureRefusal)>,
    /// The first candidate that is usable without misplacements but is not certified, and the reason.
    pub uncertain: Option<(Spot, NotCertified)>,
}

impl FirstFree {
    /// Returns the outcome of the operation after all necessary checks; None if there was no candidate.
    pub fn outcome(&self) -> Option<Outcome> {
        match (self.free, self.uncertain, self.refused) {
            (Some(free), ..) => Some(Outcome::Found(free.spot)),
            (None, Some((nearest, why)), _) => Some(Outcome::Uncertain { nearest, why }),
            (None, None, Some((nearest, refusal))) => Some(Outcome::Refused { nearest, refusal }),
            (None, None, None) => self.nearest.map(|nearest| Outcome::AllCollide { nearest: nearest.spot }),
        }
    }
}

impl OperationQuery<'_> {
    /// Checks the candidates that `next` returns, best first, until a candidate can be used. The candidate is
    /// then refined along its redundant coordinates ([`Self::refined`]).
    pub fn first_free(
        &self,
        memory: &mut PostureMemory,
        mut next: impl FnMut(&mut PostureMemory) -> Option<PostureCandidate>,
    ) -> FirstFree {
        let mut found = self.first_free_sample(memory, &mut next);
        found.free = found.free.map(|best| self.refined(best, memory, next));
        found
    }

    /// Checks the candidates that `next` returns, best first, until a candidate can be used.
    ///
    /// If the layout must withstand misplacements, a candidate must also be certified. The search gives up
    /// after [`most_uncertain`] candidates without a certificate.
    ///
    /// The inverse kinematics of a candidate is solved again here. This costs less than storing the postures
    /// of all nodes, because few candidates are checked.
    pub fn first_free_sample(
        &self,
        memory: &mut PostureMemory,
        mut next: impl FnMut(&mut PostureMemory) -> Option<PostureCandidate>,
    ) -> FirstFree {
        let (mut found, mut uncertain) = (FirstFree::default(), 0);
        while let Some(candidate) = next(memory) {
            let PostureCandidate { spot, target, .. } = candidate;
            found.nearest.get_or_insert(candidate);
            if self.placed.mapper.scene.base_hit(&self.placed.solids).is_some() {
                // The base has a contact, so no posture is collision-free.
                break;
            }
            if !self.is_free(&candidate, memory) {
                continue;
            }
            let branch = self.branch_to_check(&candidate, memory);
            let uncertainty = self.uncertainty(&target, branch, memory);
            // A certified posture is also allowed by the motion rules.
            let refusal = match self.placed.demand.is_some() && uncertainty.is_none() {
                true => None,
                false => self.refusal(branch.as_ref(), &mut memory.lines),
            };
            match (refusal, uncertainty) {
                (None, None) => {
                    found.free = Some(candidate);
                    break;
                }
                (Some(refusal), _) => found.refused = found.refused.or(Some((spot, refusal))),
                (None, Some(why)) => {
                    found.uncertain = found.uncertain.or(Some((spot, why)));
                    uncertain += 1;
                    if uncertain == most_uncertain(self.placed.mapper.arm.inverse.cost()) {
                        break;
                    }
                }
            }
        }
        found
    }

    /// Returns whether a candidate is collision-free, allowed by the motion rules and, if demanded,
    /// certified.
    pub fn is_usable(&self, candidate: &PostureCandidate, memory: &mut PostureMemory) -> bool {
        if !self.is_free(candidate, memory) {
            return false;
        }
        let branch = self.branch_to_check(candidate, memory);
        match self.placed.demand {
            // A certified posture is also allowed by the motion rules.
            Some(_) => self.uncertainty(&candidate.target, branch, memory).is_none(),
            None => self.refusal(branch.as_ref(), &mut memory.lines).is_none(),
        }
    }

    /// Returns the posture of a candidate; None if the branch does not exist.
    fn posture(&self, candidate: &PostureCandidate, memory: &PostureMemory) -> Option<Posture> {
        let PostureCandidate { spot, target, first, .. } = candidate;
        let inverse = &self.placed.mapper.arm.inverse;
        match first {
            Some(first) => inverse.member(target, &self.attitudes, spot.branch, &memory.firsts[*first]),
            None => inverse.posture(target, &self.attitudes, spot.branch),
        }
    }

    /// Returns the branch of a candidate if the motion rules or a certificate need it; otherwise None.
    fn branch_to_check(&self, candidate: &PostureCandidate, memory: &PostureMemory) -> Option<Branch> {
        let PostureCandidate { spot, target, first, .. } = candidate;
        if !self.asks_postures() && self.placed.demand.is_none() {
            return None;
        }
        let inverse = &self.placed.mapper.arm.inverse;
        match first {
            Some(first) => {
                let posture = inverse.member(target, &self.attitudes, spot.branch, &memory.firsts[*first])?;
                Some(inverse.branch(spot.branch, &posture, target, &self.attitudes))
            }
            None => self.branch_at(target, spot.branch),
        }
    }

    /// Returns whether the posture of a candidate is collision-free.
    pub(super) fn is_free(&self, candidate: &PostureCandidate, memory: &mut PostureMemory) -> bool {
        let PlacedLayout { mapper, solids, .. } = self.placed;
        let part = match candidate.contact {
            ArmContact::Unknown => ArmPart::Whole,
            ArmContact::OnlyBehindLastJoint => ArmPart::BehindLastJoint,
            ArmContact::BeforeLastJoint => return false,
        };
        self.posture(candidate, memory).is_some_and(|posture| {
            let PostureMemory { frames, contacts, counts, .. } = memory;
            counts.contacts += 1;
            mapper.arm.chain.place(&posture, frames);
            mapper.scene.is_part_free(part, solids, &frames.links, Some(self.operation), contacts)
        })
    }

    /// Returns the reason why the motion rules refuse a collision-free posture; None if they allow the
    /// posture. `lines` receives the ends of the lines of an allowed posture if transfers need them.
    fn refusal(&self, branch: Option<&Branch>, lines: &mut Vec<LineEnds>) -> Option<PostureRefusal> {
        let PlacedLayout { mapper, solids, .. } = self.placed;
        let guard = mapper.guard.as_ref().filter(|_| self.asks_postures())?;
        match guard.admits(&mapper.scene, solids, self.operation, &branch?.joints) {
            Ok(ends) => lines.extend(guard.asks_transfers().then_some(ends)),
            Err(refusal) => return Some(refusal),
        }
        None
    }

    /// Returns whether the motion rules check the postures of the operation.
    pub(super) fn asks_postures(&self) -> bool {
        let guard = self.placed.mapper.guard.as_ref();
        guard.is_some_and(|guard| guard.asks_postures(self.operation))
    }

    /// Returns the reason why a posture within the joint limits cannot be used; None if the posture can be
    /// used.
    ///
    /// `memory` must hold the frames of the posture.
    pub fn refusal_status(
        &self,
        target: &Vector3<f64>,
        branch: u64,
        memory: &PostureMemory,
    ) -> Option<Status> {
        let PlacedLayout { mapper, solids, .. } = self.placed;
        let hit = mapper.scene.hit(solids, &memory.frames.links, Some(self.operation));
        let collision = hit.map(|hit| Status::Collision { hit });
        collision.or_else(|| {
            let branch = self.asks_postures().then(|| self.branch_at(target, branch)).flatten();
            self.refusal(branch.as_ref(), &mut Vec::new()).map(Status::Refused)
        })
    }

    /// Returns the reason why no candidate of one target can be used. If there are candidates, the reason
    /// concerns the best candidate.
    pub fn why_none(&self, target: &Vector3<f64>, found: &FirstFree, memory: &mut PostureMemory) -> Status {
        let arm = &self.placed.mapper.arm;
        let refusal_status = found.nearest.and_then(|PostureCandidate { spot, .. }| {
            if let Some((_, refusal)) = found.refused.filter(|(refused, _)| refused.branch == spot.branch) {
                return Some(Status::Refused(refusal));
            }
            let posture = arm.inverse.posture(target, &self.attitudes, spot.branch)?;
            arm.chain.place(&posture, &mut memory.frames);
            self.refusal_status(target, spot.branch, memory)
        });
        refusal_status.unwrap_or_else(|| self.why_unreached(target))
    }
}
