//! Tool attitudes of an operation, prepared for one arm.

use super::attitude_set::AttitudeSet;

/// Attitude of the tool in the vertical plane of a planar arm, given by the angle phi.
///
/// The angle phi is theta_2 + theta_3 + theta_4: the direction of link 4 in this plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarAttitude {
    pub cos_phi: f64,
    pub sin_phi: f64,
    /// Horizontal component, in the plane of the arm, of the vector from the wrist to the TCP, m.
    pub u: f64,
    /// Vertical component of the vector from the wrist to the TCP, m. The component is positive upwards if
    /// alpha_1 is +90 degrees, and positive downwards if alpha_1 is -90 degrees.
    pub v: f64,
    /// Cosine of the tool's elevation; negative if the tool points opposite to the azimuth theta_1.
    pub(in crate::reach) cos_elevation: f64,
    /// Sine of the tool's elevation.
    pub(in crate::reach) sin_elevation: f64,
}

/// Tool attitudes of an operation over one surface, prepared for one arm.
///
/// A search reuses one instance for all layouts, so it allocates no memory per layout.
#[derive(Debug, Clone, Default)]
pub struct ToolAttitudes {
    pub(super) set: AttitudeSet,
    /// Attitudes in the vertical plane of a planar arm; empty for other arms.
    pub(super) planar: Vec<PlanarAttitude>,
}

impl ToolAttitudes {
    /// Returns one entry per spin: cosine and sine of the angle from the first spin to this spin.
    pub fn spin_rotations(&self) -> &[(f64, f64)] {
        &self.set.spin_rotations
    }

    /// Returns the attitudes in the vertical plane of a planar arm; empty for other arms.
    pub fn planar(&self) -> &[PlanarAttitude] {
        &self.planar
    }
}
