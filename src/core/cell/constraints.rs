//! Further constraints of a layout: margins, transfers between operations, and the fence.

use super::robot_model::{Joint, JointKind, JointVector};

/// Margins that every posture must keep from joint limits and from singular postures; a margin of 0 excludes
/// no posture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Margins {
    /// Least distance from the limits of revolute joints, rad.
    pub turn: f64,
    /// Least distance from the limits of prismatic joints, m.
    pub slide: f64,
    /// Least allowed value of the smallest singular value of the Jacobian, with lengths divided by the arm
    /// reach.
    pub singularity: f64,
}

impl Margins {
    /// Returns the limits of a joint, moved inwards by the margin. The limits of a passive joint stay
    /// unchanged.
    pub fn kept(&self, joint: &Joint) -> (f64, f64) {
        if joint.is_passive() {
            return joint.limits;
        }
        let margin = self.of(joint);
        (joint.limits.0 + margin, joint.limits.1 - margin)
    }

    /// Returns the distance that a joint must keep from its limits: rad if revolute, m if prismatic.
    pub fn of(&self, joint: &Joint) -> f64 {
        match joint.kind {
            JointKind::Revolute => self.turn,
            JointKind::Prismatic => self.slide,
        }
    }
}

/// Rules for the collision-free transfers between operations.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferRules {
    /// Height by which the TCP may be lifted before and after a move, m; 0 means no lift.
    pub lift: f64,
    /// Intermediate postures (via points); a transfer may pass through one of these postures.
    pub via: Vec<JointVector>,
    /// Whether a transfer from the last operation back to the first is also planned.
    pub cycle: bool,
}

/// Fence: a simple polygon in the world that encloses equipment and robot base.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// Corners (x, y) in anticlockwise order, m.
    pub corners: Vec<(f64, f64)>,
    /// Height of the walls that the robot must not touch, m; None if the fence is only a line on the floor.
    pub height: Option<f64>,
}
