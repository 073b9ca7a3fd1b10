//! The document of `calibrate --json`.

use super::numbers::{degrees, millimetres, nine_digits};
use crate::calibration::{
    Accuracy, Calibration, Deformed, FittedSession, Identified, MeasuringSession, ResidualVariances, Unknown,
    aligned,
};
use crate::cell::{Convention, Joint, JointKind, Parameter, Robot, SignedErrors};
use crate::robot::Chain;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `calibrate --json`.
pub const CALIBRATION_SCHEMA: &str = "sweetspot/calibration/1";

/// A parameter of an undetermined combination is named if its share in the combination is above this value.
const NAMED_SHARE: f64 = 0.3;

/// Kinematic errors of a robot, identified from measured positions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibrationDocument {
    #[schemars(extend("const" = CALIBRATION_SCHEMA))]
    pub schema: String,
    pub robot: String,
    /// Files from which the parameters are identified.
    pub sessions: Vec<CalibratedFile>,
    /// Files that test the parameters, but do not serve to identify them. Base and reflectors are fitted to
    /// each file.
    pub tests: Vec<TestedFile>,
    /// Errors of predictions for blocks of the joint space that were left out of the fit. Null if the data do
    /// not allow such a fit.
    pub held_out: Option<AccuracyEntry>,
    pub parameters: Vec<IdentifiedParameter>,
    /// Periodic errors of the joints; empty if none were requested.
    #[serde(default)]
    pub harmonics: Vec<HarmonicsEntry>,
    /// Number of combinations of parameters that the data determine. After the fit, the standard deviation of
    /// such a combination is less than half its prior standard deviation.
    pub rank: usize,
    /// Combinations of parameters that the data do not determine.
    pub unidentified: Vec<String>,
    /// Residual standard deviation per axis, mm. Null if a file states the parameters.
    pub residual_mm: Option<f64>,
    /// Errors that the parameters do not explain. Null if a file states the parameters.
    pub misfit: Option<MisfitEntry>,
    /// Time of the fit and of the cross-validation, s.
    pub seconds: f64,
}

/// Standard deviations of the errors that the parameters do not explain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MisfitEntry {
    /// Standard deviation of the error of every joint: degrees, or mm for a prismatic joint.
    pub joints: Vec<f64>,
    /// Standard deviation per axis of the unexplained position error that no joint causes, mm.
    pub position_mm: f64,
}

/// Outlier: measured position that is more than six standard deviations from the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutlierRow {
    /// Line of the file, counted from 1.
    pub row: usize,
    /// Distance between the measured and the predicted position, mm.
    pub distance_mm: f64,
}

/// File of measured positions from which the parameters are identified.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibratedFile {
    pub file: String,
    /// Number of measured positions.
    pub poses: usize,
    /// Distances of the measured positions from the positions of the nominal robot, after base and reflectors
    /// are fitted.
    pub before: AccuracyEntry,
    /// Distances of the measured positions from the positions of the calibrated robot, after base and
    /// reflectors are fitted.
    pub after: AccuracyEntry,
    /// Rows whose measured position is more than six standard deviations from the prediction.
    pub outliers: Vec<OutlierRow>,
}

/// File of measured positions that serve to test the parameters, but not to identify them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestedFile {
    pub file: String,
    /// Number of measured positions.
    pub poses: usize,
    /// Distances of the measured positions from the positions of the nominal robot, after base and reflectors
    /// are fitted.
    pub before: AccuracyEntry,
    /// Distances of the measured positions from the positions of the calibrated robot, after base and
    /// reflectors are fitted.
    pub after: AccuracyEntry,
    /// Share of the positions inside their predicted 95 % ellipsoids.
    pub coverage_95: f64,
    /// Rows whose measured position is more than six standard deviations from the prediction.
    pub outliers: Vec<OutlierRow>,
}

/// Statistics of position errors, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccuracyEntry {
    pub mean_mm: f64,
    pub rms_mm: f64,
    pub p95_mm: f64,
    pub max_mm: f64,
}

/// Identified parameter of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IdentifiedParameter {
    /// Name such as dq2 or dl3, or "q2 carries link 3" for an elastic term.
    pub name: String,
    pub value: f64,
    /// Unit of the values: mm, deg, or deg/m for an elastic term.
    pub unit: String,
    /// Standard deviation before the measurement. Null if a file states the parameter.
    pub prior: Option<f64>,
    /// Standard deviation after the measurement. Null if a file states the parameter.
    pub sigma: Option<f64>,
    /// Whether `sigma` is less than half of `prior`. True if a file states the parameter.
    pub identified: bool,
}

impl AccuracyEntry {
    pub fn new(accuracy: &Accuracy) -> Self {
        Self {
            mean_mm: millimetres(accuracy.mean),
            rms_mm: millimetres(accuracy.rms),
            p95_mm: millimetres(accuracy.p95),
            max_mm: millimetres(accuracy.max),
        }
    }
}

impl CalibratedFile {
    /// Makes the entry of a session from which the parameters are identified. Returns None if the session is
    /// empty or does not determine base and reflectors.
    pub fn new(chain: &Chain, session: &MeasuringSession, fitted: &FittedSession) -> Option<Self> {
        Some(Self {
            file: session.name.clone(),
            poses: session.measured.len(),
            before: nominal(chain, session)?,
            after: AccuracyEntry::new(&Accuracy::of(fitted.distances.clone())?),
            outliers: OutlierRow::of(fitted),
        })
    }
}

impl TestedFile {
    /// Makes the entry of a session that tests the parameters, but does not serve to identify them. Returns
    /// None if the session is empty or does not determine base and reflectors.
    pub fn new(chain: &Chain, session: &MeasuringSession, calibration: &Calibration) -> Option<Self> {
        let (fitted, coverage_95) = calibration.tested(&session.measured)?;
        Some(Self {
            file: session.name.clone(),
            poses: session.measured.len(),
            before: nominal(chain, session)?,
            outliers: OutlierRow::of(&fitted),
            after: AccuracyEntry::new(&Accuracy::of(fitted.distances)?),
            coverage_95,
        })
    }
}

/// Returns statistics of the distances between measured positions and positions of the nominal robot. Base
/// and reflectors are fitted first.
fn nominal(chain: &Chain, session: &MeasuringSession) -> Option<AccuracyEntry> {
    let poses: Vec<_> = session.measured.iter().map(|m| Deformed::new(chain, &m.joints, &[], &[])).collect();
    let frames = aligned(&poses, &session.measured)?;
    let distances = poses.iter().zip(&session.measured);
    let distances = distances.map(|(pose, m)| frames.residual(&pose.interface, m).norm()).collect();
    Accuracy::of(distances).as_ref().map(AccuracyEntry::new)
}

impl OutlierRow {
    /// Returns the outliers of a session.
    pub fn of(session: &FittedSession) -> Vec<Self> {
        let entry = |&(row, distance): &(usize, f64)| Self { row, distance_mm: millimetres(distance) };
        session.outliers.iter().map(entry).collect()
    }
}

/// Periodic error of one joint: the sum of `cos_deg[k] cos((k + 1) q)` and `sin_deg[k] sin((k + 1) q)` over
/// all k.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HarmonicsEntry {
    pub joint: String,
    /// Prior standard deviation of the coefficients of the highest order. The fit estimates this value
    /// together with the coefficients. All orders above 4 have equal prior standard deviations. The orders 1
    /// to 4 have twice the prior standard deviation of the higher orders.
    pub prior_deg: f64,
    /// Root mean square of the identified error over one revolution of the joint.
    pub rms_deg: f64,
    pub cos_deg: Vec<f64>,
    pub sin_deg: Vec<f64>,
}

impl HarmonicsEntry {
    fn of(robot: &Robot, calibration: &Calibration) -> Vec<Self> {
        let of_joint = |(k, joint): (usize, &Joint)| {
            let prior_deg = degrees(calibration.harmonics_of(k).last()?.prior);
            let values = |wanted: bool| -> Vec<f64> {
                let all = calibration.harmonics_of(k);
                let own =
                    all.filter(|i| matches!(i.unknown, Unknown::Harmonic { sine, .. } if sine == wanted));
                own.map(|i| degrees(i.value)).collect()
            };
            let squares: f64 = calibration.harmonics_of(k).map(|i| i.value.powi(2)).sum();
            let rms_deg = degrees((squares / 2.0).sqrt());
            Some(Self {
                joint: joint.name.clone(),
                prior_deg,
                rms_deg,
                cos_deg: values(false),
                sin_deg: values(true),
            })
        };
        robot.joints.iter().enumerate().filter_map(of_joint).collect()
    }
}

impl MisfitEntry {
    fn new(robot: &Robot, misfit: &ResidualVariances) -> Self {
        let deviation = |(variance, kind): (&f64, JointKind)| match kind {
            JointKind::Revolute => degrees(variance.sqrt()),
            JointKind::Prismatic => millimetres(variance.sqrt()),
        };
        let joints = misfit.joints.iter().zip(robot.joints.iter().map(|joint| joint.kind));
        Self { joints: joints.map(deviation).collect(), position_mm: millimetres(misfit.position.sqrt()) }
    }
}

impl IdentifiedParameter {
    fn new(robot: &Robot, identified: &Identified) -> Self {
        let is_length = match identified.unknown {
            Unknown::Row(Parameter::Dr(_) | Parameter::Dl(_)) => true,
            Unknown::Row(Parameter::Dq(i)) => robot.joints[i].kind == JointKind::Prismatic,
            _ => false,
        };
        let shown = if is_length { millimetres } else { degrees };
        let unit = match identified.unknown {
            Unknown::Elastic { .. } => "deg/m",
            _ if is_length => "mm",
            _ => "deg",
        };
        Self {
            name: unknown_name(robot, identified.unknown),
            value: shown(identified.value),
            unit: unit.into(),
            prior: Some(shown(identified.prior)),
            sigma: Some(shown(identified.sigma)),
            identified: identified.is_identified(),
        }
    }
}

/// Returns the name of an unknown. Row numbers start at 1 and refer to the rows of the robot file.
fn unknown_name(robot: &Robot, unknown: Unknown) -> String {
    let modified = robot.convention == Convention::Modified;
    match unknown {
        // The common normal at the end of a standard row begins the next modified row.
        Unknown::Row(Parameter::Dl(i)) if modified => Parameter::Dl(i + 1).name(),
        Unknown::Row(Parameter::Dalpha(i)) if modified => Parameter::Dalpha(i + 1).name(),
        Unknown::Row(Parameter::Dbeta(i)) if modified => Parameter::Dbeta(i + 1).name(),
        Unknown::Row(parameter) => parameter.name(),
        Unknown::Elastic { joint, link } => format!("q{} carries link {}", joint + 1, link + 1),
        Unknown::Harmonic { joint, order, sine } => {
            format!("q{} {} {order}", joint + 1, if sine { "sin" } else { "cos" })
        }
    }
}

impl CalibrationDocument {
    /// Returns the document of errors (m and rad) that a file states. The standard deviations in the document
    /// are null, and the list of sessions is empty.
    pub fn stated(robot: &Robot, errors: &SignedErrors) -> Self {
        let values = Parameter::of_robot(robot.axes()).zip(errors.values());
        let parameters = values.filter(|(_, value)| *value != 0.0).map(|(parameter, value)| {
            let is_length = match parameter {
                Parameter::Dr(_) | Parameter::Dl(_) => true,
                Parameter::Dq(i) => robot.joints[i].kind == JointKind::Prismatic,
                Parameter::Base(c) | Parameter::Tool(c) | Parameter::Joint(_, c) => c < 3,
                _ => false,
            };
            IdentifiedParameter {
                name: parameter.name(),
                value: if is_length { millimetres(value) } else { degrees(value) },
                unit: if is_length { "mm" } else { "deg" }.into(),
                prior: None,
                sigma: None,
                identified: true,
            }
        });
        let parameters: Vec<_> = parameters.collect();
        Self {
            schema: CALIBRATION_SCHEMA.into(),
            robot: robot.name.clone(),
            sessions: Vec::new(),
            tests: Vec::new(),
            held_out: None,
            rank: parameters.len(),
            unidentified: vec!["the covariance, which the file does not state".into()],
            parameters,
            harmonics: Vec::new(),
            residual_mm: None,
            misfit: None,
            seconds: 0.0,
        }
    }

    pub fn new(
        robot: &Robot,
        calibration: &Calibration,
        sessions: Vec<CalibratedFile>,
        tests: Vec<TestedFile>,
        seconds: f64,
    ) -> Self {
        let parameters: Vec<_> =
            calibration.parameters().iter().map(|i| IdentifiedParameter::new(robot, i)).collect();
        let unidentified = calibration.unidentified.iter().map(|direction| {
            let mut shares: Vec<_> = direction.iter().zip(&parameters).collect();
            shares.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
            let named = shares.iter().filter(|(share, _)| share.abs() > NAMED_SHARE);
            let names: Vec<_> = named.map(|(_, parameter)| parameter.name.as_str()).collect();
            match names[..] {
                [] => "a combination of many parameters".into(),
                [one] => one.to_string(),
                _ => format!("a combination of {}", names.join(", ")),
            }
        });
        Self {
            schema: CALIBRATION_SCHEMA.into(),
            robot: robot.name.clone(),
            sessions,
            tests,
            held_out: calibration.held_out.as_ref().map(AccuracyEntry::new),
            rank: calibration.rank,
            unidentified: unidentified.collect(),
            parameters,
            harmonics: HarmonicsEntry::of(robot, calibration),
            residual_mm: Some(millimetres(calibration.residual)),
            misfit: Some(MisfitEntry::new(robot, &calibration.misfit)),
            seconds: nine_digits(seconds),
        }
    }
}
