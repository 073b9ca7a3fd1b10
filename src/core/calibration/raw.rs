//! Measurements as a file states them, before units and conventions are known.

use super::session::MeasuredPosition;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

/// Measurement of one reflector at one posture, in the units and conventions of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawMeasurement {
    /// Joint coordinates and position in the units of the file.
    pub numbers: MeasuredPosition,
    /// Orientation, if the file states one.
    pub rotation: Option<RawRotation>,
}

/// Numbers that state an orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RawRotation {
    Angles([f64; 3]),
    /// Quaternion with its scalar part first.
    ScalarFirst([f64; 4]),
    /// Quaternion whose scalar part is first or last; the file does not state which.
    Quaternion([f64; 4]),
    Matrix(Matrix3<f64>),
}

impl From<&MeasuredPosition> for RawMeasurement {
    fn from(numbers: &MeasuredPosition) -> Self {
        Self { numbers: *numbers, rotation: None }
    }
}

/// Convention of the numbers that state an orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotationConvention {
    /// `Rx(a) Ry(b) Rz(c)`: about x, the new y, the new z.
    IntrinsicXyz,
    /// `Rz(c) Ry(b) Rx(a)`: about the fixed x, y, z axes; roll, pitch and yaw.
    FixedXyz,
    /// `Rz(a) Ry(b) Rx(c)`: about z, the new y, the new x; A, B and C of KUKA.
    IntrinsicZyx,
    /// `Rz(a) Ry(b) Rz(c)`: Euler angles of Kawasaki and Staubli.
    IntrinsicZyz,
    /// Rotation vector: the axis times the angle.
    Vector,
    ScalarFirst,
    ScalarLast,
    /// Matrix whose columns are the axes of the tool.
    Matrix,
}

impl RotationConvention {
    /// Conventions of three angles, the most frequent first.
    const OF_ANGLES: [Self; 5] =
        [Self::IntrinsicXyz, Self::FixedXyz, Self::IntrinsicZyx, Self::IntrinsicZyz, Self::Vector];

    /// Returns the conventions in which the numbers of `raw` can be read.
    pub fn of(raw: &RawRotation) -> &'static [Self] {
        match raw {
            RawRotation::Angles(_) => &Self::OF_ANGLES,
            RawRotation::ScalarFirst(_) => &[Self::ScalarFirst],
            RawRotation::Quaternion(_) => &[Self::ScalarFirst, Self::ScalarLast],
            RawRotation::Matrix(_) => &[Self::Matrix],
        }
    }

    /// Returns the convention in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::IntrinsicXyz => "Rx Ry Rz, about moving axes",
            Self::FixedXyz => "roll, pitch, yaw about fixed axes",
            Self::IntrinsicZyx => "Rz Ry Rx, about moving axes (A, B, C)",
            Self::IntrinsicZyz => "Rz Ry Rz, Euler angles",
            Self::Vector => "a rotation vector",
            Self::ScalarFirst => "a quaternion, scalar first",
            Self::ScalarLast => "a quaternion, scalar last",
            Self::Matrix => "a matrix",
        }
    }

    /// Returns the rotation matrix; `scale` converts angles to rad. Returns None if the numbers are not a
    /// rotation, or do not have the form of the convention.
    pub fn matrix(self, raw: &RawRotation, scale: f64) -> Option<Matrix3<f64>> {
        match (*raw, self) {
            (RawRotation::Angles(angles), _) => self.of_angles(angles.map(|angle| angle * scale)),
            (
                RawRotation::ScalarFirst([w, x, y, z]) | RawRotation::Quaternion([w, x, y, z]),
                Self::ScalarFirst,
            )
            | (RawRotation::Quaternion([x, y, z, w]), Self::ScalarLast) => {
                let q = Quaternion::new(w, x, y, z);
                let is_unit = (q.norm() - 1.0).abs() < 0.01;
                is_unit.then(|| UnitQuaternion::from_quaternion(q).to_rotation_matrix().into_inner())
            }
            (RawRotation::Matrix(matrix), Self::Matrix) => {
                let is_rotation = (matrix * matrix.transpose() - Matrix3::identity()).amax() < 0.01;
                (is_rotation && matrix.determinant() > 0.0).then_some(matrix)
            }
            _ => None,
        }
    }

    fn of_angles(self, [a, b, c]: [f64; 3]) -> Option<Matrix3<f64>> {
        use super::deformed::about;
        Some(match self {
            Self::IntrinsicXyz => about(0, a) * about(1, b) * about(2, c),
            Self::FixedXyz => about(2, c) * about(1, b) * about(0, a),
            Self::IntrinsicZyx => about(2, a) * about(1, b) * about(0, c),
            Self::IntrinsicZyz => about(2, a) * about(1, b) * about(2, c),
            Self::Vector => nalgebra::Rotation3::new(nalgebra::Vector3::new(a, b, c)).into_inner(),
            Self::ScalarFirst | Self::ScalarLast | Self::Matrix => return None,
        })
    }
}
