//! Queue of spin families and their members, in ascending order of their bounds.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::outcome::Spot;
use super::value_field::ValueField;
use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Spin family (postures at one node that differ in the last joint alone), or one member of a family. [`Ord`]
/// ranks the entry with the least bound as the greatest.
#[derive(Clone, Copy)]
pub struct SpinFamily {
    /// Lower bound of the values of the members.
    pub bound: f64,
    pub node: usize,
    /// Branch index of the first member of the family, or of the single member.
    pub branch: u64,
    /// Index of the first member in [`super::workspace::PostureMemory::firsts`].
    pub first: usize,
    /// Known contacts of the solids before the last joint.
    pub contact: ArmContact,
    pub stage: FamilyStage,
}

/// What an entry of the queue stands for, and where its bound comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FamilyStage {
    /// A whole family whose bound was not computed at its posture. The bound is that of its configuration in
    /// the value field, or 0.
    Preliminary,
    /// A whole family, with a bound computed at its posture.
    Bounded,
    /// A single member, with a bound of this kind.
    Member(Certainty),
}

impl SpinFamily {
    /// Returns a single member as a candidate, whose value is the bound; None for a whole family. `target` is
    /// the target position of the TCP, in the base frame, m.
    pub fn as_candidate(&self, target: Vector3<f64>) -> Option<PostureCandidate> {
        let FamilyStage::Member(certainty) = self.stage else { return None };
        let spot = Spot { node: self.node, branch: self.branch, value: self.bound };
        let (contact, first) = (self.contact, Some(self.first));
        Some(PostureCandidate { spot, target, contact, certainty, first })
    }
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
        let key = |f: &Self| (f.node, f.branch);
        other.bound.total_cmp(&self.bound).then_with(|| key(other).cmp(&key(self)))
    }
}

/// Queue of spin families and single members with lower bounds, and queue of judged postures with values.
pub struct FamilyQueue<'f> {
    /// Value field that bounds the values of the nodes; None if every family was bounded at its posture.
    pub field: Option<&'f ValueField>,
    pub families: BinaryHeap<SpinFamily>,
    pub judged: BinaryHeap<PostureCandidate>,
    /// The judged posture that was removed last.
    pub last: Option<PostureCandidate>,
}

impl FamilyQueue<'_> {
    /// Returns whether the posture with the least value, usable or not, was found.
    pub fn is_nearest_known(&self) -> bool {
        self.last.is_some()
    }

    /// Returns the least bound of the families and the best judged posture; infinite without both.
    pub fn least(&self) -> f64 {
        let family = self.families.peek().map_or(f64::INFINITY, |family| family.bound);
        self.judged.peek().map_or(family, |best| family.min(best.spot.value))
    }

    /// Removes and returns the family or member with the least bound.
    ///
    /// Returns None if this bound exceeds the value of the best judged posture, or if no family is left.
    pub fn next_family(&mut self) -> Option<SpinFamily> {
        let bound = self.families.peek()?.bound;
        let is_beaten = self.judged.peek().is_some_and(|best| best.spot.value < bound);
        if is_beaten { None } else { self.families.pop() }
    }
}
