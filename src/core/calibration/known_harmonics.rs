//! Calibration with its periodic errors fixed at the identified values.
//!
//! An error set states periodic errors as functions of the posture, without a covariance of their
//! coefficients. The uncertainty of the coefficients counts as a variance of the joint coordinate.

use super::harmonics::wave;
use super::result::Calibration;
use super::unknown::Unknown;
use crate::cell::{Parameter, PeriodicError};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Number of values of one joint coordinate over which a variance is averaged.
const COORDINATES: usize = 256;

impl Calibration {
    /// Returns the identified periodic errors. The list is empty for an arm with joint coupling, because an
    /// actuator of such an arm moves more than one joint coordinate.
    pub fn periodic_errors(&self) -> Vec<PeriodicError> {
        if self.is_coupled() {
            return Vec::new();
        }
        let of_joint = |joint: usize| {
            let values = |wanted: bool| -> Vec<f64> {
                let own = self
                    .harmonics_of(joint)
                    .filter(|i| matches!(i.unknown, Unknown::Harmonic { sine, .. } if sine == wanted));
                own.map(|i| i.value).collect()
            };
            PeriodicError { joint, cos: values(false), sin: values(true) }
        };
        (0..self.ranges.len()).map(of_joint).filter(|error| !error.cos.is_empty()).collect()
    }

    /// Returns the covariance of the parameters, given the periodic errors: `C_pp - C_ph C_hh^-1 C_hp`.
    ///
    /// Here C is the covariance of all unknowns. Index p denotes the parameters, and index h the coefficients
    /// of the periodic errors. For an arm with joint coupling, the result is `C_pp`.
    pub fn covariance_beside_periodic_errors(&self) -> DMatrix<f64> {
        let (known, size) = (self.parameters().len(), self.covariance.nrows());
        let of_parameters = self.covariance.view((0, 0), (known, known)).into_owned();
        let harmonics = self.covariance.view((known, known), (size - known, size - known)).into_owned();
        let across = self.covariance.view((known, 0), (size - known, known));
        if self.is_coupled() {
            return of_parameters;
        }
        match harmonics.cholesky() {
            Some(factor) => of_parameters - across.transpose() * factor.solve(&across),
            None => of_parameters,
        }
    }

    /// Returns the variance, rad^2, that the uncertainty of a periodic error adds to the error of its joint.
    ///
    /// For an arm with joint coupling, the result is [`Self::periodic_variance`]. For any other arm, the
    /// result is the difference of two variances, but at least 0. The first variance is that of the sum of
    /// the joint-zero error dq and the periodic error. It is averaged over the measured range. The second
    /// variance is the one that the error set already states for the joint-zero error.
    /// [`Self::covariance_beside_periodic_errors`] contains the second variance.
    pub fn variance_of_periodic_error(&self, joint: usize) -> f64 {
        if self.is_coupled() {
            return self.periodic_variance(joint);
        }
        let is_own = |unknown: &Unknown| match *unknown {
            Unknown::Row(Parameter::Dq(of)) | Unknown::Harmonic { joint: of, .. } => of == joint,
            _ => false,
        };
        let own: Vec<usize> =
            (0..self.identified.len()).filter(|&k| is_own(&self.identified[k].unknown)).collect();
        if self.harmonics_of(joint).next().is_none() {
            return 0.0;
        }
        let covariance = DMatrix::from_fn(own.len(), own.len(), |i, j| self.covariance[(own[i], own[j])]);
        let (low, high) = self.ranges[joint];
        let width = (high - low).min(TAU);
        let variance_at = |k: usize| {
            let q = low + width * (k as f64 + 0.5) / COORDINATES as f64;
            let part = |&place: &usize| match self.identified[place].unknown {
                Unknown::Harmonic { order, sine, .. } => wave(q, order, sine),
                _ => 1.0,
            };
            let parts = DVector::from_iterator(own.len(), own.iter().map(part));
            parts.dot(&(&covariance * &parts))
        };
        let mean = (0..COORDINATES).map(variance_at).sum::<f64>() / COORDINATES as f64;
        let zero = self.parameters().iter().position(|i| i.unknown == Unknown::Row(Parameter::Dq(joint)));
        let stated = zero.map_or(0.0, |k| self.covariance_beside_periodic_errors()[(k, k)]);
        (mean - stated).max(0.0)
    }
}
