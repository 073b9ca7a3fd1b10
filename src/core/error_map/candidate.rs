//! Candidate postures for the spot of an operation, in the order in which they are tried.

use super::outcome::Spot;
use nalgebra::Vector3;
use std::cmp::Ordering;

/// Posture that might be the spot of an operation.
///
/// [`Ord`] ranks the best candidate as the greatest, so a [`std::collections::BinaryHeap`] returns it first.
///
/// A candidate is better if its value is smaller. If values are equal, the less certain value is better
/// ([`Certainty`]). If the certainties are also equal, the lower node index is better, then the lower branch
/// index.
#[derive(Clone, Copy)]
pub struct PostureCandidate {
    pub spot: Spot,
    /// Target position of the TCP, in the base frame, m.
    pub target: Vector3<f64>,
    pub contact: ArmContact,
    pub certainty: Certainty,
    /// Index of the first member of the candidate's spin family (postures that differ in the last joint
    /// alone). The index refers to [`super::workspace::PostureMemory::firsts`]. None if the inverse
    /// kinematics must be solved again.
    pub first: Option<usize>,
}

/// Kind of the value of a candidate: one of three lower bounds, or the value itself. A sharper bound takes
/// longer to compute.
///
/// Among equal values, the least certain value comes first, because the true value is not known yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    Value,
    SharpBound,
    Bound,
    RoughBound,
}

/// Known contacts of a posture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmContact {
    Unknown,
    /// A solid before the last joint has a contact.
    BeforeLastJoint,
    /// The solids before the last joint have no contact. The contacts of the other solids are not known.
    OnlyBehindLastJoint,
}

impl ArmContact {
    /// Returns whether the posture may be collision-free.
    pub fn may_be_free(self) -> bool {
        self != Self::BeforeLastJoint
    }
}

impl PartialEq for PostureCandidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for PostureCandidate {}
impl PartialOrd for PostureCandidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for PostureCandidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |c: &Self| (c.spot.node, c.spot.branch);
        let by_value = other.spot.value.total_cmp(&self.spot.value);
        by_value.then(self.certainty.cmp(&other.certainty)).then_with(|| key(other).cmp(&key(self)))
    }
}
