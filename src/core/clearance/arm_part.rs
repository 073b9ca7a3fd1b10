//! Parts of the arm whose contacts are checked separately.

/// Part of the arm that is checked for contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmPart {
    Whole,
    /// The solids that the last joint does not move.
    BeforeLastJoint,
    /// The solids that the last joint moves: the last link, the tool and the held part.
    BehindLastJoint,
}

impl ArmPart {
    /// Returns whether a solid belongs to the part. `frame` is the index of the frame that carries the solid,
    /// and `last` is the index of the frame after the last joint.
    pub(super) fn has(self, frame: usize, last: usize) -> bool {
        match self {
            Self::Whole => true,
            Self::BeforeLastJoint => frame < last,
            Self::BehindLastJoint => frame == last,
        }
    }
}
