//! The verdict of a report: the document of `report --json`, and the head of its page.

use super::words::VALUE_WORDS;
use crate::cell::{Objective, Unit};
use crate::search::SearchEnd;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `report --json`.
pub const REPORT_SCHEMA: &str = "sweetspot/report/1";

/// Verdict of a report. Lengths in mm, angles in degrees, rounded to 1e-9 as in search.json.
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
    /// Why the search ended; null of a layout as drawn.
    pub ended: Option<SearchEnd>,
    pub unit: Unit,
    /// Figure that is minimized.
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
    pub operations: Vec<VerdictSpot>,
    /// Why the answer is no.
    pub reasons: Vec<String>,
}

/// Subject of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictSubject {
    /// The result of a search.
    Search,
    /// A layout as drawn.
    Layout,
}

/// Answer of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictAnswer {
    Yes,
    No,
}

/// Whether the operations keep their limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementState {
    Met,
    Missed,
    /// No operation has a limit.
    None,
}

/// One number of the answer in words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactEntry {
    pub label: String,
    /// The number, as precise as it is known.
    pub value: Option<f64>,
    pub text: String,
    pub note: String,
    pub mood: FactMood,
}

/// How a fact is to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FactMood {
    Good,
    Bad,
    Plain,
}

/// The next best answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunnerUpEntry {
    pub kind: RunnerUpKind,
    /// Value in the unit of the verdict.
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

/// Where an operation happens.
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
    /// Distance to the limit; negative: it is missed.
    pub margin: Option<f64>,
    /// All of it in one sentence.
    pub text: String,
}
