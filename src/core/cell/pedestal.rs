//! Support of the robot base: the floor, a pedestal, or a wall or gantry.

use super::model::{BaseSupport, Cell};
use super::shape::Rectangle;

/// Least height of a pedestal, m; a lower base stands on the floor.
const LEAST_HEIGHT: f64 = 1e-6;

impl Cell {
    /// Returns the cross-section of the pedestal and its height (m) for a base at height `z` in the world.
    ///
    /// The result is None if the base stands on the floor, or if no pedestal carries it.
    pub fn pedestal(&self, z: f64) -> Option<(Rectangle, f64)> {
        let height = z - self.floor;
        match self.base_support {
            BaseSupport::Pedestal(section) if height > LEAST_HEIGHT => Some((section, height)),
            _ => None,
        }
    }

    /// Returns the pedestal for the greatest base height that the cell allows.
    ///
    /// The collision check uses this pedestal at every height of the base. If the base is not at its greatest
    /// height, the lower end of this pedestal is below the floor.
    pub fn highest_pedestal(&self) -> Option<(Rectangle, f64)> {
        self.pedestal(self.base[2].range().1)
    }
}

impl Rectangle {
    /// Returns the least rectangle that contains this rectangle and another.
    pub fn joined(&self, other: &Self) -> Self {
        let ends = |centre: f64, size: f64| (centre - size / 2.0, centre + size / 2.0);
        let join = |a: (f64, f64), b: (f64, f64)| {
            let (low, high) = (a.0.min(b.0), a.1.max(b.1));
            ((low + high) / 2.0, high - low)
        };
        let x = join(ends(self.centre.0, self.size.0), ends(other.centre.0, other.size.0));
        let y = join(ends(self.centre.1, self.size.1), ends(other.centre.1, other.size.1));
        Self { centre: (x.0, y.0), size: (x.1, y.1) }
    }
}
