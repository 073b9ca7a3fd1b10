//! Normal equations of a fit.

use super::deformed::PointMotion;
use super::fit_state::{FitState, PositionEquation};
use super::rigid::{FARTHEST_REFLECTOR, SessionFrames};
use super::session::MeasuringSession;
use nalgebra::{DMatrix, DVector, Vector3};
use std::cmp::Ordering;

/// Hessian of half the sum of squares, and the negative gradient of this half sum.
///
/// The unknowns of the arm come first, followed by the unknowns of the frames of every session.
#[derive(Debug, Clone)]
pub(super) struct NormalEquations {
    pub hessian: DMatrix<f64>,
    pub right: DVector<f64>,
}

impl NormalEquations {
    /// Returns the equations of the measured positions.
    ///
    /// The second derivatives of the positions enter the Hessian with the factor `newton`: 1 gives Newton's
    /// method, 0 the Gauss-Newton method.
    pub fn of_positions(state: &FitState<'_>, sessions: &[MeasuringSession], newton: f64) -> Self {
        let common = state.question.unknowns.len();
        let size = common + state.frames.iter().map(SessionFrames::size).sum::<usize>();
        let (mut hessian, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        // Harmonics are too small to need second derivatives.
        let is_curved = |k: &usize| !state.question.unknowns.get(*k).is_some_and(|u| u.is_harmonic());
        let mut first = common;
        for (s, (session, frames)) in sessions.iter().zip(&state.frames).enumerate() {
            let (own, count) = (common + frames.size(), 3 * session.measured.len());
            let curved: Vec<usize> = (0..own).filter(is_curved).collect();
            let (mut rows, mut residuals) = (DMatrix::zeros(own, count), DVector::zeros(count));
            let mut bent = DMatrix::zeros(own, own);
            for (i, measured) in session.measured.iter().enumerate() {
                let PositionEquation { residual, motions, factor, weight, .. } = state.equation(measured, s);
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
            for i in 0..own {
                right[place(i)] += along[i];
                for j in 0..own {
                    hessian[(place(i), place(j))] += square[(i, j)];
                }
            }
            first += frames.size();
        }
        Self { hessian, right }
    }

    /// Adds the prior expectations of the unknowns of the arm and of the reflectors. The prior precisions
    /// (inverse variances) of the unknowns of the arm are multiplied by `1 + damping` in the Hessian.
    ///
    /// Without the expectation of the reflectors, the height of the reflector is undetermined on an arm whose
    /// tool is always upright.
    pub fn with_expectations(mut self, state: &FitState<'_>, damping: f64) -> Self {
        for (k, (prior, value)) in state.priors.iter().zip(&state.values).enumerate() {
            self.hessian[(k, k)] += (1.0 + damping) * prior.powi(-2);
            self.right[k] -= value / prior.powi(2);
        }
        let mut first = state.values.len();
        for frames in &state.frames {
            let coordinates = frames.reflectors.iter().flat_map(|r| r.iter().copied());
            for (k, coordinate) in coordinates.enumerate() {
                let k = first + SessionFrames::OF_BASE + k;
                self.hessian[(k, k)] += FARTHEST_REFLECTOR.powi(-2);
                self.right[k] -= coordinate / FARTHEST_REFLECTOR.powi(2);
            }
            first += frames.size();
        }
        self
    }

    /// Returns these equations minus the equations `some`, which belong to a part of the measured
    /// positions.
    pub fn without(&self, some: &Self) -> Self {
        Self { hessian: &self.hessian - &some.hessian, right: &self.right - &some.right }
    }

    /// Returns the step of the unknowns and their covariance, or None if the Hessian is not positive
    /// definite.
    pub fn solution(self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let factor = self.hessian.cholesky()?;
        Some((factor.solve(&self.right), factor.inverse()))
    }
}

/// Adds to `bent` the scalar products of `residual` with the second derivatives of a position. The
/// derivatives are with respect to the motions with the indices `curved`.
///
/// The second derivative with respect to two motions is a cross product. The motion nearer to the base gives
/// the axis, and the other motion gives the displacement.
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
