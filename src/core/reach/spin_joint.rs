//! Last joint of an arm, if the axis of this joint is the tool axis through the TCP.
//!
//! This joint alone rotates the tool about the tool axis. Attitudes that differ only by this rotation have
//! the same coordinates of all other joints. One solution of the inverse kinematics serves all these
//! attitudes.

use super::attitude_set::SpinTurn;
use crate::robot::{Chain, Posture};

/// Last joint of an arm that rotates the tool about the tool axis, and leaves the TCP in place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpinJoint {
    /// Index of the joint.
    joint: usize,
    /// Direction of the joint axis relative to the tool axis: 1 or -1.
    sense: f64,
}

impl SpinJoint {
    /// Returns the last joint; None unless it is revolute and its axis is the tool axis through the TCP.
    pub fn new(chain: &Chain) -> Option<Self> {
        Some(Self { joint: chain.axes().checked_sub(1)?, sense: chain.tool_spin()? })
    }

    /// Returns a posture with the tool rotated about its axis.
    #[inline]
    pub fn turned(&self, posture: &Posture, turn: &SpinTurn) -> Posture {
        let (cos, sin) = (posture.cos[self.joint], posture.sin[self.joint]);
        let by = self.sense * turn.sin;
        let mut turned = *posture;
        turned.cos[self.joint] = cos * turn.cos - sin * by;
        turned.sin[self.joint] = sin * turn.cos + cos * by;
        turned
    }
}
