//! Result of one operation in one layout: the spot, or the reason why the operation has no spot.

use crate::certificate::NotCertified;
use crate::motion::PostureRefusal;
use crate::reach::Gap;

/// Node and posture chosen for an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Index of the node.
    pub node: usize,
    pub branch: u64,
    /// Value that the search minimizes: an error or a statistic of it (m or rad), a share of failures, or a
    /// cost of tolerances.
    ///
    /// The error is measured in the sense of the operation.
    pub value: f64,
}

/// Result of one operation in one layout.
///
/// If an operation happens at every node, [`Self::AllCollide`], [`Self::Refused`] and [`Self::Uncertain`]
/// describe the first node that cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    Found(Spot),
    /// All postures within the joint limits collide. `nearest` is the least-error posture.
    AllCollide {
        nearest: Spot,
    },
    /// The motion rules refuse all collision-free postures. `nearest` is the least-error posture among
    /// them.
    Refused {
        nearest: Spot,
        refusal: PostureRefusal,
    },
    /// Some postures are usable without misplacements, but none of them is certified. `nearest` is the
    /// least-error posture among them.
    Uncertain {
        nearest: Spot,
        why: NotCertified,
    },
    /// No node has a posture that stays within the joint limits and meets the attitude.
    ///
    /// If the operation happens at every node, this result means that at least one node has no such posture.
    Unreachable {
        gap: Gap,
    },
    /// Nodes can be reached, but their errors cannot be computed in this layout.
    Unjudged(Unjudged),
}

/// Reason why the errors of reachable nodes cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unjudged {
    /// The robot cannot touch three points of the surface to teach the surface frame.
    NotTaught,
    /// Only the points touched to teach the frame can be reached.
    OnlyTouched,
    /// The operation that picks the part has no spot.
    NoPick,
    /// The layout does not belong to the cell.
    NotALayout,
}

impl Unjudged {
    /// Returns the reason as a phrase for users.
    pub fn in_words(self) -> &'static str {
        match self {
            Unjudged::NotTaught => {
                "the surface frame cannot be taught: the robot cannot touch three points that form a triangle"
            }
            Unjudged::OnlyTouched => {
                "the robot reaches only the nodes that it touches to teach the surface frame"
            }
            Unjudged::NoPick => "the operation that picks the part has no spot",
            Unjudged::NotALayout => "the layout does not belong to the cell",
        }
    }
}
