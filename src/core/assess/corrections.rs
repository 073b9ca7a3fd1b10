//! Corrections of a cell's programme: the commands with which the TCP lands on each target despite the
//! errors.

use super::posture_context::{NodeChoice, PostureContext};
use crate::cell::{
    Attitude, Azimuth, Cell, ErrorSet, FrameErrors, JointVector, Model, Parameter, Spin, tool_columns,
};
use crate::correction::{Correction, corrected};
use crate::error_map::OperationMap;
use crate::layout::Workcell;
use crate::pose::{Displacement, Pose};
use crate::reach::{Branch, Reach};
use crate::reading::{ErrorEvaluator, PreparedSample, WorkContext};
use crate::robot::Chain;
use nalgebra::{Matrix3, Vector3};

/// User-specified target of the TCP.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedTarget {
    pub name: String,
    /// Position of the TCP in the base frame, m.
    pub position: Vector3<f64>,
    /// Orientation of the TCP in the base frame; None if the attitude of the operation applies.
    pub rotation: Option<Matrix3<f64>>,
}

/// Target with the corrected joint coordinates, at which the robot with errors reaches the target.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectedTarget {
    /// Pose that the TCP is to attain, base frame.
    pub target: Pose,
    /// Joint coordinates of the nominal robot at the target, rad or m.
    pub nominal: JointVector,
    /// Error of the uncorrected robot: displacement from the target to the attained pose, base frame.
    pub before: Displacement,
    pub correction: Correction,
    /// Root mean square of the random position error (m) and rotation error (rad) that no correction removes.
    /// None means that the errors have no random part.
    pub random: Option<(f64, f64)>,
}

/// Corrector of the errors of one operation in one layout.
pub struct OperationCorrector<'a> {
    workcell: &'a Workcell,
    operation: usize,
    chain: Chain,
    evaluator: &'a ErrorEvaluator,
    sample: PreparedSample,
}

impl<'a> OperationCorrector<'a> {
    /// Prepares the correction of one operation. Returns None if no value of an error is known, or if all
    /// known values are 0. The errors of robot and equipment are both taken into account.
    ///
    /// A tolerance does not state the actual value of an error, so no correction can be computed.
    pub fn new(workcell: &'a Workcell, operation: usize) -> Option<Self> {
        let evaluator = workcell.evaluator(operation);
        let values = evaluator.sources.signed();
        if values.iter().all(|value| *value == 0.0) {
            return None;
        }
        let chain = Chain::with_margins(&workcell.cell.robot, &workcell.cell.margins);
        let sample = evaluator.propagation().sample(&values, Model::Nonlinear);
        Some(Self { workcell, operation, chain, evaluator, sample })
    }

    /// Corrects the posture at a node of the operation's map.
    ///
    /// # Errors
    /// Returns the reason if the node has no usable posture.
    pub fn node(&self, maps: &[OperationMap], at: NodeChoice) -> Result<CorrectedTarget, String> {
        let layout = self.workcell.cell.start();
        let context = PostureContext::at(self.workcell, &layout, maps, self.operation, at);
        let context = context.map_err(|why| why.in_words())?;
        Ok(self.corrected(&context.joints, &context.frames.tcp, context.situation))
    }

    /// Returns the [`WorkContext`] for targets that are not nodes of the map. Together with a posture, this
    /// context determines the error.
    ///
    /// # Errors
    /// Returns the reason if the taught frame cannot be computed. If the operation places a picked part, also
    /// returns the reason if the posture at the pick cannot be computed.
    pub fn context(&self) -> Result<WorkContext, String> {
        let cell = &self.workcell.cell;
        let home = cell.robot.home;
        PostureContext::of_joints(cell, Ok(self.workcell), self.operation, home).map(|c| c.situation)
    }

    /// Corrects a target that is not a node of the map. Collisions are not checked.
    ///
    /// # Errors
    /// Returns the reason if the nominal robot does not reach the target.
    pub fn target(&self, stated: &StatedTarget, context: &WorkContext) -> Result<CorrectedTarget, String> {
        let joints = self.nominal(stated)?;
        let held = || self.chain.forward(&self.chain.posture(&joints)).rotation;
        let rotation = stated.rotation.unwrap_or_else(held);
        let target = Pose { rotation, translation: stated.position };
        Ok(self.corrected(&joints, &target, context.clone()))
    }

    fn corrected(&self, nominal: &JointVector, target: &Pose, mut context: WorkContext) -> CorrectedTarget {
        // The pick is corrected separately, so the error of the placing must not include the error of the
        // pick.
        context.reference = None;
        let propagation = self.evaluator.propagation();
        let error = |frames: &_| propagation.error(&context, frames, &self.sample, Model::Nonlinear);
        let before = error(&self.chain.frames(&self.chain.posture(nominal)));
        let correction = corrected(&self.chain, nominal, target, error);
        let random = self.random(&context, &correction.joints);
        CorrectedTarget { target: *target, nominal: *nominal, before, correction, random }
    }

    /// Returns the root mean squares of the random position error (m) and the random rotation error (rad) at
    /// `joints`, to first order. Returns None if no error is random.
    fn random(&self, context: &WorkContext, joints: &JointVector) -> Option<(f64, f64)> {
        let (cell, sources) = (&self.workcell.cell, &self.evaluator.sources);
        let factors = sources.independent().into_iter();
        let random: Vec<_> =
            factors.filter(|f| f.iter().all(|(k, _)| is_random(cell, sources.list[*k].parameter))).collect();
        if random.is_empty() {
            return None;
        }
        let mut memory = self.evaluator.memory();
        self.evaluator.prepare(context, &self.chain.frames(&self.chain.posture(joints)), &mut memory);
        let columns = &memory.effects().columns;
        let moved = random.iter().map(|factor| {
            factor.iter().fold(Displacement::NONE, |sum, &(k, value)| sum + columns[k] * value)
        });
        let (position, rotation) = moved.fold((0.0, 0.0), |(position, rotation), d| {
            (position + d.position.norm_squared(), rotation + d.rotation.norm_squared())
        });
        Some((position.sqrt(), rotation.sqrt()))
    }

    /// Returns joint coordinates at which the TCP of the nominal robot is at a target. If the arm cannot
    /// reach a stated orientation, only the elevation of that orientation is kept.
    fn nominal(&self, stated: &StatedTarget) -> Result<JointVector, String> {
        let (cell, inverse) = (&self.workcell.cell, self.workcell.inverse());
        let layout = cell.start();
        let at = layout.placements[cell.operations[self.operation].equipment];
        let attitudes = match &stated.rotation {
            None => vec![(layout.attitudes[self.operation].clone(), at.yaw - layout.base.yaw)],
            // An arm with fewer than six joints may reach the target only with another azimuth or spin.
            Some(rotation) => {
                let held = attitude_of(&(rotation * tool_columns(&cell.robot.tool_axis)));
                let free = Attitude::elevation(held.elevation);
                vec![(held, 0.0), (free, 0.0)]
            }
        };
        let mut why = String::new();
        for (attitude, yaw) in &attitudes {
            if let Some(refusal) = inverse.refusal(attitude) {
                why = refusal;
                continue;
            }
            match inverse.branches(&stated.position, &inverse.tool_attitudes(attitude, *yaw)) {
                Reach::Branches(all) => match nearest(&all, &cell.robot.home) {
                    Some(joints) => return Ok(joints),
                    None => why = "every posture exceeds a joint limit".into(),
                },
                Reach::OutOfReach { .. } => why = "out of reach".into(),
                Reach::Attitude { .. } => why = "the attitude cannot be reached".into(),
                Reach::NotConverged { .. } => why = "no posture was found, but one may exist".into(),
            }
        }
        Err(why)
    }
}

/// Returns the usable branch nearest to `home`.
fn nearest(branches: &[Branch], home: &JointVector) -> Option<JointVector> {
    let far = |branch: &Branch| -> f64 { branch.joints.iter().zip(home).map(|(a, b)| (a - b).powi(2)).sum() };
    let usable = branches.iter().filter(|branch| branch.is_usable());
    usable.min_by(|a, b| far(a).total_cmp(&far(b))).map(|branch| branch.joints)
}

/// Returns whether a parameter varies at random. The errors of a signed error set do not vary. The standard
/// deviations derived from a signed error set only state the magnitudes of the errors.
fn is_random(cell: &Cell, parameter: Parameter) -> bool {
    match parameter {
        Parameter::Equipment(e, _) => matches!(cell.equipment[e].errors, Some(FrameErrors::Tolerance(_))),
        _ => !matches!(cell.error_set(), ErrorSet::Signed(_)),
    }
}

/// Returns the attitude of a tool whose axes are the columns of `axes` (base frame). The columns are r, d x r
/// and d: r is the reference axis, and d is the tool axis.
///
/// The inverse function [`crate::cell::held`] computes the columns from the angles of an attitude.
fn attitude_of(axes: &Matrix3<f64>) -> Attitude {
    let (r, d) = (axes.column(0).into_owned(), axes.column(2).into_owned());
    let level = d.x.hypot(d.y);
    let (elevation, azimuth) = (d.z.atan2(level), if level < 1e-9 { 0.0 } else { d.y.atan2(d.x) });
    let (sin, cos) = elevation.sin_cos();
    let upright = Vector3::new(-sin * azimuth.cos(), -sin * azimuth.sin(), cos);
    let spin = r.dot(&d.cross(&upright)).atan2(r.dot(&upright));
    Attitude {
        azimuth: Azimuth::Surface(azimuth),
        spin: Spin::At(vec![spin]),
        ..Attitude::elevation(elevation)
    }
}
