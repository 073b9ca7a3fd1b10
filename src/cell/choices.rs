//! What a cell asks for by a word: error model, reading, registration, search.

/// How the errors of the parameters make that of the TCP.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    pub fn name(self) -> &'static str {
        match self {
            Model::Nonlinear => "nonlinear",
            Model::Linear => "linear",
            Model::SecondOrder => "second-order",
        }
    }
}

/// How the errors are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    pub fn name(self) -> &'static str {
        match self {
            Reading::Signed => "signed",
            Reading::WorstCase => "worst-case",
            Reading::Statistical => "statistical",
        }
    }
}

/// What of a random error is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    pub fn name(self) -> &'static str {
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    pub fn name(self) -> &'static str {
        match self {
            Registration::None => "none",
            Registration::BestFit => "best-fit",
            Registration::Taught => "taught",
        }
    }
}

/// How the errors of several operations make one objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    WeightedSum,
    WeightedMaximum,
}

impl Objective {
    pub const ALL: [Objective; 2] = [Objective::WeightedSum, Objective::WeightedMaximum];

    pub fn name(self) -> &'static str {
        match self {
            Objective::WeightedSum => "sum",
            Objective::WeightedMaximum => "max",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    CmaEs,
    ParticleSwarm,
    SimulatedAnnealing,
}

impl Solver {
    pub const ALL: [Solver; 3] = [Solver::CmaEs, Solver::ParticleSwarm, Solver::SimulatedAnnealing];

    pub fn name(self) -> &'static str {
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
    /// Layout evaluations.
    pub budget: u64,
    pub seed: u64,
    /// Share above the proven bound at which the best layout is good enough.
    pub gap: Option<f64>,
    /// Evaluations without improvement after which the global solver ends.
    pub stagnation: Option<u64>,
}
