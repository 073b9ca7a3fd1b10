//! The verdict of a report: the document of `report --json`, and the top of the report page.

use super::cell_yield::CellYieldEntry;
use super::placement::PlacementEntry;
use super::region::TurnEntry;
use super::words::VALUE_WORDS;
use crate::assess::Requirement;
use crate::cell::{Objective, Unit};
use crate::search::SearchEnd;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `report --json`.
pub const REPORT_SCHEMA: &str = "sweetspot/report/1";

/// Verdict of a report. Lengths are in mm and angles in degrees, rounded to 1e-9 as in search.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerdictDocument {
    #[schemars(extend("const" = REPORT_SCHEMA))]
    pub schema: String,
    pub of: VerdictSubject,
    pub cell: String,
    pub robot: String,
    pub answer: VerdictAnswer,
    pub headline: String,
    pub feasible: bool,
    /// Reason why the search ended; null if no search ran.
    pub ended: Option<SearchEnd>,
    pub unit: Unit,
    /// Name of the figure that the search minimizes.
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub objective: Objective,
    pub objective_value: Option<f64>,
    pub start_value: Option<f64>,
    pub gain_percent: Option<f64>,
    pub bound: Option<f64>,
    pub gap_percent: Option<f64>,
    pub requirement: RequirementState,
    pub runner_up: Option<RunnerUpEntry>,
    pub facts: Vec<FactEntry>,
    /// Overall yield: share of sampled arms that stay within the limits of all operations. Present if the
    /// reading is statistical, every operation has a spot, and at least one operation has a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell_yield: Option<CellYieldEntry>,
    /// Placements of the equipment and of the robot base; empty if the layout is not feasible.
    #[serde(default)]
    pub placements: Vec<VerdictPlacement>,
    pub operations: Vec<VerdictSpot>,
    /// Angles by which equipment may rotate as one body about the base axis. Equipment takes part in this
    /// rotation if its x, y and yaw have ranges. At these angles, the layout stays within every limit. Null
    /// if the layout is infeasible or misses a limit, or if equipment under an operation does not take part.
    #[serde(default)]
    pub whole_cell: Option<TurnEntry>,
    /// Reasons why the answer is no.
    pub reasons: Vec<String>,
}

/// Subject of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictSubject {
    /// Result of a search.
    Search,
    /// Layout of the cell file.
    Layout,
}

/// Answer of a report: yes if a feasible layout was found and the field `requirement` is not `missed`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictAnswer {
    Yes,
    No,
}

/// Whether the operations meet their limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementState {
    Met,
    Missed,
    /// The error without misplacement is within the limit. The upper bound of the error over all
    /// misplacements exceeds the limit or is not known.
    NotGuaranteed,
    /// There is no limit.
    None,
}

impl RequirementState {
    /// Returns whether a limit is met, missed or not guaranteed.
    pub fn of(requirement: Requirement) -> Self {
        match requirement.is_met() {
            true => Self::Met,
            false if requirement.is_unproven() => Self::NotGuaranteed,
            false => Self::Missed,
        }
    }
}

/// Key figure of the verdict, with its description.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactEntry {
    pub label: String,
    /// Value of the figure, not rounded for display.
    pub value: Option<f64>,
    pub text: String,
    pub note: String,
    pub mood: FactMood,
}

/// Whether a fact is good news, bad news or neither.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FactMood {
    Good,
    Bad,
    Plain,
}

/// Runner-up: the next best layout or node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunnerUpEntry {
    pub kind: RunnerUpKind,
    /// Objective of the runner-up, in the `unit` of the verdict. If the runner-up is a node, one operation
    /// moves to this node, and all other operations keep their spots.
    pub value: f64,
    pub text: String,
    pub note: String,
}

/// Whether the next best answer is another layout or another node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RunnerUpKind {
    Layout,
    Node,
}

/// Placement of a piece of equipment, seen from the robot base, and the room to displace and rotate the
/// piece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerdictPlacement {
    pub equipment: String,
    /// Placement in the frame of the robot base; the placement of the robot base itself is in the world
    /// frame.
    pub at: PlacementEntry,
    /// Largest distance by which the piece may be displaced in every direction in plan. Null if the distance
    /// is not known.
    pub room_mm: Option<f64>,
    /// Largest angle by which the piece may be rotated in either direction; null if the angle is not known.
    pub room_deg: Option<f64>,
    /// Reason why the room is not larger; null if the room is not known.
    pub ends_with: Option<String>,
}

/// Spot of an operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerdictSpot {
    pub name: String,
    pub equipment: String,
    pub sense: String,
    pub node: Option<[usize; 2]>,
    pub position_mm: Option<[f64; 3]>,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    /// Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` is known,
    /// the margin is the limit minus `worst`, unless the objective is a tolerance cost.
    pub margin: Option<f64>,
    /// Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is
    /// not certified, or if no bound is known.
    pub worst: Option<f64>,
    /// Whether the operation meets its limit.
    pub requirement: RequirementState,
    /// Sentence that states spot, value and position.
    pub text: String,
}
