//! Messages about refused postures and blocked transfers, with the names that the cell gives to its parts.

use super::guard::{Hindrance, PostureRefusal};
use super::straight_line::Stopped;
use super::transfer::{Blocked, TransferRoute};
use crate::cell::Cell;
use crate::safe_text::shown;
use crate::units::{mm_from_m, percent_from_share};

impl PostureRefusal {
    /// Returns the reason in words, with the names that the cell gives to its parts.
    pub fn in_words(&self, cell: &Cell) -> String {
        match self {
            Self::Singular { measure } => {
                let margin = cell.margins.singularity;
                format!("nearly singular: the singularity measure {measure:.4} is below the margin {margin}")
            }
            Self::Approach(what) => format!("approach: {}", what.in_words(cell)),
            Self::Retract(what) => format!("retract: {}", what.in_words(cell)),
        }
    }
}

impl Hindrance {
    /// Returns the hindrance in words, with the names that the cell gives to its parts.
    pub fn in_words(&self, cell: &Cell) -> String {
        match self {
            Self::Hit(hit) => {
                let share = percent_from_share(hit.at);
                format!("{} after {share:.0} % of the path", hit.hit.in_words(cell))
            }
            Self::Stopped(Stopped::Limit { joint, after }) => {
                let name = shown(&cell.robot.joints[*joint].name);
                format!("joint {name} reaches its limit after {:.1} mm", mm_from_m(*after))
            }
            Self::Stopped(Stopped::Lost { after }) => {
                format!("the arm cannot follow the line beyond {:.1} mm", mm_from_m(*after))
            }
        }
    }
}

impl TransferRoute {
    /// Returns the route in words.
    pub fn in_words(self) -> String {
        match self {
            Self::Direct => "direct".into(),
            Self::Lift => "lifted".into(),
            Self::Via(k) => format!("through via posture {}", k + 1),
            Self::LiftVia(k) => format!("lifted, through via posture {}", k + 1),
        }
    }
}

impl Blocked {
    /// Describes in words what blocks each route. Joints, operations and solids are named as in the cell.
    pub fn in_words(&self, cell: &Cell) -> String {
        let name = |k: usize| shown(&cell.operations[k].name);
        let tries =
            self.tries.iter().map(|(way, what)| format!("{}: {}", way.in_words(), what.in_words(cell)));
        let tries: Vec<_> = tries.collect();
        format!(
            "no collision-free transfer from {} to {}: {}",
            name(self.from),
            name(self.to),
            tries.join("; ")
        )
    }
}
