//! Measured positions of one set-up of instrument and reflector.

use crate::cell::JointVector;
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand::seq::index::sample;
use rand_chacha::ChaCha8Rng;
use std::collections::HashSet;

/// Measured position of one reflector at one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPosition {
    /// Line of the file, counted from 1. One line can hold the positions of several reflectors at one
    /// posture.
    pub row: usize,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    /// Index of the reflector in the session, counted from 0.
    pub reflector: usize,
    /// Position of the reflector in the frame of the instrument, m.
    pub position: Vector3<f64>,
    /// Orientation of the tool in the frame of the instrument; None if it was not measured.
    pub rotation: Option<Matrix3<f64>>,
    /// Stated standard deviation of the position per axis, m.
    pub sigma: Option<f64>,
}

/// Measured positions that share one pose of the robot base and the same reflectors.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuringSession {
    pub name: String,
    pub measured: Vec<MeasuredPosition>,
}

/// Returns the number of reflectors of measured positions.
pub fn reflectors(measured: &[MeasuredPosition]) -> usize {
    measured.iter().map(|m| m.reflector + 1).max().unwrap_or(0)
}

/// Returns the measured positions of `count` different rows, which are drawn at random. The positions keep
/// the order of `measured`. Returns all positions if there are at most `count` rows.
pub fn drawn(measured: &[MeasuredPosition], count: usize, seed: u64) -> Vec<MeasuredPosition> {
    let mut rows: Vec<_> = measured.iter().map(|m| m.row).collect();
    rows.dedup();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let chosen: HashSet<_> =
        sample(&mut rng, rows.len(), count.min(rows.len())).into_iter().map(|i| rows[i]).collect();
    measured.iter().filter(|m| chosen.contains(&m.row)).copied().collect()
}
