//! Spherical shell that contains reachable points: a cheap and safe test before any inverse kinematics.

use nalgebra::Vector3;

/// Spherical shell that contains every reachable position of a point, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// Centre of both spheres. For the shell of an arm ([`super::Inverse::shell`]), the centre is in the base
    /// frame of the arm.
    pub centre: Vector3<f64>,
    pub inner: f64,
    pub outer: f64,
}

impl Shell {
    /// Returns a lower bound of the distance, m, between a set of points and the reachable points.
    ///
    /// The distance of every point of the set from the centre of the shell is between `near` and `far` (m).
    /// The bound is 0 if a point of the set may be reachable.
    pub fn gap(&self, near: f64, far: f64) -> f64 {
        (near - self.outer).max(self.inner - far).max(0.0)
    }
}
