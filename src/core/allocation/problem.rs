//! Tolerance allocation problem: cost models and requirements.

use super::linear_figure::LinearFigure;
use crate::cell::ToleranceCost;

/// Figure of one operation at one node, with the largest value that is allowed.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceRequirement {
    pub figure: LinearFigure,
    /// Limit in the unit of the figure, greater than 0.
    pub limit: f64,
}

/// Cost models of all parameters, and the requirements that their tolerances must meet.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceProblem {
    pub costs: Vec<ToleranceCost>,
    pub requirements: Vec<ToleranceRequirement>,
}
