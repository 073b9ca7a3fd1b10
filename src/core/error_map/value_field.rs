//! Table of lower bounds of the value at a node, over the height of the node and its distance from the base
//! axis.
//!
//! [`crate::proof::rank_nodes`] computes these tables. The mathematics is stated there.

use nalgebra::Vector3;

/// Margin, m, by which the ranges of a bound are widened. The margin is far above the position errors of the
/// inverse kinematics.
const SLACK: f64 = 1e-6;

/// Table of lower bounds of the value at a node, as a function of the node's height and its distance from the
/// base axis (radius).
///
/// The bounds are valid for every layout in which two quantities lie in the ranges of the table. These
/// quantities are the height of the operation and the elevation of the tool axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueField {
    /// Range of the elevation that the operation asks of the tool axis, rad.
    elevation: (f64, f64),
    height: Ticks,
    radius: Ticks,
    /// One bound per table cell, m or rad, radius by radius within each height; infinite if no posture
    /// reaches the cell.
    bounds: Vec<f64>,
}

/// Range that is divided into cells of equal length.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ticks {
    low: f64,
    high: f64,
    count: usize,
    /// Cells per metre.
    density: f64,
}

impl Ticks {
    fn new((low, high): (f64, f64), step: f64) -> Self {
        let count = ((high - low) / step).ceil().max(1.0) as usize;
        Self { low, high, count, density: count as f64 / (high - low).max(SLACK) }
    }

    /// Returns the index of the cell that contains a number; None if the number lies outside the range.
    fn cell(&self, at: f64) -> Option<usize> {
        (at >= self.low && at <= self.high).then(|| self.nearest(at))
    }

    /// Returns the index of the cell that is nearest to a number.
    fn nearest(&self, at: f64) -> usize {
        (((at - self.low) * self.density) as usize).min(self.count - 1)
    }
}

impl ValueField {
    /// Creates a table for a range of elevations (rad) and for ranges of height and radius, m. All bounds are
    /// infinite until [`Self::note`] lowers them. `step` is the largest length of a table cell, m.
    pub fn new(elevation: (f64, f64), height: (f64, f64), radius: (f64, f64), step: f64) -> Self {
        let (height, radius) = (Ticks::new(height, step), Ticks::new(radius, step));
        let bounds = vec![f64::INFINITY; height.count * radius.count];
        Self { elevation, height, radius, bounds }
    }

    /// Notes a lower bound of the value at all nodes whose height and radius lie in the given ranges, m.
    pub fn note(&mut self, height: (f64, f64), radius: (f64, f64), bound: f64) {
        let cells = |ticks: &Ticks, (low, high): (f64, f64)| {
            let is_inside = high + SLACK >= ticks.low && low - SLACK <= ticks.high;
            let (first, last) = (ticks.nearest(low - SLACK), ticks.nearest(high + SLACK));
            if is_inside { first..last + 1 } else { 0..0 }
        };
        let across = cells(&self.radius, radius);
        for k in cells(&self.height, height) {
            for least in &mut self.bounds[k * self.radius.count..][across.clone()] {
                *least = least.min(bound);
            }
        }
    }

    /// Returns whether the table covers both the given height of a target in the base frame (m) and the given
    /// elevation of the tool axis (rad).
    pub fn covers(&self, z: f64, elevation: f64) -> bool {
        self.height.cell(z).is_some() && self.elevation.0 <= elevation && elevation <= self.elevation.1
    }

    /// Returns a lower bound of the value at a target in the base frame, m. The bound is 0 outside the table,
    /// and infinite if no posture reaches the target.
    pub fn bound(&self, target: &Vector3<f64>) -> f64 {
        match (self.height.cell(target.z), self.radius.cell(target.xy().norm())) {
            (Some(k), Some(j)) => self.bounds[k * self.radius.count + j],
            _ => 0.0,
        }
    }
}
