//! Heights that objects on the floor occupy.

use crate::cell::{Equipment, Robot, Shape, extent};

/// Range of heights, m; an end may be infinite.
pub(super) type HeightRange = (f64, f64);

/// Heights of one piece of equipment above the origin of its frame.
#[derive(Clone, Copy)]
pub(super) struct Heights {
    /// Height of the lowest point of solids and surface, m; 0 if there is neither solid nor surface.
    pub low: f64,
    /// Height of the highest point of solids and surface, m; 0 if there is neither solid nor surface.
    high: f64,
    /// Whether the equipment has legs, which occupy the space down to the floor.
    legs: bool,
    has_solids: bool,
}

impl Heights {
    /// Returns the heights of a piece of equipment.
    pub fn of(equipment: &Equipment) -> Self {
        let solids = equipment.solids.iter().map(|s| extent(&s.shape)).map(|(lo, hi)| (lo.z, hi.z));
        let all = solids.chain(equipment.surface.map(|_| (0.0, 0.0)));
        let (low, high) = all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 0.0));
        let legs = equipment.solids.iter().any(|s| matches!(s.shape, Shape::Leg { .. }));
        Self { low, high, legs, has_solids: !equipment.solids.is_empty() }
    }

    /// Returns the heights in the world that equipment occupies if its frame is at height `z`, m.
    ///
    /// Equipment without solids counts as occupying all heights.
    pub fn at(&self, z: f64) -> HeightRange {
        if self.has_solids { self.known_at(z) } else { (f64::NEG_INFINITY, f64::INFINITY) }
    }

    /// Returns the heights in the world that solids and surface occupy if the equipment is at height `z`, m.
    ///
    /// For equipment with legs, the lower end of the range is minus infinity.
    pub fn known_at(&self, z: f64) -> HeightRange {
        (if self.legs { f64::NEG_INFINITY } else { z + self.low }, z + self.high)
    }
}

/// Returns the height of the highest point of the robot base above the origin of its frame, m.
///
/// The height is infinite if the base has no solids.
pub(super) fn base_top(robot: &Robot) -> f64 {
    let solids = robot.solids.iter().filter(|s| s.link == 0);
    solids.map(|s| extent(&s.solid.shape).1.z).reduce(f64::max).unwrap_or(f64::INFINITY)
}

/// Returns the height of the lowest point of the robot base above the origin of its frame, m.
///
/// The height is minus infinity if the base has no solids.
pub(super) fn base_bottom(robot: &Robot) -> f64 {
    let solids = robot.solids.iter().filter(|s| s.link == 0);
    solids.map(|s| extent(&s.solid.shape).0.z).reduce(f64::min).unwrap_or(f64::NEG_INFINITY)
}

/// Returns the vertical distance between two height ranges, m; negative if the ranges overlap.
pub(super) fn rise(a: HeightRange, b: HeightRange) -> f64 {
    (a.0 - b.1).max(b.0 - a.1)
}
