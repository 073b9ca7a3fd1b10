//! The document of `budget --json`.

use super::map::MonteCarloEntry;
use super::numbers::{in_unit, joints, known_in_unit, nine_digits, percent, position_mm};
use super::parameter_names as names;
use super::parameter_unit::ParameterUnit;
use super::words::{VALUE_WORDS, reading_word};
use crate::assess::{BudgetReport, PostureContext, Tighter};
use crate::cell::{Cell, Model, Reading, Registration, Unit};
use crate::reading::{Figures, PostureErrors, Share};
use crate::units::rounded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `budget --json`.
pub const BUDGET_SCHEMA: &str = "sweetspot/budget/1";

/// Error budget: contribution of every parameter to the error at the spots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BudgetDocument {
    #[schemars(extend("const" = BUDGET_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub reading: Reading,
    /// Name of the error figure that the reading (interpretation of errors) gives, such as "worst case".
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    pub operations: Vec<OperationBudget>,
}

/// Error budget of one operation at one node. Positions are in the world frame, mm; angles are in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationBudget {
    pub name: String,
    pub equipment: String,
    pub sense: String,
    /// Largest allowed error of the operation, in the unit of its sense.
    pub limit: Option<f64>,
    pub node: Option<[usize; 2]>,
    pub position_mm: [f64; 3],
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints_deg: Vec<f64>,
    /// Whether the linear worst case is exact; otherwise it is an upper bound. Null in the signed reading if
    /// the errors of the sample compensate each other. The program assumes such compensation if the error of
    /// a Denavit-Hartenberg length (r or l) exceeds the reach of the arm.
    pub worst_linear_exact: Option<bool>,
    pub total: TotalEntry,
    /// Limit minus the error figure that the reading gives; negative if the error exceeds the limit. If a
    /// certificate is required, a known upper bound of this figure over all misplacements replaces the
    /// figure. Null if the operation has no limit, or if the quantity is the yield.
    pub margin: Option<f64>,
    /// Monte Carlo check of the posture; null unless the reading is statistical.
    pub monte_carlo: Option<MonteCarloEntry>,
    /// Shares of the parameters, the largest first.
    pub parameters: Vec<ShareEntry>,
    /// Gains from halving the tolerances of the parameters with the largest shares. The list is empty if
    /// `worst_linear_exact` is null.
    pub tighten: Vec<TightenEntry>,
    /// Worst case of the error by the linear model, in the unit of the sense; null if `worst_linear_exact` is
    /// null.
    pub linear_worst: Option<f64>,
    /// Root mean square deviation of the error from its mean, by the linear model, in the unit of the sense.
    /// Null if `worst_linear_exact` is null.
    pub linear_rms: Option<f64>,
}

/// Error figures of a posture, for the component of the error that matters for the operation (its sense).
/// Worst case and statistics are null in the signed reading if the errors of the sample compensate each
/// other. The program assumes such compensation if the error of a Denavit-Hartenberg length (r or l) exceeds
/// the reach of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TotalEntry {
    pub unit: Unit,
    pub error: f64,
    pub worst_linear: Option<f64>,
    pub worst: Option<f64>,
    pub rms: Option<f64>,
    pub mean: Option<f64>,
    pub p95: Option<f64>,
    pub p99: Option<f64>,
    /// Yield: share of arms whose error does not exceed the limit. The parameter errors of the arms are
    /// random and follow the tolerances.
    pub r#yield: Option<f64>,
}

/// Share of one parameter in the error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShareEntry {
    pub parameter: String,
    pub unit: ParameterUnit,
    pub signed: f64,
    pub plus_minus: f64,
    /// Linear position error of the TCP that the parameter causes, in the world frame. In the signed reading,
    /// the parameter has its signed value. In any other reading, the parameter deviates from its mean by the
    /// half width of its tolerance.
    pub linear_term_mm: [f64; 3],
    /// Linear error that the operation's sense measures if this parameter is at its tolerance and all other
    /// parameters are 0.
    pub alone: f64,
    /// Share of the parameter in the linear worst case, from 0 to 1; null if `worst_linear_exact` of the
    /// operation is null.
    pub share_of_worst: Option<f64>,
    /// Share of the parameter in the linear variance, from 0 to 1; null if `worst_linear_exact` of the
    /// operation is null.
    pub share_of_variance: Option<f64>,
}

/// Gain from halving the tolerances of the parameters in `halved`.
///
/// In the statistical reading, the fields `of` and `to` hold the first-order quantity before and after the
/// halving. In any other reading, they hold the worst case before and after the halving.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TightenEntry {
    pub halved: Vec<String>,
    pub of: f64,
    pub to: f64,
    pub unit: Unit,
    pub cut_percent: f64,
}

impl BudgetDocument {
    pub fn new(cell: &Cell, accounts: &[BudgetReport<'_>]) -> Self {
        Self {
            schema: BUDGET_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: reading_word(cell).into(),
            registration: cell.registration,
            operations: accounts.iter().map(OperationBudget::new).collect(),
        }
    }
}

impl OperationBudget {
    fn new(a: &BudgetReport<'_>) -> Self {
        let context = &a.context;
        let operation = &context.cell.operations[context.operation];
        let unit = context.evaluator.sense.unit;
        Self {
            name: operation.name.clone(),
            equipment: context.cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            limit: operation.limit.map(|l| in_unit(operation.sense.unit, l)),
            node: context.node.map(|(i, j)| [i, j]),
            position_mm: position_mm(&context.position),
            joints_deg: joints(context.cell, &context.joints),
            worst_linear_exact: a.worst.map(|worst| worst.exact),
            total: TotalEntry::new(context, &a.judged),
            margin: context.requirement(a.judged.value).map(|r| in_unit(unit, r.margin)),
            monte_carlo: a.check.as_ref().map(|c| MonteCarloEntry::of(&c.samples, unit, Some(c.confirmed))),
            parameters: a.budget.shares.iter().map(|s| ShareEntry::new(a, s)).collect(),
            tighten: a.tighter.iter().map(|t| TightenEntry::new(a, t)).collect(),
            linear_worst: known_in_unit(unit, a.budget.worst),
            linear_rms: known_in_unit(unit, a.budget.deviation),
        }
    }
}

impl TotalEntry {
    pub fn new(context: &PostureContext<'_>, judged: &PostureErrors) -> Self {
        let unit = context.evaluator.sense.unit;
        let Figures { error, worst_linear, worst, rms, mean, p95, p99 } =
            judged.figures[context.evaluator.own()];
        let [worst_linear, worst, rms, mean, p95, p99] =
            [worst_linear, worst, rms, mean, p95, p99].map(|v| known_in_unit(unit, v));
        let error = in_unit(unit, error);
        let r#yield = judged.success.map(nine_digits);
        Self { unit, error, worst_linear, worst, rms, mean, p95, p99, r#yield }
    }
}

impl ShareEntry {
    fn new(a: &BudgetReport<'_>, s: &Share) -> Self {
        let context = &a.context;
        let share = |of: f64| a.worst.map(|_| rounded(of, 12));
        let unit = ParameterUnit::new(context.cell, s.parameter);
        Self {
            parameter: names::parameter(context.cell, s.parameter),
            unit,
            signed: unit.shown(s.signed),
            plus_minus: unit.shown(s.plus_minus),
            linear_term_mm: position_mm(&s.term),
            alone: in_unit(context.evaluator.sense.unit, s.alone),
            share_of_worst: share(s.of_worst),
            share_of_variance: share(s.of_variance),
        }
    }
}

impl TightenEntry {
    fn new(a: &BudgetReport<'_>, t: &Tighter) -> Self {
        let cell = a.context.cell;
        Self {
            halved: t.parameters.iter().map(|p| names::parameter(cell, *p)).collect(),
            of: in_unit(a.unit(), a.figure),
            to: in_unit(a.unit(), t.figure),
            unit: a.unit(),
            cut_percent: percent(a.cut(t)),
        }
    }
}
