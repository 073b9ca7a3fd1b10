//! Postures beyond the joint ranges that a calibration has measured.

use super::node_record::OperationMap;
use crate::cell::{Cell, ErrorSet, JointKind, JointVector};
use std::f64::consts::TAU;

/// Amount by which each end of a measured range is widened, rad or m, because the numbers in the file are
/// rounded.
const ROUNDING: f64 = 1e-6;

/// Usable nodes whose postures lie outside the joint ranges of the calibration. The errors at these nodes are
/// extrapolated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Extrapolation {
    /// Number of usable nodes whose postures lie outside the measured ranges.
    pub nodes: usize,
    /// Number of usable nodes.
    pub usable: usize,
    /// Indices of the joints that lie outside their measured range at one or more usable nodes, in ascending
    /// order.
    pub joints: Vec<usize>,
    /// Whether the posture at the spot of the operation lies outside the measured ranges.
    pub has_spot: bool,
}

impl Extrapolation {
    /// Returns the usable nodes of a map whose postures lie outside the measured joint ranges. Returns None
    /// if there are no such nodes, or if the error set states no measured ranges.
    pub fn of(cell: &Cell, map: &OperationMap) -> Option<Self> {
        let ErrorSet::Measured(measured) = cell.error_set() else { return None };
        let ranges = measured.ranges.as_ref()?;
        let is_outside = |joint: usize, q: &JointVector| {
            let turns = cell.robot.joints[joint].kind == JointKind::Revolute;
            !contains_joint(ranges[joint], q[joint], turns)
        };
        let mut found = Self { nodes: 0, usable: 0, joints: Vec::new(), has_spot: false };
        for (k, _, posture) in map.usable() {
            found.usable += 1;
            let outside: Vec<usize> =
                (0..ranges.len()).filter(|&joint| is_outside(joint, &posture.joints)).collect();
            found.nodes += usize::from(!outside.is_empty());
            found.has_spot |= !outside.is_empty() && map.best == Some(k);
            found.joints.extend(outside);
        }
        found.joints.sort_unstable();
        found.joints.dedup();
        (found.nodes > 0).then_some(found)
    }
}

/// Returns whether a range contains a joint coordinate. If `turns` is true, angles that differ by a whole
/// turn count as equal.
pub fn contains_joint((low, high): (f64, f64), q: f64, turns: bool) -> bool {
    let (low, high) = (low - ROUNDING, high + ROUNDING);
    match turns {
        true => (q - low).rem_euclid(TAU) <= high - low,
        false => (low..=high).contains(&q),
    }
}
