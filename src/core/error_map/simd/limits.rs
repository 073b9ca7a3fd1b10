//! Check of the joint limits of several postures at once, in SIMD lanes.

use super::lanes::{CosSin, Mask};
use crate::reach::LimitCone;
use pulp::Simd;

/// Amount by which this check lowers the cosine of half a joint's range. The joint limits thus become a
/// little wider.
///
/// The scalar code, which judges single nodes, therefore also refuses every posture that this check refuses.
const SLACK: f64 = 1e-9;

/// Returns the lanes in which a joint surely lies outside its range. The joint is given by the cosine and
/// the sine of its angle.
#[inline(always)]
pub fn is_passed<S: Simd>(cone: &LimitCone, (cos, sin): CosSin<S>) -> Mask<S> {
    let along = cos * cone.axis.0 + sin * cone.axis.1;
    along.is_below(along.like(cone.cos_half - SLACK))
}

/// Adds to `out` the lanes in which any joint except the first exceeds its limits.
#[inline(always)]
pub fn any_passed<S: Simd, const N: usize>(
    cones: &[LimitCone; N],
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
        out = out | is_passed(&cones[i], own[i]);
    }
    out
}
