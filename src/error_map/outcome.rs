//! What an operation gets from a layout.

use crate::motion::PostureRefusal;
use crate::reach::Gap;
use nalgebra::Vector3;
use std::cmp::Ordering;

/// The spot chosen for an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Number of the node.
    pub node: usize,
    pub branch: u32,
    /// What the reading makes small: the error in the sense of the operation (m or rad) or one of
    /// its statistics, or a share of failures.
    pub value: f64,
}

/// What one operation gets from one layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    Found(Spot),
    /// Postures within limits exist, all of them touch something; the least-error one of them.
    AllCollide {
        nearest: Spot,
    },
    /// Postures touch nothing, but motion refuses them all; the least-error one of them, and why.
    Refused {
        nearest: Spot,
        refusal: PostureRefusal,
    },
    /// No node has a posture within the limits.
    Unreachable {
        gap: Gap,
    },
    /// Nodes can be reached, but their errors depend on something that is missing.
    Unjudged(Unjudged),
}

/// Why an operation cannot be judged although nodes may be reachable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unjudged {
    /// No three points of the surface can be touched to teach its frame.
    NotTaught,
    /// Nothing but the touched points themselves can be reached.
    OnlyTouched,
    /// The operation that it is relative to has no spot.
    NoPick,
}

impl Unjudged {
    pub fn in_words(self) -> &'static str {
        match self {
            Unjudged::NotTaught => {
                "the surface frame cannot be taught: three points, in no line, cannot all be touched"
            }
            Unjudged::OnlyTouched => "only the points touched to teach the frame can be reached",
            Unjudged::NoPick => "the operation it is relative to has no spot",
        }
    }
}

/// A posture that might be the spot, ordered by error, then node, then branch (reversed: the heap
/// gives the greatest first).
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    pub spot: Spot,
    pub target: Vector3<f64>,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |c: &Self| (c.spot.node, c.spot.branch);
        other.spot.value.total_cmp(&self.spot.value).then_with(|| key(other).cmp(&key(self)))
    }
}
