//! State of a fit: estimates of all unknowns, and the equation of every measured position.

use super::deformed::{Deformed, PointMotion};
use super::harmonics::wave;
use super::residual_variances::ResidualVariances;
use super::rigid::{FARTHEST_REFLECTOR, SessionFrames, aligned};
use super::session::{MeasuredPosition, MeasuringSession};
use super::unknown::Unknown;
use crate::cell::Parameter;
use crate::robot::Chain;
use nalgebra::{Cholesky, Const, Matrix3, Vector3};

/// Normalized residual above which the loss grows linearly (Huber 1964).
const HUBER: f64 = 4.0;

/// Arm and unknowns of a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct FitProblem<'a> {
    pub chain: &'a Chain,
    pub unknowns: &'a [Unknown],
    /// Prior standard deviations of the unknowns. The fit adjusts the standard deviations of harmonics.
    pub priors: &'a [f64],
}

impl FitProblem<'_> {
    /// Returns the initial variances of the misfit. The argument `spread` is the standard deviation (m, per
    /// axis) of measured minus predicted positions.
    fn expected_misfit(&self, spread: f64) -> ResidualVariances {
        let has_harmonics = self.unknowns.iter().any(|u| u.is_harmonic());
        ResidualVariances::expected(self.chain, has_harmonics, spread)
    }
}

/// Estimates of the unknowns, of the frames of the sessions, and of the misfit.
#[derive(Debug, Clone)]
pub(super) struct FitState<'a> {
    pub question: FitProblem<'a>,
    pub values: Vec<f64>,
    /// Prior standard deviations of the unknowns; the fit has adjusted the standard deviations of harmonics.
    pub priors: Vec<f64>,
    pub frames: Vec<SessionFrames>,
    pub misfit: ResidualVariances,
}

/// One measured position in the fit.
pub(super) struct PositionEquation {
    pub residual: Vector3<f64>,
    pub drives: Vec<Vector3<f64>>,
    pub motions: Vec<PointMotion>,
    /// Covariance of the misfit (the error that the identified parameters do not explain), m^2.
    pub misfit: Matrix3<f64>,
    /// Cholesky factor of the covariance (m^2) that weights the residual in the fit.
    pub factor: Cholesky<f64, Const<3>>,
    pub weight: f64,
}

impl<'a> FitState<'a> {
    /// Returns the state of the nominal arm, with the session frames aligned to the measured positions.
    ///
    /// Returns an error that names a session whose positions do not determine the base.
    pub fn nominal(question: FitProblem<'a>, sessions: &[MeasuringSession]) -> Result<Self, String> {
        let mut state = Self {
            question,
            values: vec![0.0; question.unknowns.len()],
            priors: question.priors.to_vec(),
            frames: Vec::new(),
            misfit: question.expected_misfit(0.0),
        };
        let (mut squares, mut count) = (0.0, 0.0);
        for session in sessions {
            let poses: Vec<_> = session.measured.iter().map(|m| state.deformed(m)).collect();
            let Some(frames) = aligned(&poses, &session.measured) else {
                let name = &session.name;
                return Err(format!("the positions of {name} do not determine the pose of the robot base"));
            };
            let off = poses.iter().zip(&session.measured).map(|(p, m)| frames.residual(&p.interface, m));
            squares += off.map(|by| by.norm_squared()).sum::<f64>();
            count += 3.0 * session.measured.len() as f64;
            state.frames.push(frames);
        }
        state.misfit = question.expected_misfit((squares / count).sqrt());
        Ok(state)
    }

    /// Moves the unknowns, and the frames of the sessions, by a step.
    pub fn take_step(&mut self, step: &[f64]) {
        let (of_unknowns, mut left) = step.split_at(self.values.len());
        self.values.iter_mut().zip(of_unknowns).for_each(|(value, by)| *value += by);
        for frames in &mut self.frames {
            let (own, others) = left.split_at(frames.size());
            frames.take_step(own);
            left = others;
        }
    }

    /// Returns half the sum of the squares of all residuals and unknowns, each divided by its standard
    /// deviation. Outliers count with Huber's loss.
    pub fn loss(&self, sessions: &[MeasuringSession]) -> f64 {
        let measured =
            sessions.iter().enumerate().flat_map(|(s, session)| session.measured.iter().map(move |m| (s, m)));
        let of_positions = measured.map(|(s, measured)| {
            let PositionEquation { residual, factor, weight, .. } = self.equation(measured, s);
            weight * (2.0 - weight) * residual.dot(&factor.solve(&residual))
        });
        let of_unknowns = self.values.iter().zip(&self.priors).map(|(value, prior)| (value / prior).powi(2));
        let of_reflectors = self
            .frames
            .iter()
            .flat_map(|f| &f.reflectors)
            .map(|r| r.norm_squared() / FARTHEST_REFLECTOR.powi(2));
        (of_positions.sum::<f64>() + of_unknowns.sum::<f64>() + of_reflectors.sum::<f64>()) / 2.0
    }

    fn deformed(&self, measured: &MeasuredPosition) -> Deformed {
        Deformed::new(self.question.chain, &measured.joints, self.question.unknowns, &self.values)
    }

    /// Returns the equation of a position of session `s`.
    pub fn equation(&self, measured: &MeasuredPosition, s: usize) -> PositionEquation {
        let (chain, frames) = (self.question.chain, &self.frames[s]);
        let pose = self.deformed(measured);
        let at = frames.reached(&pose.interface, measured.reflector);
        let residual = frames.residual(&pose.interface, measured);
        let drives = drives(chain, &pose, &at);
        let misfit = self.misfit.covariance(&drives, measured.sigma);
        let weight = (HUBER / residual.dot(&factor(misfit).solve(&residual)).sqrt()).min(1.0);
        let factor = factor(self.misfit.covariance_of_fit(&drives, measured.sigma));
        let of_chain = self.question.unknowns.iter().map(|unknown| match *unknown {
            // There are many harmonics, and they need no axis because the fit ignores their curvature.
            Unknown::Harmonic { joint, order, sine } => PointMotion {
                slope: drives[joint] * wave(measured.joints[joint], order, sine),
                ..PointMotion::none(0)
            },
            _ => pose.motion(chain, *unknown, &at),
        });
        let motions = of_chain.chain(frames.motions(&pose.interface, measured.reflector)).collect();
        PositionEquation { residual, drives, motions, misfit, factor, weight }
    }
}

/// Returns the displacement of the point `at` (m, base frame) per unit of every actuator coordinate.
pub(super) fn drives(chain: &Chain, pose: &Deformed, at: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let motion = |j: usize| pose.motion(chain, Unknown::Row(Parameter::Dq(j)), at).slope;
    (0..chain.axes()).map(motion).collect()
}

/// Returns the Cholesky factor of a covariance. The factor exists because no variance is 0.
pub(super) fn factor(covariance: Matrix3<f64>) -> Cholesky<f64, Const<3>> {
    covariance.cholesky().unwrap_or_else(|| Cholesky::pack_dirty(Matrix3::identity()))
}
