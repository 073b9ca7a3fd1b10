//! Joint limits as cones in the plane of cosine and sine of an actuator coordinate.
//!
//! The actuator is within its range if the unit vector (cosine, sine) lies in its cone.

use super::limits::Limits;
use crate::cell::JointKind;

/// Range of one revolute joint as a cone of unit vectors.
///
/// Every angle is written as a complex number of length 1, so a division subtracts angles. Let `theta_i` be
/// the D-H angle of joint i, and `a_i` the coordinate of its actuator plus an offset `o_i`. Then `a_i` is
/// `theta_i` divided by `a_j^factor` for every joint j that drives joint i. Here `factor` is the coupling
/// factor from joint j to joint i. As an angle, `o_i` is `theta_i` with all actuators at coordinate 0, minus
/// `factor * o_j` for every such joint j.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitCone {
    /// Cosine and sine of the angle of the cone's axis.
    ///
    /// The angle is the middle of the range plus the offset `o_i` of the joint (see [`LimitCone`]).
    pub axis: (f64, f64),
    /// Cosine of half the width of the range; -2 if every angle is allowed.
    pub cos_half: f64,
    /// Index and coupling factor of every other joint that drives this joint.
    pub factors: Vec<(usize, i32)>,
}

impl Limits {
    /// Returns one cone per joint.
    ///
    /// Returns None if a joint is prismatic, or if a coupling factor is not a whole number from -8 to 8.
    pub fn cones(&self) -> Option<Vec<LimitCone>> {
        let whole = self.whole.as_ref()?;
        if self.ranges.iter().any(|r| r.kind == JointKind::Prismatic) {
            return None;
        }
        let mut offsets = Vec::new();
        let mut cones = Vec::new();
        for (i, range) in self.ranges.iter().enumerate() {
            let own = whole.iter().filter(|w| w.0 == i);
            let factors: Vec<_> = own.map(|&(_, j, factor)| (j, factor)).collect();
            let driven: f64 = factors.iter().map(|&(j, factor)| f64::from(factor) * offsets[j]).sum();
            let offset = range.zero.1.atan2(range.zero.0) - driven;
            offsets.push(offset);
            let (sin, cos) = (offset + range.centre).sin_cos();
            cones.push(LimitCone { axis: (cos, sin), cos_half: range.cos_half, factors });
        }
        Some(cones)
    }
}
