//! The document of `explain --json`.

use super::budget::TotalEntry;
use super::map::MonteCarloEntry;
use super::numbers::{
    degrees, in_unit, joint_coordinate, joints, millimetres, nine_digits, percent, plain, position_mm,
    rotation_deg,
};
use super::parameter_names::{self as names, frame_name};
use super::parameter_unit::ParameterUnit;
use super::placement::{ByName, PlacementEntry};
use super::words::{VALUE_WORDS, reading_word};
use crate::assess::{DhRow, Explanation, MotionFrame, ParameterEffect, ParameterMotion, SenseRow};
use crate::cell::{JointKind, Model, Reading, Registration, Unit};
use crate::pose::{Displacement, Pose};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `explain --json`.
pub const EXPLANATION_SCHEMA: &str = "sweetspot/explain/1";

/// Error calculation of one posture with all intermediate results, for a check by hand. Lengths are in mm,
/// angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplanationDocument {
    #[schemars(extend("const" = EXPLANATION_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub reading: Reading,
    /// Name of the error figure that the reading (interpretation of errors) gives, such as "worst case".
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    pub name: String,
    pub equipment: String,
    pub sense: String,
    /// Largest allowed error of the operation, in the unit of its sense.
    pub limit: Option<f64>,
    /// Indices of the node; null if joint values were given.
    pub node: Option<[usize; 2]>,
    /// Position of the TCP in the world frame.
    pub position_mm: [f64; 3],
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints_deg: Vec<f64>,
    /// Placement of the robot base in the world frame.
    pub base: PlacementEntry,
    pub tool_axis_world: [f64; 3],
    /// Angle of the tool axis above the horizontal.
    pub tool_elevation_deg: f64,
    /// Denavit-Hartenberg convention of the rows in the robot file.
    pub convention: String,
    /// Rows of the Denavit-Hartenberg table at the posture, always in standard convention.
    ///
    /// For a file in modified convention, row k has l and alpha of row k + 1 of the file. The pose of frame 0
    /// includes l and alpha of row 1 of the file. In the last row of this table, l and alpha are 0.
    pub dh: Vec<DhEntry>,
    /// Frames of the links and of the TCP, in the base frame.
    pub frames: Vec<FrameEntry>,
    pub parameters: Vec<ParameterEntry>,
    /// Error of the TCP by the linear model, in the world frame.
    pub linear: DisplacementEntry,
    /// Second-order correction of the linear model, in the world frame.
    pub second_order_correction: DisplacementEntry,
    /// Error of the TCP by the second-order model, in the world frame.
    pub second_order: DisplacementEntry,
    /// Error of the TCP by the nonlinear model, in the world frame.
    pub nonlinear: DisplacementEntry,
    /// Nonlinear error of the robot alone, in the world frame. This error ignores the registration and the
    /// errors of the equipment. If the operation places a picked part, the error at the pick is ignored, too.
    pub robot_alone_nonlinear: DisplacementEntry,
    /// Difference `robot_alone_nonlinear` minus `nonlinear`, in the world frame. The registration and the
    /// errors of the equipment cause this difference. If the operation places a picked part, the error at the
    /// pick contributes, too.
    pub taken_off_nonlinear: DisplacementEntry,
    pub guard: PostureGuardEntry,
    /// Rows of the sense: weighted components of the error, with their values.
    pub sense_rows: Vec<SenseRowEntry>,
    /// Sign of every parameter at the worst corner of the tolerance box. Null in the signed reading if the
    /// errors of the sample compensate each other. The program assumes such compensation if the error of a
    /// Denavit-Hartenberg length (r or l) exceeds the reach of the arm.
    pub worst_corner: Option<ByName<i8>>,
    pub total: TotalEntry,
    /// Limit minus the value of the operation; negative if the value exceeds the limit. If a certificate is
    /// required, the margin is the limit minus the upper bound of the value over all misplacements. If this
    /// bound is not known, the margin remains the limit minus the value. Null if the operation has no limit,
    /// or if the quantity is the yield.
    pub margin: Option<f64>,
    /// Monte Carlo check of the posture; null unless the reading is statistical.
    pub monte_carlo: Option<MonteCarloEntry>,
    /// Value of the figure named in `quantity`; its unit is given in `unit`.
    pub value: f64,
    pub unit: Unit,
}

/// Row of the Denavit-Hartenberg table: `Rz(theta) Tz(r) Tx(l) Rx(alpha)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DhEntry {
    pub kind: JointKindWord,
    /// Actuator coordinate: degrees, or mm for a prismatic joint.
    pub q: f64,
    pub within_limits: bool,
    pub theta_deg: f64,
    pub r_mm: f64,
    pub l_mm: f64,
    pub alpha_deg: f64,
}

/// Kind of a joint in documents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JointKindWord {
    Revolute,
    Prismatic,
    /// Revolute joint that a linkage drives.
    Passive,
}

impl From<JointKind> for JointKindWord {
    fn from(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => Self::Revolute,
            JointKind::Prismatic => Self::Prismatic,
        }
    }
}

/// Origin and axes of a frame, expressed in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrameEntry {
    pub name: String,
    pub origin_mm: [f64; 3],
    pub x_axis: [f64; 3],
    pub y_axis: [f64; 3],
    pub z_axis: [f64; 3],
}

/// Effect of one parameter. Vectors with `base` in their names are in the base frame. The terms
/// `linear_term_mm` and `linear_term_deg` of the linear model are in the world frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterEntry {
    pub parameter: String,
    pub unit: ParameterUnit,
    /// Value of the parameter in the explained sample: the signed sample or the worst corner.
    pub value: f64,
    pub signed: f64,
    pub plus_minus: f64,
    pub standard_deviation: f64,
    pub motions: Vec<MotionEntry>,
    pub effect_base_mm_per_unit: [f64; 3],
    /// Displacement that is subtracted from `effect_base_mm_per_unit`, in the base frame. The registration
    /// removes a part of the effect. If the operation places a picked part, the effect at the pick is
    /// subtracted, too.
    pub taken_off_base_mm_per_unit: [f64; 3],
    pub linear_term_mm: [f64; 3],
    pub linear_term_deg: [f64; 3],
}

/// Small motion per unit of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionEntry {
    pub kind: MotionKind,
    /// Axis of `frame` along or about which the motion happens: x, y or z.
    #[schemars(extend("enum" = AXES))]
    pub axis: String,
    pub frame: String,
    /// Amount of the motion per unit of the parameter. For an elastic parameter, the amount is a lever in m
    /// or a torque in N m.
    pub factor: f64,
    pub axis_base: [f64; 3],
    /// Vector from the origin of `frame` to the TCP, in the base frame.
    pub lever_base_mm: [f64; 3],
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Kind of a motion: a rotation about its axis or a translation along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MotionKind {
    Turn,
    Slide,
}

/// Small displacement of the TCP.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisplacementEntry {
    pub position_mm: [f64; 3],
    pub size_mm: f64,
    pub rotation_deg: [f64; 3],
}

/// Discrepancies of the linear and the second-order model at a posture. A discrepancy is the length of the
/// difference between two position errors. One error comes from the linear or the second-order model, and the
/// other error comes from the nonlinear model. The discrepancy is in percent of the length of the nonlinear
/// position error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PostureGuardEntry {
    pub threshold_percent: f64,
    pub linear_off_percent: f64,
    pub second_order_off_percent: f64,
    /// Discrepancy between the chosen error model and the nonlinear model, percent.
    pub off_percent: f64,
    pub trusted: bool,
}

/// Row of a sense: a direction or an axis, with the error along or about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SenseRowEntry {
    pub kind: SenseRowKind,
    /// Direction in the base frame. The length of the vector is the weight.
    pub direction_base: [f64; 3],
    pub value: f64,
}

/// Whether a row of a sense measures position or rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SenseRowKind {
    Position,
    Rotation,
}

impl ExplanationDocument {
    pub fn new(e: &Explanation<'_>) -> Self {
        let context = &e.context;
        let cell = context.cell;
        let operation = &cell.operations[context.operation];
        let sense_unit = operation.sense.unit;
        let to_world = context.situation.site.world.transpose();
        let tool = to_world * context.frames.tcp.rotation * cell.robot.tool_axis;
        let world = |d: &Displacement| DisplacementEntry::new(&d.turned(&to_world));
        Self {
            schema: EXPLANATION_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: reading_word(cell).into(),
            registration: cell.registration,
            name: operation.name.clone(),
            equipment: cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            limit: operation.limit.map(|l| in_unit(operation.sense.unit, l)),
            node: context.node.map(|(i, j)| [i, j]),
            position_mm: position_mm(&context.position),
            joints_deg: joints(cell, &context.joints),
            base: PlacementEntry::new(&context.base),
            tool_axis_world: plain(&tool),
            tool_elevation_deg: degrees(tool.z.clamp(-1.0, 1.0).asin()),
            convention: cell.robot.convention.name().into(),
            dh: e.rows.iter().map(DhEntry::new).collect(),
            frames: frames(e),
            parameters: e.lines.iter().map(|l| ParameterEntry::new(e, l)).collect(),
            linear: world(&e.judged.linear),
            second_order_correction: world(&(e.judged.second_order - e.judged.linear)),
            second_order: world(&e.judged.second_order),
            nonlinear: world(&e.judged.nonlinear),
            robot_alone_nonlinear: world(&e.robot),
            taken_off_nonlinear: world(&(e.robot - e.judged.nonlinear)),
            guard: PostureGuardEntry::new(e),
            sense_rows: e.sense.iter().map(|row| SenseRowEntry::new(e, row)).collect(),
            worst_corner: corner(e),
            total: TotalEntry::new(context, &e.judged),
            margin: context.requirement(e.judged.value).map(|r| in_unit(sense_unit, r.margin)),
            monte_carlo: e
                .check
                .as_ref()
                .map(|c| MonteCarloEntry::of(&c.samples, sense_unit, Some(c.confirmed))),
            value: in_unit(e.unit(), e.judged.value),
            unit: e.unit(),
        }
    }
}

impl DhEntry {
    fn new(row: &DhRow) -> Self {
        Self {
            kind: row.kind.into(),
            q: joint_coordinate(row.kind, row.q),
            within_limits: row.allowed,
            theta_deg: degrees(row.theta),
            r_mm: millimetres(row.r),
            l_mm: millimetres(row.l),
            alpha_deg: degrees(row.alpha),
        }
    }
}

fn frames(e: &Explanation<'_>) -> Vec<FrameEntry> {
    let entry = |(name, pose): (String, &Pose)| {
        let axis = |k: usize| plain(&pose.rotation.column(k).into_owned());
        let [x_axis, y_axis, z_axis] = [0, 1, 2].map(axis);
        FrameEntry { name, origin_mm: position_mm(&pose.translation), x_axis, y_axis, z_axis }
    };
    let frames = &e.context.frames;
    let links = frames.links[..=e.rows.len()].iter().enumerate();
    let links = links.map(|(k, pose)| (frame_name(MotionFrame::Link(k)), pose));
    links.chain([(frame_name(MotionFrame::Tcp), &frames.tcp)]).map(entry).collect()
}

impl ParameterEntry {
    fn new(e: &Explanation<'_>, line: &ParameterEffect) -> Self {
        let cell = e.context.cell;
        let unit = ParameterUnit::new(cell, line.source.parameter);
        let per_unit = |d: &Displacement| plain(&unit.effect_mm(&d.position));
        let term = line.term().turned(&e.context.situation.site.world.transpose());
        Self {
            parameter: names::parameter(cell, line.source.parameter),
            unit,
            value: unit.shown(line.value),
            signed: unit.shown(line.source.signed),
            plus_minus: unit.shown(line.source.plus_minus),
            standard_deviation: unit.shown(line.source.deviation),
            motions: line.motions.iter().map(MotionEntry::new).collect(),
            effect_base_mm_per_unit: per_unit(&line.alone),
            taken_off_base_mm_per_unit: per_unit(&(line.alone - line.left)),
            linear_term_mm: position_mm(&term.position),
            linear_term_deg: rotation_deg(&term.rotation),
        }
    }
}

impl MotionEntry {
    fn new(m: &ParameterMotion) -> Self {
        Self {
            kind: if m.turns { MotionKind::Turn } else { MotionKind::Slide },
            axis: AXES[m.axis].into(),
            frame: frame_name(m.place),
            factor: nine_digits(m.factor),
            axis_base: plain(&m.direction),
            lever_base_mm: position_mm(&m.lever),
        }
    }
}

impl DisplacementEntry {
    fn new(d: &Displacement) -> Self {
        Self {
            position_mm: position_mm(&d.position),
            size_mm: millimetres(d.position.norm()),
            rotation_deg: rotation_deg(&d.rotation),
        }
    }
}

impl PostureGuardEntry {
    fn new(e: &Explanation<'_>) -> Self {
        Self {
            threshold_percent: percent(e.context.cell.guard),
            linear_off_percent: percent(e.linear_off),
            second_order_off_percent: percent(e.second_order_off),
            off_percent: percent(e.off()),
            trusted: e.trusted(),
        }
    }
}

impl SenseRowEntry {
    fn new(e: &Explanation<'_>, row: &SenseRow) -> Self {
        Self {
            kind: if row.turns { SenseRowKind::Rotation } else { SenseRowKind::Position },
            direction_base: plain(&row.direction),
            value: in_unit(e.context.evaluator.sense.unit, row.value),
        }
    }
}

fn corner(e: &Explanation<'_>) -> Option<ByName<i8>> {
    let signs = e.lines.iter().zip(e.worst?.corner.signs());
    let sign = |(line, sign): (&ParameterEffect, f64)| {
        (names::parameter(e.context.cell, line.source.parameter), if sign < 0.0 { -1 } else { 1 })
    };
    Some(signs.map(sign).collect())
}
