//! Table of lower bounds of the value at a node, over the height of the node and its distance from the base
//! axis.
//!
//! [`crate::proof::rank_nodes`] computes these tables. The mathematics is stated there.

use super::configuration::ConfigurationFlags;
use crate::robot::Posture;
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
    flags: ConfigurationFlags,
    /// Bounds of every configuration in every table cell, m or rad, in the order of `bounds`; infinite if no
    /// posture of the configuration reaches the cell.
    by_configuration: Vec<f64>,
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
    pub fn new(
        elevation: (f64, f64),
        height: (f64, f64),
        radius: (f64, f64),
        step: f64,
        flags: ConfigurationFlags,
    ) -> Self {
        let (height, radius) = (Ticks::new(height, step), Ticks::new(radius, step));
        let bounds = vec![f64::INFINITY; height.count * radius.count];
        let by_configuration = vec![f64::INFINITY; bounds.len() * flags.configurations()];
        Self { elevation, height, radius, bounds, flags, by_configuration }
    }

    /// Notes a lower bound of the value at all nodes whose height and radius lie in the given ranges, m. The
    /// bound holds for the postures of the given configurations, a bit mask.
    pub fn note(&mut self, height: (f64, f64), radius: (f64, f64), bound: f64, configurations: u32) {
        let cells = |ticks: &Ticks, (low, high): (f64, f64)| {
            let is_inside = high + SLACK >= ticks.low && low - SLACK <= ticks.high;
            let (first, last) = (ticks.nearest(low - SLACK), ticks.nearest(high + SLACK));
            if is_inside { first..last + 1 } else { 0..0 }
        };
        let across = cells(&self.radius, radius);
        let count = self.flags.configurations();
        for k in cells(&self.height, height) {
            for cell in across.clone().map(|j| k * self.radius.count + j) {
                self.bounds[cell] = self.bounds[cell].min(bound);
                for (bit, least) in self.by_configuration[cell * count..][..count].iter_mut().enumerate() {
                    if configurations >> bit & 1 == 1 {
                        *least = least.min(bound);
                    }
                }
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
        self.cell(target).map_or(0.0, |cell| self.bounds[cell])
    }

    /// Returns the lower bounds of the values at a target in the base frame, m; None outside the table.
    pub fn posture_bounds(&self, target: &Vector3<f64>) -> Option<PostureBounds<'_>> {
        let count = self.flags.configurations();
        let bounds = &self.by_configuration[self.cell(target)? * count..][..count];
        Some(PostureBounds { flags: &self.flags, bounds })
    }

    /// Returns the index of the table cell that holds a target in the base frame, m; None outside the table.
    fn cell(&self, target: &Vector3<f64>) -> Option<usize> {
        Some(self.height.cell(target.z)? * self.radius.count + self.radius.cell(target.xy().norm())?)
    }
}

/// Lower bounds of the values of the postures at one target, one bound for each configuration of the arm.
pub struct PostureBounds<'f> {
    flags: &'f ConfigurationFlags,
    bounds: &'f [f64],
}

impl PostureBounds<'_> {
    /// Returns a lower bound of the value of a posture at the target.
    #[inline]
    pub fn of(&self, posture: &Posture) -> f64 {
        self.bounds[self.flags.configuration(posture)]
    }
}
