//! Interpretation of the numbers in a file of measured positions.

use super::joint_map::JointMap;
use crate::calibration::raw::RawMeasurement;
use crate::calibration::session::MeasuredPosition;
use crate::pose::Pose;
use crate::robot::Chain;
use crate::units::{INCH, MILLIMETRE};

/// Interpretation of the numbers in a file of measured positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataReading {
    /// Whether joint angles are in degrees, not rad.
    pub degrees: bool,
    /// Size in m of the unit of lengths in the file: 0.001, 1 or 0.0254.
    pub unit: f64,
    /// Map from the joint columns to actuator coordinates.
    pub joints: JointMap,
    /// Whether the frame of the positions is left-handed: two columns are swapped, or one column has the
    /// wrong sign.
    pub mirrored: bool,
    /// Root mean square of the distances between measured and nominal positions, m. The worst tenth of the
    /// rows is left out. Base and reflectors are fitted.
    pub rms: f64,
    /// Root mean square of the distances between measured and nominal positions under the plain reading of
    /// the file, m. The plain reading keeps the columns, signs and zero offsets of the file. The value is
    /// infinite if the positions do not determine base and reflectors in the plain reading.
    pub plain_rms: f64,
    /// Fitted pose of the robot base in the frame of the positions.
    pub base: Pose,
}

/// Units of length of measured data: the name of each unit, and its size in m.
pub const LENGTH_UNITS: [(&str, f64); 3] = [("mm", MILLIMETRE), ("m", 1.0), ("inch", INCH)];

/// Largest plausible root mean square distance between measured and nominal positions, as a share of the
/// reach of the arm. A hypothesis with a larger distance is rejected.
const IMPLAUSIBLE: f64 = 0.02;

impl DataReading {
    /// Returns the measured position with joint coordinates in rad or m and lengths in m.
    pub fn applied(&self, chain: &Chain, raw: &RawMeasurement) -> MeasuredPosition {
        let joints = self.joints.applied(chain, &raw.numbers.joints, self.degrees, self.unit);
        let mut position = raw.numbers.position * self.unit;
        if self.mirrored {
            position.z = -position.z;
        }
        let sigma = raw.numbers.sigma.map(|sigma| sigma * self.unit);
        MeasuredPosition { joints, position, sigma, ..raw.numbers }
    }

    /// Returns whether the nominal arm explains the data; `reach` is the reach of the arm, m.
    pub fn is_plausible(&self, reach: f64) -> bool {
        self.rms < IMPLAUSIBLE * reach
    }

    /// Returns whether the reading changes no column, sign or zero offset, adds no coupling, and mirrors no
    /// position.
    pub fn is_plain(&self) -> bool {
        self.joints == JointMap::PLAIN && !self.mirrored
    }

    /// Returns the complexity of a hypothesis: a weighted count of its differences from the plain reading.
    pub(super) fn complexity(&self) -> usize {
        self.joints.complexity() + 2 * usize::from(self.mirrored)
    }
}

/// Returns the name of the unit of length whose size in m is `unit`. Returns "m" if [`LENGTH_UNITS`] has no
/// such unit.
pub fn unit_name(unit: f64) -> &'static str {
    LENGTH_UNITS.iter().find(|(_, length)| *length == unit).map_or("m", |(name, _)| name)
}
