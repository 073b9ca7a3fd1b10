//! The document of `allocate --json`.

use super::numbers::{in_unit, nine_digits, percent, rounded_down};
use super::parameter_names as names;
use super::parameter_unit::ParameterUnit;
use super::words::reading_word;
use crate::allocation::ToleranceShortfall;
use crate::assess::{AllocatedParameter, CellAllocation, CheapestTolerances};
use crate::cell::{Cell, CostLaw, Model, Reading, Registration, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `allocate --json`.
pub const ALLOCATION_SCHEMA: &str = "sweetspot/allocation/1";

/// Tolerance allocation: the cheapest tolerances with which every operation stays within its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllocationDocument {
    #[schemars(extend("const" = ALLOCATION_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub reading: Reading,
    /// Name of the error figure that the reading (interpretation of errors) gives, such as "worst case".
    pub quantity: String,
    pub registration: Registration,
    /// Required yield: share of arms with random parameter errors that must stay within each limit. Null
    /// unless the quantity is the yield.
    pub demanded_yield: Option<f64>,
    pub status: AllocationStatus,
    /// Cost of the tolerances in the error set.
    pub cost_before: f64,
    /// Cost of the final tolerances; null if infeasible. If the optimized tolerances give a figure above its
    /// limit, the program finally reduces all tolerances. This reduction increases `cost`.
    pub cost: Option<f64>,
    /// Proven lower bound of the cost; null if infeasible. The proof uses figures of the linear error model.
    /// A factor adapts each of these figures to the error model of the cell.
    pub lower_bound: Option<f64>,
    /// Duality gap: relative distance of the cost from its lower bound; null if infeasible.
    pub duality_gap: Option<f64>,
    /// Uniform tightening for comparison; null if no common scale meets the limits.
    pub uniform: Option<UniformEntry>,
    pub parameters: Vec<AllocatedEntry>,
    /// Names of the error parameters that the allocation does not change, because they are measured or
    /// correlated.
    pub fixed: Vec<String>,
    pub requirements: Vec<AllocationRequirement>,
    /// Limits that figures exceed even at the tightest tolerances.
    pub shortfalls: Vec<ShortfallEntry>,
    /// Judgement of the tolerances by the error model of the cell; null if infeasible.
    pub judgement: Option<JudgementEntry>,
}

/// Result of a tolerance allocation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AllocationStatus {
    /// The error model of the cell confirms that the final tolerances meet all limits. `duality_gap`
    /// compares their cost with its lower bound. If the optimized tolerances give a figure above its limit,
    /// the program afterwards reduces all tolerances. This reduction increases the gap.
    Cheapest,
    /// The final tolerances give a figure above its limit, according to the error model of the cell. A
    /// reduction of all tolerances after the optimization did not lower the figure to the limit.
    Exceeded,
    /// A figure exceeds its limit even at the tightest tolerances.
    Infeasible,
}

/// Uniform tightening: the loosest common scale of all tolerances with which every limit is met. Where this
/// scale lies outside the range of a tolerance, the nearest end of the range applies. A tolerance with grades
/// gets the loosest grade that is at least as tight as the scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UniformEntry {
    pub scale: f64,
    pub cost: f64,
    /// Saving of the cheapest tolerances compared with the uniform tightening, percent.
    pub saving_percent: f64,
}

/// Kind of function that gives the cost of a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CostKind {
    Reciprocal,
    Exponential,
    Grades,
}

/// End of the range of a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ToleranceEnd {
    Tightest,
    Loosest,
}

/// Tolerance of one parameter before and after the allocation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllocatedEntry {
    pub parameter: String,
    pub unit: ParameterUnit,
    pub cost_kind: CostKind,
    /// Half width of the tolerance in the error set.
    pub before: f64,
    /// Half width of the cheapest tolerance; null if infeasible.
    pub after: Option<f64>,
    /// `after` divided by `before`; null if infeasible.
    pub scale: Option<f64>,
    /// Least and greatest permitted scale.
    pub scale_range: [f64; 2],
    pub cost_before: f64,
    pub cost: Option<f64>,
    /// Name of the chosen grade; null for a continuous cost.
    pub grade: Option<String>,
    /// If the tolerance lies at an end of its permitted range, this end. Null if it lies between the ends.
    pub at_end: Option<ToleranceEnd>,
}

/// One operation at one node with its limit. Figures are in `unit`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllocationRequirement {
    pub operation: String,
    pub node: [usize; 2],
    pub unit: Unit,
    pub limit: f64,
    /// Figure that the tolerances in the error set give.
    pub before: f64,
    /// Figure with the cheapest tolerances, judged by the error model of the cell; null if infeasible.
    pub after: Option<f64>,
    /// Whether the figure is at its limit.
    pub is_binding: bool,
    /// Decrease of the cost for each unit by which the limit is raised; null if infeasible.
    pub shadow_price: Option<f64>,
    /// Figure that Monte Carlo samples of the nonlinear model give; null if the node was not sampled.
    pub sampled: Option<f64>,
}

/// Limit that a figure exceeds even at the tightest tolerances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShortfallEntry {
    pub operation: String,
    pub node: [usize; 2],
    pub unit: Unit,
    pub limit: f64,
    /// Least figure that the permitted tolerances give.
    pub least: f64,
    /// `least` minus `limit`.
    pub excess: f64,
    /// Tightest permitted tolerances: one for each parameter whose error makes `least` larger. The list is
    /// sorted by `without`, the least value first.
    pub in_the_way: Vec<BoundEntry>,
}

/// Tightest permitted tolerance of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundEntry {
    pub parameter: String,
    pub unit: ParameterUnit,
    pub tightest: f64,
    /// Figure that results if this parameter has no error and all others have their tightest tolerances. The
    /// unit is the unit of the limit.
    pub without: f64,
}

/// Judgement of the tolerances by the error model of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JudgementEntry {
    /// Largest excess of a figure over its limit after the first round, percent; negative if all figures are
    /// below their limits. A round uses the linear error model to find tolerances. The error model of the
    /// cell then judges these tolerances.
    pub missed_percent: f64,
    /// Index of the round that gave the solution; the first round has the index 0. Each round multiplies
    /// every figure of the linear error model by a factor. At the tolerances of the previous round, the
    /// product equals the figure of the error model of the cell.
    pub rounds: usize,
    /// Number of further allocations that were necessary because Monte Carlo samples exceeded a limit.
    pub sampled_rounds: usize,
    /// Largest excess of a figure over its limit at the final tolerances, percent; negative if all figures
    /// are below their limits.
    pub excess_percent: f64,
    /// Number of convex optimization problems (cone programs) in the round that gave the solution.
    pub programs: usize,
}

impl AllocationDocument {
    /// Makes the document of an allocation. `found` contains the tolerances, or the limits that figures
    /// exceed even at the tightest tolerances.
    pub fn new(
        problem: &CellAllocation<'_>,
        found: Result<&CheapestTolerances, &[ToleranceShortfall]>,
    ) -> Self {
        let cell = &problem.workcell.cell;
        let cost_before = problem.parameters.iter().map(|p| p.cost.cost(1.0)).sum();
        let (solved, shortfalls) = match found {
            Ok(cheapest) => (Some(cheapest), &[][..]),
            Err(shortfalls) => (None, shortfalls),
        };
        let allocation = solved.map(|s| &s.found.allocation);
        let status = match solved {
            None => AllocationStatus::Infeasible,
            Some(s) if s.found.excess > crate::allocation::JUDGED_EXCESS => AllocationStatus::Exceeded,
            Some(_) => AllocationStatus::Cheapest,
        };
        let uniform = solved.and_then(|s| {
            let (scale, cost) = s.found.uniform?;
            let saving_percent = percent(1.0 - s.found.allocation.cost / cost);
            Some(UniformEntry { scale: nine_digits(scale), cost: nine_digits(cost), saving_percent })
        });
        Self {
            schema: ALLOCATION_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: reading_word(cell).into(),
            registration: cell.registration,
            demanded_yield: problem.demanded_yield(),
            status,
            cost_before: nine_digits(cost_before),
            cost: allocation.map(|a| nine_digits(a.cost)),
            lower_bound: allocation.map(|a| rounded_down(a.lower_bound)),
            duality_gap: allocation.map(|a| rounded_up(a.gap())),
            uniform,
            parameters: (0..problem.parameters.len())
                .map(|k| AllocatedEntry::new(cell, &problem.parameters[k], allocation.map(|a| a.scales[k])))
                .collect(),
            fixed: problem.fixed.iter().map(|p| names::parameter(cell, *p)).collect(),
            requirements: (0..problem.requirements.len())
                .map(|k| AllocationRequirement::new(problem, k, solved))
                .collect(),
            shortfalls: shortfalls.iter().map(|s| ShortfallEntry::new(problem, s)).collect(),
            judgement: solved.map(|s| JudgementEntry {
                missed_percent: percent(s.found.missed),
                rounds: s.found.rounds,
                sampled_rounds: s.sampled_rounds,
                excess_percent: percent(s.found.excess),
                programs: s.found.allocation.programs,
            }),
        }
    }
}

impl AllocatedEntry {
    fn new(cell: &Cell, allocated: &AllocatedParameter, scale: Option<f64>) -> Self {
        let AllocatedParameter { parameter, plus_minus, cost } = allocated;
        let unit = ParameterUnit::new(cell, *parameter);
        let (low, high) = cost.range;
        let grade = scale.and_then(|u| cost.grades().get(cost.grade(u)?));
        Self {
            parameter: names::parameter(cell, *parameter),
            unit,
            cost_kind: match cost.law {
                CostLaw::Reciprocal { .. } => CostKind::Reciprocal,
                CostLaw::Exponential { .. } => CostKind::Exponential,
                CostLaw::Grades(_) => CostKind::Grades,
            },
            before: unit.shown(*plus_minus),
            after: scale.map(|u| unit.shown(u * plus_minus)),
            scale: scale.map(nine_digits),
            scale_range: [low, high].map(nine_digits),
            cost_before: nine_digits(cost.cost(1.0)),
            cost: scale.map(|u| nine_digits(cost.cost(u))),
            grade: grade.map(|g| g.name.clone()),
            at_end: scale.and_then(|u| end_of(u, (low, high))),
        }
    }
}

/// Rounds a gap up to a multiple of 1e-9, because the costs have 9 decimals.
fn rounded_up(gap: f64) -> f64 {
    nine_digits((gap * 1e9).ceil() / 1e9)
}

/// Returns the end of the range that lies within a relative distance of 1e-6 of the scale `u`. Returns None
/// if both ends are farther away.
fn end_of(u: f64, (low, high): (f64, f64)) -> Option<ToleranceEnd> {
    let near = |end: f64| (u - end).abs() <= 1e-6 * end;
    match (near(high), near(low)) {
        (true, _) => Some(ToleranceEnd::Loosest),
        (_, true) => Some(ToleranceEnd::Tightest),
        _ => None,
    }
}

impl AllocationRequirement {
    fn new(problem: &CellAllocation<'_>, k: usize, solved: Option<&CheapestTolerances>) -> Self {
        let requirement = &problem.requirements[k];
        let unit = problem.unit(requirement.operation);
        let sampled = solved.and_then(|s| s.sampled.iter().find(|check| check.requirement == k));
        Self {
            operation: problem.workcell.cell.operations[requirement.operation].name.clone(),
            node: [requirement.node.0, requirement.node.1],
            unit,
            limit: in_unit(unit, requirement.limit),
            before: in_unit(unit, requirement.before),
            after: solved.map(|s| in_unit(unit, s.found.judged[k])),
            is_binding: solved.is_some_and(|s| problem.is_binding(k, &s.found)),
            shadow_price: solved
                .map(|s| nine_digits(s.found.allocation.shadow_prices[k] / unit.from_si(1.0))),
            sampled: sampled.map(|check| in_unit(unit, check.figure.value)),
        }
    }
}

impl ShortfallEntry {
    fn new(problem: &CellAllocation<'_>, shortfall: &ToleranceShortfall) -> Self {
        let cell = &problem.workcell.cell;
        let requirement = &problem.requirements[shortfall.requirement];
        let unit = problem.unit(requirement.operation);
        let bounds = shortfall.bounds.iter().map(|bound| {
            let AllocatedParameter { parameter, plus_minus, cost } = &problem.parameters[bound.parameter];
            let own = ParameterUnit::new(cell, *parameter);
            BoundEntry {
                parameter: names::parameter(cell, *parameter),
                unit: own,
                tightest: own.shown(plus_minus * cost.range.0),
                without: in_unit(unit, bound.without),
            }
        });
        Self {
            operation: cell.operations[requirement.operation].name.clone(),
            node: [requirement.node.0, requirement.node.1],
            unit,
            limit: in_unit(unit, shortfall.limit),
            least: in_unit(unit, shortfall.least),
            excess: in_unit(unit, shortfall.least - shortfall.limit),
            in_the_way: bounds.collect(),
        }
    }
}
