//! Keys of the error sets of a robot, and of the errors of equipment.

use super::constraints::POSTURE;
use super::costs;
use super::key::*;
use super::parts::*;
use crate::cell::{Distribution, MAX_JOINTS, PER_FRAME, Spread};

/// Meaning of the numbers of an error set: signed errors or tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorForm {
    /// Errors of one robot, with their signs.
    Signed,
    /// Plus-or-minus values: half widths of the ranges of the errors.
    Tolerance,
}

impl ErrorForm {
    pub const ALL: [Self; 2] = [Self::Signed, Self::Tolerance];

    pub fn name(self) -> &'static str {
        match self {
            Self::Signed => "signed",
            Self::Tolerance => "tolerance",
        }
    }
}

words!(ErrorForm);

/// Meaning of the numbers of an error set of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorSetForm {
    Plain(ErrorForm),
    /// Errors of one robot with their signs, and a covariance that states their uncertainty.
    Measured,
}

impl ErrorSetForm {
    pub const ALL: [Self; 3] =
        [Self::Plain(ErrorForm::Signed), Self::Plain(ErrorForm::Tolerance), Self::Measured];

    pub fn name(self) -> &'static str {
        match self {
            Self::Plain(form) => form.name(),
            Self::Measured => "measured",
        }
    }

    /// Returns the form of the numbers in the lists of the set. Measured errors are signed numbers.
    pub fn of_lists(self) -> ErrorForm {
        match self {
            Self::Plain(form) => form,
            Self::Measured => ErrorForm::Signed,
        }
    }
}

words!(ErrorSetForm);

const FORM: Key = word::<ErrorForm>(
    "kind",
    "signed: errors of one robot, with their signs; tolerance: plus-or-minus values for all robots of a series.",
)
.required();

const FORM_OF_SET: Key = word::<ErrorSetForm>(
    "kind",
    "signed: errors of one robot, with their signs; tolerance: plus-or-minus values for all robots of a series; measured: errors of one robot from a calibration, with their signs and a covariance that states their uncertainty.",
)
.required();

const SIGMAS: Key = number(
    "sigmas",
    NumberRange::Positive,
    "Number of standard deviations in the plus-or-minus value of a normal distribution.",
)
.default(Literal::Number(Spread::SIGMAS));

/// Distributions of one D-H error, such as dq: one word for all joints, or a list with one word for each
/// joint.
const BY_JOINT: ValueKind = ValueKind::Either(&[SPREAD, ValueKind::List(&SPREAD, (1, MAX_JOINTS), "words")]);

/// Distributions of a frame error: one word, or a list with one word for each of the six components.
const BY_COMPONENT: ValueKind =
    ValueKind::Either(&[SPREAD, ValueKind::List(&SPREAD, (PER_FRAME, PER_FRAME), "words")]);

const SPREAD: ValueKind = ValueKind::word::<Distribution>();

/// Returns the key of one error of the D-H rows, such as dr. The key holds a list with one number for each
/// joint.
const fn row(name: &'static str, help: &'static str) -> Key {
    Key::new(name, POSTURE, help).required_unless("joints")
}

key_table! {
    frame_error, "a frame error", "Error of a frame: the erroneous frame is the nominal frame times Trans(position_mm) Rz Ry Rx.", {
        POSITION = vector_or_zero("position_mm", "Errors along x, y and z.");
        ROTATION = vector_or_zero("rotation_deg", "Errors about x, y and z: after the translation, the frame is rotated about its z axis, then about its new y axis, then about its new x axis.");
    }
}

key_table! {
    joint_frame_error, "a frame error of `joints`", "Error of the frame of one joint: the erroneous frame is the nominal frame times Trans(position_mm) Rz Ry Rx.", {
        JOINT = Key::new("joint", ValueKind::Either(&[ValueKind::Whole(1, MAX_JOINTS as u64), ValueKind::Text]), "Joint, by its number (counted from 1) or by its name.").required().example("1").remedy("add joint = 1, the number or the name of the joint");
    }
    extends super::frame_error::TABLE;
}

key_table! {
    elastic_term, "an elastic term", "Deflection of a joint under the weight of everything at and beyond the end of a link. The deflection is deg_per_m times the horizontal lever of this link about the joint axis, in m.", {
        JOINT = Key::new("joint", ValueKind::Either(&[ValueKind::Whole(1, MAX_JOINTS as u64), ValueKind::Text]), "Number (counted from 1) or name of the revolute joint that deflects.").required().example("2").remedy("add joint = 2, the number or the name of the joint that deflects");
        LINK = Key::new("link", ValueKind::Whole(1, MAX_JOINTS as u64), "Number of the D-H row of the link whose horizontal lever is used: the row of the joint or a later row. The link extends from the frame before this row to the frame after it.").required().example("3").remedy("add link = 3, the number of the D-H row of the link");
        VALUE = number("deg_per_m", NumberRange::Finite, "Deflection per unit length of the lever: the compliance of the joint times the weight at and beyond the end of the link.").required().example("-0.05").remedy("add deg_per_m = -0.05");
    }
}

/// Largest order of a periodic error.
const MAX_ORDER: usize = 64;

/// Returns the key of a list of coefficients, one for each order.
const fn coefficients(name: &'static str, example: &'static str, help: &'static str) -> Key {
    Key::new(name, ValueKind::List(&FINITE, (1, MAX_ORDER), "numbers"), help).required().example(example)
}

key_table! {
    periodic_error, "a periodic error", "Error of a joint that repeats with every turn of its coordinate q: the sum of cos_deg cos(k q) and sin_deg sin(k q) over the orders k = 1, 2, ...", {
        JOINT = Key::new("joint", ValueKind::Either(&[ValueKind::Whole(1, MAX_JOINTS as u64), ValueKind::Text]), "Number (counted from 1) or name of the revolute joint with this error.").required().example("2").remedy("add joint = 2, the number or the name of the joint");
        COS = coefficients("cos_deg", "[0.004, 0]", "Coefficients of the cosines, one for each order, starting at order 1.").remedy("add cos_deg = [...], a number for each order");
        SIN = coefficients("sin_deg", "[0, -0.01]", "Coefficients of the sines, one for each order, starting at order 1.").remedy("add sin_deg = [...], a number for each order");
    }
}

key_table! {
    distribution, "`distribution`", "Distributions of the plus-or-minus values of the D-H rows and the frames.", {
        DEFAULT = word::<Distribution>("default", "Distribution of the errors for which this table has no key.").default(Literal::Word(Distribution::Normal.name()));
        DQ = Key::new("dq", BY_JOINT, "Distribution of dq_deg and dq_mm: one word, or a list with one word for each joint.");
        DR = Key::new("dr", BY_JOINT, "Distribution of dr_mm: one word, or a list with one word for each joint.");
        DL = Key::new("dl", BY_JOINT, "Distribution of dl_mm: one word, or a list with one word for each joint.");
        DALPHA = Key::new("dalpha", BY_JOINT, "Distribution of dalpha_deg: one word, or a list with one word for each joint.");
        DBETA = Key::new("dbeta", BY_JOINT, "Distribution of dbeta_deg: one word, or a list with one word for each joint.");
        BASE = Key::new("base", BY_COMPONENT, "Distribution of the errors of the base frame: one word, or six words for x, y, z and the rotations about these axes.");
        TOOL = Key::new("tool", BY_COMPONENT, "Distribution of the errors of the TCP: one word, or six words for x, y, z and the rotations about these axes.");
        JOINTS = Key::new("joints", BY_COMPONENT, "Distribution of the errors of every joint frame: one word, or six words for x, y, z and the rotations about these axes.");
        ELASTIC = word::<Distribution>("elastic", "Distribution of all elastic terms.");
        COMPLIANCE = Key::new("compliance", BY_JOINT, "Distribution of compliance_deg_per_Nm: one word, or a list with one word for each joint.");
    }
}

/// Help text that lists the names of the parameters of a covariance.
pub const PARAMETERS: &str = "write a name such as dl2 (dq, dr, dl, dalpha or dbeta of a joint), tool rx (x, y, z, rx, ry or rz of base, tool or joint2), elastic 2 3 (joint and link) or compliance 2 (joint)";

key_table! {
    covariance, "`covariance`", "Covariance from a calibration. The named parameters are normally distributed and correlated. In a set of tolerances, these parameters must have plus-or-minus values of 0.", {
        PARAMETERS = Key::new("parameters", ValueKind::Checked(&ValueKind::List(&ValueKind::Text, (1, UNBOUNDED), "names"), unique), "Parameters of the matrix rows: dq, dr, dl, dalpha or dbeta with a joint number (dl2), a frame (base, tool, joint2) with x, y, z, rx, ry or rz (joint2 x), elastic with a joint and a link (elastic 2 3), or compliance with a joint (compliance 2).").required().example("[\"dl2\", \"dalpha3\", \"base x\"]").remedy("add parameters = [\"dq1\", \"dl2\"], the parameters of the matrix rows");
        MATRIX = Key::new("matrix", ValueKind::List(&ValueKind::List(&FINITE, (1, UNBOUNDED), "numbers"), (1, UNBOUNDED), "rows"), "Covariances, one row for each of the parameters. Their units are products of mm, degrees, degrees per m and degrees per N m.").required().example("[[0.25, 0.1], [0.1, 4]]").remedy("add matrix = [[...], ...], a row for each of `parameters`");
    }
}

key_table! {
    error_set, "an error set", "Errors of the robot: one signed sample, tolerances, or measured errors.", {
        SOURCE = super::SOURCE.required().example("").remedy("add source = \"...\"");
        FORM = super::FORM_OF_SET;
        DQ_DEG = Key::new("dq_deg", POSTURE, "Errors of the coordinates of revolute joints: one for each joint, 0 for a prismatic joint.");
        DQ_MM = Key::new("dq_mm", POSTURE, "Errors of the coordinates of prismatic joints: one for each joint, 0 for a revolute joint.");
        DR = row("dr_mm", "Errors of the axial offsets r: one for each joint.");
        DL = row("dl_mm", "Errors of the common normals l: one for each joint.");
        DALPHA = row("dalpha_deg", "Errors of the twists alpha: one for each joint.");
        DBETA = Key::new("dbeta_deg", POSTURE, "Errors of the fifth parameter (Hayati), for parallel axes: one for each joint. Each error is a rotation about y after Tx(l) Rx(alpha) of the row. The error of the next joint frame comes after this rotation.");
        BASE = table("base", &frame_error::TABLE, "Error of the base frame.");
        TOOL = table("tool", &frame_error::TABLE, "Error of the TCP.");
        JOINTS = Key::new("joints", ValueKind::List(&ValueKind::Table(&joint_frame_error::TABLE), (0, MAX_JOINTS), "frame errors"), "Errors of joint frames. Each error moves its joint and everything after the joint. The frame is the D-H frame before a standard row, the frame after Tx(l) Rx(alpha) of a modified row, or the origin frame of a URDF joint.").example("[{ joint = 1, rotation_deg = [0, 0, 0.1] }]");
        ELASTIC = Key::new("elastic", ValueKind::List(&ValueKind::Table(&elastic_term::TABLE), (0, UNBOUNDED), "elastic terms"), "Deflections of joints by gravity, as identified by a calibration; each deflection depends on the posture.").example("[{ joint = 2, link = 3, deg_per_m = -0.05 }]");
        COMPLIANCE = Key::new("compliance_deg_per_Nm", POSTURE, "Compliances of the joints: the deflection per torque that the weights of links, tool and held part exert; one for each joint, 0 for a prismatic joint.");
        PERIODIC = Key::new("periodic", ValueKind::List(&ValueKind::Table(&periodic_error::TABLE), (0, MAX_JOINTS), "periodic errors"), "Periodic errors of joints, as identified by a calibration; for robots without joint coupling.").example("[{ joint = 1, cos_deg = [0.004, 0], sin_deg = [0, -0.01] }]");
        DISTRIBUTION = Key::new("distribution", ValueKind::Either(&[SPREAD, ValueKind::Table(&distribution::TABLE)]), "Distribution of the plus-or-minus values: one word for all, or a table with words for rows and frames.").default(Literal::Word(Distribution::Normal.name()));
        SIGMAS = super::SIGMAS;
        COVARIANCE = table("covariance", &covariance::TABLE, "Covariance from a calibration.");
        COST = costs::COST;
        RANGES = Key::new("measured_ranges", ValueKind::List(&ValueKind::List(&FINITE, (2, 2), "numbers"), (1, MAX_JOINTS), "ranges"), "Least and largest coordinate of every joint among the measured postures, degrees or mm. `map` and `search` warn about nodes whose joint coordinates lie outside these ranges.").example("[[-90, 90], [-120, -30]]");
    }
    rules [
        Rule::When { key: "kind", words: signed, needs: &[], never: &["distribution", "sigmas", "covariance", "cost", "measured_ranges"] },
        Rule::When { key: "kind", words: tolerance, needs: &[], never: &["measured_ranges", "periodic"] },
        Rule::When { key: "kind", words: measured, needs: &[], never: &["distribution", "cost"] },
        Rule::NotNegativeWhen("kind", "tolerance"),
    ];
}

key_table! {
    errors_of_equipment, "`errors`", "Errors of the placement or the fixture of a piece of equipment, in its frame.", {
        FORM = super::FORM;
        DISTRIBUTION = Key::new("distribution", BY_COMPONENT, "Distribution of the errors: one word, or six words for x, y, z and the rotations about these axes.").default(Literal::Word(Distribution::Normal.name()));
        SIGMAS = super::SIGMAS;
        COST = costs::COST;
    }
    extends super::frame_error::TABLE;
    rules [
        Rule::When { key: "kind", words: signed, needs: &[], never: &["distribution", "sigmas", "cost"] },
        Rule::NotNegativeWhen("kind", "tolerance"),
    ];
    refused [Refused {
        name: "covariance",
        message: "the errors of equipment cannot have `covariance`",
        remedy: "give the plus-or-minus values in position_mm and rotation_deg",
    }];
}

fn measured() -> Vec<String> {
    vec![ErrorSetForm::Measured.name().to_string()]
}

fn tolerance() -> Vec<String> {
    vec![ErrorForm::Tolerance.name().to_string()]
}

fn signed() -> Vec<String> {
    vec![ErrorForm::Signed.name().to_string()]
}
