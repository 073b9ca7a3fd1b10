//! The document of `calibrate --plan --json`.

use super::numbers::{joints, millimetres, nine_digits, position_mm};
use crate::calibration::UnmodelledError;
use crate::cell::{Cell, JointVector};
use crate::layout::MeasurablePoses;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `calibrate --plan --json`.
pub const MEASURING_PLAN_SCHEMA: &str = "sweetspot/measuring-plan/1";

/// Poses to be measured for a calibration that serves the operations of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuringPlanDocument {
    #[schemars(extend("const" = MEASURING_PLAN_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Poses in the layout of the cell file, the most informative first.
    pub poses: Vec<PlannedPoseEntry>,
    pub expected: ExpectedEntry,
    pub tried: TriedEntry,
    /// Number of unknowns of the calibration, including the unknowns of base and reflector.
    pub unknowns: usize,
    /// Position of the reflector in the frame of the mechanical interface.
    pub reflector_mm: [f64; 3],
    /// Position of the instrument in the world frame; null if visibility was not checked.
    pub tracker_mm: Option<[f64; 3]>,
    pub seed: u64,
}

/// Pose to be measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlannedPoseEntry {
    /// Number of the pose, counted from 1.
    pub pose: usize,
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints: Vec<f64>,
    /// Nominal position of the reflector in the world frame.
    pub reflector_mm: [f64; 3],
}

/// Expected root mean square error of predicted positions at the operations.
///
/// The expected errors assume that the base frame is measured again with the robot after the calibration.
/// They leave out the part that the new base frame removes. They also leave out errors that the unknowns of
/// the calibration cannot explain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExpectedEntry {
    /// Number of nodes in the root mean square: the usable nodes of all operations.
    pub nodes: usize,
    /// Error without a measurement, from the standard deviations of the unknowns.
    pub before_mm: f64,
    /// Error after the planned poses are measured.
    pub after_mm: f64,
    /// Error after another set of poses is measured. This set has as many poses as the plan, spread evenly
    /// over the joint space.
    pub evenly_spread_mm: f64,
    /// Assumed standard deviation, per axis, of one part of the errors that the unknowns do not explain. This
    /// part is nearly the same at nearby poses.
    pub shared_misfit_mm: f64,
    /// Assumed standard deviation, per axis, of the other part of the errors that the unknowns do not
    /// explain. This part is independent from pose to pose.
    pub own_misfit_mm: f64,
}

/// Numbers of postures that were examined for the plan: usable, colliding, and hidden from the tracker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TriedEntry {
    /// Number of usable postures. The poses of the plan were chosen from these postures.
    pub candidates: usize,
    /// Number of postures at which the robot touches an object or is nearer to an object than the clearance
    /// that the cell requires.
    pub colliding: usize,
    /// Number of collision-free postures at which the tracker does not see the reflector.
    pub hidden: usize,
}

impl ExpectedEntry {
    /// Returns the entry for three expected errors, m. The first is the error without a measurement. The
    /// second is the error after the planned poses are measured. The third is the error after evenly spread
    /// poses are measured.
    pub fn new(nodes: usize, [before, after, evenly]: [f64; 3], error: UnmodelledError) -> Self {
        Self {
            nodes,
            before_mm: millimetres(before),
            after_mm: millimetres(after),
            evenly_spread_mm: millimetres(evenly),
            shared_misfit_mm: millimetres(error.shared),
            own_misfit_mm: millimetres(error.own),
        }
    }
}

impl TriedEntry {
    pub fn new(found: &MeasurablePoses) -> Self {
        Self { candidates: found.joints.len(), colliding: found.colliding, hidden: found.hidden }
    }
}

impl PlannedPoseEntry {
    /// Returns the entry of pose number `pose`. The position of the reflector is in the world frame, m.
    pub fn new(cell: &Cell, pose: usize, q: &JointVector, reflector: &Vector3<f64>) -> Self {
        let joints = joints(cell, q).into_iter().map(nine_digits).collect();
        Self { pose, joints, reflector_mm: position_mm(reflector) }
    }
}
