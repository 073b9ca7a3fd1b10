//! Guess of the tolerances of a robot from the pose accuracy and the repeatability on its data sheet.

use super::arm_series::{PoseAccuracy, PoseAccuracyTest};
use super::repeatability::joint_scatter;
use crate::cell::{Distribution, JointVector, PER_LINK, Robot, Spread};
use crate::robot::Chain;

/// Largest number of steps of the search for the scale.
const STEPS: usize = 30;

/// Relative difference between the predicted and the wanted accuracy at which the search ends.
const CLOSE: f64 = 1e-9;

/// Reason why no tolerances can be derived from a data sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GuessFault {
    /// The tolerances do not move the TCP at the test poses.
    NoEffect,
    /// No scale gives the wanted accuracy. The nearest accuracy that was found is `nearest`, m.
    NotFound { nearest: f64 },
}

/// Tolerances with which the predicted pose accuracy equals the pose accuracy on a data sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorGuess {
    /// Tolerances of the parameters in the order of [`crate::cell::Parameter::of_robot`]: the scaled
    /// tolerances, with the random errors of the joints added.
    pub spreads: Vec<Spread>,
    /// Factor by which the given tolerances are multiplied.
    pub scale: f64,
    /// Number of iterations of the search for [`Self::scale`]. Each iteration predicts the pose accuracy
    /// once.
    pub steps: usize,
    /// Predicted pose accuracy with the scaled tolerances. This accuracy does not depend on the random errors
    /// of the joints.
    pub accuracy: PoseAccuracy,
    /// Standard deviations of the joint coordinates of one robot, rad or m; None if no repeatability was
    /// given.
    pub scatter: Option<JointVector>,
}

/// Returns the tolerances in `spreads`, scaled until the predicted accuracy is `ap` (m). Without `ap`, the
/// tolerances are not scaled.
///
/// If `rp` is given, the joints have random errors that cause this repeatability (m). These errors are added
/// to the tolerances of the joint coordinates by root sum square. A tolerance to which a random error is
/// added gets the normal distribution.
///
/// # Errors
/// Returns the reason if no scale gives this accuracy, or if the tolerances do not move the TCP.
pub fn guessed(
    robot: &Robot,
    chain: &Chain,
    test: &PoseAccuracyTest<'_>,
    spreads: &[Spread],
    (ap, rp): (Option<f64>, Option<f64>),
) -> Result<ErrorGuess, GuessFault> {
    let scaled = |by: f64| {
        let spread = |s: &Spread| Spread { plus_minus: s.plus_minus * by, ..*s };
        spreads.iter().map(spread).collect::<Vec<_>>()
    };
    let mut scale = 1.0;
    let mut nearest = f64::INFINITY;
    for step in 1..=STEPS {
        let spreads = scaled(scale);
        let accuracy = test.accuracy(&spreads);
        if accuracy.median < 1e-15 || !accuracy.median.is_finite() {
            return Err(GuessFault::NoEffect);
        }
        let wanted = ap.unwrap_or(accuracy.median);
        if (accuracy.median / wanted - 1.0).abs() < CLOSE {
            let scatter = rp.and_then(|rp| joint_scatter(robot, chain, test, rp));
            let spreads = scatter.map_or_else(|| spreads.clone(), |s| with_scatter(spreads.clone(), &s));
            return Ok(ErrorGuess { spreads, scale, steps: step, accuracy, scatter });
        }
        if (accuracy.median - wanted).abs() < (nearest - wanted).abs() {
            nearest = accuracy.median;
        }
        // The accuracy is nearly in proportion to the scale, so this step converges fast.
        scale *= wanted / accuracy.median;
    }
    Err(GuessFault::NotFound { nearest })
}

/// Adds random errors of the joint coordinates to their tolerances by root sum square.
fn with_scatter(mut spreads: Vec<Spread>, scatter: &[f64]) -> Vec<Spread> {
    let links = spreads.chunks_exact_mut(PER_LINK).zip(scatter);
    for (link, random) in links.filter(|(_, random)| **random > 0.0) {
        let Some(dq) = link.first_mut() else { continue };
        let deviation = dq.deviation().hypot(*random);
        *dq = Spread { plus_minus: deviation * dq.sigmas, distribution: Distribution::Normal, ..*dq };
    }
    spreads
}
