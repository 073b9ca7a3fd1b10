//! The resolved settings of a run. A result depends on these settings and on the input files.

use super::numbers::{degrees, in_unit, millimetres, percent};
use super::placement::ByName;
use crate::cell::{
    Cell, Goal, Model, Objective, PlacementTolerance, Quantity, Reading, Registration, Role, Solver, Unit,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings that result when flags, cell file and defaults are merged.
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
    /// Largest deviation from the nonlinear model at which reports trust a simpler model, % of the error.
    pub guard_percent: f64,
    /// Whether collisions of the robot and overlaps of equipment are checked.
    pub collision: bool,
    pub clearance_mm: f64,
    pub margins: ResolvedMargins,
    pub base_tolerance: ResolvedTolerance,
    /// Placement tolerances by the name of the equipment.
    pub placement_tolerances: ByName<ResolvedTolerance>,
    pub operations: Vec<ResolvedOperation>,
    pub objective: Objective,
    /// Relative difference up to which two objectives count as equally good. The lexicographic objective
    /// divides values into steps of this relative width. Values in the same step count as equally good.
    pub indifference: f64,
    pub solver: Solver,
    pub seed: u64,
    /// Largest number of layouts to evaluate.
    pub budget: u64,
    /// Whether every piece is assumed to stand exactly at its placement, so that placement tolerances are
    /// ignored.
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

/// Margins of all postures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResolvedMargins {
    /// Least distance from the limits of revolute joints, degrees.
    pub joint_deg: f64,
    /// Least distance from the limits of prismatic joints, mm.
    pub joint_mm: f64,
    /// Least allowed value of the smallest singular value of the Jacobian, with lengths divided by the reach.
    pub singularity: f64,
}

/// Half widths of a placement tolerance, mm and degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResolvedTolerance {
    pub x_mm: f64,
    pub y_mm: f64,
    pub z_mm: f64,
    pub yaw_deg: f64,
}

impl ResolvedTolerance {
    fn new(tolerance: &PlacementTolerance) -> Self {
        let [x, y, z, yaw] = tolerance.0;
        let [x_mm, y_mm, z_mm] = [x, y, z].map(millimetres);
        Self { x_mm, y_mm, z_mm, yaw_deg: degrees(yaw) }
    }
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
        let placed = cell.equipment.iter().filter(|e| e.role == Role::Equipment);
        Self {
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: cell.quantity,
            registration: cell.registration,
            guard_percent: percent(cell.guard),
            collision: cell.collision,
            clearance_mm: millimetres(cell.clearance),
            margins: ResolvedMargins {
                joint_deg: degrees(cell.margins.turn),
                joint_mm: millimetres(cell.margins.slide),
                singularity: cell.margins.singularity,
            },
            base_tolerance: ResolvedTolerance::new(&cell.base_tolerance),
            placement_tolerances: placed
                .map(|e| (e.name.clone(), ResolvedTolerance::new(&e.tolerance)))
                .collect(),
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
