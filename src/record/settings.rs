//! The resolved settings of a run. A result depends on these settings and on the input files.

use super::numbers::in_unit;
use crate::cell::{Cell, Goal, Model, Objective, Quantity, Reading, Registration, Solver, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of a run after flags, cell file and defaults were merged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResolvedSettings {
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub reading: Reading,
    /// Statistic that is minimized in the statistical reading.
    pub quantity: Quantity,
    pub registration: Registration,
    pub operations: Vec<ResolvedOperation>,
    pub objective: Objective,
    /// Relative difference up to which two objectives count as equally good. The lexicographic objective
    /// divides values into steps of this relative width. Values in the same step count as equally good.
    pub indifference: f64,
    pub solver: Solver,
    pub seed: u64,
    /// Largest number of layouts to evaluate.
    pub budget: u64,
    /// Whether every piece stands exactly at its placement, so that placement tolerances do not count.
    pub ideal: bool,
    /// Whether the worst case over the placement tolerances is minimized.
    pub robust: bool,
    /// Relative gap to the proven lower bound. The search ends when the best layout reaches this gap.
    pub gap: Option<f64>,
    /// Number of evaluations without a better layout after which a search ends.
    pub stagnation: Option<u64>,
    /// Goals of a Pareto search; empty for a search that minimizes only the objective.
    pub pareto: Vec<Goal>,
    /// Number of layouts to keep; 0 if the cell states none.
    pub keep: usize,
}

/// Sense and limit of an operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResolvedOperation {
    pub name: String,
    pub sense: String,
    pub unit: Unit,
    /// Largest allowed error of the operation, in `unit`.
    pub limit: Option<f64>,
}

impl ResolvedSettings {
    pub fn new(cell: &Cell) -> Self {
        let search = &cell.search;
        let operations = cell.operations.iter().map(|o| ResolvedOperation {
            name: o.name.clone(),
            sense: o.sense.name.clone(),
            unit: o.sense.unit,
            limit: o.limit.map(|limit| in_unit(o.sense.unit, limit)),
        });
        Self {
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: cell.quantity,
            registration: cell.registration,
            operations: operations.collect(),
            objective: search.objective,
            indifference: search.indifference,
            solver: search.solver,
            seed: search.seed,
            budget: search.budget,
            ideal: search.ideal,
            robust: search.robust,
            gap: search.gap,
            stagnation: search.stagnation,
            pareto: search.pareto.iter().collect(),
            keep: search.keep,
        }
    }
}
