//! Choices that a cell file names by a word: error model, reading, registration and search.

use super::goal::{Goal, Goals};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Error model: how parameter errors become the error of the TCP.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Nonlinear model, eqs. (4)-(6) of the seed paper.
    Nonlinear,
    /// Linear model, eqs. (7)-(8) of the seed paper.
    Linear,
    /// Second-order model: the linear model plus the quadratic terms (section 2.3 of the seed paper).
    SecondOrder,
}

impl Model {
    /// All error models.
    pub const ALL: [Model; 3] = [Model::Nonlinear, Model::Linear, Model::SecondOrder];

    /// Returns the name of this error model as it is written in files, for example `second-order`.
    pub const fn name(self) -> &'static str {
        match self {
            Model::Nonlinear => "nonlinear",
            Model::Linear => "linear",
            Model::SecondOrder => "second-order",
        }
    }
}

/// Reading: how a set of errors is interpreted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reading {
    /// One signed sample of the errors.
    Signed,
    /// Worst case: the largest error over all corners of the tolerance box.
    WorstCase,
    /// Statistics of random errors.
    Statistical,
}

impl Reading {
    /// All readings.
    pub const ALL: [Reading; 3] = [Reading::Signed, Reading::WorstCase, Reading::Statistical];

    /// Returns the name of this reading as it is written in files, for example `worst-case`.
    pub const fn name(self) -> &'static str {
        match self {
            Reading::Signed => "signed",
            Reading::WorstCase => "worst-case",
            Reading::Statistical => "statistical",
        }
    }
}

/// Quantity of a random error that the search minimizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    Rms,
    Mean,
    P95,
    P99,
    /// Share of failures, P(error > limit): 1 minus the yield.
    Yield,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Quantity; 5] =
        [Quantity::Rms, Quantity::Mean, Quantity::P95, Quantity::P99, Quantity::Yield];

    /// Returns the name of this quantity as it is written in files, for example `p95`.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Rms => "rms",
            Quantity::Mean => "mean",
            Quantity::P95 => "p95",
            Quantity::P99 => "p99",
            Quantity::Yield => "yield",
        }
    }
}

/// Registration: frame that is measured with the robot itself. The measurement removes a part of the robot's
/// errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Registration {
    /// No frame is measured: robot base and equipment are assumed to be exactly at their nominal placements.
    None,
    /// The base frame is measured by a least-squares fit to TCP positions. The fit covers all postures
    /// between the joint limits.
    BestFit,
    /// The frame of each work surface is taught by touching three points.
    Taught,
}

impl Registration {
    /// All registrations.
    pub const ALL: [Registration; 3] = [Registration::None, Registration::BestFit, Registration::Taught];

    /// Returns the name of this registration as it is written in files, for example `best-fit`.
    pub const fn name(self) -> &'static str {
        match self {
            Registration::None => "none",
            Registration::BestFit => "best-fit",
            Registration::Taught => "taught",
        }
    }
}

/// Rule that combines the values of an operation's nodes into one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NodeAggregation {
    /// Least value, for an operation that happens at the best node.
    Best,
    /// Greatest value, for an operation that happens at every node.
    Max,
    /// Mean value, for an operation that happens at every node.
    Mean,
    /// 95th percentile of the values, for an operation that happens at every node.
    ///
    /// The percentile is the least value that at least 95 % of the nodes do not exceed.
    P95,
}

impl NodeAggregation {
    /// All rules that combine the values of nodes.
    pub const ALL: [NodeAggregation; 4] =
        [NodeAggregation::Best, NodeAggregation::Max, NodeAggregation::Mean, NodeAggregation::P95];

    /// Returns the name of this rule as it is written in files, for example `max`.
    pub const fn name(self) -> &'static str {
        match self {
            NodeAggregation::Best => "best",
            NodeAggregation::Max => "max",
            NodeAggregation::Mean => "mean",
            NodeAggregation::P95 => "p95",
        }
    }

    /// Returns whether the operation happens at every node, so that all nodes must be usable.
    pub fn needs_every_node(self) -> bool {
        self != NodeAggregation::Best
    }

    /// Combines the values of all nodes into one value, and sorts `values` in place.
    pub fn of(self, values: &mut [f64]) -> f64 {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        match self {
            NodeAggregation::Best => values.first().copied().unwrap_or(0.0),
            NodeAggregation::Max => values.last().copied().unwrap_or(0.0),
            NodeAggregation::Mean => values.iter().sum::<f64>() / count.max(1) as f64,
            // The least value that at least 95 % of the nodes do not exceed.
            NodeAggregation::P95 => values.get((count * 19).div_ceil(20).max(1) - 1).copied().unwrap_or(0.0),
        }
    }
}

/// Rule that combines the values of several operations into one objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Objective {
    #[serde(rename = "sum")]
    WeightedSum,
    #[serde(rename = "max")]
    WeightedMaximum,
    /// The values are compared in the order of the operations in the file. A later operation decides only
    /// between layouts that are equally good for all earlier operations.
    Lexicographic,
    /// Cost of the cheapest tolerances with which every operation stays within its limit.
    ToleranceCost,
}

impl Objective {
    /// All objectives.
    pub const ALL: [Objective; 4] = [
        Objective::WeightedSum,
        Objective::WeightedMaximum,
        Objective::Lexicographic,
        Objective::ToleranceCost,
    ];

    /// Returns the name of this objective as it is written in files, for example `lexicographic`.
    pub const fn name(self) -> &'static str {
        match self {
            Objective::WeightedSum => "sum",
            Objective::WeightedMaximum => "max",
            Objective::Lexicographic => "lexicographic",
            Objective::ToleranceCost => "tolerance-cost",
        }
    }
}

/// Global solver of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    CmaEs,
    ParticleSwarm,
    SimulatedAnnealing,
}

impl Solver {
    /// All global solvers.
    pub const ALL: [Solver; 3] = [Solver::CmaEs, Solver::ParticleSwarm, Solver::SimulatedAnnealing];

    /// Returns the name of this solver as it is written in files, for example `cma-es`.
    pub const fn name(self) -> &'static str {
        match self {
            Solver::CmaEs => "cma-es",
            Solver::ParticleSwarm => "particle-swarm",
            Solver::SimulatedAnnealing => "simulated-annealing",
        }
    }
}

/// Settings of a search for the best layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    pub solver: Solver,
    pub objective: Objective,
    /// Relative difference up to which two objectives count as equally good.
    ///
    /// The lexicographic objective divides values into steps of this relative width. The last phase of a
    /// search selects a layout with much room. The objective of this layout exceeds the least objective by at
    /// most this share. Within the region of a piece of equipment, the objective grows by at most this share.
    pub indifference: f64,
    /// Resolution of the layout: the coordinates that a search finds are multiples of this resolution.
    pub resolution: Resolution,
    /// Largest number of layout evaluations.
    pub budget: u64,
    pub seed: u64,
    /// Whether placement tolerances are ignored: the layout need only work at its nominal placements.
    pub ideal: bool,
    /// Whether the search minimizes the worst value over the placement tolerances instead of the value at the
    /// nominal placements.
    pub robust: bool,
    /// Optimality gap at which the search ends, as a share of the proven lower bound. None means that no
    /// gap ends the search.
    pub gap: Option<f64>,
    /// Number of evaluations without improvement after which the global solver ends; None means that there is
    /// no such limit.
    pub stagnation: Option<u64>,
    /// Goals of a Pareto search; empty for a search for the least error.
    pub pareto: Goals,
    /// Number of distinct layouts to report. If this number is 0, a Pareto search reports the whole front,
    /// and any other search reports only the best layout.
    pub keep: usize,
}

/// Assumed value of a quantity that the cell file leaves out.
#[derive(Debug, Clone, PartialEq)]
pub struct Assumption {
    /// Key of the cell file that sets the value, for example `margins.joint_deg`.
    pub key: String,
    /// Assumed value in the notation of the file.
    pub value: String,
}

/// Resolution of the coordinates that a search finds.
///
/// The resolution is in mm and degrees, the units of the coordinates in files. These coordinates are
/// multiples of the resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    pub mm: f64,
    pub deg: f64,
}

impl Resolution {
    /// Resolution with which a fitter can place equipment.
    pub const BUILDABLE: Self = Self { mm: 1.0, deg: 0.1 };
    /// Resolution of a layout that need only work at its nominal placements ([`SearchSettings::ideal`]). A
    /// layout file states multiples of this resolution without rounding.
    pub const IDEAL: Self = Self { mm: 1e-3, deg: 1e-4 };
}

impl SearchSettings {
    /// Allowed budgets, in layout evaluations.
    pub const BUDGETS: std::ops::RangeInclusive<u64> = 1..=1_000_000_000;

    /// Search settings of a cell file that states no settings.
    pub const DEFAULT: Self = Self {
        solver: Solver::CmaEs,
        objective: Objective::WeightedSum,
        indifference: 0.01,
        resolution: Resolution::BUILDABLE,
        budget: 20_000,
        seed: 1,
        ideal: false,
        robust: false,
        gap: None,
        stagnation: None,
        pareto: Goals::NONE,
        keep: 0,
    };
}

impl SearchSettings {
    /// Returns whether the search takes the cost of tolerances into account. If so, the search computes the
    /// cheapest tolerances with which every operation stays within its limit. The search then accepts some
    /// layouts whose error at the present tolerances exceeds the limit.
    pub fn prices_tolerances(&self) -> bool {
        self.objective == Objective::ToleranceCost || self.pareto.iter().any(|goal| goal == Goal::Cost)
    }
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}
