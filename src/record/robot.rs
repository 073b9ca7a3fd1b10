//! The documents of `robots --json`, `robot --json` and `envelope --json`.

use super::explanation::JointKindWord;
use super::numbers::{degrees, joint_coordinate, millimetres, nine_digits, position_mm};
use crate::assess::{Reachable, RobotDataSheet, SheetEnvelope};
use crate::cell::{ErrorSet, Joint, JointKind, Robot, Unit};
use crate::reach::{EnvelopeSection, Size};
use crate::units::{mm_from_m, rounded};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `robots --json`.
pub const ROBOTS_SCHEMA: &str = "sweetspot/robots/1";
/// Name and version of the document of `robot --json`.
pub const ROBOT_SHEET_SCHEMA: &str = "sweetspot/robot-sheet/1";
/// Name and version of the document of `envelope --json`.
pub const ENVELOPE_SCHEMA: &str = "sweetspot/envelope/1";

/// Robots of the library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotsDocument {
    #[schemars(extend("const" = ROBOTS_SCHEMA))]
    pub schema: String,
    pub robots: Vec<RobotEntry>,
}

/// Robot of the library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotEntry {
    /// Name in the library. Cell files use this name to refer to the robot.
    pub robot: String,
    pub name: String,
    pub axes: usize,
    /// Name of the method that solves the inverse kinematics.
    pub family: String,
    pub reach_mm: f64,
    pub error_sets: usize,
    /// Source of the numbers of the robot.
    pub source: String,
}

impl RobotsDocument {
    /// Makes the document from one tuple per robot: library name, robot, and family of its inverse
    /// kinematics.
    pub fn new(all: &[(&str, Robot, &str)]) -> Self {
        let robots = all.iter().map(|(stem, robot, family)| RobotEntry {
            robot: stem.to_string(),
            name: robot.name.clone(),
            axes: robot.axes(),
            family: family.to_string(),
            reach_mm: millimetres(robot.reach()),
            error_sets: robot.errors.len(),
            source: robot.source.clone(),
        });
        Self { schema: ROBOTS_SCHEMA.into(), robots: robots.collect() }
    }
}

/// Data sheet of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSheetDocument {
    #[schemars(extend("const" = ROBOT_SHEET_SCHEMA))]
    pub schema: String,
    pub name: String,
    /// Source of the numbers of the robot.
    pub source: String,
    /// Name of the method that solves the inverse kinematics.
    pub family: String,
    /// Denavit-Hartenberg convention of the rows.
    pub convention: String,
    pub joints: Vec<JointSheet>,
    /// Rows of the matrix that converts actuator coordinates to Denavit-Hartenberg coordinates.
    pub coupling: Vec<Vec<f64>>,
    pub tool: ToolSheet,
    pub reach_mm: f64,
    /// Home posture: degrees, or mm for a prismatic joint.
    pub home: Vec<f64>,
    /// Position of the TCP in the home posture, in the base frame.
    pub home_position_mm: [f64; 3],
    /// Names of the solids of the links.
    pub solids: Vec<String>,
    pub errors: Vec<ErrorSetEntry>,
    /// Size of the working envelope; null for a redundant arm and for an arm with numeric inverse kinematics.
    /// The command `sweetspot envelope` computes the envelope of such an arm.
    pub envelope: Option<EnvelopeSize>,
}

/// Joint of a robot with its Denavit-Hartenberg row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointSheet {
    pub name: String,
    pub kind: JointKindWord,
    pub theta_deg: f64,
    pub r_mm: f64,
    pub l_mm: f64,
    pub alpha_deg: f64,
    /// Least and greatest coordinate, in `unit`.
    pub limits: [f64; 2],
    pub unit: Unit,
    /// Maximum speed, in `unit` per s; null if the robot file states none.
    pub max_velocity: Option<f64>,
    /// Maximum acceleration, in `unit` per s^2; null if the robot file states none.
    pub max_acceleration: Option<f64>,
}

/// Tool of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToolSheet {
    /// Position of the TCP in the frame of the last Denavit-Hartenberg row.
    pub position_mm: [f64; 3],
    /// Unit vector of the tool axis in the frame of the TCP.
    pub axis: [f64; 3],
}

/// Error set of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorSetEntry {
    pub name: String,
    pub kind: ErrorSetKind,
}

/// Whether an error set is one signed sample, consists of tolerances, or was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorSetKind {
    Signed,
    Tolerance,
    Measured,
}

/// Size of the working envelope of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvelopeSize {
    /// Elevation of the tool axis above the horizontal.
    pub bend_deg: f64,
    /// Distance between neighbouring sample points. The envelope is computed from these points.
    pub step_mm: f64,
    pub size: SizeEntry,
}

/// Size of a working envelope in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SizeEntry {
    pub volume_m3: f64,
    /// Estimated error of the volume: the difference from a second volume. The second volume is computed with
    /// twice the distance between the sample points.
    pub volume_error_m3: f64,
    pub rotationally_symmetric: bool,
    /// Least and greatest distance from the vertical axis through the base; null if nothing is reached.
    pub radius_mm: Option<[f64; 2]>,
    /// Least and greatest height above the origin of the base; null if nothing is reached.
    pub height_mm: Option<[f64; 2]>,
    /// Bound of the error of `radius_mm` and `height_mm`. Parts of the envelope that are narrower than the
    /// distance between the sample points may be missed.
    pub extent_within_mm: Option<f64>,
}

impl SizeEntry {
    fn new(size: &Size) -> Self {
        let pair = |(low, high): (f64, f64)| [low, high].map(millimetres);
        Self {
            volume_m3: nine_digits(size.volume),
            volume_error_m3: nine_digits(size.error),
            rotationally_symmetric: size.symmetric,
            radius_mm: size.extent.map(|e| pair(e.radius)),
            height_mm: size.extent.map(|e| pair(e.height)),
            extent_within_mm: size.extent.map(|e| millimetres(e.within)),
        }
    }
}

impl RobotSheetDocument {
    pub fn new(sheet: &RobotDataSheet<'_>) -> Self {
        let robot = sheet.robot;
        let rows = robot.joints.iter().zip(robot.rows_of_file());
        let home = robot.joints.iter().zip(&robot.home);
        let kind = |set: &ErrorSet| match set {
            ErrorSet::Signed(_) => ErrorSetKind::Signed,
            ErrorSet::Tolerance(_) => ErrorSetKind::Tolerance,
            ErrorSet::Measured(_) => ErrorSetKind::Measured,
        };
        let error_set = |set: &ErrorSet| ErrorSetEntry { name: set.name().into(), kind: kind(set) };
        Self {
            schema: ROBOT_SHEET_SCHEMA.into(),
            name: robot.name.clone(),
            source: robot.source.clone(),
            family: sheet.family.into(),
            convention: robot.convention.name().into(),
            joints: rows.map(|(joint, row)| JointSheet::new(joint, row)).collect(),
            coupling: robot.coupling.clone(),
            tool: ToolSheet {
                position_mm: position_mm(&robot.tool.translation),
                axis: robot.tool_axis.map(|v| rounded(v, 12)).into(),
            },
            reach_mm: millimetres(robot.reach()),
            home: home.map(|(joint, q)| joint_coordinate(joint.kind, *q)).collect(),
            home_position_mm: position_mm(&sheet.pose.translation),
            solids: robot.solids.iter().map(|s| s.solid.name.clone()).collect(),
            errors: robot.errors.iter().map(error_set).collect(),
            envelope: sheet.envelope.as_ref().map(EnvelopeSize::new),
        }
    }
}

impl EnvelopeSize {
    fn new(envelope: &SheetEnvelope) -> Self {
        Self {
            bend_deg: degrees(envelope.elevation),
            step_mm: millimetres(envelope.step),
            size: SizeEntry::new(&envelope.size),
        }
    }
}

impl JointSheet {
    fn new(joint: &Joint, [theta, r, l, alpha]: [f64; 4]) -> Self {
        let limits = [joint.limits.0, joint.limits.1].map(|q| joint_coordinate(joint.kind, q));
        let unit = if joint.kind == JointKind::Revolute { Unit::Angle } else { Unit::Length };
        Self {
            name: joint.name.clone(),
            kind: if joint.is_passive() { JointKindWord::Passive } else { joint.kind.into() },
            theta_deg: degrees(theta),
            r_mm: millimetres(r),
            l_mm: millimetres(l),
            alpha_deg: degrees(alpha),
            limits,
            unit,
            max_velocity: joint.rates.velocity.map(|v| joint_coordinate(joint.kind, v)),
            max_acceleration: joint.rates.acceleration.map(|a| joint_coordinate(joint.kind, a)),
        }
    }
}

/// Working envelope of a robot in its base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvelopeDocument {
    #[schemars(extend("const" = ENVELOPE_SCHEMA))]
    pub schema: String,
    pub robot: String,
    /// Name of the method that solves the inverse kinematics.
    pub family: String,
    /// Operation whose attitude the tool keeps; null if the attitude does not come from an operation.
    pub operation: Option<String>,
    #[schemars(extend("const" = BASE_FRAME))]
    pub frame: String,
    /// Elevation of the tool axis above the horizontal.
    pub bend_deg: f64,
    /// Distance between neighbouring sample points. The envelope is computed from these points.
    pub step_mm: f64,
    pub size: SizeEntry,
    pub section: SectionEntry,
    pub plans: Vec<PlanEntry>,
}

const BASE_FRAME: &str = "base";

/// Vertical section of a working envelope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionEntry {
    pub azimuth_deg: f64,
    pub area_m2: f64,
    pub outlines: Vec<SectionOutline>,
}

/// Horizontal section of a working envelope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanEntry {
    pub height_mm: f64,
    pub area_m2: f64,
    pub outlines: Vec<PlanOutline>,
}

/// Closed line in a vertical section. Outer lines run counterclockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionOutline {
    pub hole: bool,
    pub r_mm: Vec<f64>,
    pub z_mm: Vec<f64>,
}

/// Closed line in a horizontal section. Outer lines run counterclockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanOutline {
    pub hole: bool,
    pub x_mm: Vec<f64>,
    pub y_mm: Vec<f64>,
}

impl EnvelopeDocument {
    pub fn new(envelope: &Reachable<'_>) -> Self {
        let plan = |(height, plan): &(f64, EnvelopeSection)| PlanEntry {
            height_mm: millimetres(*height),
            area_m2: nine_digits(plan.area()),
            outlines: outlines(plan, |hole, [x_mm, y_mm]| PlanOutline { hole, x_mm, y_mm }),
        };
        Self {
            schema: ENVELOPE_SCHEMA.into(),
            robot: envelope.robot.name.clone(),
            family: envelope.family.into(),
            operation: envelope.operation.map(|o| o.name.clone()),
            frame: BASE_FRAME.into(),
            bend_deg: degrees(envelope.attitude.elevation),
            step_mm: millimetres(envelope.step),
            size: SizeEntry::new(&envelope.size),
            section: SectionEntry {
                azimuth_deg: degrees(envelope.azimuth),
                area_m2: nine_digits(envelope.section.area()),
                outlines: outlines(&envelope.section, |hole, [r_mm, z_mm]| SectionOutline {
                    hole,
                    r_mm,
                    z_mm,
                }),
            },
            plans: envelope.plans.iter().map(plan).collect(),
        }
    }
}

/// Converts the outlines of a region with `make`. `make` receives whether the outline is a hole, and the
/// coordinates of the outline along both axes, mm.
fn outlines<O>(region: &EnvelopeSection, make: impl Fn(bool, [Vec<f64>; 2]) -> O) -> Vec<O> {
    let outlines = region.outlines.iter();
    let axes = |o: &crate::reach::Outline| {
        [0, 1].map(|k| o.points.iter().map(|p| rounded(mm_from_m(p[k]), 3)).collect::<Vec<_>>())
    };
    outlines.map(|o| make(o.is_hole(), axes(o))).collect()
}
