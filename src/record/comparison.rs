//! The document of `compare --json`.

use super::cycle_time::CycleTimeEntry;
use super::numbers::nine_digits;
use super::placement::{AttitudeEntry, ByName, PlacementEntry, attitudes, placements};
use super::spot::SpotEntry;
use crate::assess::{Assessment, Comparison};
use crate::cell::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `compare --json`.
pub const COMPARISON_SCHEMA: &str = "sweetspot/compare/1";

/// Comparison of layouts; the first layout is the reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparisonDocument {
    #[schemars(extend("const" = COMPARISON_SCHEMA))]
    pub schema: String,
    pub layouts: Vec<ComparedLayout>,
}

/// One layout of a comparison. Positions are in the world frame, mm; angles are in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparedLayout {
    pub name: String,
    pub feasible: bool,
    /// Objective if it is a length; null otherwise.
    pub objective_mm: Option<f64>,
    /// Objective of the layout, in `unit`; null if the layout is not feasible.
    pub objective: Option<f64>,
    pub unit: Unit,
    /// Change of the objective relative to the first layout, percent.
    pub change_percent: Option<f64>,
    /// Cycle time; left out if the layout is not feasible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time: Option<CycleTimeEntry>,
    /// Reasons why the layout is not feasible.
    pub reasons: Vec<String>,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub attitudes: ByName<AttitudeEntry>,
    pub operations: Vec<SpotEntry>,
}

impl ComparisonDocument {
    pub fn new(comparison: &Comparison<'_>) -> Self {
        let layouts = comparison.columns.iter().enumerate().map(|(k, a)| ComparedLayout {
            name: a.label.clone(),
            feasible: a.evaluation.objective.is_some(),
            objective_mm: a.objective_mm().map(nine_digits),
            objective: a.objective().map(nine_digits),
            unit: a.cell.unit(),
            change_percent: comparison.change_percent(k, Assessment::objective).map(nine_digits),
            cycle_time: CycleTimeEntry::new(a),
            reasons: a.reasons(),
            layout: placements(a.cell, &a.layout),
            base: PlacementEntry::new(&a.layout.base),
            attitudes: attitudes(a.cell, &a.layout),
            operations: SpotEntry::all(a),
        });
        Self { schema: COMPARISON_SCHEMA.into(), layouts: layouts.collect() }
    }
}
