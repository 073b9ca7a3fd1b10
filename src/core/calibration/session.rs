//! Measured positions of one set-up of instrument and reflector.

use crate::cell::JointVector;
use nalgebra::Vector3;
use rand::SeedableRng;
use rand::seq::index::sample;
use rand_chacha::ChaCha8Rng;

/// Measured position of the reflector at one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPosition {
    /// Row of the file, counted from 1.
    pub row: usize,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    /// Position of the reflector in the frame of the instrument, m.
    pub position: Vector3<f64>,
}

/// Measured positions that share one pose of the robot base and one reflector.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuringSession {
    pub name: String,
    pub measured: Vec<MeasuredPosition>,
}

/// Returns `count` positions drawn at random without repetition, in the order of the rows; all positions if
/// there are not more.
pub fn drawn(measured: &[MeasuredPosition], count: usize, seed: u64) -> Vec<MeasuredPosition> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut places = sample(&mut rng, measured.len(), count.min(measured.len())).into_vec();
    places.sort_unstable();
    places.into_iter().map(|i| measured[i]).collect()
}
