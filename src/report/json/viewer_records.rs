//! Records that the 3-D viewer reads. The file `records.d.ts` declares the types of these records for the
//! scripts of the viewer.
//!
//! Long lists of numbers are base64 of little-endian f32 or u32. NaN means that there is no value. Positions
//! are in the world frame, mm; angles are in degrees.

use crate::cell::{Model, Unit};
use crate::error_map::NodeSign;
use crate::record::{JointEntry, SenseEntry};
use serde::Serialize;

/// Pose: the three columns of the rotation matrix, then the position of the origin, mm.
pub type PoseNumbers = [f64; 12];

/// Layouts for the viewer. A mesh that several layouts share is written once.
#[derive(Serialize)]
pub struct DrawingsRecord<'a> {
    pub schema: &'static str,
    pub units: DrawingUnits,
    pub meshes: Vec<MeshRecord>,
    pub drawings: Vec<DrawingRecord<'a>>,
}

/// Units of the numbers in the document.
#[derive(Serialize)]
pub struct DrawingUnits {
    pub length: Unit,
    pub angle: Unit,
}

/// Triangles of a solid.
#[derive(Clone, PartialEq, Eq, Hash, Serialize)]
pub struct MeshRecord {
    pub positions: String,
    pub normals: String,
    pub indices: String,
}

/// One layout for the viewer.
#[derive(Serialize)]
pub struct DrawingRecord<'a> {
    pub name: &'a str,
    pub cell: &'a str,
    pub robot: &'a str,
    pub base: PoseNumbers,
    pub floor_mm: f64,
    /// Least and greatest corner of everything shown.
    pub extent_mm: [[f64; 3]; 2],
    pub joints: Vec<JointEntry>,
    pub equipment: Vec<EquipmentRecord<'a>>,
    pub operations: Vec<OperationRecord<'a>>,
    pub parts: Vec<PartRecord<'a>>,
    pub lenses: Vec<LensRecord>,
    pub fields: Vec<FieldRecord<'a>>,
    pub envelopes: Vec<EnvelopeRecord>,
    pub movement: MovementRecord<'a>,
}

/// Equipment or obstacle.
#[derive(Serialize)]
pub struct EquipmentRecord<'a> {
    pub name: &'a str,
    pub obstacle: bool,
    /// Index of the equipment that carries this equipment.
    pub on: Option<usize>,
    /// Pose of the equipment; null if the equipment has no solid.
    pub at: Option<PoseNumbers>,
    pub surface: Option<RectangleRecord>,
    pub footprint: RectangleRecord,
}

/// Rectangle in the plan.
#[derive(Serialize)]
pub struct RectangleRecord {
    pub centre_mm: [f64; 2],
    pub size_mm: [f64; 2],
}

/// Operation and the index of its equipment.
#[derive(Serialize)]
pub struct OperationRecord<'a> {
    pub name: &'a str,
    pub equipment: usize,
    pub sense: &'a str,
    pub standoff_mm: f64,
    /// Largest allowed error, in the unit of the sense.
    pub limit: Option<f64>,
}

/// Solid that is fixed to a link of the robot or to the world.
#[derive(Serialize)]
pub struct PartRecord<'a> {
    pub name: &'a str,
    pub owner: &'a str,
    pub kind: &'static str,
    pub link: Option<usize>,
    pub at: Option<PoseNumbers>,
    pub equipment: Option<usize>,
    pub operation: Option<usize>,
    /// Index into the meshes of the document.
    pub mesh: usize,
}

/// Error model and reading (interpretation of the errors) under which errors are shown.
#[derive(Serialize)]
pub struct LensRecord {
    pub model: Model,
    pub reading: &'static str,
    pub signed: bool,
}

/// Error map of an operation: one list per property of its nodes.
#[derive(Serialize)]
pub struct FieldRecord<'a> {
    pub operation: usize,
    pub equipment: usize,
    pub senses: Vec<SenseEntry>,
    /// Index into `senses` of the sense that the operation states.
    pub sense: usize,
    pub size: [usize; 2],
    /// Thinning of the grid: every n-th node along each axis is shown.
    pub every: usize,
    pub nodes: Vec<[usize; 2]>,
    pub positions: String,
    pub status: Vec<NodeSign>,
    pub reason: Vec<&'a str>,
    pub joints: Vec<Option<Vec<f64>>>,
    pub best: Option<usize>,
    pub spot_mm: Option<[f64; 3]>,
    pub refined_mm: Option<[f64; 3]>,
    pub takes: Vec<TakeRecord>,
}

/// Errors at the nodes of an operation under one model and reading.
#[derive(Serialize)]
pub struct TakeRecord {
    pub lens: usize,
    pub error: String,
    /// Values of all nodes: one text per sense. Each text is the base64 encoding of f32 numbers.
    pub values: Vec<String>,
    pub best: Option<usize>,
}

/// Outlines of the working envelope.
#[derive(Serialize)]
pub struct EnvelopeRecord {
    pub at_work: Vec<String>,
    pub around: Vec<String>,
}

/// Movement of the robot from operation to operation.
#[derive(Serialize)]
pub struct MovementRecord<'a> {
    pub checked: bool,
    pub stops: Vec<StopRecord<'a>>,
    pub times_s: Vec<f64>,
    /// Index of the operation whose part the robot holds at each time; null if the robot holds no part.
    pub holding: Vec<Option<usize>>,
    /// Number of link frames (poses) at each time.
    pub links: usize,
    pub frames: String,
}

/// Posture in which the robot stops.
#[derive(Serialize)]
pub struct StopRecord<'a> {
    pub operation: Option<usize>,
    pub name: &'a str,
    pub joints: Vec<f64>,
    pub time_s: f64,
}
