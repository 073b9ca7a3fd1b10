//! Parameter that a calibration identifies, and its prior standard deviation.

use crate::cell::{JointKind, Parameter};
use crate::robot::Chain;
use crate::units::{m_from_mm, rad_from_deg};

/// Error parameter of a robot that a calibration identifies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Error of a Denavit-Hartenberg row.
    Row(Parameter),
    /// Deflection of joint `joint` caused by the weight that link `link` carries.
    ///
    /// The deflection is the value of the unknown (rad/m) times the horizontal lever of the link (m; see
    /// [`crate::robot::lever`]). The value is the compliance of the joint (rad/(N m)) times the weight (N) at
    /// and beyond the end of the link.
    Elastic { joint: usize, link: usize },
    /// Error of actuator `joint` that is periodic in the coordinate q of the actuator. The error is the value
    /// (rad) times `cos(order q)`, or `sin(order q)` if `sine` is true.
    Harmonic { joint: usize, order: usize, sine: bool },
}

/// Unknown with its value and standard deviations, all in m, rad or rad/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    pub unknown: Unknown,
    pub value: f64,
    /// Prior standard deviation (before the measurement).
    pub prior: f64,
    /// Posterior standard deviation (after the measurement).
    pub sigma: f64,
}

impl Identified {
    /// Returns whether the data reduce the standard deviation of the parameter to less than half.
    pub fn is_identified(&self) -> bool {
        self.sigma < self.prior / 2.0
    }
}

impl Unknown {
    /// Returns whether the unknown is a coefficient of a periodic error.
    pub const fn is_harmonic(self) -> bool {
        matches!(self, Self::Harmonic { .. })
    }

    /// Returns the default prior standard deviation, m, rad or rad/m.
    ///
    /// The values are assumptions of this library. The value is 0.5 mm for lengths and for the zeros of
    /// prismatic joints. It is 0.5 degrees for the zeros of revolute joints, and 0.1 degrees for twists. It
    /// is 3 mrad/m for elastic terms. The value for a coefficient of a harmonic is 0.15 mrad up to order 4,
    /// and 0.075 mrad above order 4.
    pub fn default_prior(self, chain: &Chain) -> f64 {
        match self {
            Self::Row(Parameter::Dr(_) | Parameter::Dl(_)) => m_from_mm(0.5),
            Self::Row(Parameter::Dq(i)) if chain.links[i].kind == JointKind::Prismatic => m_from_mm(0.5),
            Self::Row(Parameter::Dq(_)) => rad_from_deg(0.5),
            Self::Row(_) => rad_from_deg(0.1),
            Self::Elastic { .. } => 3e-3,
            Self::Harmonic { order, .. } => expected_harmonic(order),
        }
    }
}

/// Largest order of the slow harmonics, whose coefficients are larger because encoders and gears are
/// eccentric or tilted.
const SLOW: usize = 4;
/// Expected standard deviation of a coefficient of a harmonic above order [`SLOW`] before the fit, rad.
const EXPECTED_HARMONIC: f64 = 7.5e-5;

/// Returns the prior standard deviation of one coefficient of this order, rad.
///
/// The values come from a real arm (results/measured).
pub(super) fn expected_harmonic(order: usize) -> f64 {
    if order <= SLOW { 2.0 * EXPECTED_HARMONIC } else { EXPECTED_HARMONIC }
}
