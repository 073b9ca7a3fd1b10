//! Last joint of an arm, if the axis of this joint is the tool axis through the TCP.
//!
//! This joint alone rotates the tool about the tool axis. Attitudes that differ only by this rotation have
//! the same coordinates of all other joints. One solution of the inverse kinematics serves all these
//! attitudes.

use super::attitude_set::SpinTurn;
use crate::cell::JointKind;
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// A deviation from the last axis of at most this value counts as a rounding error: of a unit vector (no
/// unit), or of a point (m).
const ON_AXIS: f64 = 1e-12;

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
        let last = chain.links.last().filter(|link| link.kind == JointKind::Revolute)?;
        // Direction of the last axis, and a point on it, in the last frame.
        let axis = Vector3::new(0.0, last.sin_alpha, last.cos_alpha);
        let point = -Vector3::new(last.l, last.r * last.sin_alpha, last.r * last.cos_alpha);
        let tool_axis = chain.tool.rotation * chain.tool_axis;
        let off = (chain.tool.translation - point).cross(&axis).norm().max(tool_axis.cross(&axis).norm());
        (off <= ON_AXIS).then(|| Self { joint: chain.axes() - 1, sense: tool_axis.dot(&axis).signum() })
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
