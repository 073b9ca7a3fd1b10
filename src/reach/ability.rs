//! What an arm cannot do by its build.

use super::Inverse;
use super::kernel::Kernel;
use crate::cell::{Attitude, Azimuth, Spin};
use crate::robot::Chain;
use crate::units::{deg_from_rad, rounded};

/// Postures looked at.
const POSTURES: usize = 32;

/// Elevations that differ by less are one, rad.
const SAME: f64 = 1e-9;

/// The elevation of the tool axis (rad) if it is the same in every posture: of a SCARA, of a palletizer.
pub(super) fn kept_elevation(chain: &Chain) -> Option<f64> {
    let elevation = |k: usize| {
        let tcp = chain.forward(&chain.posture(&chain.spread(k)));
        let axis = tcp.rotation * chain.tool_axis;
        axis.z.atan2(axis.x.hypot(axis.y))
    };
    let first = elevation(0);
    (1..POSTURES).all(|k| (elevation(k) - first).abs() < SAME).then_some(first)
}

impl Inverse {
    /// Why the arm cannot hold its tool like this anywhere.
    pub fn refusal(&self, attitude: &Attitude) -> Option<String> {
        let degrees = |rad: f64| rounded(deg_from_rad(rad), 3);
        if let Some(kept) = self.kept
            && (kept - attitude.elevation).abs() > attitude.tolerance + 1e-6
        {
            return Some(format!(
                "the arm keeps its tool at an elevation of {} deg by its build: write bend_deg = {0}",
                degrees(kept)
            ));
        }
        let Kernel::Planar(arm) = &self.kernel else { return None };
        let exact = attitude.tolerance == 0.0;
        if exact && !attitude.is_vertical() && matches!(attitude.azimuth, Azimuth::Surface(_)) {
            return Some(
                "the arm heads where its base turns, so that azimuth_deg cannot be an angle of the surface: \
                 write azimuth_deg = \"radial\", or allow a tolerance_deg"
                    .into(),
            );
        }
        if exact && !arm.rolls() && matches!(attitude.spin, Spin::At(_)) {
            return Some(
                "the arm has no axis that turns the tool about itself, so that spin_deg cannot be chosen: \
                 leave it out, or allow a tolerance_deg"
                    .into(),
            );
        }
        None
    }
}
