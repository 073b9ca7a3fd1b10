//! Explanation of one posture's error, step by step, so that it can be checked by hand.

use super::parameter_motion::{ParameterMotion, motions};
use super::posture_check::PostureCheck;
use super::posture_context::PostureContext;
use crate::cell::{Frame, JointKind, Model, Parameter, Reading, Unit};
use crate::kinematic_error::{deviation, pose_error};
use crate::pose::Displacement;
use crate::reading::{ErrorSource, Figures, MAX_SOURCES, PostureErrors, WorstCase};
use crate::robot::Frames;
use nalgebra::{Matrix3, Vector3};

/// Row of the Denavit-Hartenberg table at the explained posture: `Rz(theta) Tz(r) Tx(l) Rx(alpha)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DhRow {
    pub kind: JointKind,
    /// Coordinate of the actuator (before joint coupling), rad or m.
    pub q: f64,
    /// Whether the actuator coordinate `q` is within the joint limits.
    pub allowed: bool,
    pub theta: f64,
    pub r: f64,
    pub l: f64,
    pub alpha: f64,
}

/// Effect of one error parameter on the TCP, base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterEffect {
    pub source: ErrorSource,
    pub motions: Vec<ParameterMotion>,
    /// Value of the parameter in the signed sample or at the worst corner of the tolerance box, m or rad.
    pub value: f64,
    /// Effect of one unit (1 m or 1 rad) of the parameter on the TCP. Registration is ignored. If the
    /// operation places a picked part, the effect at the pick is also ignored.
    pub alone: Displacement,
    /// Effect of one unit (1 m or 1 rad) of the parameter on the TCP after registration. If the operation
    /// places a picked part, the effect at the pick is subtracted.
    pub left: Displacement,
}

impl ParameterEffect {
    /// Returns the linear term of this parameter: [`Self::left`] times [`Self::value`].
    pub fn term(&self) -> Displacement {
        self.left * self.value
    }

    /// Returns the effect of a parameter on the TCP: the sum over the small motions that it causes.
    ///
    /// Motions of the operation's own equipment (index `own`) have the opposite sign, because the error is
    /// relative to that equipment. Other equipment has no effect.
    fn alone(parameter: Parameter, own: usize, motions: &[ParameterMotion]) -> Displacement {
        let sum = motions.iter().fold(Displacement::NONE, |sum, motion| sum + motion.effect());
        match parameter {
            // Relative to the moved equipment, the TCP moves in the opposite direction.
            Parameter::Equipment(e, _) if e == own => sum * -1.0,
            Parameter::Equipment(..) => Displacement::NONE,
            _ => sum,
        }
    }
}

/// One row of the operation's sense ([`crate::cell::Row`]) at the explained posture, with its error. The row
/// is a position error along a direction, or a rotation error about this direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SenseRow {
    pub turns: bool,
    /// Direction of the row in the base frame; the length of this vector is the weight of the row.
    pub direction: Vector3<f64>,
    pub value: f64,
}

/// All numbers from which the error of one posture follows; base frame, m and rad.
pub struct Explanation<'a> {
    pub context: PostureContext<'a>,
    pub rows: Vec<DhRow>,
    pub lines: Vec<ParameterEffect>,
    pub judged: PostureErrors,
    /// Monte Carlo check of the posture; None unless the reading is statistical.
    pub check: Option<PostureCheck>,
    /// Worst case of the error component that matters to the operation (its sense); None if the errors are
    /// not tolerances ([`crate::reading::ErrorEvaluator::has_tolerances`]).
    pub worst: Option<WorstCase>,
    /// Nonlinear error of the robot alone. Registration and errors of the equipment are ignored. If the
    /// operation places a picked part, the error at the pick is also ignored.
    pub robot: Displacement,
    pub sense: Vec<SenseRow>,
    /// Deviation of the linear position error from the nonlinear position error, as a share of the latter.
    pub linear_off: f64,
    /// Deviation of the second-order position error from the nonlinear position error, as a share of the
    /// latter.
    pub second_order_off: f64,
}

impl<'a> Explanation<'a> {
    /// Explains the error of a posture.
    pub fn new(context: PostureContext<'a>) -> Self {
        let PostureContext { evaluator, situation, frames, .. } = &context;
        let mut memory = evaluator.memory();
        let (judged, check) = PostureCheck::judged(&context, &mut memory);
        evaluator.prepare(situation, frames, &mut memory);
        let has_worst = evaluator.has_tolerances();
        let worst = has_worst.then(|| evaluator.worst(&evaluator.sense, situation, frames, &mut memory));
        let sources = &evaluator.sources;
        let mut values = [0.0; MAX_SOURCES];
        match &worst {
            Some(worst) if evaluator.reading != Reading::Signed => {
                evaluator.corner(worst.corner, &mut values);
            }
            _ => values.iter_mut().zip(sources.signed()).for_each(|(v, s)| *v = s),
        }
        let theory = evaluator.propagation();
        let line = |(k, source): (usize, &ErrorSource)| {
            let motions = motions(theory.chain, frames, &situation.site.work, source.parameter);
            let alone = ParameterEffect::alone(source.parameter, situation.site.equipment, &motions);
            ParameterEffect {
                source: *source,
                motions,
                value: values[k],
                alone,
                left: memory.effects().columns[k],
            }
        };
        let lines = sources.list.iter().enumerate().map(line).collect();
        let sample = theory.sample(&values[..sources.list.len()], Model::Nonlinear);
        let robot = pose_error(frames, sample.errors(), Model::Nonlinear);
        let off = |model: &Displacement| deviation(&judged.nonlinear.position, &model.position);
        let (linear_off, second_order_off) = (off(&judged.linear), off(&judged.second_order));
        let (rows, sense) = (dh_rows(&context), sense_rows(&context, &judged.error));
        Self { rows, lines, worst, robot, sense, linear_off, second_order_off, judged, check, context }
    }

    /// Returns the error figures of the posture for the error component that matters to the operation (its
    /// sense), m or rad.
    pub fn figures(&self) -> &Figures {
        &self.judged.figures[self.context.evaluator.own()]
    }

    /// Compares the position error in the cell's model with the position error in the nonlinear model.
    /// Returns the deviation as a share of the nonlinear position error.
    pub fn off(&self) -> f64 {
        match self.context.evaluator.model {
            Model::Nonlinear => 0.0,
            Model::Linear => self.linear_off,
            Model::SecondOrder => self.second_order_off,
        }
    }

    /// Returns whether the deviation of the cell's model is at most the guard, the cell's threshold of trust.
    pub fn trusted(&self) -> bool {
        self.off() <= self.context.cell.guard
    }

    /// Returns whether the explained error differs from the error of the robot alone.
    ///
    /// The two errors differ if a frame is registered, if the operation places a picked part, or if
    /// equipment has errors.
    pub fn takes_off(&self) -> bool {
        let situation = &self.context.situation;
        situation.reference.is_some()
            || situation.site.taught.is_some()
            || self.context.cell.registration != crate::cell::Registration::None
            || self.lines.iter().any(|l| matches!(l.source.parameter, Parameter::Equipment(..)))
    }

    /// Returns the unit of the value that the reading gives: length, angle or share.
    pub fn unit(&self) -> Unit {
        match self.context.cell.is_yield() {
            true => Unit::Share,
            false => self.context.evaluator.sense.unit,
        }
    }
}

fn dh_rows(context: &PostureContext<'_>) -> Vec<DhRow> {
    let robot = &context.cell.robot;
    let rows = robot.joints.iter().enumerate().map(|(i, joint)| {
        let coordinate: f64 = robot.coupling[i].iter().zip(&context.joints).map(|(c, q)| c * q).sum();
        let (turn, slide) = match joint.kind {
            JointKind::Revolute => (coordinate, 0.0),
            JointKind::Prismatic => (0.0, coordinate),
        };
        let q = context.joints[i];
        // Without this tolerance, rounded degrees could put a posture at a joint limit beyond the limit.
        let allowed = q >= joint.limits.0 - 1e-9 && q <= joint.limits.1 + 1e-9;
        let (theta, r) = (joint.theta + turn, joint.r + slide);
        DhRow { kind: joint.kind, q, allowed, theta, r, l: joint.l, alpha: joint.alpha }
    });
    rows.collect()
}

/// Returns the rows (weighted directions) of the operation's sense in the base frame. Each row states the
/// component of `error` that it measures.
fn sense_rows(context: &PostureContext<'_>, error: &Displacement) -> Vec<SenseRow> {
    let PostureContext { evaluator, situation, frames, .. } = context;
    let axes: &Matrix3<f64> = match evaluator.sense.frame {
        Frame::World => &situation.site.world,
        Frame::Surface => &situation.site.work.rotation,
        Frame::Tool => &frames.tcp.rotation,
    };
    let at_point = error.at(&arm(context, frames));
    let row = |row: &crate::cell::Row| {
        let direction = axes * row.direction;
        let value = direction.dot(if row.turns { &at_point.rotation } else { &at_point.position });
        SenseRow { turns: row.turns, direction, value }
    };
    evaluator.sense.rows().iter().map(row).collect()
}

/// Returns the vector (base frame, m) from the TCP to the point whose error the sense of the operation
/// measures.
fn arm(context: &PostureContext<'_>, frames: &Frames) -> Vector3<f64> {
    frames.tcp.rotation * context.evaluator.sense.point
}
