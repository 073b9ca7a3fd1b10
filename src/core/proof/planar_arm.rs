//! Planar arms: the first joint rotates the vertical plane in which all links move.

use super::coordinates::DIRECTION_ROUNDING;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::kinematic_error::Screws;
use nalgebra::Vector3;

/// Direction in which the tool of a planar arm leans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lean {
    /// The tool axis has a component along the horizontal unit vector in the plane of the arm.
    Forwards,
    /// The tool axis has a component against this vector.
    Backwards,
}

/// Returns a horizontal unit vector in the plane of a planar arm, in the base frame. Returns None if the
/// arm is not planar, or if the first joint is not held.
///
/// The axes of all joints of a planar arm between the first and the last joint are horizontal and parallel to
/// each other. The last axis is parallel to these axes or to the tool axis, and the tool axis is
/// perpendicular to these axes.
pub(super) fn facing(screws: &Screws, held: &[bool; MAX_JOINTS]) -> Option<Vector3<f64>> {
    let (first, others) = screws.axes.get(..screws.kinds.len())?.split_first()?;
    let (last, between) = others.split_last()?;
    let across = between.first()?;
    let is_small = |v: Vector3<f64>| v.norm() < DIRECTION_ROUNDING;
    let is_planar = held[0]
        && screws.kinds.iter().all(|kind| *kind == JointKind::Revolute)
        && is_small(first.cross(&Vector3::z()))
        && across.z.abs() < DIRECTION_ROUNDING
        && screws.tool.dot(across).abs() < DIRECTION_ROUNDING
        && between.iter().all(|axis| is_small(axis.cross(across)))
        && (is_small(last.cross(across)) || is_small(last.cross(&screws.tool)));
    is_planar.then(|| across.cross(&Vector3::z()).normalize())
}
