//! Conversion of SI values to the numbers of documents: mm, degrees and percent, rounded to 9 decimals.

use crate::cell::{Cell, Joint, JointKind, JointVector, Unit};
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};
use nalgebra::Vector3;

/// Rounds a number to 9 decimals. The number must already be in the unit of the document.
pub fn nine_digits(value: f64) -> f64 {
    rounded(value, 9)
}

/// Converts metres to millimetres, rounded to 9 decimals.
pub fn millimetres(m: f64) -> f64 {
    nine_digits(mm_from_m(m))
}

/// Converts radians to degrees, rounded to 9 decimals.
pub fn degrees(rad: f64) -> f64 {
    nine_digits(deg_from_rad(rad))
}

/// Converts a share to percent, rounded to 9 decimals.
pub fn percent(share: f64) -> f64 {
    nine_digits(percent_from_share(share))
}

/// Converts an SI value to `unit` (mm, degrees or share), rounded to 9 decimals.
pub fn in_unit(unit: Unit, si: f64) -> f64 {
    nine_digits(unit.from_si(si))
}

/// Converts an SI value to `unit` as [`in_unit`] does. Returns None if the value is not finite, because an
/// unknown value is stored as infinity.
pub fn known_in_unit(unit: Unit, si: f64) -> Option<f64> {
    si.is_finite().then(|| in_unit(unit, si))
}

/// Converts a position to millimetres.
pub fn position_mm(v: &Vector3<f64>) -> [f64; 3] {
    v.map(millimetres).into()
}

/// Converts a rotation vector to degrees.
pub fn rotation_deg(v: &Vector3<f64>) -> [f64; 3] {
    v.map(degrees).into()
}

/// Rounds the components of a vector that has no unit, or that is already in the unit of the document.
pub fn plain(v: &Vector3<f64>) -> [f64; 3] {
    v.map(nine_digits).into()
}

/// Converts a joint coordinate: to degrees for a revolute joint, to mm for a prismatic joint.
pub fn joint_coordinate(kind: JointKind, q: f64) -> f64 {
    match kind {
        JointKind::Revolute => degrees(q),
        JointKind::Prismatic => millimetres(q),
    }
}

/// Converts the coordinates of all joints: to degrees for revolute joints, to mm for prismatic joints.
pub fn joints(cell: &Cell, q: &JointVector) -> Vec<f64> {
    cell.robot.joints.iter().zip(q).map(|(joint, &q)| joint_coordinate(joint.kind, q)).collect()
}

/// A joint counts as near a limit if its distance from the limit is below this share of the travel.
pub const NEAR_LIMIT: f64 = 0.05;

/// Returns, for each joint, whether it is near one of its limits.
pub fn near_limits(cell: &Cell, q: &JointVector) -> Vec<bool> {
    let near = |(joint, q): (&Joint, &f64)| {
        let (low, high) = joint.limits;
        !joint.is_passive() && (q - low).min(high - q) < NEAR_LIMIT * (high - low)
    };
    cell.robot.joints.iter().zip(q).map(near).collect()
}

/// Rounds a lower bound down to 9 decimals, because a bound rounded up would not be proven.
pub fn rounded_down(bound: f64) -> f64 {
    (bound * 1e9).floor() / 1e9
}
