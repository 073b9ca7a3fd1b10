//! Fit of all unknowns to the measured positions of all sessions.

use super::fit_state::{FitProblem, FitState, factor};
use super::harmonics::improve_deviations;
use super::normal_equations::NormalEquations;
use super::residual_variances::Scores;
use super::rigid::SessionFrames;
use super::session::{MeasuredPosition, MeasuringSession};
use super::taken_up::jacobian;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Largest number of Newton steps in each of the two phases of a fit. The first phase also fits the
/// variances. The second phase keeps them fixed.
const STEPS: usize = 100;
/// The fit has converged when its largest step, in prior standard deviations, is at most this value.
const CONVERGED: f64 = 1e-6;
/// Smallest fraction of a step of Fisher's scoring method by which one iteration changes the variances.
const LEAST_SHARE: f64 = 0.1;
/// The variances count as converged only if the largest step of an unknown is below this value. The unit of
/// the step is the prior standard deviation.
const ROUGHLY: f64 = 1e-3;
/// Largest step, in prior standard deviations, that is accepted without a check of the loss.
const SURE: f64 = 0.1;
/// Factor by which the damping grows after a step that raised the loss. The damping shrinks by the same
/// factor after any other step.
const DAMPING: f64 = 4.0;
/// A successful step sets the damping to 0 if the damping is at most this value.
const LEAST_DAMPING: f64 = 0.1;
/// A variance has converged when its relative change is at most this value.
const SETTLED: f64 = 1e-2;
/// Number of positions whose covariances are computed at once.
const STACKED: usize = 512;

/// Values of the unknowns and the frames of the sessions at the minimum of the loss.
pub(super) struct Fit<'a> {
    pub state: FitState<'a>,
    /// Covariance matrix of the unknowns of the arm and, after them, of the frames of every session.
    pub covariance: DMatrix<f64>,
}

/// Measured position compared with its prediction, base frame.
pub(super) struct Residual {
    pub row: usize,
    /// Measured minus predicted position, m.
    pub by: Vector3<f64>,
    /// Covariance of the misfit (the error that the identified parameters do not explain), m^2.
    pub misfit: Matrix3<f64>,
    /// Covariance of the prediction, m^2.
    pub spread: Matrix3<f64>,
}

impl Residual {
    /// Returns the squared Mahalanobis distance of the residual under the covariance of misfit and
    /// prediction.
    pub fn normalised(&self) -> f64 {
        let covariance = self.misfit + self.spread;
        covariance.cholesky().map_or(f64::INFINITY, |c| self.by.dot(&c.solve(&self.by)))
    }
}

impl<'a> Fit<'a> {
    /// Fits the unknowns and the variances of the misfit.
    pub fn new(question: FitProblem<'a>, sessions: &[MeasuringSession]) -> Result<Self, String> {
        let state = FitState::nominal(question, sessions)?;
        Self { state, covariance: DMatrix::zeros(0, 0) }.solved(sessions, true)
    }

    /// Returns the fit to all positions except `left_out`, with the variances of the present fit.
    ///
    /// A single step is exact up to second-order terms of the change, because errors are small. `all` holds
    /// the equations of all positions, and the share of the curvature that they contain: 1 for a Newton step,
    /// 0 for a Gauss-Newton step. Returns None if the remaining positions do not determine the unknowns.
    pub fn without(
        &self,
        (all, newton): (&NormalEquations, f64),
        left_out: &[MeasuringSession],
    ) -> Option<Self> {
        let left_out = NormalEquations::of_positions(&self.state, left_out, newton);
        let (step, covariance) = all.without(&left_out).with_expectations(&self.state, 0.0).solution()?;
        let mut state = self.state.clone();
        state.take_step(step.as_slice());
        Some(Self { state, covariance })
    }

    fn solved(mut self, sessions: &[MeasuringSession], finds_misfit: bool) -> Result<Self, String> {
        let (mut share, mut before, mut damping) = (1.0, 0.0, 0.0);
        for _ in 0..STEPS {
            let largest = self.take_step(sessions, &mut damping)?;
            let mut change = 0.0;
            let mut of_harmonics = 0.0;
            if finds_misfit {
                change = self.improve_misfit(sessions, share);
                let (unknowns, state) = (self.state.question.unknowns, &mut self.state);
                of_harmonics =
                    improve_deviations(unknowns, &state.values, &self.covariance, &mut state.priors);
            }
            // If the variances oscillate, shorter steps make them converge.
            let swings = change * before < 0.0;
            share = if swings { (share / 2.0).max(LEAST_SHARE) } else { (share * 1.5).min(1.0) };
            before = change;
            if damping > 0.0 {
                continue;
            }
            if finds_misfit && largest < ROUGHLY && change.abs().max(of_harmonics) < SETTLED {
                // The variances stay fixed from here on, because their last digits hardly affect the
                // unknowns.
                return self.solved(sessions, false);
            }
            if !finds_misfit && largest < CONVERGED {
                return Ok(self);
            }
        }
        if finds_misfit {
            // Few positions may leave a variance undetermined. The variances found so far weight the
            // positions well enough.
            return self.solved(sessions, false);
        }
        Err(format!("the fit of the parameters has not converged after {STEPS} steps"))
    }

    /// Takes a Levenberg-Marquardt step, and returns the largest change of an unknown, in prior standard
    /// deviations.
    ///
    /// A long step that raises the loss is undone, and the damping grows.
    fn take_step(&mut self, sessions: &[MeasuringSession], damping: &mut f64) -> Result<f64, String> {
        let state = &mut self.state;
        let solution = |newton: f64| {
            let equations = NormalEquations::of_positions(state, sessions, newton);
            equations.with_expectations(state, *damping).solution()
        };
        // Far from the minimum, the Hessian can be indefinite.
        let Some((step, covariance)) = solution(1.0).or_else(|| solution(0.0)) else {
            return Err("the measured positions do not determine the pose of the robot base and the positions of the reflectors".into());
        };
        self.covariance = covariance;
        let relative = step.iter().zip(&state.priors).map(|(by, prior)| (by / prior).abs());
        let largest = relative.fold(0.0, f64::max);
        let unmoved = (largest > SURE).then(|| (state.loss(sessions), state.clone()));
        state.take_step(step.as_slice());
        match unmoved {
            Some((loss, unmoved)) if state.loss(sessions) > loss => {
                *state = unmoved;
                *damping = (*damping * DAMPING).max(1.0);
            }
            _ => *damping = if *damping > LEAST_DAMPING { *damping / DAMPING } else { 0.0 },
        }
        Ok(largest)
    }

    /// Changes the variances of the misfit by the fraction `share` of one step of Fisher's scoring method.
    /// Returns the signed relative change of the variance that changes most.
    fn improve_misfit(&mut self, sessions: &[MeasuringSession], share: f64) -> f64 {
        let mut scores = Scores::none();
        for (s, session) in sessions.iter().enumerate() {
            let own = self.own_covariance(s);
            let equations: Vec<_> = session.measured.iter().map(|m| self.state.equation(m, s)).collect();
            let jacobians = equations.iter().map(|e| jacobian(e.motions.iter().map(|m| m.slope)));
            let spreads = spreads(&jacobians.collect::<Vec<_>>(), &own);
            for (equation, spread) in equations.iter().zip(spreads) {
                let residual = equation.residual;
                let of_fit = equation.factor.l_dirty().lower_triangle().norm_squared();
                let spread = spread * (equation.misfit.trace() / of_fit);
                let scatter = residual * residual.transpose() * equation.weight + spread;
                scores.add(&equation.drives, &factor(equation.misfit).inverse(), &scatter);
            }
        }
        let (misfit, change) = self.state.misfit.improved(&scores, share);
        self.state.misfit = misfit;
        change
    }

    /// Returns the covariance of the unknowns and of the frames of session `s`.
    pub fn own_covariance(&self, s: usize) -> DMatrix<f64> {
        let common = self.state.values.len();
        let before: usize = self.state.frames.iter().take(s).map(SessionFrames::size).sum();
        let size = common + self.state.frames.get(s).map_or(0, SessionFrames::size);
        let place = |k: usize| if k < common { k } else { k + before };
        DMatrix::from_fn(size, size, |i, j| self.covariance[(place(i), place(j))])
    }

    /// Returns the residuals of positions of session `s`.
    pub fn residuals(&self, measured: &[MeasuredPosition], s: usize) -> Vec<Residual> {
        let equations: Vec<_> = measured.iter().map(|m| self.state.equation(m, s)).collect();
        let jacobians = equations.iter().map(|e| jacobian(e.motions.iter().map(|m| m.slope)));
        let spreads = spreads(&jacobians.collect::<Vec<_>>(), &self.own_covariance(s));
        let all = measured.iter().zip(&equations).zip(spreads);
        let residual = all.map(|((measured, equation), spread)| Residual {
            row: measured.row,
            by: equation.residual,
            misfit: equation.misfit,
            spread,
        });
        residual.collect()
    }
}

/// Returns the covariances (m^2) of positions, given their Jacobians and the covariance `of_unknowns` of the
/// unknowns.
pub(super) fn spreads(jacobians: &[DMatrix<f64>], of_unknowns: &DMatrix<f64>) -> Vec<Matrix3<f64>> {
    // One product of large matrices is faster than many products of small matrices.
    let stacks = jacobians.chunks(STACKED).flat_map(|some| {
        let mut stack = DMatrix::zeros(3 * some.len(), of_unknowns.nrows());
        for (k, jacobian) in some.iter().enumerate() {
            stack.rows_mut(3 * k, 3).copy_from(jacobian);
        }
        let moved = &stack * of_unknowns;
        let own = |k: usize| moved.rows(3 * k, 3) * stack.rows(3 * k, 3).transpose();
        let spreads = (0..some.len()).map(own).map(|spread| Matrix3::from_fn(|i, j| spread[(i, j)]));
        spreads.collect::<Vec<_>>()
    });
    stacks.collect()
}
