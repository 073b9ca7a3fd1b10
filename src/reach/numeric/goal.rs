//! What is wanted of the TCP, and how far a pose is from it.

use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3, vector};

/// An answer is off by less than this, m and rad: half of what is promised.
const REACHED: f64 = 5e-10;

/// An elevation that leaves the vertical by less than this has no azimuth left, rad.
const VERTICAL: f64 = 1e-9;

/// How far the given rotation may be from an orthogonal matrix with determinant 1.
const ORTHOGONAL: f64 = 1e-6;

/// What is wanted of the TCP, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// m.
    pub position: Vector3<f64>,
    pub attitude: Held,
}

/// How the tool is to be held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Held {
    /// Nothing is asked.
    Any,
    /// The tool axis at this elevation (rad) above the horizontal xy plane of the base.
    Elevation(f64),
    /// The tool axis along a unit vector; the turn about it is free.
    Axis(Vector3<f64>),
    /// The whole rotation of the TCP.
    Rotation(Matrix3<f64>),
}

impl Goal {
    /// The goal in a form that can be solved: a vertical elevation is an axis. None if it is not
    /// finite or holds no direction or rotation.
    pub(super) fn checked(&self) -> Option<Self> {
        let attitude = match self.attitude {
            Held::Any => Held::Any,
            Held::Elevation(angle) if !angle.is_finite() => return None,
            Held::Elevation(angle) if angle.cos().abs() < VERTICAL => {
                Held::Axis(Vector3::z() * angle.sin().signum())
            }
            // Beyond the vertical an axis goes down again on the other side.
            Held::Elevation(angle) => Held::Elevation(angle.sin().atan2(angle.cos().abs())),
            Held::Axis(axis) => Held::Axis(axis.try_normalize(ORTHOGONAL).filter(finite)?),
            Held::Rotation(r) => {
                let off = (r * r.transpose() - Matrix3::identity()).amax();
                return (off < ORTHOGONAL && r.determinant() > 0.0 && finite(&self.position))
                    .then_some(*self);
            }
        };
        finite(&self.position).then_some(Self { attitude, ..*self })
    }

    /// Rows of the task: what is asked of position and attitude together.
    pub(super) fn rows(&self) -> usize {
        match self.attitude {
            Held::Any => 3,
            Held::Elevation(_) => 4,
            Held::Axis(_) => 5,
            Held::Rotation(_) => 6,
        }
    }

    /// How far the TCP is from the goal.
    #[inline]
    pub(super) fn miss(&self, tcp: &Pose, tool_axis: &Vector3<f64>) -> Miss {
        let position = self.position - tcp.translation;
        let (rotation, seen) = match self.attitude {
            Held::Any => (Vector3::zeros(), Seen::Nothing),
            Held::Elevation(angle) => {
                let axis = tcp.rotation * tool_axis;
                let across = axis.x.hypot(axis.y);
                // The tool rises by a turn about the horizontal axis x z; upright, about any.
                let about = if across > 0.0 { vector![axis.y, -axis.x, 0.0] / across } else { Vector3::x() };
                (about * (angle - axis.z.atan2(across)), Seen::Along(about))
            }
            Held::Axis(wanted) => {
                let axis = tcp.rotation * tool_axis;
                (least_turn(&axis, &wanted), Seen::Across(axis))
            }
            Held::Rotation(wanted) => (rotation_vector(&(wanted * tcp.rotation.transpose())), Seen::All),
        };
        Miss { position, rotation, seen }
    }

    /// A quick measure of the distance, for ranking: lengths by `scale` (1/m).
    #[inline]
    pub(super) fn far(&self, tcp: &Pose, tool_axis: &Vector3<f64>, scale: f64) -> f64 {
        let position = (self.position - tcp.translation).norm_squared() * scale * scale;
        // 2 (1 - cos) of the angle, which is its square if it is small.
        let attitude = match self.attitude {
            Held::Any => 0.0,
            Held::Elevation(angle) => {
                let off = (tcp.rotation * tool_axis).z - angle.sin();
                off * off
            }
            Held::Axis(wanted) => 2.0 - 2.0 * (tcp.rotation * tool_axis).dot(&wanted),
            Held::Rotation(wanted) => 3.0 - wanted.dot(&tcp.rotation),
        };
        position + attitude
    }
}

/// Which turns of the TCP (base frame) the goal sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seen {
    Nothing,
    /// Those about this unit vector.
    Along(Vector3<f64>),
    /// Those that move this unit vector.
    Across(Vector3<f64>),
    All,
}

impl Seen {
    /// The part of a turn that is seen.
    #[inline]
    pub fn of(&self, turn: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Seen::Nothing => Vector3::zeros(),
            Seen::Along(axis) => axis * axis.dot(turn),
            Seen::Across(axis) => turn - axis * axis.dot(turn),
            Seen::All => *turn,
        }
    }
}

/// What is missing to the goal: the twist that leads there, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Miss {
    /// m.
    pub position: Vector3<f64>,
    /// Rotation vector, rad.
    pub rotation: Vector3<f64>,
    pub seen: Seen,
}

impl Miss {
    /// `|e|^2 / 2`, lengths by `scale` (1/m).
    pub fn cost(&self, scale: f64) -> f64 {
        (self.position.norm_squared() * scale * scale + self.rotation.norm_squared()) / 2.0
    }

    pub fn is_reached(&self) -> bool {
        self.position.norm_squared() < REACHED * REACHED && self.rotation.norm_squared() < REACHED * REACHED
    }
}

fn finite(v: &Vector3<f64>) -> bool {
    v.iter().all(|x| x.is_finite())
}

/// The shortest turn of one unit vector to another, a rotation vector (rad).
pub fn least_turn(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let (cross, cosine) = (from.cross(to), from.dot(to));
    let sine = cross.norm();
    if sine > 1e-150 {
        return cross * (sine.atan2(cosine) / sine);
    }
    if cosine > 0.0 {
        return Vector3::zeros();
    }
    // Opposite: any axis across does.
    let other = if from.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    from.cross(&other).normalize() * std::f64::consts::PI
}

/// The logarithm of a rotation matrix: the rotation vector of at most pi.
pub fn rotation_vector(m: &Matrix3<f64>) -> Vector3<f64> {
    let v = vector![m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12] / 2.0;
    let (sine, cosine) = (v.norm(), (m.trace() - 1.0) / 2.0);
    let angle = sine.atan2(cosine);
    if cosine > -0.99 {
        // The axis times the sine; both vanish together at 0.
        return if sine > 1e-150 { v * (angle / sine) } else { v };
    }
    // Near a half turn v has no digits left, but (M + M^T) / 2 - cos I = (1 - cos) a a^T has.
    let square = (m + m.transpose()) / 2.0 - Matrix3::from_diagonal_element(cosine);
    let axis = square.column(square.diagonal().imax()).normalize();
    if axis.dot(&v) < 0.0 { axis * -angle } else { axis * angle }
}
