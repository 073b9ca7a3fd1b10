//! Tool attitudes that an arm cannot reach at any position, whatever the layout.

use super::Inverse;
use super::solver::ChainSolver;
use crate::cell::{Attitude, Azimuth, Spin};
use crate::units::{deg_from_rad, rounded};

/// Elevations count as equal if they differ by at most this value, rad.
///
/// The value exceeds the rounding error of an angle that a file states in degrees.
const SAME_ELEVATION: f64 = 1e-6;

impl Inverse {
    /// Returns the reason why the arm cannot reach this tool attitude at any position; None if no reason is
    /// known.
    pub fn refusal(&self, attitude: &Attitude) -> Option<String> {
        let degrees = |rad: f64| rounded(deg_from_rad(rad), 3);
        if let Some(fixed) = self.fixed_elevation
            && (fixed - attitude.elevation).abs() > attitude.tolerance + SAME_ELEVATION
        {
            return Some(format!(
                "the arm always holds its tool at an elevation of {} deg: write bend_deg = {0}",
                degrees(fixed)
            ));
        }
        let ChainSolver::Planar(arm) = &self.solver else { return None };
        let exact = attitude.tolerance == 0.0;
        if exact && !attitude.is_vertical() && matches!(attitude.azimuth, Azimuth::Surface(_)) {
            return Some(
                "joint 1 of the arm determines the azimuth of the tool, so azimuth_deg cannot be an angle: \
                 write azimuth_deg = \"radial\", or set a tolerance_deg above 0"
                    .into(),
            );
        }
        if exact && !arm.rolls() && matches!(attitude.spin, Spin::At(_)) {
            return Some(
                "no joint of the arm rotates the tool about the tool axis, so spin_deg cannot be chosen: \
                 omit spin_deg, or set a tolerance_deg above 0"
                    .into(),
            );
        }
        None
    }
}
