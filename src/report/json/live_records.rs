//! Records that the live page of `view` reads. The file `records.d.ts` declares the types of these records
//! for the scripts of the page.

use crate::cell::{Model, Reading, Unit};
use crate::error_map::NodeSign;
use crate::record::{ByName, RegionEntry, StatusCounts, TurnEntry};
use serde::Serialize;
use serde_json::Value;

/// Part of a cell that does not depend on the layout.
#[derive(Serialize)]
pub struct FormRecord<'a> {
    pub schema: &'static str,
    pub cell: &'a str,
    pub robot: &'a str,
    /// Name of the error set.
    pub errors: &'a str,
    pub form: Vec<FormGroup<'a>>,
    pub senses: Vec<&'a str>,
    pub budget: u64,
    pub seed: u64,
    pub can_search: bool,
    pub equipment: Vec<FormEquipment<'a>>,
    pub base_footprint: [f64; 4],
    /// Keep-out boxes in plan: least x, least y, greatest x and greatest y of each box in the world frame,
    /// mm.
    pub keep_out: Vec<[f64; 4]>,
    pub fence: Option<Vec<[f64; 2]>>,
}

/// Equipment in the plan. Each rectangle lists x and y of its centre, then its sizes along x and y, in the
/// frame of the equipment, mm.
#[derive(Serialize)]
pub struct FormEquipment<'a> {
    pub name: &'a str,
    pub obstacle: bool,
    /// Index of the equipment that carries this equipment.
    pub on: Option<usize>,
    pub footprint: [f64; 4],
    pub surface: Option<[f64; 4]>,
}

/// Group of coordinates that the page can change. A piece of equipment, an operation or the robot base owns
/// the group.
#[derive(Serialize)]
pub struct FormGroup<'a> {
    pub group: &'static str,
    pub name: &'a str,
    /// Index of the equipment that owns the coordinates; None if an operation or the robot base owns them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index: Option<usize>,
    pub numbers: Vec<FormNumber>,
}

/// One coordinate and the range in which the search may change it.
#[derive(Serialize)]
pub struct FormNumber {
    pub key: &'static str,
    pub free: bool,
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub list: Option<Vec<f64>>,
}

/// Coordinates of a layout by owner and key, mm and degrees.
#[derive(Default, Serialize)]
pub struct NumbersRecord {
    pub robot_base: ByName<f64>,
    pub equipment: ByName<ByName<f64>>,
    pub attitude: ByName<ByName<f64>>,
}

/// Evaluation of a layout: its objective and its error maps. Each placement lists x, y, z (mm) and yaw
/// (degrees).
#[derive(Serialize)]
pub struct AnswerRecord<'a> {
    pub feasible: bool,
    /// Whether every limit is met.
    pub met: bool,
    /// Whether the layout works at every misplacement within the tolerances; None if the cell does not demand
    /// a certificate.
    pub certified: Option<bool>,
    pub objective: Option<f64>,
    pub unit: Unit,
    /// Name of the objective, such as "p95".
    pub word: String,
    pub reasons: Vec<String>,
    pub placements: Vec<[f64; 4]>,
    pub base: [f64; 4],
    pub operations: Vec<AnswerOperation<'a>>,
}

/// Evaluation of one operation: its value and its error map.
#[derive(Serialize)]
pub struct AnswerOperation<'a> {
    pub name: &'a str,
    pub equipment: usize,
    pub sense: &'a str,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    pub margin: Option<f64>,
    /// Upper bound of the value within the placement tolerances. None if the layout is not certified, or if
    /// no bound is known.
    pub worst: Option<f64>,
    /// Names of the joints that are near a limit at the spot.
    pub near_limits: Vec<&'a str>,
    pub counts: StatusCounts,
    pub best: Option<[usize; 2]>,
    pub nodes: AnswerNodes,
}

/// Nodes of an error map: one list per property, with one entry per node. Positions and errors are in mm.
#[derive(Default, Serialize)]
pub struct AnswerNodes {
    pub ij: Vec<[usize; 2]>,
    pub at: Vec<[f64; 3]>,
    pub status: Vec<NodeSign>,
    pub value: Vec<Option<f64>>,
    pub error: Vec<Option<[f64; 3]>>,
    /// Index into `reasons` for each node.
    pub why: Vec<usize>,
    pub reasons: Vec<String>,
    /// Thinning of the grid: every n-th node along each axis is sent.
    pub every: usize,
}

/// Error model and reading (interpretation of the errors) under which a cell can be evaluated.
#[derive(Serialize)]
pub struct LensChoice {
    pub model: Model,
    pub reading: Reading,
    pub word: &'static str,
}

/// Document that a page loads first: the cell, its file and the current step.
#[derive(Serialize)]
pub struct LiveState<'a> {
    #[serde(flatten)]
    pub form: FormRecord<'a>,
    pub file: String,
    /// Current step, a [`LiveStep`].
    pub now: Value,
}

/// Sense, model and reading under which the page evaluates a layout.
#[derive(Serialize)]
pub struct LiveQuestion<'a> {
    /// Name of the sense; None if each operation keeps its own sense.
    pub sense: Option<&'a str>,
    pub model: Model,
    pub reading: Reading,
}

/// Current step of the undo history, with the evaluation of its layout.
#[derive(Serialize)]
pub struct LiveStep<'a> {
    pub revision: u64,
    /// Number of steps that can be undone.
    pub undo: usize,
    /// Number of steps that can be redone.
    pub redo: usize,
    /// Change that led to this step, in words.
    pub what: &'a str,
    pub question: LiveQuestion<'a>,
    pub numbers: NumbersRecord,
    pub lenses: Vec<LensChoice>,
    /// Objective of the previous step.
    pub before: Option<f64>,
    pub answer: AnswerRecord<'a>,
}

/// Evaluation of a layout that is tried while equipment is dragged.
#[derive(Serialize)]
pub struct LiveLayoutTrial<'a> {
    pub numbers: NumbersRecord,
    pub answer: AnswerRecord<'a>,
    /// Drawing for the 3-D view; None if the page has not asked for it.
    pub drawing: Option<Value>,
}

/// Outlines of the reachable region at the height of every operation, in plan, mm.
#[derive(Serialize)]
pub struct LiveReach {
    pub outlines: Vec<Vec<Vec<[f64; 2]>>>,
}

/// Regions of the pieces in the current layout, and the allowed rotation of the equipment as one body.
#[derive(Serialize)]
pub struct LiveRegions {
    pub regions: Vec<RegionEntry>,
    /// Angles by which equipment may rotate as one body about the base axis. None if the layout is infeasible
    /// or misses a limit, or if equipment under an operation does not take part in this rotation.
    pub whole_cell: Option<TurnEntry>,
}

/// Outlines of the region in which a piece of equipment may stand, as closed rings in plan, mm.
#[derive(Serialize)]
pub struct LiveStanding {
    pub outline: Vec<Vec<[f64; 2]>>,
}

/// Progress and result of a search from the page.
#[derive(Serialize)]
pub struct LiveSearch {
    pub running: bool,
    pub evaluations: u64,
    pub budget: u64,
    pub feasible: u64,
    pub seed: u64,
    /// Objective of the start layout, in `unit`.
    pub start: Option<f64>,
    /// Least objective found, in `unit`.
    pub best: Option<f64>,
    /// Reduction of the objective from `start` to `best`, in percent of `start`.
    pub gain_percent: Option<f64>,
    pub unit: Unit,
    pub seconds: f64,
    /// Reason why the search ended, in words.
    pub ended: Option<&'static str>,
    /// Reason why the search failed, in words.
    pub fault: Option<String>,
    /// Whether the search has ended with a layout that the page can accept.
    pub acceptable: bool,
}

/// State that can change without a request from the page.
#[derive(Serialize)]
pub struct LivePulse {
    pub revision: u64,
    /// Running or last search; None if the page has started no search.
    pub search: Option<LiveSearch>,
}

/// Answer after the layout was saved as a cell file.
#[derive(Serialize)]
pub struct LiveSaved {
    pub saved: String,
}

/// Answer to a request that the server refuses.
#[derive(Serialize)]
pub struct LiveRefusal<'a> {
    pub error: &'a str,
    /// Whether a file of the requested name exists.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub taken: bool,
}
