//! What a cell asks for by a word: error model, reading, registration, search.

use super::goal::Goals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the errors of the parameters make that of the TCP.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Eqs. (4)-(6).
    Nonlinear,
    /// Eqs. (7)-(8).
    Linear,
    /// Linear plus the quadratic form (section 2.3).
    SecondOrder,
}

impl Model {
    pub const ALL: [Model; 3] = [Model::Nonlinear, Model::Linear, Model::SecondOrder];

    pub const fn name(self) -> &'static str {
        match self {
            Model::Nonlinear => "nonlinear",
            Model::Linear => "linear",
            Model::SecondOrder => "second-order",
        }
    }
}

/// How the errors are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reading {
    /// As one signed sample.
    Signed,
    /// As plus-or-minus: the largest error of any corner of the tolerance box.
    WorstCase,
    /// As random variables.
    Statistical,
}

impl Reading {
    pub const ALL: [Reading; 3] = [Reading::Signed, Reading::WorstCase, Reading::Statistical];

    pub const fn name(self) -> &'static str {
        match self {
            Reading::Signed => "signed",
            Reading::WorstCase => "worst-case",
            Reading::Statistical => "statistical",
        }
    }
}

/// What of a random error is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    Rms,
    Mean,
    P95,
    P99,
    /// The share of failures, one less the yield: P(error > limit).
    Yield,
}

impl Quantity {
    pub const ALL: [Quantity; 5] =
        [Quantity::Rms, Quantity::Mean, Quantity::P95, Quantity::P99, Quantity::Yield];

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

/// What has been measured with the robot itself, so that its errors cancel there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Registration {
    /// Nothing: the robot base stands where the drawing says.
    None,
    /// The base frame, fitted over the workspace.
    BestFit,
    /// The frame of each work surface, taught by touching three points.
    Taught,
}

impl Registration {
    pub const ALL: [Registration; 3] = [Registration::None, Registration::BestFit, Registration::Taught];

    pub const fn name(self) -> &'static str {
        match self {
            Registration::None => "none",
            Registration::BestFit => "best-fit",
            Registration::Taught => "taught",
        }
    }
}

/// What of the nodes of an operation counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// The best node: the operation happens there.
    Best,
    /// The operation happens at every node: the worst of them, ...
    Max,
    /// ... their mean, ...
    Mean,
    /// ... or what 95 % of them do not pass.
    P95,
}

impl Over {
    pub const ALL: [Over; 4] = [Over::Best, Over::Max, Over::Mean, Over::P95];

    pub const fn name(self) -> &'static str {
        match self {
            Over::Best => "best",
            Over::Max => "max",
            Over::Mean => "mean",
            Over::P95 => "p95",
        }
    }

    /// Whether every node must be reached.
    pub fn takes_all(self) -> bool {
        self != Over::Best
    }

    /// One number of the values of all nodes.
    pub fn of(self, values: &mut [f64]) -> f64 {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        match self {
            Over::Best => values.first().copied().unwrap_or(0.0),
            Over::Max => values.last().copied().unwrap_or(0.0),
            Over::Mean => values.iter().sum::<f64>() / count.max(1) as f64,
            // The least value that at least 95 % of the nodes do not pass.
            Over::P95 => values[(count * 19).div_ceil(20).max(1) - 1],
        }
    }
}

/// How the errors of several operations make one objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Objective {
    #[serde(rename = "sum")]
    WeightedSum,
    #[serde(rename = "max")]
    WeightedMaximum,
    /// The operations in the order of the file: a later one counts where those before it are as good.
    Lexicographic,
}

impl Objective {
    pub const ALL: [Objective; 3] =
        [Objective::WeightedSum, Objective::WeightedMaximum, Objective::Lexicographic];

    pub const fn name(self) -> &'static str {
        match self {
            Objective::WeightedSum => "sum",
            Objective::WeightedMaximum => "max",
            Objective::Lexicographic => "lexicographic",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    CmaEs,
    ParticleSwarm,
    SimulatedAnnealing,
}

impl Solver {
    pub const ALL: [Solver; 3] = [Solver::CmaEs, Solver::ParticleSwarm, Solver::SimulatedAnnealing];

    pub const fn name(self) -> &'static str {
        match self {
            Solver::CmaEs => "cma-es",
            Solver::ParticleSwarm => "particle-swarm",
            Solver::SimulatedAnnealing => "simulated-annealing",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    pub solver: Solver,
    pub objective: Objective,
    /// Share by which values may differ and still count as equally good, of the lexicographic objective.
    pub indifference: f64,
    /// Layout evaluations.
    pub budget: u64,
    pub seed: u64,
    /// Whether the worst over the placement tolerances is made small, not the value as drawn.
    pub robust: bool,
    /// Share above the proven bound at which the best layout is good enough.
    pub gap: Option<f64>,
    /// Evaluations without improvement after which the global solver ends.
    pub stagnation: Option<u64>,
    /// If any: a front of layouts none of which is better than another in all of these.
    pub pareto: Goals,
    /// How many of the best layouts that differ are told; 0: the best alone, or the whole front.
    pub keep: usize,
}

impl SearchSettings {
    /// Budgets that a search may have, layout evaluations.
    pub const BUDGETS: std::ops::RangeInclusive<u64> = 1..=1_000_000_000;

    /// Settings of a cell that says nothing.
    pub const DEFAULT: Self = Self {
        solver: Solver::CmaEs,
        objective: Objective::WeightedSum,
        indifference: 0.01,
        budget: 20_000,
        seed: 1,
        robust: false,
        gap: None,
        stagnation: None,
        pareto: Goals::NONE,
        keep: 0,
    };
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}
