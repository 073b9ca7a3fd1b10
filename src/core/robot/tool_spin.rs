//! Rotation of the tool about its axis by the last joint alone.

use super::{Chain, Frames, Posture};
use crate::cell::JointKind;
use nalgebra::Vector3;

/// A distance of the TCP from the last joint axis up to this value, m, counts as a rounding error. This value
/// also limits the sine of the angle between the tool axis and the last joint axis.
const ON_AXIS: f64 = 1e-12;

impl Chain {
    /// Returns 1 if the last joint axis points along the tool axis, and -1 if the two are opposite.
    ///
    /// Returns None unless the last joint rotates the tool about the tool axis and leaves the TCP in place.
    pub fn tool_spin(&self) -> Option<f64> {
        let last = self.links.last().filter(|link| link.kind == JointKind::Revolute)?;
        // Direction of the last axis, and a point on it, in the last frame.
        let axis = Vector3::new(0.0, last.sin_alpha, last.cos_alpha);
        let point = -Vector3::new(last.l, last.r * last.sin_alpha, last.r * last.cos_alpha);
        let tool_axis = self.tool.rotation * self.tool_axis;
        let off = (self.tool.translation - point).cross(&axis).norm().max(tool_axis.cross(&axis).norm());
        (off <= ON_AXIS).then(|| tool_axis.dot(&axis).signum())
    }

    /// Returns cosine and sine of the angle by which the last joint rotates the tool about the tool axis from
    /// posture `a` to posture `b`. The function [`Self::tool_spin`] must not return None.
    pub fn spin_between(&self, a: &Posture, b: &Posture) -> (f64, f64) {
        let Some(last) = self.links.len().checked_sub(1) else { return (1.0, 0.0) };
        let sense = self.tool_spin().unwrap_or(1.0);
        let cos = b.cos[last] * a.cos[last] + b.sin[last] * a.sin[last];
        (cos, sense * (b.sin[last] * a.cos[last] - b.cos[last] * a.sin[last]))
    }

    /// Returns the frames after a rotation of the last joint to theta = 0. The last joint must be revolute.
    pub fn with_last_joint_at_zero(&self, frames: &Frames) -> Frames {
        let mut zero = *frames;
        if let Some(last) = self.links.last() {
            let flange = frames.links[self.links.len() - 1] * last.pose(1.0, 0.0, last.r);
            zero.links[self.links.len()] = flange;
            zero.tcp = flange * self.tool;
        }
        zero
    }
}
