//! State of a sweep: combinations that are done, that run on a host, and that have failed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the schema of a [`SweepStatus`].
pub const SWEEP_STATUS_SCHEMA: &str = "sweetspot/sweep-status/1";

/// State of a sweep, which `sweep --status` prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepStatus {
    #[schemars(extend("const" = SWEEP_STATUS_SCHEMA))]
    pub schema: String,
    pub combinations: usize,
    pub done: usize,
    /// Number of combinations that no worker has begun.
    pub free: usize,
    pub running: Vec<RunningCombination>,
    pub failed: Vec<FailedCombination>,
    /// Estimated time until the last combination is done, if the running workers continue. Null if no worker
    /// is running, or if no worker has finished a combination.
    pub seconds_left: Option<f64>,
    /// Work that each host has done. Only workers of `sweep --claim` record this information.
    pub hosts: Vec<HostWork>,
    /// Whether the tables and the manifest of the sweep are written.
    pub complete: bool,
}

/// Combination that a worker processes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunningCombination {
    pub index: usize,
    pub host: String,
    pub process: u32,
    /// Time from the start of the combination to the last heartbeat of the worker.
    pub seconds: f64,
    /// Time since the last heartbeat, by the clock of the file server.
    pub seconds_since_heartbeat: f64,
}

/// Combination that its last worker did not finish. The next free worker takes over the combination, unless
/// the combination is given up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FailedCombination {
    pub index: usize,
    /// Host of the last worker; null if no worker of `sweep --claim` is known.
    pub host: Option<String>,
    pub process: Option<u32>,
    pub why: String,
    /// Whether the combination is given up, because too many workers have died while they processed it. No
    /// worker of `sweep --claim` takes over such a combination.
    pub given_up: bool,
}

/// Combinations that the workers of one host have finished.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HostWork {
    pub host: String,
    pub combinations: Vec<usize>,
    /// Sum of the times of all combinations of the host.
    pub seconds: f64,
}

impl SweepStatus {
    /// Returns the mean time of a finished combination; None if no worker of `sweep --claim` has finished a
    /// combination.
    pub fn mean_seconds(&self) -> Option<f64> {
        let finished: usize = self.hosts.iter().map(|host| host.combinations.len()).sum();
        let seconds: f64 = self.hosts.iter().map(|host| host.seconds).sum();
        (finished > 0).then(|| seconds / finished as f64)
    }

    /// Adds the estimated time until the last combination is done. The estimate uses the mean time of a
    /// finished combination and the number of running combinations.
    pub fn with_estimate(mut self) -> Self {
        let spent: f64 = self.running.iter().map(|running| running.seconds).sum();
        if let Some(mean) = self.mean_seconds().filter(|_| !self.running.is_empty()) {
            let left = mean * (self.combinations - self.done) as f64 - spent;
            self.seconds_left = Some(left.max(0.0) / self.running.len() as f64);
        }
        self
    }
}
