//! Residual variances: variances of the random errors of joints and positions that the identified
//! parameters do not explain.
//!
//! Gears and bearings add an error to each actuator coordinate. This error depends on the posture in a way
//! that no parameter describes. The model of the remaining error of a measured position is
//!
//! ```text
//! r ~ N(0, sum_j v_j g_j g_j^T + (v_0 + u^2) I)
//! ```
//!
//! Here `g_j` is the displacement of the point per unit of actuator j, and `u` is the stated standard
//! deviation of the measurement. The variances `v_j` and `v_0` are found by restricted maximum likelihood
//! with Fisher's scoring (Harville 1977).

use crate::cell::{JointKind, MAX_JOINTS};
use crate::robot::Chain;
use crate::units::m_from_mm;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Largest number of variances.
const MAX_VARIANCES: usize = MAX_JOINTS + 1;
/// Expected standard deviation of the unexplained error of a revolute joint before the fit, rad.
const EXPECTED_ANGLE: f64 = 3e-4;
/// Standard deviation that sets the smallest variance of a joint, rad or m. The smallest variance is
/// [`NEGLIGIBLE`] times the square of this value.
const FINEST_JOINT: f64 = 1e-7;
/// Smallest initial standard deviation of a position, m; no laser tracker is more accurate. The smallest
/// fitted variance is [`NEGLIGIBLE`] times the square of this value.
const FINEST_POSITION: f64 = 1e-6;
/// Largest factor by which one step may change a variance.
const STEEPEST: f64 = 10.0;
/// Share of a variance that counts as negligible.
///
/// The relative change of a joint variance is its change divided by `v + NEGLIGIBLE e`. Here `v` is the
/// variance before the step, and `e` is the expected variance.
/// The smallest variance is this share of the square of [`FINEST_JOINT`] or [`FINEST_POSITION`]. So the
/// smallest standard deviation is about 0.03 times [`FINEST_JOINT`] or [`FINEST_POSITION`].
const NEGLIGIBLE: f64 = 1e-3;

/// Factors that enlarge the variances of the joints in the fit: without harmonics, then with harmonics.
///
/// Errors of a joint depend on the posture, so nearby postures have nearly the same misfit. Nearby postures
/// therefore carry less information than the same number of independent postures. Harmonics explain a part
/// of the common misfit. The values come from a real arm (results/measured).
const CORRELATED: [f64; 2] = [4.0, 2.0];

/// Variances of the errors that the identified parameters do not explain.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualVariances {
    /// Variance of the error of every actuator coordinate, rad^2 or m^2.
    pub joints: Vec<f64>,
    /// Variance per axis of the part of the position error that no joint causes, m^2.
    pub position: f64,
    expected: Vec<f64>,
    /// Factor that enlarges the variances of the joints in the fit.
    correlated: f64,
}

impl ResidualVariances {
    /// Returns the initial variances. The argument `spread` is the standard deviation (m, per axis) of
    /// measured minus predicted positions.
    pub fn expected(chain: &Chain, has_harmonics: bool, spread: f64) -> Self {
        let of_joint = |kind| match kind {
            JointKind::Revolute => EXPECTED_ANGLE.powi(2),
            JointKind::Prismatic => m_from_mm(0.1).powi(2),
        };
        let expected: Vec<_> = chain.links.iter().map(|link| of_joint(link.kind)).collect();
        let position = spread.max(FINEST_POSITION).powi(2);
        let correlated = CORRELATED[usize::from(has_harmonics)];
        Self { joints: expected.clone(), position, expected, correlated }
    }

    /// Returns the covariance of the unexplained error of one measured position, m^2.
    ///
    /// `drives` holds the displacement of the measured point per unit of every actuator coordinate. `stated`
    /// is the standard deviation per axis that the file of the measurement states, m.
    pub fn covariance(&self, drives: &[Vector3<f64>], stated: Option<f64>) -> Matrix3<f64> {
        let own = Matrix3::identity() * (self.position + stated.unwrap_or(0.0).powi(2));
        drives.iter().zip(&self.joints).fold(own, |sum, (g, v)| sum + g * g.transpose() * *v)
    }

    /// Returns the covariance (m^2) that weights the residual in the fit. Unlike [`Self::covariance`], this
    /// function enlarges the variances of the joints, because nearby postures have nearly the same misfit.
    pub fn covariance_of_fit(&self, drives: &[Vector3<f64>], stated: Option<f64>) -> Matrix3<f64> {
        let joints = self.joints.iter().map(|v| v * self.correlated).collect();
        Self { joints, ..self.clone() }.covariance(drives, stated)
    }

    /// Returns the variances after the fraction `share` of one step of Fisher's scoring method. Also returns
    /// the signed relative change of the variance that changes most.
    pub fn improved(&self, scores: &Scores, share: f64) -> (Self, f64) {
        let count = self.joints.len() + 1;
        let mut information = DMatrix::from_fn(count, count, |i, j| scores.information[i][j]);
        let mut gradient = DVector::from_fn(count, |i, _| scores.gradient[i]);
        // The expected variance has the same weight as two observed joint errors. If the data contain no
        // information, only the expected variance counts.
        for (k, (v, expected)) in self.joints.iter().zip(&self.expected).enumerate() {
            information[(k, k)] += expected.powi(-2);
            gradient[k] += (expected - v) / expected.powi(2);
        }
        // Units differ by many orders of magnitude, so the system is scaled to a unit diagonal.
        let scale: Vec<f64> = (0..count).map(|i| information[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
        let scaled = DMatrix::from_fn(count, count, |i, j| information[(i, j)] / (scale[i] * scale[j]));
        let right = DVector::from_fn(count, |i, _| gradient[i] / scale[i]);
        let Some(step) = scaled.cholesky().map(|factor| factor.solve(&right)) else {
            return (self.clone(), 0.0);
        };
        let mut next = self.clone();
        let mut change = 0.0;
        let finest = std::iter::repeat_n(FINEST_JOINT, count - 1).chain([FINEST_POSITION]);
        let negligible = self.expected.iter().map(|v| NEGLIGIBLE * v).chain([FINEST_POSITION.powi(2)]);
        let variances = next.joints.iter_mut().chain([&mut next.position]);
        for (k, ((v, finest), negligible)) in variances.zip(finest).zip(negligible).enumerate() {
            let moved = (*v + step[k] / scale[k] * share).clamp(*v / STEEPEST, *v * STEEPEST);
            let moved = moved.max(finest.powi(2) * NEGLIGIBLE);
            let own = (moved - *v) / (*v + negligible);
            change = if own.abs() > f64::abs(change) { own } else { change };
            *v = moved;
        }
        (next, change)
    }
}

/// Derivatives of the restricted likelihood with respect to the variances.
#[derive(Debug, Clone)]
pub struct Scores {
    gradient: [f64; MAX_VARIANCES],
    information: [[f64; MAX_VARIANCES]; MAX_VARIANCES],
}

impl Scores {
    /// Returns derivatives that are all 0, to which positions can be added.
    pub fn none() -> Self {
        Self { gradient: [0.0; MAX_VARIANCES], information: [[0.0; MAX_VARIANCES]; MAX_VARIANCES] }
    }

    /// Adds one measured position.
    ///
    /// `inverse` is the inverse of the covariance of the position. `scatter` is the outer product `r r^T` of
    /// the remaining error, plus the covariance of the fitted position.
    pub fn add(&mut self, drives: &[Vector3<f64>], inverse: &Matrix3<f64>, scatter: &Matrix3<f64>) {
        let last = drives.len();
        for (k, g) in drives.iter().enumerate() {
            let weighed = inverse * g;
            self.gradient[k] += (weighed.dot(&(scatter * weighed)) - g.dot(&weighed)) / 2.0;
            for (l, other) in drives.iter().enumerate() {
                self.information[k][l] += weighed.dot(other).powi(2) / 2.0;
            }
            self.information[k][last] += weighed.norm_squared() / 2.0;
            self.information[last][k] += weighed.norm_squared() / 2.0;
        }
        self.gradient[last] += ((inverse * scatter * inverse).trace() - inverse.trace()) / 2.0;
        self.information[last][last] += inverse.norm_squared() / 2.0;
    }
}
