//! Masses that the joints of a chain carry.

use crate::cell::MAX_JOINTS;
use nalgebra::Vector3;

/// Masses that move with each Denavit-Hartenberg frame. Entry k belongs to the frame after link k. Entry 0
/// belongs to the base, which no joint carries.
pub type Loads = [CarriedMass; MAX_JOINTS + 1];

/// Masses that move with one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarriedMass {
    /// Total mass, kg.
    pub mass: f64,
    /// Sum of all masses, each multiplied by the position of its centre in the frame, kg m.
    pub moment: Vector3<f64>,
}

impl CarriedMass {
    /// Adds a mass (kg) whose centre is at the position `centre` (m) in the frame.
    pub fn add(&mut self, mass: f64, centre: &Vector3<f64>) {
        self.mass += mass;
        self.moment += centre * mass;
    }
}
