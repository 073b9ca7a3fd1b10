//! Lower bound of the value of a posture over all rotations of the tool by the last joint.
//!
//! The last joint rotates the tool about its axis and leaves the TCP where it is. Only the errors behind this joint
//! rotate with it: those of the last link after the joint, and those of the tool. All other effects stay the same.
//!
//! - Signed sample: the errors behind the joint displace the TCP by at most r, and the errors before it move the
//!   displaced TCP rigidly. So two rotations differ by at most 2 r.
//! - Statistics of normal parameters: the rotated effects and the mean are left out. Both only enlarge the error:
//!   a ball contains the sum of independent symmetric unimodal vectors less probably than one of them, and a shifted
//!   one less probably than a centred one (T. W. Anderson, Proc. Amer. Math. Soc. 6 (1955) 170-176). RMS, mean,
//!   percentiles and the share of failures all follow this order.

use super::{ErrorEvaluator, ErrorSources, EvaluatorScratch, WorkContext};
use crate::cell::{Frame, Model, Parameter, Quantity, Reading, Sense};
use crate::kinematic_error::{FrameError, Perturbation};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3, Vector6};

/// Relative error that a computed figure may have.
const ROUNDING: f64 = 1e-7;

/// Method that bounds the value of an operation over all rotations of the tool by the last joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SpinBound {
    /// The values of the signed sample differ by at most this length, m.
    Signed(f64),
    /// The effects of these independent random factors stay the same.
    Statistical(Vec<bool>),
}

impl SpinBound {
    /// Returns the bound for signed position errors in world directions.
    pub fn of_sample(chain: &Chain, errors: &Perturbation, sense: &Sense) -> Self {
        let rows = sense.rows().iter().map(|row| row.direction);
        let gram = rows.fold(Matrix3::zeros(), |sum: Matrix3<f64>, d: Vector3<f64>| sum + d * d.transpose());
        let largest = gram.symmetric_eigenvalues().max().max(0.0).sqrt();
        Self::Signed(2.0 * largest * displacement_behind(chain, errors))
    }

    /// Returns the bound for random errors in a sense; None if it is not known.
    pub fn of_statistics(axes: usize, sources: &ErrorSources, sense: &Sense) -> Option<Self> {
        if sources.has_bounded() || sense.frame == Frame::Tool || sense.point != Vector3::zeros() {
            return None;
        }
        let stays = |source: &usize| !is_behind(sources.list[*source].parameter, axes);
        let factors = sources.independent();
        Some(Self::Statistical(factors.iter().map(|f| f.iter().all(|(source, _)| stays(source))).collect()))
    }
}

/// Returns whether a parameter describes a part behind the last joint.
fn is_behind(parameter: Parameter, axes: usize) -> bool {
    match parameter {
        Parameter::Dl(link) | Parameter::Dalpha(link) | Parameter::Dbeta(link) => link + 1 == axes,
        Parameter::Tool(_) => true,
        _ => false,
    }
}

/// Returns the largest displacement of the TCP, m, that errors behind the last joint cause.
fn displacement_behind(chain: &Chain, errors: &Perturbation) -> f64 {
    let lever = chain.tool.translation.norm();
    let mut moved = 0.0;
    if let Some(FrameError { slides, turns }) = &errors.tool {
        turns.iter().for_each(|turn| moved += turn.angle.abs() * moved);
        moved += Vector3::from(*slides).norm();
    }
    if let Some(last) = errors.links().last() {
        [last.dbeta, last.dalpha].iter().for_each(|turn| moved += turn.angle.abs() * (lever + moved));
        moved += last.dl.abs();
    }
    moved
}

impl ErrorEvaluator {
    /// Returns whether [`Self::least_over_spins`] is known.
    pub fn has_spin_bound(&self) -> bool {
        self.spin_bound.is_some()
    }

    /// Returns a lower bound of [`Self::value`] over all rotations of the tool by the last joint; 0 if none is known.
    pub fn least_over_spins(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        match &self.spin_bound {
            None => 0.0,
            Some(SpinBound::Signed(apart)) => {
                (self.value(context, frames, memory) * (1.0 - ROUNDING) - apart).max(0.0)
            }
            Some(SpinBound::Statistical(stays)) => {
                self.propagation().effects(
                    context,
                    frames,
                    &mut memory.expansion,
                    false,
                    &mut memory.effects,
                );
                let measure = self.measure(&self.sense, context, frames);
                let figure = self.figure_of(&self.norm_of(&measure, &Vector6::zeros(), |k| stays[k], memory));
                match self.quantity {
                    Quantity::Yield => figure - ROUNDING,
                    _ => figure * (1.0 - ROUNDING),
                }
            }
        }
    }

    /// Returns the bound that suits this evaluator; None if it is not known.
    pub(super) fn spin_bound_of(&self) -> Option<SpinBound> {
        match self.reading {
            Reading::Signed if self.alone && self.sense.is_of_position() => {
                let bound = SpinBound::of_sample(&self.chain, self.signed.errors(), &self.sense);
                let is_rigid = self.model != Model::SecondOrder || bound == SpinBound::Signed(0.0);
                is_rigid.then_some(bound)
            }
            Reading::Statistical => SpinBound::of_statistics(self.chain.axes(), &self.sources, &self.sense),
            Reading::Signed | Reading::WorstCase => None,
        }
    }
}
