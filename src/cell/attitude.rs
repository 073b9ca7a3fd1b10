//! How an operation holds the tool.
//!
//! The tool axis points at an elevation above the horizontal and, seen from above, along an azimuth.
//! With `h` the horizontal unit vector of the azimuth,
//!
//! ```text
//! d = cos(elevation) h + sin(elevation) z          the tool axis
//! w = -sin(elevation) h + cos(elevation) z         upright: perpendicular to d in the same plane
//! r = cos(spin) w + sin(spin) (d x w)              the reference axis of the tool
//! ```
//!
//! so that a tool pointing down with spin 0 has its reference axis along the azimuth. The reference
//! axis is the first of the x, y, z axes of the TCP that is perpendicular to the tool axis.

use crate::pose::exact_sin_cos;
use nalgebra::{Matrix3, Vector3};

/// Values tried for a free angle: every 30 degrees.
pub const FREE_STEPS: usize = 12;

/// Cosines below this are those of a right angle.
const RIGHT_ANGLE: f64 = 1e-12;

/// Where the tool axis points, seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Azimuth {
    /// Anywhere.
    Free,
    /// In the vertical plane through the base axis of the robot: outward or, where the arm can, inward.
    Radial,
    /// At an angle from the x axis of the surface, rad.
    Surface(f64),
}

/// The turn about the tool axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Spin {
    /// Any: [`FREE_STEPS`] values are tried by an arm that can choose.
    Free,
    /// One of these, rad.
    At(Vec<f64>),
}

/// The attitude of the tool at an operation.
#[derive(Debug, Clone, PartialEq)]
pub struct Attitude {
    /// The paper's tool bending angle: of the tool axis above the horizontal, rad; -pi/2 points down.
    pub elevation: f64,
    pub azimuth: Azimuth,
    pub spin: Spin,
    /// The tool axis may be tilted by so much; heading and spin of an arm that cannot choose them may
    /// be off by so much, too, rad.
    pub tolerance: f64,
}

impl Attitude {
    /// An elevation alone (rad).
    pub fn elevation(elevation: f64) -> Self {
        Self { elevation, azimuth: Azimuth::Free, spin: Spin::Free, tolerance: 0.0 }
    }

    /// Whether the tool is vertical: the azimuth then says only where the spin counts from.
    pub fn is_vertical(&self) -> bool {
        self.elevation.cos().abs() < RIGHT_ANGLE
    }

    /// The spins to try where any will do, rad.
    pub fn free_spins() -> impl Iterator<Item = f64> {
        (0..FREE_STEPS).map(free_step)
    }

    /// The azimuths to try, rad, from the x axis of the surface or the radial direction.
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

/// Columns r, d x r, d of a tool held at these angles (rad), with the azimuth from x.
pub fn held(elevation: f64, azimuth: f64, spin: f64) -> Matrix3<f64> {
    let (sin, cos) = exact_sin_cos(elevation);
    let (h_y, h_x) = exact_sin_cos(azimuth);
    let d = Vector3::new(cos * h_x, cos * h_y, sin);
    let w = Vector3::new(-sin * h_x, -sin * h_y, cos);
    let (sin, cos) = exact_sin_cos(spin);
    let r = w * cos + d.cross(&w) * sin;
    Matrix3::from_columns(&[r, d.cross(&r), d])
}

/// Returns the columns of [`held`] in the frame of the TCP; `axis`: the tool axis there, unit length.
pub fn tool_columns(axis: &Vector3<f64>) -> Matrix3<f64> {
    let unit = [Vector3::x(), Vector3::y(), Vector3::z()];
    let square = unit.into_iter().find(|e| e.dot(axis).abs() < RIGHT_ANGLE);
    // A tool axis askew to all three: x, made perpendicular.
    let r = square.unwrap_or_else(|| Vector3::x() - axis * axis.x).normalize();
    Matrix3::from_columns(&[r, axis.cross(&r), *axis])
}
