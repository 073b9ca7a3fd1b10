//! Encoder harmonics: errors of an actuator that are periodic in its own coordinate.
//!
//! Encoders, gears and bearings repeat their errors with every revolution of a joint. The error of actuator j
//! is
//!
//! ```text
//! e_j(q_j) = sum_k a_jk cos(k q_j) + b_jk sin(k q_j),   a_jk, b_jk ~ N(0, (f_j s_k)^2)
//! ```
//!
//! Here `s_k` is the expected standard deviation of a coefficient of order k. So `e_j` is a Gaussian process,
//! in which nearby postures have nearly the same error. Outside the measured range, the error is as uncertain
//! as before the measurement. Let `S_j` be the sum of the squared ratios `a_jk / s_k` and `b_jk / s_k`. Let
//! `n_j` be the number of coefficients that the data determine. The factor `f_j^2` is then
//! `(S_j + 20) / (n_j + 20)`. The fit estimates this factor together with the coefficients (D. J. C. MacKay,
//! "Bayesian interpolation", Neural Computation 4, 1992). The expectation that `f_j` is 1 counts as much as
//! twenty coefficients. This weight is high because the errors in the measured range say little about the
//! rest of the revolution.

use super::unknown::{Unknown, expected_harmonic};
use crate::cell::{JointKind, MAX_JOINTS};
use crate::robot::Chain;
use nalgebra::DMatrix;

/// Weight of the expectation `f_j = 1`, as a number of determined coefficients.
const WEIGHT_OF_EXPECTATION: f64 = 20.0;

/// Returns the harmonics (periodic errors) of every revolute joint, as unknowns of a calibration. The
/// harmonics have the orders 1 to `orders`.
pub fn harmonics(chain: &Chain, orders: usize) -> Vec<Unknown> {
    let turning = (0..chain.axes()).filter(|&j| chain.links[j].kind == JointKind::Revolute);
    let of_joint = |joint| {
        let orders = (1..=orders).map(move |order| (joint, order));
        orders.flat_map(|(joint, order)| [false, true].map(|sine| Unknown::Harmonic { joint, order, sine }))
    };
    turning.flat_map(of_joint).collect()
}

/// Returns the sine of `order` times the angle `q` (rad) if `sine` is true, otherwise the cosine.
pub(super) fn wave(q: f64, order: usize, sine: bool) -> f64 {
    let angle = order as f64 * q;
    if sine { angle.sin() } else { angle.cos() }
}

/// Updates the prior standard deviations of the harmonics. Returns the largest relative change of a variance.
///
/// `covariance` is the covariance of the unknowns, whose estimates are `values`. The matrix may have further
/// rows and columns.
pub(super) fn improve_deviations(
    unknowns: &[Unknown],
    values: &[f64],
    covariance: &DMatrix<f64>,
    deviations: &mut [f64],
) -> f64 {
    let mut largest: f64 = 0.0;
    for joint in 0..MAX_JOINTS {
        // Indices and expected standard deviations of the coefficients of the joint.
        let own = unknowns.iter().enumerate().filter_map(|(k, unknown)| match *unknown {
            Unknown::Harmonic { joint: of, order, .. } if of == joint => Some((k, expected_harmonic(order))),
            _ => None,
        });
        let own: Vec<(usize, f64)> = own.collect();
        let Some(before) = own.first().map(|&(k, expected)| (deviations[k] / expected).powi(2)) else {
            continue;
        };
        let squares: f64 = own.iter().map(|&(k, expected)| (values[k] / expected).powi(2)).sum();
        let determined: f64 =
            own.iter().map(|&(k, _)| 1.0 - covariance[(k, k)] / deviations[k].powi(2)).sum();
        let after = (squares + WEIGHT_OF_EXPECTATION) / (determined.max(0.0) + WEIGHT_OF_EXPECTATION);
        largest = largest.max((after / before - 1.0).abs());
        own.iter().for_each(|&(k, expected)| deviations[k] = expected * after.sqrt());
    }
    largest
}
