//! Progress of a search, as lines of JSON.

use crate::cell::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the schema of a [`ProgressLine`].
pub const PROGRESS_SCHEMA: &str = "sweetspot/progress/1";

/// Progress line that `search --progress json` prints on stderr once per second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProgressLine {
    #[schemars(extend("const" = PROGRESS_SCHEMA))]
    pub schema: String,
    /// Number of layouts evaluated so far.
    pub evaluations: u64,
    pub budget: u64,
    /// Objective of the best feasible layout so far, in `unit`; null if no layout is feasible yet.
    pub best: Option<f64>,
    /// Proven lower bound of the objective, in `unit`; null if no bound is known.
    pub bound: Option<f64>,
    pub unit: Unit,
    /// Relative difference between `best` and `bound`: `best / bound - 1`. Null unless both are known and the
    /// bound is positive.
    pub gap: Option<f64>,
    /// Share of the evaluated layouts that are feasible and within every limit.
    pub feasible_share: f64,
    /// Evaluation rate of this process.
    pub evaluations_per_second: f64,
    /// Time since the start of this process.
    pub seconds: f64,
    /// Estimated time until the budget is used up; null if the rate is not known yet.
    pub seconds_left: Option<f64>,
}
