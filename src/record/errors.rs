//! The document of `errors --json`.

use super::numbers::{degrees, joint_coordinate, millimetres, nine_digits, position_mm};
use super::parameter_names as names;
use super::parameter_unit::ParameterUnit;
use super::words::is_guess;
use crate::cell::{Distribution, Parameter, Robot, Spin};
use crate::pose_accuracy::{ErrorGuess, PoseAccuracy, TestCube};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `errors --json`.
pub const ERRORS_SCHEMA: &str = "sweetspot/errors/1";

/// Tolerances of a robot, with the pose accuracy (ISO 9283) that these tolerances give. Guessed tolerances
/// are not a measurement of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorsDocument {
    #[schemars(extend("const" = ERRORS_SCHEMA))]
    pub schema: String,
    pub robot: String,
    /// Name of the error set, as in the TOML table that `errors --toml` prints.
    pub name: String,
    /// True if the tolerances are guesses, either from a preset or from a data sheet. If false, the
    /// tolerances come from an error set of the robot.
    pub guess: bool,
    /// Description of the origin of the tolerances, as in the TOML table that `errors --toml` prints.
    pub source: String,
    pub origin: ErrorOrigin,
    /// Name of the preset, or of the error set of the robot.
    pub origin_name: String,
    /// Frame to which the accuracy refers.
    pub base: BaseChoice,
    /// Pose accuracy AP that the data sheet states; null if none is stated.
    pub wanted_ap_mm: Option<f64>,
    /// Pose repeatability RP that the data sheet states; null if none is stated.
    pub wanted_rp_mm: Option<f64>,
    /// Factor that multiplies the tolerances of the preset or of the robot's error set.
    pub scale: f64,
    /// Number of iterations that the program needs to find `scale`. Each iteration predicts the accuracy
    /// once.
    pub steps: usize,
    /// Predicted pose accuracy AP from the constant errors alone.
    pub ap: AccuracyQuantiles,
    /// Predicted pose accuracy AP from the tolerances in `parameters`. These tolerances include the random
    /// errors.
    pub ap_of_set: AccuracyQuantiles,
    /// Standard deviations of the joint coordinates: degrees, or mm for a prismatic joint. Together they
    /// cause the repeatability `wanted_rp_mm`. Null if `wanted_rp_mm` is null.
    pub joint_scatter: Option<Vec<f64>>,
    pub cube: TestCubeEntry,
    /// Tolerances that are not 0.
    pub parameters: Vec<SpreadEntry>,
}

/// Origin of the tolerances: an error set of the robot, or a preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorOrigin {
    /// Error set of the robot.
    Robot,
    /// Preset of a class of arms.
    Preset,
}

/// Frame to which a predicted accuracy refers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BaseChoice {
    /// The base frame is fitted to each simulated robot, at sampled postures between the joint limits.
    Fitted,
    /// The base frame is the nominal base frame.
    Nominal,
}

/// Quantiles of the pose accuracy AP of simulated robots, mm. The accuracy of one robot is the mean over five
/// poses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccuracyQuantiles {
    pub median_mm: f64,
    /// 5th percentile: 5 % of the robots are better.
    pub p5_mm: f64,
    /// 95th percentile: 95 % of the robots are better.
    pub p95_mm: f64,
    /// Median over all robots of the AP that each robot has at its worst pose.
    pub worst_pose_mm: f64,
}

/// Test cube of ISO 9283. Positions are in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestCubeEntry {
    pub edge_mm: f64,
    /// Whether ISO 9283 names a cube of this size.
    pub is_standard: bool,
    pub centre_mm: [f64; 3],
    /// Elevation of the tool axis.
    pub bend_deg: f64,
    /// Spin of the tool, equal at all five poses; null if the spin is free.
    pub spin_deg: Option<f64>,
    /// The poses P1 to P5.
    pub poses: Vec<TestPoseEntry>,
}

/// Pose in the test cube at which the accuracy is predicted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestPoseEntry {
    pub position_mm: [f64; 3],
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints: Vec<f64>,
    /// Median of the pose accuracy AP of all simulated robots at this pose.
    pub ap_mm: f64,
}

/// Tolerance of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpreadEntry {
    pub name: String,
    /// Half width of the tolerance, in `unit`.
    pub plus_minus: f64,
    /// Unit of the half width, for example mm or deg.
    pub unit: String,
    pub distribution: String,
    /// Half width as a number of standard deviations; null unless the distribution is normal.
    pub sigmas: Option<f64>,
}

impl AccuracyQuantiles {
    pub fn new(accuracy: &PoseAccuracy) -> Self {
        Self {
            median_mm: millimetres(accuracy.median),
            p5_mm: millimetres(accuracy.best),
            p95_mm: millimetres(accuracy.worst),
            worst_pose_mm: millimetres(accuracy.largest_pose),
        }
    }
}

impl TestCubeEntry {
    pub fn new(robot: &Robot, cube: &TestCube, accuracy: &PoseAccuracy) -> Self {
        let spin_deg = match &cube.attitude.spin {
            Spin::At(spins) => spins.first().copied().map(degrees),
            Spin::Free => None,
        };
        let poses = cube.poses.iter().zip(accuracy.poses).map(|(pose, ap)| TestPoseEntry {
            position_mm: position_mm(&pose.position),
            joints: in_joints(robot, &pose.joints),
            ap_mm: millimetres(ap),
        });
        Self {
            edge_mm: millimetres(cube.edge),
            is_standard: cube.is_standard,
            centre_mm: position_mm(&cube.centre),
            bend_deg: degrees(cube.attitude.elevation),
            spin_deg,
            poses: poses.collect(),
        }
    }
}

/// Request for a guessed error set. The request states the source of the tolerances, and the pose accuracy
/// and pose repeatability from the data sheet. It also states whether the accuracy refers to a fitted or the
/// nominal base frame.
pub struct GuessQuestion {
    pub origin: ErrorOrigin,
    pub origin_name: String,
    pub base: BaseChoice,
    /// Pose accuracy AP of the robot, from its data sheet, mm.
    pub ap_mm: Option<f64>,
    /// Pose repeatability RP of the robot, from its data sheet, mm.
    pub rp_mm: Option<f64>,
}

impl ErrorsDocument {
    /// Makes the document of an error set from its tolerances (`guess`), its name and its source. `total` is
    /// the pose accuracy that constant and random errors together give.
    pub fn new(
        robot: &Robot,
        question: &GuessQuestion,
        (guess, total): (&ErrorGuess, &PoseAccuracy),
        cube: &TestCube,
        (name, source): (String, String),
    ) -> Self {
        let spreads =
            Parameter::of_robot(robot.axes()).zip(&guess.spreads).filter(|(_, s)| s.plus_minus > 0.0);
        let parameters = spreads.map(|(parameter, spread)| {
            let unit = ParameterUnit::of_robot(robot, parameter);
            SpreadEntry {
                name: names::of_robot(robot, parameter),
                plus_minus: unit.shown(spread.plus_minus),
                unit: unit.word().into(),
                distribution: spread.distribution.name().into(),
                sigmas: (spread.distribution == Distribution::Normal).then_some(spread.sigmas),
            }
        });
        let is_own = question.origin == ErrorOrigin::Robot && question.ap_mm.is_none();
        Self {
            schema: ERRORS_SCHEMA.into(),
            robot: robot.name.clone(),
            name,
            guess: is_guess(&question.origin_name) || !(is_own && question.rp_mm.is_none()),
            source,
            origin: question.origin,
            origin_name: question.origin_name.clone(),
            base: question.base,
            wanted_ap_mm: question.ap_mm,
            wanted_rp_mm: question.rp_mm,
            scale: nine_digits(guess.scale),
            steps: guess.steps,
            ap: AccuracyQuantiles::new(&guess.accuracy),
            ap_of_set: AccuracyQuantiles::new(total),
            joint_scatter: guess.scatter.as_ref().map(|scatter| in_joints(robot, scatter)),
            cube: TestCubeEntry::new(robot, cube, &guess.accuracy),
            parameters: parameters.collect(),
        }
    }
}

/// Returns joint coordinates in degrees, or in mm for prismatic joints.
fn in_joints(robot: &Robot, q: &[f64]) -> Vec<f64> {
    robot.joints.iter().zip(q).map(|(joint, q)| joint_coordinate(joint.kind, *q)).collect()
}
