//! Reasons that limit the region of a piece in a held layout.

use crate::cell::{Cell, Unit};
use crate::certificate::NotCertified;
use crate::clearance::Overlap;
use crate::error_map::Status;
use crate::motion::Blocked;
use crate::safe_text::shown;

/// Reason why a layout is infeasible, misses a limit or has too large an objective. The operations of this
/// layout keep the spots of another layout ([`super::HeldLayout`]).
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// The objective exceeds the largest objective that is allowed.
    Objective,
    /// The value of the operation, or an upper bound of this value, exceeds the limit of the operation.
    Limit(usize),
    Overlap(Overlap),
    /// The operation cannot keep its posture.
    Posture(usize, Status),
    /// The operation is not certified.
    NotCertified(usize, NotCertified),
    /// The operation cannot keep its posture at a corner of the placement tolerances.
    Corner(usize),
    /// At least one node of an operation that happens at every node cannot be used.
    EveryNode(usize),
    /// A transfer between two operations is blocked.
    Transfer(Blocked),
}

impl Ending {
    /// Describes the reason as a clause, with the names of operations, joints and solids in the cell.
    pub fn in_words(&self, cell: &Cell) -> String {
        let of = |k: &usize, why: String| format!("{}: {why}", shown(&cell.operations[*k].name));
        match self {
            Self::Objective => {
                let what = if cell.unit() == Unit::Cost { "cost" } else { "error" };
                format!("the {what} grows by more than the indifference allows")
            }
            Self::Limit(k) => of(k, "its error may exceed the limit of the operation".into()),
            Self::Overlap(overlap) => overlap.in_words(cell),
            Self::Posture(k, status) => of(k, status.reason(cell)),
            Self::NotCertified(k, NotCertified::JointLimit { joint, .. }) => {
                of(k, format!("joint {} reaches its limit or margin", shown(&cell.robot.joints[*joint].name)))
            }
            Self::NotCertified(k, why) => of(k, why.in_words(cell)),
            Self::Corner(k) => {
                of(k, "its posture cannot be used at a corner of the placement tolerances".into())
            }
            Self::EveryNode(k) => of(k, "a node cannot be used".into()),
            Self::Transfer(blocked) => blocked.in_words(cell),
        }
    }
}
