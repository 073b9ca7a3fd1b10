//! Certificate: proof that an operation works at every misplacement inside the placement tolerances.
//!
//! A misplaced robot base or piece of equipment displaces the TCP target as seen from the base
//! ([`TargetBox`]). The arm follows the target in the same branch ([`JointEnclosure`]). For all joint
//! coordinates in this enclosure, the certificate shows that
//!
//! - the target stays within reach, and the joints stay within their limits and margins;
//! - the posture keeps its distance from singular postures;
//! - every solid keeps its clearance: no solid moves farther than its distance from other solids allows
//!   ([`Misplacements`]);
//! - the value of the operation is at most a known bound ([`ValueBound`]).
//!
//! All steps use bounds that cover the whole target box, not samples. If a bound is too wide, no certificate
//! is issued, although the posture may be usable.
//!
//! | file | content |
//! |---|---|
//! | `target_box` | set of possible targets |
//! | `joint_enclosure` | bounds of the joint coordinates for all targets in the target box |
//! | `posed_chain` | test that the arm follows the target within these bounds |
//! | `jacobian_change` | bound of the change of the Jacobian |
//! | `misplacements` | bounds of the motion of solids |
//! | `value_bound` | upper bound of the value |

mod jacobian_change;
mod joint_enclosure;
mod misplacements;
mod posed_chain;
mod target_box;
mod value_bound;

pub use joint_enclosure::{JointEnclosure, NoEnclosure};
pub use misplacements::{Misplacements, PostureMotion};
pub use target_box::{BoxAxis, TargetBox};
pub use value_bound::{BoxedPosture, NoValueBound, ValueBound};

use crate::cell::{Cell, JointKind};
use crate::clearance::Hit;
use crate::motion::Hindrance;
use crate::safe_text::shown;
use crate::units::{deg_from_rad, mm_from_m};

/// Reason why an operation is not certified at its spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotCertified {
    /// The operation has no spot.
    NoSpot,
    /// The branch does not exist at the target.
    NoBranch,
    /// No bound of the joint coordinates is known, because no [`crate::reach::ToolTask`] describes how the
    /// arm follows the target.
    NoTask,
    /// The posture is too near to a singular posture for a target box of this size.
    NearlySingular,
    /// A joint may exceed its reduced limit by up to `by` (rad or m). The margin reduces this limit.
    JointLimit { joint: usize, by: f64 },
    /// The distance from singular postures may fall to `measure`, which is below the margin.
    Singular { measure: f64 },
    /// Two solids may come nearer to each other than the clearance.
    Clearance(Hit),
    /// The straight approach or retract, or the move from the operation to the next one, may be blocked.
    Path(Hindrance),
}

impl From<NoEnclosure> for NotCertified {
    fn from(why: NoEnclosure) -> Self {
        match why {
            NoEnclosure::NearlySingular => Self::NearlySingular,
            NoEnclosure::JointLimit { joint, by } => Self::JointLimit { joint, by },
        }
    }
}

impl NotCertified {
    /// Returns the reason as a clause about the operation. The clause uses the names of joints and solids in
    /// the cell.
    pub fn in_words(&self, cell: &Cell) -> String {
        match self {
            Self::NoSpot => "it has no spot".into(),
            Self::NoBranch => "the chosen branch has no posture that reaches the target".into(),
            Self::NoTask => "no method bounds the joint coordinates of this arm in this attitude".into(),
            Self::NearlySingular => "the posture is too near to a singular posture".into(),
            Self::JointLimit { joint, by } => {
                let joint = &cell.robot.joints[*joint];
                let (by, unit) = match joint.kind {
                    JointKind::Revolute => (deg_from_rad(*by), "deg"),
                    JointKind::Prismatic => (mm_from_m(*by), "mm"),
                };
                format!(
                    "joint {} could exceed its limit (minus the margin) by {by:.2} {unit}",
                    shown(&joint.name)
                )
            }
            Self::Singular { measure } => format!(
                "nearly singular: the singularity measure could be as low as {measure:.4}, below the margin {}",
                cell.margins.singularity
            ),
            Self::Clearance(Hit { solid, other }) => {
                format!(
                    "{} and {} could come nearer to each other than the clearance",
                    solid.in_words(cell),
                    other.in_words(cell)
                )
            }
            Self::Path(hindrance) => format!("a path may be blocked: {}", hindrance.in_words(cell)),
        }
    }
}
