//! What is known of one posture, figure by figure.

use crate::cell::{Quantity, Reading};
use crate::pose::Displacement;

/// Every figure of one sense at one posture, m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Of the sample: the signed one, or the corner that is worst in the operation's sense.
    pub error: f64,
    /// Worst case by the linear model (exact), and of the chosen model.
    pub worst_linear: f64,
    pub worst: f64,
    pub rms: f64,
    pub mean: f64,
    pub p95: f64,
    pub p99: f64,
}

impl Figures {
    /// What a reading asks for; of a yield, which belongs to a limit, the 95th percentile.
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

/// Everything known of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureErrors {
    /// What the search makes small: an error (m or rad), or a share of failures.
    pub value: f64,
    /// By the model of the cell, of the sample; base frame.
    pub error: Displacement,
    /// The same by each model.
    pub nonlinear: Displacement,
    pub linear: Displacement,
    pub second_order: Displacement,
    /// One per sense of [`super::ErrorEvaluator::reported`].
    pub figures: Vec<Figures>,
    /// P(|error| <= limit), of an operation with a limit.
    pub success: Option<f64>,
}
