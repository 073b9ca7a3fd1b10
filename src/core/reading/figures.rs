//! Error figures of one posture.

use crate::cell::{Quantity, Reading};
use crate::pose::Displacement;

/// Error figures in one [sense](crate::cell::Sense) at one posture, m or rad.
///
/// If the errors are not tolerances, all figures except `error` are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// In the signed reading, the error of the signed sample. In the other readings, the error at the corner
    /// of the tolerance box that is worst in the operation's sense.
    pub error: f64,
    /// Worst case by the linear model, or an upper bound of it ([`super::WorstCase::linear`]).
    pub worst_linear: f64,
    /// Worst case by the chosen model.
    pub worst: f64,
    pub rms: f64,
    pub mean: f64,
    pub p95: f64,
    pub p99: f64,
}

impl Figures {
    /// Returns the figures of a signed sample whose errors compensate each other. All figures except the
    /// error are infinite, because such a sample has neither a worst case nor statistics.
    pub fn of_sample(error: f64) -> Self {
        let [worst_linear, worst, rms, mean, p95, p99] = [f64::INFINITY; 6];
        Self { error, worst_linear, worst, rms, mean, p95, p99 }
    }

    /// Returns the figure `quantity` of the statistical reading (m or rad); for a yield, the share of
    /// failures.
    pub fn statistic(&self, quantity: Quantity, success: Option<f64>) -> f64 {
        match quantity {
            Quantity::Yield => 1.0 - success.unwrap_or(1.0),
            quantity => self.in_reading(Reading::Statistical, quantity),
        }
    }

    /// Returns the figure of a reading, m or rad. A yield is not an error in m or rad, so the 95th percentile
    /// replaces it.
    pub fn in_reading(&self, reading: Reading, quantity: Quantity) -> f64 {
        match (reading, quantity) {
            (Reading::Signed, _) => self.error,
            (Reading::WorstCase, _) => self.worst,
            (Reading::Statistical, Quantity::Rms) => self.rms,
            (Reading::Statistical, Quantity::Mean) => self.mean,
            (Reading::Statistical, Quantity::P99) => self.p99,
            (Reading::Statistical, Quantity::P95 | Quantity::Yield) => self.p95,
        }
    }
}

/// All error figures of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureErrors {
    /// Figure that the search minimizes: an error (m or rad), or a share of failures.
    pub value: f64,
    /// Error by the model of the cell, base frame. In the signed reading, this is the error of the signed
    /// sample. In the other readings, this is the error at the worst corner of the tolerance box.
    pub error: Displacement,
    /// Error by the nonlinear model, base frame, for the sample or corner that `error` refers to.
    pub nonlinear: Displacement,
    /// Error by the linear model, base frame, for the sample or corner that `error` refers to.
    pub linear: Displacement,
    /// Error by the second-order model, base frame, for the sample or corner that `error` refers to.
    pub second_order: Displacement,
    /// Figures of each sense in [`super::ErrorEvaluator::reported`].
    pub figures: Vec<Figures>,
    /// Probability that the size of the error does not exceed the limit. None without a limit, or if the
    /// errors are not tolerances ([`super::ErrorEvaluator::has_tolerances`]).
    pub success: Option<f64>,
}
