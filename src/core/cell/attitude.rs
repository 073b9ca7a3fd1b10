//! Attitude: orientation of the tool that an operation requires.
//!
//! The tool axis points at an elevation above the horizontal and, seen from above, along an azimuth. Let `h`
//! be the horizontal unit vector along the azimuth and `z` the upward unit vector. Then:
//!
//! ```text
//! d = cos(elevation) h + sin(elevation) z          the tool axis
//! w = -sin(elevation) h + cos(elevation) z         perpendicular to d in the plane of h and z
//! r = cos(spin) w + sin(spin) (d x w)              the reference axis of the tool
//! ```
//!
//! The reference axis is the first of the axes x, y and z of the TCP that is perpendicular to the tool axis.
//! If no axis is perpendicular, the reference axis is the component of x perpendicular to the tool axis. If
//! the tool points down with spin 0, the reference axis lies along the azimuth.

use crate::pose::exact_sin_cos;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Number of values that are tried for a free azimuth or spin: one every 30 degrees.
pub const FREE_STEPS: usize = 12;

/// Largest absolute cosine of an angle that counts as a right angle.
const RIGHT_ANGLE: f64 = 1e-12;

/// Azimuth of the tool axis: direction of this axis seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Azimuth {
    /// Any azimuth is allowed.
    Free,
    /// The tool axis lies in the vertical plane through the TCP and the robot's base axis. The tool axis
    /// points outward or inward; both directions are tried.
    Radial,
    /// Angle from the x axis of the surface to the horizontal direction of the tool axis, rad.
    Surface(f64),
}

/// Spin of the tool: its rotation about the tool axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Spin {
    /// Any spin is allowed. If the joints of the arm can set the spin, [`FREE_STEPS`] values are tried.
    Free,
    /// The spin must be one of these angles, rad.
    At(Vec<f64>),
}

/// Attitude of the tool at an operation: elevation, azimuth and spin, with a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Attitude {
    /// Elevation of the tool axis above the horizontal, rad; -pi/2 points down.
    ///
    /// The [seed paper](crate) calls this elevation the tool bending angle.
    pub elevation: f64,
    pub azimuth: Azimuth,
    pub spin: Spin,
    /// Largest allowed tilt of the tool axis from its nominal direction, rad.
    ///
    /// If the joints of the arm cannot set the azimuth or the spin, the tolerance also applies to that angle.
    pub tolerance: f64,
}

impl Attitude {
    /// Returns an attitude with this elevation (rad), free azimuth, free spin and tolerance 0.
    pub fn elevation(elevation: f64) -> Self {
        Self { elevation, azimuth: Azimuth::Free, spin: Spin::Free, tolerance: 0.0 }
    }

    /// Returns whether the tool axis is vertical. The azimuth then only defines the direction of spin 0.
    pub fn is_vertical(&self) -> bool {
        self.elevation.cos().abs() < RIGHT_ANGLE
    }

    /// Returns the spins that are tried if the spin is free, rad.
    pub fn free_spins() -> impl Iterator<Item = f64> + Clone {
        (0..FREE_STEPS).map(free_step)
    }

    /// Returns the azimuths to try, rad. They are measured from the x axis of the surface, or from the
    /// outward radial direction if the azimuth is [`Azimuth::Radial`].
    pub fn azimuths(&self) -> Vec<f64> {
        match self.azimuth {
            Azimuth::Free if self.is_vertical() => vec![0.0],
            Azimuth::Free => (0..FREE_STEPS).map(free_step).collect(),
            Azimuth::Radial if self.is_vertical() => vec![0.0],
            Azimuth::Radial => vec![0.0, std::f64::consts::PI],
            Azimuth::Surface(angle) => vec![angle],
        }
    }
}

fn free_step(k: usize) -> f64 {
    std::f64::consts::TAU * k as f64 / FREE_STEPS as f64
}

/// Returns the rotation matrix of a tool with these angles, rad. The azimuth is measured from the x axis of
/// the frame in which the matrix is expressed.
///
/// The columns are r, d x r and d: r is the reference axis, and d is the tool axis.
pub fn held(elevation: f64, azimuth: f64, spin: f64) -> Matrix3<f64> {
    let (sin, cos) = exact_sin_cos(spin);
    ToolDirection::new(elevation, azimuth).spun(cos, sin)
}

/// Direction of a tool axis, from which the rotation matrices of all spins follow.
#[derive(Debug, Clone, Copy)]
pub struct ToolDirection {
    /// Tool axis d.
    d: Vector3<f64>,
    /// Reference axis r at the spin 0.
    w: Vector3<f64>,
    /// Reference axis r at a spin of a right angle.
    u: Vector3<f64>,
}

impl ToolDirection {
    /// Returns the direction of a tool axis with these angles, rad.
    pub fn new(elevation: f64, azimuth: f64) -> Self {
        let (sin, cos) = exact_sin_cos(elevation);
        let (h_y, h_x) = exact_sin_cos(azimuth);
        let d = Vector3::new(cos * h_x, cos * h_y, sin);
        let w = Vector3::new(-sin * h_x, -sin * h_y, cos);
        Self { d, w, u: d.cross(&w) }
    }

    /// Returns the rotation matrix of [`held`] for a spin with this cosine and sine.
    pub fn spun(&self, cos: f64, sin: f64) -> Matrix3<f64> {
        let r = self.w * cos + self.u * sin;
        Matrix3::from_columns(&[r, self.d.cross(&r), self.d])
    }
}

/// Returns the axes r, d x r and d of [`held`] as columns in the frame of the TCP.
///
/// Here r is the reference axis of the tool, and d is the tool axis `axis` (unit length).
pub fn tool_columns(axis: &Vector3<f64>) -> Matrix3<f64> {
    let unit = [Vector3::x(), Vector3::y(), Vector3::z()];
    let square = unit.into_iter().find(|e| e.dot(axis).abs() < RIGHT_ANGLE);
    // If no axis is perpendicular to the tool axis, the perpendicular part of x is used.
    let r = square.unwrap_or_else(|| Vector3::x() - axis * axis.x).normalize();
    Matrix3::from_columns(&[r, axis.cross(&r), *axis])
}
