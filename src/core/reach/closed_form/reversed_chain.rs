//! Six-axis chains solved from flange to base.

use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use nalgebra::{Matrix3, Vector3};

/// Returns the solver that `new` makes from the D-H rows of a six-axis chain. If `new` fails, it is called
/// again with the rows of the reversed chain.
///
/// The second argument of `new` is None for the chain itself. For the reversed chain, it is the constant part
/// `Tx(l_6) Rx(alpha_6)` of the last row of the chain.
///
/// # Errors
/// Returns the reasons for both directions if both fail, or states that the chain does not have six axes.
pub(in crate::reach) fn in_either_direction<T>(
    chain: &Chain,
    new: impl Fn([Link; 6], Option<Pose>) -> Result<T, String>,
) -> Result<T, String> {
    let links: [Link; 6] =
        chain.links[..].try_into().map_err(|_| format!("the chain has {} axes, not 6", chain.axes()))?;
    new(links, None).or_else(|forward| {
        let (rows, lead) = reversed(&links);
        new(rows, Some(lead)).map_err(|back| format!("{forward}; with base and flange exchanged, {back}"))
    })
}

/// Calls `solve` with the pose `flange` and a posture of the chain. Calls `found` with every posture found.
///
/// If `lead` is given, `solve` solves the reversed chain, and this function converts poses and postures
/// between the two chains. `lead` is the constant part of the last row of the chain.
#[inline]
pub(in crate::reach) fn solve_either_direction(
    lead: Option<&Pose>,
    flange: &Pose,
    posture: &mut Posture,
    found: &mut dyn FnMut(u8, &Posture),
    solve: impl FnOnce(&Pose, &mut Posture, &mut dyn FnMut(u8, &Posture)) -> f64,
) -> f64 {
    let Some(lead) = lead else { return solve(flange, posture, found) };
    let mut mirror = mirrored(posture);
    solve(&(*lead * flange.inverse()), &mut mirror, &mut |branch, mirror| {
        *posture = mirrored(mirror);
        found(branch, posture);
    })
}

/// Returns the D-H rows of the reversed chain, and the constant part `Tx(l_6) Rx(alpha_6)` of the last row of
/// the chain.
///
/// If the chain reaches a pose, the reversed chain reaches the constant part times the inverse of this pose.
///
/// Row k (from 1) is `Rz(-theta) Tz(-r)` of joint 7 - k, then `Tx(-l) Rx(-alpha)` of row 6 - k. Row 6 has
/// only the first part.
fn reversed(links: &[Link; 6]) -> ([Link; 6], Pose) {
    let last = &links[5];
    let (s, c) = (last.sin_alpha, last.cos_alpha);
    let rotation = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    let lead = Pose { rotation, translation: Vector3::new(last.l, 0.0, 0.0) };
    let rows = std::array::from_fn(|k| {
        let (joint, before) = (&links[5 - k], 4usize.checked_sub(k).map(|i| &links[i]));
        let twist = before.map_or((0.0, 0.0, 1.0, 0.0), |b| (-b.l, -b.alpha, b.cos_alpha, -b.sin_alpha));
        let (l, alpha, cos_alpha, sin_alpha) = twist;
        Link { theta: -joint.theta, r: -joint.r, l, alpha, cos_alpha, sin_alpha, ..*joint }
    });
    (rows, lead)
}

/// Converts a posture of the chain to the equivalent posture of the reversed chain, or the other way round.
#[inline]
fn mirrored(posture: &Posture) -> Posture {
    let mut mirror = *posture;
    for k in 0..6 {
        mirror.cos[k] = posture.cos[5 - k];
        mirror.sin[k] = -posture.sin[5 - k];
        mirror.r[k] = -posture.r[5 - k];
    }
    mirror
}
