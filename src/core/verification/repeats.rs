//! Pose accuracy and repeatability of measured repeats, as ISO 9283:1998 defines them for positions.

use super::clusters::clusters;
use super::compared_pose::ComparedPose;
use crate::cell::MAX_JOINTS;
use nalgebra::Vector3;

/// Number of cycles with which ISO 9283 measures pose accuracy and pose repeatability.
pub const CYCLES_OF_STANDARD: usize = 30;

/// Two postures are the same command if their joint coordinates differ by at most this value, rad or m.
const SAME_COMMAND: f64 = 1e-6;

/// Accuracy and repeatability of one posture that was visited several times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RepeatedPosture {
    /// Row of the first visit in the measurement file, counted from 1.
    pub row: usize,
    pub visits: usize,
    /// Nominal position of the reflector, m, base frame.
    pub position: Vector3<f64>,
    /// Pose accuracy `AP_p`: distance of the barycentre from the command position, m.
    pub accuracy: f64,
    /// Pose repeatability `RP_l`: mean distance from the barycentre plus three standard deviations, m.
    pub repeatability: f64,
}

/// Postures of one session that were visited at least twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeatability {
    pub postures: Vec<RepeatedPosture>,
}

impl Repeatability {
    /// Finds the repeated postures; None if no posture was visited twice.
    pub fn of(poses: &[ComparedPose]) -> Option<Self> {
        let reflectors = poses.iter().map(|pose| pose.reflector + 1).max().unwrap_or(0);
        let mut postures = Vec::new();
        for reflector in 0..reflectors {
            let own: Vec<_> = poses.iter().filter(|pose| pose.reflector == reflector).collect();
            let commands: Vec<[f64; MAX_JOINTS]> = own.iter().map(|pose| pose.joints).collect();
            for visits in clusters(&commands, SAME_COMMAND) {
                let errors: Vec<_> = visits.iter().map(|&i| own[i].measured).collect();
                let Some((accuracy, repeatability)) = repeatability_of(&errors) else { continue };
                let ComparedPose { row, nominal: position, .. } = *own[visits[0]];
                let visits = visits.len();
                postures.push(RepeatedPosture { row, visits, position, accuracy, repeatability });
            }
        }
        postures.sort_by_key(|posture| posture.row);
        (!postures.is_empty()).then_some(Self { postures })
    }

    /// Returns the largest pose accuracy `AP_p`, m.
    pub fn largest_accuracy(&self) -> f64 {
        self.postures.iter().map(|posture| posture.accuracy).fold(0.0, f64::max)
    }

    /// Returns the largest pose repeatability `RP_l`, m.
    pub fn largest_repeatability(&self) -> f64 {
        self.postures.iter().map(|posture| posture.repeatability).fold(0.0, f64::max)
    }

    /// Returns the number of visits of the repeated posture with the fewest visits.
    pub fn least_visits(&self) -> usize {
        self.postures.iter().map(|posture| posture.visits).min().unwrap_or(0)
    }
}

/// Returns `AP_p` and `RP_l`, m, given the errors relative to the command position; None for fewer than two
/// visits.
///
/// ```text
/// AP_p = |c|                    c   = mean of the errors x_j
/// RP_l = l + 3 S_l              l_j = |x_j - c|, l = mean of l_j, S_l^2 = sum (l_j - l)^2 / (n - 1)
/// ```
pub fn repeatability_of(errors: &[Vector3<f64>]) -> Option<(f64, f64)> {
    let count = errors.len() as f64;
    if errors.len() < 2 {
        return None;
    }
    let barycentre = errors.iter().sum::<Vector3<f64>>() / count;
    let distances: Vec<f64> = errors.iter().map(|x| (x - barycentre).norm()).collect();
    let mean = distances.iter().sum::<f64>() / count;
    let squares: f64 = distances.iter().map(|l| (l - mean).powi(2)).sum();
    Some((barycentre.norm(), mean + 3.0 * (squares / (count - 1.0)).sqrt()))
}
