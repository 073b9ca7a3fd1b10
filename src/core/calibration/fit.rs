//! The fit of all unknowns to the measured positions of all sessions.

use super::deformed::{Deformed, PointMotion};
use super::harmonics::improve_deviations;
use super::residual_variances::{ResidualVariances, Scores};
use super::rigid::{SessionFrames, aligned};
use super::session::{MeasuredPosition, MeasuringSession};
use super::taken_up::jacobian;
use super::unknown::Unknown;
use crate::cell::Parameter;
use crate::robot::Chain;
use nalgebra::{Cholesky, Const, DMatrix, DVector, Matrix3, Vector3};
use std::cmp::Ordering;

/// Largest number of Newton steps.
const STEPS: usize = 100;
/// Largest step, in standard deviations before the measurement, at which the fit has converged.
const CONVERGED: f64 = 1e-6;
/// Smallest share of a step of the variances.
const LEAST_SHARE: f64 = 0.1;
/// Largest step at which the variances may settle.
const ROUGHLY: f64 = 1e-3;
/// Largest step, in standard deviations before the measurement, that need not lower the loss.
const SURE: f64 = 0.1;
/// Factor by which the damping grows after a step that raised the loss, and shrinks after another one.
const DAMPING: f64 = 4.0;
/// Smallest damping that is not left out.
const LEAST_DAMPING: f64 = 0.1;
/// Largest relative change of a variance that has settled.
const SETTLED: f64 = 1e-2;
/// Number of positions whose covariances are computed at once.
const STACKED: usize = 512;
/// Normalised residual above which the loss grows linearly (Huber 1964).
const HUBER: f64 = 4.0;
/// Standard deviation of the coordinates of a reflector before the measurement, m.
const FARTHEST_REFLECTOR: f64 = 1.0;

/// Arm and unknowns of a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct FitProblem<'a> {
    pub chain: &'a Chain,
    pub unknowns: &'a [Unknown],
    /// Standard deviations of the unknowns before the measurement; those of harmonics are improved by the fit.
    pub priors: &'a [f64],
}

impl FitProblem<'_> {
    /// Returns the variances of the misfit to begin with; `spread` is the standard deviation of a position per axis, m.
    fn expected_misfit(&self, spread: f64) -> ResidualVariances {
        let has_harmonics = self.unknowns.iter().any(|u| u.is_harmonic());
        ResidualVariances::expected(self.chain, has_harmonics, spread)
    }
}

/// Values of the unknowns and the frames of the sessions at the minimum.
pub(super) struct Fit<'a> {
    question: FitProblem<'a>,
    pub values: Vec<f64>,
    /// Standard deviations of the unknowns before the measurement.
    pub priors: Vec<f64>,
    pub frames: Vec<SessionFrames>,
    pub misfit: ResidualVariances,
    /// Covariance of the unknowns, followed by those of the frames of every session.
    pub covariance: DMatrix<f64>,
}

/// Measured position beside its prediction, base frame.
pub(super) struct Residual {
    pub row: usize,
    /// Measured minus predicted position, m.
    pub by: Vector3<f64>,
    /// Covariance of the misfit, m^2.
    pub misfit: Matrix3<f64>,
    /// Covariance of the prediction, m^2.
    pub spread: Matrix3<f64>,
}

impl Residual {
    /// Returns the squared distance divided by the covariance of misfit and prediction.
    pub fn normalised(&self) -> f64 {
        let covariance = self.misfit + self.spread;
        covariance.cholesky().map_or(f64::INFINITY, |c| self.by.dot(&c.solve(&self.by)))
    }
}

/// One measured position in the fit.
struct Equation {
    residual: Vector3<f64>,
    drives: Vec<Vector3<f64>>,
    motions: Vec<PointMotion>,
    /// Covariance of the misfit, m^2.
    misfit: Matrix3<f64>,
    /// Factor of the covariance by which the fit divides, m^2.
    factor: Cholesky<f64, Const<3>>,
    weight: f64,
}

impl<'a> Fit<'a> {
    /// Fits the unknowns and the variances of the misfit.
    pub fn new(question: FitProblem<'a>, sessions: &[MeasuringSession]) -> Result<Self, String> {
        let mut fit = Self {
            question,
            values: vec![0.0; question.unknowns.len()],
            priors: question.priors.to_vec(),
            frames: Vec::new(),
            misfit: question.expected_misfit(0.0),
            covariance: DMatrix::zeros(0, 0),
        };
        let (mut squares, mut count) = (0.0, 0.0);
        for session in sessions {
            let poses: Vec<_> = session.measured.iter().map(|m| fit.deformed(m)).collect();
            let Some(frames) = aligned(&poses, &session.measured) else {
                let name = &session.name;
                return Err(format!("the positions of {name} do not determine the pose of the robot base"));
            };
            let off = poses.iter().zip(&session.measured).map(|(p, m)| frames.residual(&p.interface, m));
            squares += off.map(|by| by.norm_squared()).sum::<f64>();
            count += 3.0 * session.measured.len() as f64;
            fit.frames.push(frames);
        }
        fit.misfit = question.expected_misfit((squares / count).sqrt());
        fit.solved(sessions, true)
    }

    /// Fits the unknowns again with the present variances.
    pub fn again(&self, sessions: &[MeasuringSession]) -> Result<Self, String> {
        let fit = Self {
            question: self.question,
            values: self.values.clone(),
            priors: self.priors.clone(),
            frames: self.frames.clone(),
            misfit: self.misfit.clone(),
            covariance: DMatrix::zeros(0, 0),
        };
        fit.solved(sessions, false)
    }

    fn solved(mut self, sessions: &[MeasuringSession], finds_misfit: bool) -> Result<Self, String> {
        let unknowns = self.question.unknowns;
        let (mut share, mut before, mut damping) = (1.0, 0.0, 0.0);
        for _ in 0..STEPS {
            let largest = self.take_step(sessions, &mut damping)?;
            let mut change = 0.0;
            let mut of_harmonics = 0.0;
            if finds_misfit {
                change = self.improve_misfit(sessions, share);
                of_harmonics = improve_deviations(unknowns, &self.values, &self.covariance, &mut self.priors);
            }
            // Where the variances swing, shorter steps settle them.
            let swings = change * before < 0.0;
            share = if swings { (share / 2.0).max(LEAST_SHARE) } else { (share * 1.5).min(1.0) };
            before = change;
            if damping > 0.0 {
                continue;
            }
            if finds_misfit && largest < ROUGHLY && change.abs().max(of_harmonics) < SETTLED {
                // The last digits of the unknowns do not depend on those of the variances.
                return self.solved(sessions, false);
            }
            if !finds_misfit && largest < CONVERGED {
                return Ok(self);
            }
        }
        if finds_misfit {
            // Few positions leave a variance open; those found so far weigh the positions well enough.
            return self.solved(sessions, false);
        }
        Err(format!("the fit has not converged after {STEPS} steps"))
    }

    /// Takes a step of Levenberg and Marquardt, and returns its largest change in standard deviations before the
    /// measurement.
    ///
    /// The damping adds to the precisions of the unknowns before the measurement, as a multiple of them. A long step
    /// that raises the loss is taken back and the damping grows.
    fn take_step(&mut self, sessions: &[MeasuringSession], damping: &mut f64) -> Result<f64, String> {
        let (newton, right) = self.equations(sessions, 1.0);
        let damped = |mut hessian: DMatrix<f64>| {
            for (k, prior) in self.priors.iter().enumerate() {
                hessian[(k, k)] += *damping * prior.powi(-2);
            }
            hessian.cholesky()
        };
        // Far from the minimum, the Hessian can be indefinite.
        let factor = damped(newton).or_else(|| damped(self.equations(sessions, 0.0).0));
        let Some(factor) = factor else {
            return Err("the measured positions do not determine base and reflector".into());
        };
        let by = factor.solve(&right);
        let (of_unknowns, of_sessions) = by.as_slice().split_at(self.values.len());
        let largest =
            of_unknowns.iter().zip(&self.priors).fold(0.0_f64, |most, (by, s)| most.max((by / s).abs()));
        let unmoved =
            (largest > SURE).then(|| (self.loss(sessions), self.values.clone(), self.frames.clone()));
        self.values.iter_mut().zip(of_unknowns).for_each(|(value, by)| *value += by);
        let mut left = of_sessions;
        for (session, frames) in sessions.iter().zip(&mut self.frames) {
            let (own, others) = left.split_at(SessionFrames::unknowns(&session.measured));
            frames.take_step(own);
            left = others;
        }
        self.covariance = factor.inverse();
        match unmoved {
            Some((loss, values, frames)) if self.loss(sessions) > loss => {
                (self.values, self.frames) = (values, frames);
                *damping = (*damping * DAMPING).max(1.0);
            }
            _ => *damping = if *damping > LEAST_DAMPING { *damping / DAMPING } else { 0.0 },
        }
        Ok(largest)
    }

    /// Returns half the sum of squares of all residuals, of which outliers have the loss of Huber.
    fn loss(&self, sessions: &[MeasuringSession]) -> f64 {
        let measured =
            sessions.iter().enumerate().flat_map(|(s, session)| session.measured.iter().map(move |m| (s, m)));
        let of_positions = measured.map(|(s, measured)| {
            let Equation { residual, factor, weight, .. } = self.equation(measured, s);
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

    /// Takes a share of one step of the variances, and returns their largest relative change with its sign.
    fn improve_misfit(&mut self, sessions: &[MeasuringSession], share: f64) -> f64 {
        let mut scores = Scores::none();
        for (s, session) in sessions.iter().enumerate() {
            let own = self.own_covariance(sessions, s);
            let equations: Vec<_> = session.measured.iter().map(|m| self.equation(m, s)).collect();
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
        let (misfit, change) = self.misfit.improved(&scores, share);
        self.misfit = misfit;
        change
    }

    /// Returns the covariance of the unknowns and of the frames of session `s`.
    pub fn own_covariance(&self, sessions: &[MeasuringSession], s: usize) -> DMatrix<f64> {
        let common = self.question.unknowns.len();
        let count = |session: &MeasuringSession| SessionFrames::unknowns(&session.measured);
        let before: usize = sessions.iter().take(s).map(count).sum();
        let size = common + sessions.get(s).map_or(0, count);
        let place = |k: usize| if k < common { k } else { k + before };
        DMatrix::from_fn(size, size, |i, j| self.covariance[(place(i), place(j))])
    }

    /// Returns the residuals of positions of session `s`; `own` is the covariance of its unknowns.
    pub fn residuals(&self, measured: &[MeasuredPosition], s: usize, own: &DMatrix<f64>) -> Vec<Residual> {
        let equations: Vec<_> = measured.iter().map(|m| self.equation(m, s)).collect();
        let jacobians = equations.iter().map(|e| jacobian(e.motions.iter().map(|m| m.slope)));
        let spreads = spreads(&jacobians.collect::<Vec<_>>(), own);
        let residual =
            |((measured, equation), spread): ((&MeasuredPosition, &Equation), Matrix3<f64>)| Residual {
                row: measured.row,
                by: equation.residual,
                misfit: self.misfit.covariance(&equation.drives, measured.sigma),
                spread,
            };
        measured.iter().zip(&equations).zip(spreads).map(residual).collect()
    }

    fn deformed(&self, measured: &MeasuredPosition) -> Deformed {
        Deformed::new(self.question.chain, &measured.joints, self.question.unknowns, &self.values)
    }

    fn equation(&self, measured: &MeasuredPosition, s: usize) -> Equation {
        let (chain, frames) = (self.question.chain, &self.frames[s]);
        let pose = self.deformed(measured);
        let at = frames.reached(&pose.interface, measured.reflector);
        let residual = frames.residual(&pose.interface, measured);
        let drives = drives(chain, &pose, &at);
        let misfit = self.misfit.covariance(&drives, measured.sigma);
        let weight = (HUBER / residual.dot(&factor(misfit).solve(&residual)).sqrt()).min(1.0);
        let factor = factor(self.misfit.covariance_of_fit(&drives, measured.sigma));
        let of_chain = self.question.unknowns.iter().map(|u| pose.motion(chain, *u, &at));
        let motions = of_chain.chain(frames.motions(&pose.interface, measured.reflector)).collect();
        Equation { residual, drives, motions, misfit, factor, weight }
    }

    /// Returns the Hessian of half the sum of squares, and its negative gradient.
    ///
    /// The Hessian has `newton` times the second derivatives of the positions: 1 for Newton's method, 0 for
    /// the method of Gauss and Newton.
    fn equations(&self, sessions: &[MeasuringSession], newton: f64) -> (DMatrix<f64>, DVector<f64>) {
        let common = self.question.unknowns.len();
        let owns: Vec<_> = sessions.iter().map(|s| SessionFrames::unknowns(&s.measured)).collect();
        let size = common + owns.iter().sum::<usize>();
        let (mut normal, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut first = common;
        for (s, (session, own)) in sessions.iter().zip(owns).enumerate() {
            let count = 3 * session.measured.len();
            let mut rows = DMatrix::zeros(common + own, count);
            let mut residuals = DVector::zeros(count);
            let mut bent = DMatrix::zeros(common + own, common + own);
            // Harmonics are too small to need second derivatives.
            let is_curved = |k: &usize| !self.question.unknowns.get(*k).is_some_and(|u| u.is_harmonic());
            let curved: Vec<usize> = (0..common + own).filter(is_curved).collect();
            for (i, measured) in session.measured.iter().enumerate() {
                let Equation { residual, motions, factor, weight, .. } = self.equation(measured, s);
                let whitened = |v: &Vector3<f64>| {
                    factor.l_dirty().solve_lower_triangular(v).unwrap_or_default() * weight.sqrt()
                };
                for (k, motion) in motions.iter().enumerate() {
                    let column = whitened(&motion.slope);
                    rows.fixed_view_mut::<1, 3>(k, 3 * i).copy_from(&column.transpose());
                }
                residuals.fixed_rows_mut::<3>(3 * i).copy_from(&whitened(&residual));
                if newton != 0.0 {
                    add_curvature(&mut bent, &curved, &motions, &(factor.solve(&residual) * weight));
                }
            }
            let (square, along) = (&rows * rows.transpose() - bent * newton, &rows * &residuals);
            let place = |k: usize| if k < common { k } else { k - common + first };
            for i in 0..common + own {
                right[place(i)] += along[i];
                for j in 0..common + own {
                    normal[(place(i), place(j))] += square[(i, j)];
                }
            }
            // Without this, an arm whose tool is always upright leaves the height of its reflector undetermined.
            let coordinates = self.frames[s].reflectors.iter().flat_map(|r| r.iter().copied());
            for (k, coordinate) in coordinates.enumerate() {
                let k = first + SessionFrames::OF_BASE + k;
                normal[(k, k)] += FARTHEST_REFLECTOR.powi(-2);
                right[k] -= coordinate / FARTHEST_REFLECTOR.powi(2);
            }
            first += own;
        }
        for (k, prior) in self.priors.iter().enumerate() {
            normal[(k, k)] += prior.powi(-2);
            right[k] -= self.values[k] / prior.powi(2);
        }
        (normal, right)
    }
}

/// Returns the displacement of the point `at` (m, base frame) per unit of every actuator.
pub(super) fn drives(chain: &Chain, pose: &Deformed, at: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let motion = |j: usize| pose.motion(chain, Unknown::Row(Parameter::Dq(j)), at).slope;
    (0..chain.axes()).map(motion).collect()
}

/// Returns the Cholesky factor of a covariance, which has one because no variance is 0.
fn factor(covariance: Matrix3<f64>) -> Cholesky<f64, Const<3>> {
    covariance.cholesky().unwrap_or_else(|| Cholesky::pack_dirty(Matrix3::identity()))
}

/// Returns the covariances of positions with these Jacobians, whose unknowns have the covariance `of_unknowns`.
pub(super) fn spreads(jacobians: &[DMatrix<f64>], of_unknowns: &DMatrix<f64>) -> Vec<Matrix3<f64>> {
    // One product of large matrices is faster than many of small ones.
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

/// Adds the scalar products of `residual` with the second derivatives of a position by the motions `curved`.
///
/// The second derivative by two motions is the axis of the one nearer to the base times (vector product) the
/// displacement by the other one.
fn add_curvature(
    bent: &mut DMatrix<f64>,
    curved: &[usize],
    motions: &[PointMotion],
    residual: &Vector3<f64>,
) {
    for (place, &j) in curved.iter().enumerate() {
        let a = &motions[j];
        for &k in &curved[..=place] {
            let b = &motions[k];
            let second = match a.place.cmp(&b.place) {
                Ordering::Less => a.axis.cross(&b.slope),
                Ordering::Greater => b.axis.cross(&a.slope),
                Ordering::Equal => (a.axis.cross(&b.slope) + b.axis.cross(&a.slope)) / 2.0,
            };
            let term = residual.dot(&second);
            bent[(j, k)] += term;
            if j != k {
                bent[(k, j)] += term;
            }
        }
    }
}
