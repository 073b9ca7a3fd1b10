//! Figures with their confidence intervals in documents.

use super::numbers::in_unit;
use crate::cell::Unit;
use crate::reading::Estimate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Estimated figure with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EstimateEntry {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl EstimateEntry {
    pub fn new(e: &Estimate, unit: Unit) -> Self {
        let [value, low, high] = [e.value, e.low, e.high].map(|v| in_unit(unit, v));
        Self { value, low, high }
    }
}
