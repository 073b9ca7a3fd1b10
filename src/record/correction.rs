//! The document of `correct --json`.

use super::check::PoseEntry;
use super::numbers::{degrees, joints, millimetres, position_mm};
use crate::assess::CorrectedTarget;
use crate::cell::{Cell, JointKind, Registration, Unit};
use crate::files::shown;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `correct --json`.
pub const CORRECTION_SCHEMA: &str = "sweetspot/correction/1";

/// Joint and pose commands with which a robot with known errors lands on its targets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorrectionDocument {
    #[schemars(extend("const" = CORRECTION_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub registration: Registration,
    /// Joints of the robot. Every list of joint coordinates has the order of this list.
    pub joints: Vec<CommandedJoint>,
    pub targets: Vec<CorrectionEntry>,
}

/// Joint with the unit of its coordinate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandedJoint {
    pub name: String,
    pub unit: Unit,
    /// Whether the joint has no actuator. Tables for people leave out passive joints.
    pub passive: bool,
}

/// Whether a target is corrected, and if not, why.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CorrectionState {
    /// The corrected robot lands on the position of the target.
    Corrected,
    /// The correction exceeds a joint limit.
    JointLimit,
    /// Newton's method has not converged.
    NotConverged,
    /// The nominal robot cannot use the target, for example because the target is out of reach.
    Unusable,
}

impl CorrectionState {
    pub fn name(self) -> &'static str {
        match self {
            Self::Corrected => "corrected",
            Self::JointLimit => "joint-limit",
            Self::NotConverged => "not-converged",
            Self::Unusable => "unusable",
        }
    }
}

/// One target with its correction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorrectionEntry {
    pub operation: String,
    /// Name of the target in the table of targets; null for a node.
    pub name: Option<String>,
    /// Indices of the node along x and y of the surface; null for a target of a table.
    pub node: Option<[usize; 2]>,
    /// Position of the target in the world frame.
    pub position_mm: Option<[f64; 3]>,
    pub state: CorrectionState,
    /// Reason why the target is not corrected; null if the target is corrected.
    pub reason: Option<String>,
    /// Joint coordinates without correction: degrees, or mm for a prismatic joint.
    pub nominal_joints: Option<Vec<f64>>,
    /// Corrected joint coordinates, the joint command: degrees, or mm for a prismatic joint.
    pub joints: Option<Vec<f64>>,
    /// Pose command for a controller without calibration: the nominal pose of the TCP at the joint
    /// command, in the base frame.
    pub command: Option<PoseEntry>,
    /// Position error of the TCP without correction.
    pub before_mm: Option<f64>,
    /// Orientation error of the TCP without correction.
    pub before_deg: Option<f64>,
    /// Position error of the TCP that remains after the correction.
    pub rest_mm: Option<f64>,
    /// Orientation error of the TCP that remains after the correction.
    pub rest_deg: Option<f64>,
    /// Root mean square of the random position error, which no correction removes; null without random
    /// errors.
    pub random_mm: Option<f64>,
    /// Root mean square of the random orientation error; null without random errors.
    pub random_deg: Option<f64>,
    /// Number of Newton steps.
    pub steps: Option<usize>,
}

impl CorrectionDocument {
    pub fn new(cell: &Cell, targets: Vec<CorrectionEntry>) -> Self {
        let unit = |kind| if kind == JointKind::Revolute { Unit::Angle } else { Unit::Length };
        let joints = cell.robot.joints.iter();
        Self {
            schema: CORRECTION_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            registration: cell.registration,
            joints: joints
                .map(|j| CommandedJoint { name: j.name.clone(), unit: unit(j.kind), passive: j.is_passive() })
                .collect(),
            targets,
        }
    }

    /// Returns the joints with an actuator, each with its index in the lists of joint coordinates.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &CommandedJoint)> {
        self.joints.iter().enumerate().filter(|(_, joint)| !joint.passive)
    }
}

impl CorrectionEntry {
    /// Makes the entry of a target of an operation. A target of a table has a `name`; a target on the grid
    /// has a `node`.
    ///
    /// `position` is the position of the target in the world frame, m.
    pub fn new(
        cell: &Cell,
        operation: usize,
        (name, node): (Option<String>, Option<(usize, usize)>),
        position: Option<Vector3<f64>>,
        found: &Result<CorrectedTarget, String>,
    ) -> Self {
        let (state, reason) = judged(cell, found);
        let found = found.as_ref().ok();
        let random = found.and_then(|f| f.random);
        Self {
            operation: cell.operations[operation].name.clone(),
            name,
            node: node.map(|(i, j)| [i, j]),
            position_mm: position.as_ref().map(position_mm),
            state,
            reason,
            nominal_joints: found.map(|f| joints(cell, &f.nominal)),
            joints: found.map(|f| joints(cell, &f.correction.joints)),
            command: found.map(|f| PoseEntry::new(&f.correction.command)),
            before_mm: found.map(|f| millimetres(f.before.position.norm())),
            before_deg: found.map(|f| degrees(f.before.rotation.norm())),
            rest_mm: found.map(|f| millimetres(f.correction.rest.position.norm())),
            rest_deg: found.map(|f| degrees(f.correction.rest.rotation.norm())),
            random_mm: random.map(|r| millimetres(r.0)),
            random_deg: random.map(|r| degrees(r.1)),
            steps: found.map(|f| f.correction.steps),
        }
    }
}

/// Returns the state of a target, and the reason if it is not corrected.
fn judged(cell: &Cell, found: &Result<CorrectedTarget, String>) -> (CorrectionState, Option<String>) {
    let correction = match found {
        Err(why) => return (CorrectionState::Unusable, Some(why.clone())),
        Ok(found) => &found.correction,
    };
    if !correction.converged {
        let (rest, steps) = (millimetres(correction.rest.position.norm()), correction.steps);
        let why = format!("not converged after {steps} steps: {rest} mm remain; the posture may be singular");
        return (CorrectionState::NotConverged, Some(why));
    }
    match correction.beyond {
        None => (CorrectionState::Corrected, None),
        Some(joint) => {
            let name = shown(&cell.robot.joints[joint].name);
            let why = format!("the correction moves joint {name} beyond its limit");
            (CorrectionState::JointLimit, Some(why))
        }
    }
}
