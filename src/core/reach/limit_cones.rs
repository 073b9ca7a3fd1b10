//! Joint limits as cones in the plane of cosine and sine of an actuator coordinate.
//!
//! The actuator is within its range if the unit vector (cosine, sine) lies in its cone.

use super::limits::Limits;
use crate::cell::JointKind;

/// Range of one revolute joint as a cone of unit vectors.
///
/// Let `theta_i` be the D-H angle of joint i, and `q_i` the coordinate of its actuator. The angle `a_i` is
/// `q_i` plus a constant offset `o_i`:
///
/// ```text
/// a_i = q_i + o_i = theta_i - sum_j f_ij a_j
/// o_i = zero_i - sum_j f_ij o_j
/// ```
///
/// Here `zero_i` is `theta_i` with all actuators at coordinate 0. The coupling factor from joint j to joint i
/// is `f_ij`. The sums run over the joints j that drive joint i. The cone limits the unit vector (cosine,
/// sine) of `a_i`. Let `u(a)` be the unit vector of an angle `a`, treated as a complex number. A division of
/// such numbers subtracts their angles:
///
/// ```text
/// u(a_i) = u(theta_i) / product_j u(a_j)^f_ij
/// ```
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
