//! What a layout must keep besides reach and collision: margins, ways between operations, a fence.

use super::robot_model::{Joint, JointKind, JointVector};

/// Postures nearer than this to a limit or a singularity are not used; 0: every posture is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Margins {
    /// From the limits of turning joints, rad.
    pub turn: f64,
    /// From the limits of slides, m.
    pub slide: f64,
    /// Least singular value of the Jacobian, lengths in arm reaches.
    pub singularity: f64,
}

impl Margins {
    /// The limits that a joint keeps; a passive joint has none of its own.
    pub fn kept(&self, joint: &Joint) -> (f64, f64) {
        if joint.is_passive() {
            return joint.limits;
        }
        let margin = self.of(joint);
        (joint.limits.0 + margin, joint.limits.1 - margin)
    }

    /// From the limits of this joint, rad or m.
    pub fn of(&self, joint: &Joint) -> f64 {
        match joint.kind {
            JointKind::Revolute => self.turn,
            JointKind::Prismatic => self.slide,
        }
    }
}

/// The moves between the operations are to be free.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferRules {
    /// How far the TCP may be lifted before and after a move, m; 0: it is not.
    pub lift: f64,
    /// Postures through which a move may go, each alone.
    pub via: Vec<JointVector>,
    /// Whether the last operation is followed by the first.
    pub cycle: bool,
}

/// A simple polygon in the world within which equipment and robot base stand.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// Anticlockwise, m.
    pub corners: Vec<(f64, f64)>,
    /// Height of walls that the robot must not touch, m; None: the fence is a line on the floor.
    pub height: Option<f64>,
}
