//! Goals of the TCP, and the twist from a pose of the TCP to its goal.

use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3, vector};

/// Largest error of a solution, m and rad: half of the documented accuracy of 1e-9.
const REACHED: f64 = 5e-10;

/// Angle from the vertical, rad, below which a tool axis counts as vertical.
const VERTICAL: f64 = 1e-9;

/// Largest entry of `R R^T - 1` for which a given matrix R counts as a rotation.
const ORTHOGONAL_TOLERANCE: f64 = 1e-6;

/// Goal of the TCP, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TcpGoal {
    /// Required position of the TCP, m.
    pub position: Vector3<f64>,
    pub attitude: AttitudeGoal,
}

/// Goal of the tool's attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AttitudeGoal {
    /// Any attitude of the tool.
    Any,
    /// Elevation (rad) of the tool axis above the horizontal xy plane of the base.
    Elevation(f64),
    /// Unit vector along the tool axis; the rotation about this axis is free.
    Axis(Vector3<f64>),
    /// Orientation of the TCP in the base frame.
    Rotation(Matrix3<f64>),
}

impl TcpGoal {
    /// Returns the goal in a form that can be solved; None if the goal is not valid.
    ///
    /// The elevation of a vertical tool becomes an axis. The goal is not valid if a number is not finite, the
    /// axis is zero or the matrix is not a rotation.
    pub(super) fn checked(&self) -> Option<Self> {
        let attitude = match self.attitude {
            AttitudeGoal::Any => AttitudeGoal::Any,
            AttitudeGoal::Elevation(angle) if !angle.is_finite() => return None,
            AttitudeGoal::Elevation(angle) if angle.cos().abs() < VERTICAL => {
                AttitudeGoal::Axis(Vector3::z() * angle.sin().signum())
            }
            // An angle beyond the vertical becomes the equivalent elevation between -90 and 90 degrees.
            AttitudeGoal::Elevation(angle) => AttitudeGoal::Elevation(angle.sin().atan2(angle.cos().abs())),
            AttitudeGoal::Axis(axis) => {
                AttitudeGoal::Axis(axis.try_normalize(ORTHOGONAL_TOLERANCE).filter(finite)?)
            }
            AttitudeGoal::Rotation(r) => {
                let off = (r * r.transpose() - Matrix3::identity()).amax();
                return (off < ORTHOGONAL_TOLERANCE && r.determinant() > 0.0 && finite(&self.position))
                    .then_some(*self);
            }
        };
        finite(&self.position).then_some(Self { attitude, ..*self })
    }

    /// Returns the number of scalar conditions on position and attitude together.
    pub(super) fn rows(&self) -> usize {
        match self.attitude {
            AttitudeGoal::Any => 3,
            AttitudeGoal::Elevation(_) => 4,
            AttitudeGoal::Axis(_) => 5,
            AttitudeGoal::Rotation(_) => 6,
        }
    }

    /// Returns the twist from the pose `tcp` to the goal, base frame; `tool_axis` is in the frame of the TCP.
    #[inline]
    pub(super) fn miss(&self, tcp: &Pose, tool_axis: &Vector3<f64>) -> TwistError {
        let position = self.position - tcp.translation;
        let (rotation, seen) = match self.attitude {
            AttitudeGoal::Any => (Vector3::zeros(), ConstrainedRotation::Nothing),
            AttitudeGoal::Elevation(angle) => {
                let axis = tcp.rotation * tool_axis;
                let across = axis.x.hypot(axis.y);
                // A rotation about `axis` x z, which is horizontal, raises the tool. For a vertical tool, any
                // horizontal axis is suitable.
                let about = if across > 0.0 { vector![axis.y, -axis.x, 0.0] / across } else { Vector3::x() };
                (about * (angle - axis.z.atan2(across)), ConstrainedRotation::Along(about))
            }
            AttitudeGoal::Axis(wanted) => {
                let axis = tcp.rotation * tool_axis;
                (least_turn(&axis, &wanted), ConstrainedRotation::Across(axis))
            }
            AttitudeGoal::Rotation(wanted) => {
                (rotation_vector(&(wanted * tcp.rotation.transpose())), ConstrainedRotation::All)
            }
        };
        TwistError { position, rotation, seen }
    }

    /// Returns a measure of the distance from the pose `tcp` to the goal, which ranks start postures cheaply.
    ///
    /// Lengths are multiplied by `scale` (1/m).
    #[inline]
    pub(super) fn far(&self, tcp: &Pose, tool_axis: &Vector3<f64>, scale: f64) -> f64 {
        let position = (self.position - tcp.translation).norm_squared() * scale * scale;
        // For a small angle, 2 (1 - cos) is about the square of the angle.
        let attitude = match self.attitude {
            AttitudeGoal::Any => 0.0,
            AttitudeGoal::Elevation(angle) => {
                let off = (tcp.rotation * tool_axis).z - angle.sin();
                off * off
            }
            AttitudeGoal::Axis(wanted) => 2.0 - 2.0 * (tcp.rotation * tool_axis).dot(&wanted),
            AttitudeGoal::Rotation(wanted) => 3.0 - wanted.dot(&tcp.rotation),
        };
        position + attitude
    }
}

/// Rotations of the TCP (base frame) that a goal constrains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ConstrainedRotation {
    /// The goal constrains no rotation.
    Nothing,
    /// The goal constrains only rotations about this unit vector.
    Along(Vector3<f64>),
    /// The goal constrains the rotations that change the direction of this unit vector.
    Across(Vector3<f64>),
    /// The goal constrains all rotations.
    All,
}

impl ConstrainedRotation {
    /// Returns the part of a rotation vector that the goal constrains.
    #[inline]
    pub fn of(&self, turn: &Vector3<f64>) -> Vector3<f64> {
        match self {
            ConstrainedRotation::Nothing => Vector3::zeros(),
            ConstrainedRotation::Along(axis) => axis * axis.dot(turn),
            ConstrainedRotation::Across(axis) => turn - axis * axis.dot(turn),
            ConstrainedRotation::All => *turn,
        }
    }
}

/// Twist from the TCP to the goal, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TwistError {
    /// Translation from the TCP to the position of the goal, m.
    pub position: Vector3<f64>,
    /// Rotation vector from the orientation of the TCP to the orientation of the goal, rad.
    pub rotation: Vector3<f64>,
    pub seen: ConstrainedRotation,
}

impl TwistError {
    /// Returns the cost `|e|^2 / 2` of this twist e, with lengths multiplied by `scale` (1/m).
    pub fn cost(&self, scale: f64) -> f64 {
        (self.position.norm_squared() * scale * scale + self.rotation.norm_squared()) / 2.0
    }

    /// Returns whether the goal is reached within the accuracy of the solver.
    pub fn is_reached(&self) -> bool {
        self.position.norm_squared() < REACHED * REACHED && self.rotation.norm_squared() < REACHED * REACHED
    }
}

fn finite(v: &Vector3<f64>) -> bool {
    v.iter().all(|x| x.is_finite())
}

/// Returns the rotation vector (rad) of the smallest rotation that turns the unit vector `from` into `to`.
pub fn least_turn(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let (cross, cosine) = (from.cross(to), from.dot(to));
    let sine = cross.norm();
    if sine > 1e-150 {
        return cross * (sine.atan2(cosine) / sine);
    }
    if cosine > 0.0 {
        return Vector3::zeros();
    }
    // For opposite vectors, any perpendicular axis is suitable.
    let other = if from.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    from.cross(&other).normalize() * std::f64::consts::PI
}

/// Returns the rotation vector (rad) of the rotation matrix `m`; the length of the vector is at most pi.
pub fn rotation_vector(m: &Matrix3<f64>) -> Vector3<f64> {
    let v = vector![m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12] / 2.0;
    let (sine, cosine) = (v.norm(), (m.trace() - 1.0) / 2.0);
    let angle = sine.atan2(cosine);
    if cosine > -0.99 {
        // v is the axis times the sine; angle and sine vanish together at 0.
        return if sine > 1e-150 { v * (angle / sine) } else { v };
    }
    // Near a half turn, v is inaccurate, but (M + M^T) / 2 - cos I = (1 - cos) a a^T is not.
    let square = (m + m.transpose()) / 2.0 - Matrix3::from_diagonal_element(cosine);
    let axis = square.column(square.diagonal().imax()).normalize();
    if axis.dot(&v) < 0.0 { axis * -angle } else { axis * angle }
}
