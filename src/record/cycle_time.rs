//! The cycle time of a layout in documents.

use super::numbers::nine_digits;
use crate::assess::Assessment;
use crate::cell::Cell;
use crate::cycle_time::{CyclePhase, CycleStep, CycleTime};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Least time of the operations and motions of a layout, at the maximum speeds and accelerations of the
/// joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleTimeEntry {
    /// Sum of the times of all steps; null if the maximum speed of a joint is not given.
    pub total_s: Option<f64>,
    /// Whether the robot returns to the first operation, so that the total is the time of a cycle.
    pub is_cycle: bool,
    /// Whether an acceleration is assumed, so that the times are estimates.
    pub is_estimate: bool,
    /// Steps in the order of execution; empty if the maximum speed of a joint is not given.
    pub steps: Vec<CycleStepEntry>,
    /// Joints whose maximum speed is missing.
    pub missing_speeds: Vec<String>,
}

/// Step of a cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleStepEntry {
    pub phase: CyclePhaseWord,
    /// Operation of the step; for a move between operations, the operation before the move.
    pub operation: String,
    /// Operation after the move; null if the step is not a move between operations.
    pub next: Option<String>,
    pub time_s: f64,
}

/// What the robot does in a step of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CyclePhaseWord {
    /// Straight approach to the spot.
    Approach,
    /// Operation itself, with the robot at rest.
    Dwell,
    /// Straight retract from the spot.
    Retract,
    /// Collision-free move to the next operation.
    Transfer,
    /// Direct move to the next operation; the move is not checked for collision.
    DirectMove,
}

impl From<CyclePhase> for CyclePhaseWord {
    fn from(phase: CyclePhase) -> Self {
        match phase {
            CyclePhase::Approach => Self::Approach,
            CyclePhase::Dwell => Self::Dwell,
            CyclePhase::Retract => Self::Retract,
            CyclePhase::Transfer => Self::Transfer,
            CyclePhase::DirectMove => Self::DirectMove,
        }
    }
}

impl CycleTimeEntry {
    /// Makes the entry of a layout; None if the layout is not feasible.
    pub fn new(a: &Assessment<'_>) -> Option<Self> {
        a.evaluation.objective?;
        let missing = a.cell.robot.joints_without_speed();
        if missing.is_empty() {
            return a.cycle_time().map(|cycle| Self::of(a.cell, &cycle));
        }
        let name = |joint: &usize| a.cell.robot.joints[*joint].name.clone();
        Some(Self {
            total_s: None,
            is_cycle: false,
            is_estimate: false,
            steps: Vec::new(),
            missing_speeds: missing.iter().map(name).collect(),
        })
    }

    fn of(cell: &Cell, cycle: &CycleTime) -> Self {
        let name = |k: usize| cell.operations[k].name.clone();
        let step = |step: &CycleStep| CycleStepEntry {
            phase: step.phase.into(),
            operation: name(step.operation),
            next: step.next.map(name),
            time_s: nine_digits(step.time),
        };
        Self {
            total_s: Some(nine_digits(cycle.total())),
            is_cycle: cycle.is_cycle,
            is_estimate: cycle.is_assumed,
            steps: cycle.steps.iter().map(step).collect(),
            missing_speeds: Vec::new(),
        }
    }
}
