//! The document of `check --json`.

use super::numbers::{degrees, millimetres, position_mm};
use super::placement::ByName;
use crate::cell::{Operation, Robot};
use crate::clearance::{Allowed, SelfCollisionPair};
use crate::error_map::PostureOrder;
use crate::files::{Fault, shown};
use crate::layout::Workcell;
use crate::pose::Pose;
use crate::proof;
use nalgebra::{Rotation3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `check --json`.
pub const CHECK_SCHEMA: &str = "sweetspot/check/1";

/// Result of a check: whether a cell file is valid, and all its faults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckDocument {
    #[schemars(extend("const" = CHECK_SCHEMA))]
    pub schema: String,
    pub valid: bool,
    pub faults: Vec<Fault>,
    /// Pairs of the robot's solids. A pair states a reason if contact of its two solids is allowed. If
    /// self-collision is not checked, the list holds only pairs with the pedestal.
    pub self_collision: Vec<OwnPairEntry>,
    /// Entries that state how a search treats each operation. Empty if the cell is not valid.
    #[serde(default)]
    pub operations: Vec<OperationOrderEntry>,
    /// Facts derived from a URDF; left out for a robot given by Denavit-Hartenberg rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<UrdfEntry>,
}

/// Statement of how a search treats the postures of an operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationOrderEntry {
    pub name: String,
    /// Word that states what the search skips. With "ranked-nodes", it skips nodes. With "bounded-postures",
    /// it skips postures. With "spin-families", it skips groups of postures that differ in the last joint
    /// alone. With "every-posture", it skips nothing. A node, posture or group is skipped if its lower bound
    /// exceeds the best value found.
    pub judges: String,
    /// Reason why the search judges every posture; null if the search skips some postures.
    pub why: Option<String>,
    /// Reason why no value field can be computed for the operation; null if one can be computed. A value
    /// field is a table of lower bounds of the operation's value at a node. The bounds hold in every layout,
    /// and a search uses them to exclude nodes.
    #[serde(default)]
    pub why_no_field: Option<String>,
}

impl OperationOrderEntry {
    /// Returns the entry of every operation in the start layout.
    pub fn all(workcell: &Workcell) -> Vec<Self> {
        let operations = workcell.cell.operations.iter().zip(workcell.posture_orders()).enumerate();
        let entry = |(k, (operation, order)): (usize, (&Operation, PostureOrder))| Self {
            name: operation.name.clone(),
            judges: order.name().into(),
            why: order.reason().map(String::from),
            why_no_field: proof::why_no_field(workcell, k).map(String::from),
        };
        operations.map(entry).collect()
    }
}

/// Pair of the robot's solids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OwnPairEntry {
    pub a: String,
    pub b: String,
    /// Reason why contact of the two solids is allowed; null if contact counts as a collision.
    pub allowed: Option<String>,
}

impl OwnPairEntry {
    /// Returns every pair of robot solids that can be present at the same time. A held part counts as a robot
    /// solid, and is present only during its operation. If self-collision is not checked, only pairs with the
    /// pedestal are returned.
    pub fn all(workcell: &Workcell) -> Vec<Self> {
        let pair = |p: &SelfCollisionPair| {
            let [a, b] = [p.a, p.b].map(|id| id.in_words(&workcell.cell).to_string());
            Self { a, b, allowed: p.allowed.map(|why| Allowed::in_words(why).into()) }
        };
        workcell.self_collision_pairs().iter().map(pair).collect()
    }
}

/// Denavit-Hartenberg rows derived from a URDF, and the unused elements of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UrdfEntry {
    pub file: String,
    pub base_link: String,
    pub tip_link: String,
    pub base_to_frame_0: PoseEntry,
    pub rows: Vec<UrdfRow>,
    pub last_frame_to_tip: PoseEntry,
    /// Number of unused elements of each kind in the file.
    pub ignored: ByName<usize>,
}

/// Pose: position, and roll, pitch and yaw about the fixed axes x, y and z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseEntry {
    pub position_mm: [f64; 3],
    pub rpy_deg: [f64; 3],
}

/// Denavit-Hartenberg row of a joint of a URDF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UrdfRow {
    pub joint: String,
    pub theta_deg: f64,
    pub r_mm: f64,
    pub l_mm: f64,
    pub alpha_deg: f64,
    pub passive: bool,
}

impl UrdfEntry {
    /// Makes the entry; None for a robot given by Denavit-Hartenberg rows.
    pub fn new(robot: &Robot) -> Option<Self> {
        let origin = robot.urdf.as_ref()?;
        let rows = robot.joints.iter().map(|j| UrdfRow {
            joint: shown(&j.name),
            theta_deg: degrees(j.theta),
            r_mm: millimetres(j.r),
            l_mm: millimetres(j.l),
            alpha_deg: degrees(j.alpha),
            passive: j.is_passive(),
        });
        Some(Self {
            file: shown(&origin.file),
            base_link: shown(&origin.base_link),
            tip_link: shown(&origin.tip_link),
            base_to_frame_0: PoseEntry::new(&robot.mount),
            rows: rows.collect(),
            last_frame_to_tip: PoseEntry::new(&origin.tip),
            ignored: origin.ignored.iter().map(|(what, n)| (shown(what), *n)).collect(),
        })
    }
}

impl PoseEntry {
    pub fn new(pose: &Pose) -> Self {
        Self {
            position_mm: position_mm(&pose.translation),
            rpy_deg: roll_pitch_yaw(pose).map(degrees).into(),
        }
    }
}

/// Returns roll, pitch and yaw about the fixed axes x, y and z, rad. [`Pose::from_translation_rpy`] accepts
/// the same angles.
pub fn roll_pitch_yaw(pose: &Pose) -> Vector3<f64> {
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
    Vector3::new(roll, pitch, yaw)
}
