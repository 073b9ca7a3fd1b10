//! Posture that an operation keeps while the layout changes.

use crate::cell::JointVector;
use crate::reach::{Branch, CONTINUED, Inverse, PoseMiss, ToolAttitudes};
use nalgebra::Vector3;

/// Point of the surface at which the operation can happen, with the posture and the value there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSpot {
    pub posture: HeldPosture,
    /// Value to minimize, defined like [`crate::error_map::Spot::value`].
    pub value: f64,
}

/// Point and posture that are kept while the layout changes a little.
///
/// Closed-form inverse kinematics finds the posture again by its branch index. For other arms and for arms
/// with seven revolute axes ([`Inverse::continues_postures`]), a numeric solver starts at the kept joint
/// coordinates. If the arm has six or more joints, this solver also rotates the tool about the vertical. The
/// angle of this rotation is the difference between the new reference azimuth and the kept one
/// ([`Self::heading`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldPosture {
    /// Coordinates x and y of the point in the frame of the equipment, m.
    pub at: (f64, f64),
    pub branch: u64,
    pub joints: JointVector,
    /// Reference azimuth at the point, in the base frame, rad ([`Inverse::heading`]).
    ///
    /// If the operation has a radial azimuth, the reference is the direction from the base axis to the point.
    /// Otherwise, the reference is fixed in the surface.
    pub heading: f64,
}

impl HeldPosture {
    /// Returns a copy of this posture at another point of the surface. Branch, joint coordinates and heading
    /// do not change.
    #[must_use]
    pub fn at_point(&self, at: (f64, f64)) -> Self {
        Self { at, ..*self }
    }

    /// Returns the branch index with which inverse kinematics finds this posture in another layout or at
    /// another point. The result is [`CONTINUED`] if a numeric solver finds the posture.
    pub fn branch_elsewhere(&self, inverse: &Inverse) -> u64 {
        if inverse.continues_postures() { CONTINUED } else { self.branch }
    }

    /// Finds the posture at a target (base frame, m) to which the numeric solver leads from this posture.
    ///
    /// # Errors
    /// Returns the remaining position and angle errors if the arm cannot reach the target.
    pub(super) fn continued(
        &self,
        inverse: &Inverse,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Result<Branch, PoseMiss> {
        let turn = inverse.heading(target, attitudes) - self.heading;
        inverse.continued(&self.joints, turn, target, attitudes)
    }

    /// Finds the posture of [`Self::continued`] for an arm whose joints may exceed their limits. Returns None
    /// if no posture is found, or if the arm has only a numeric solver.
    pub(super) fn continued_beyond_limits(
        &self,
        inverse: &Inverse,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Option<Branch> {
        let turn = inverse.heading(target, attitudes) - self.heading;
        inverse.continued_beyond_limits(&self.joints, turn, target, attitudes)
    }
}
