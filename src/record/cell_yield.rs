//! Yield of a whole cell in documents.

use super::estimate::EstimateEntry;
use super::placement::ByName;
use crate::assess::Assessment;
use crate::cell::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Share of sampled arms that stay within the limits of the operations at their spots (Monte Carlo, nonlinear
/// model).
///
/// If an operation must keep its limit at every node, the operation is judged at its worst node. An operation
/// without a limit counts as within its limit. The intervals are Wilson score intervals for 95 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CellYieldEntry {
    pub samples: usize,
    /// Share of arms that stay within the limits of all operations.
    pub together: EstimateEntry,
    /// Share of arms that stay within the limit of one operation, for each operation with a limit.
    pub operations: ByName<EstimateEntry>,
}

impl CellYieldEntry {
    /// Makes the entry. Returns None if the reading is not statistical, an operation has no spot, or no
    /// operation has a limit.
    pub fn new(a: &Assessment<'_>) -> Option<Self> {
        let together = EstimateEntry::new(a.cell_yield.as_ref()?, Unit::Share);
        let sampled = a.cell.operations.iter().zip(&a.samples);
        let alone = sampled.filter_map(|(operation, samples)| {
            let success = samples.as_ref()?.success.as_ref()?;
            Some((operation.name.clone(), EstimateEntry::new(success, Unit::Share)))
        });
        let samples = a.samples.iter().flatten().map(|samples| samples.samples).max()?;
        Some(Self { samples, together, operations: alone.collect() })
    }
}
