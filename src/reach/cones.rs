//! Joint limits in lanes: an actuator keeps its range where its unit vector lies in a cone.

use super::limits::Limits;
use crate::cell::JointKind;
use crate::lanes::{CosSin, Mask, Simd};

/// Added to the tolerance of the joint limits, in the cosine of the angle from the middle of the range:
/// what is refused here is refused by [`Limits::excess`], too.
const SLACK: f64 = 1e-9;

/// The range of one turning joint. With `theta_i` its angle and `a_j` the unit vectors of the joints
/// that drive it, `a_i = theta_i / a_j^factor`; the offsets of all of them are in the axis of the cone.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cone {
    axis: (f64, f64),
    cos_half: f64,
    factors: Vec<(usize, i32)>,
}

impl Limits {
    /// One cone per joint; None if a joint slides or is driven by a fraction.
    pub fn cones(&self) -> Option<Vec<Cone>> {
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
            cones.push(Cone { axis: (cos, sin), cos_half: range.cos_half, factors });
        }
        Some(cones)
    }
}

impl Cone {
    /// Where the unit vector of the joint surely lies outside.
    #[inline(always)]
    pub fn is_passed<S: Simd>(&self, (cos, sin): CosSin<S>) -> Mask<S> {
        let along = cos * self.axis.0 + sin * self.axis.1;
        along.is_below(along.like(self.cos_half - SLACK))
    }

    /// Where a joint behind the first passes its limit, and where it is out already.
    #[inline(always)]
    pub fn any_passed<S: Simd, const N: usize>(
        cones: &[Cone; N],
        turns: &[CosSin<S>; N],
        mut out: Mask<S>,
    ) -> Mask<S> {
        let mut own = *turns;
        for i in 1..N {
            for &(j, factor) in &cones[i].factors {
                let (c, s) = own[j];
                let s = if factor > 0 { s } else { -s };
                for _ in 0..factor.abs() {
                    own[i] = (own[i].0 * c + own[i].1 * s, own[i].1 * c - own[i].0 * s);
                }
            }
            out = out | cones[i].is_passed(own[i]);
        }
        out
    }
}
