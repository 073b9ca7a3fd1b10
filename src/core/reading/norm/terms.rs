//! Random terms of an error: they represent all parameters except the dominating parameter, which is treated
//! separately. Each term uses one coordinate of a low-discrepancy point.
//!
//! All normal parameters are merged: one term for each principal axis of their covariance. Bounded parameters
//! that contribute little excess kurtosis are merged with the normal parameters, because fewer coordinates
//! need fewer points. Each merged term has the excess kurtosis that the merged parameters cause along its
//! axis ([`PowerNormal`]). The other bounded parameters have one term each.

use super::dominance::Dominance;
use super::jacobi::{covariance, diagonalize};
use super::points::COORDINATES;
use super::power_normal::PowerNormal;
use crate::cell::Distribution;
use crate::reading::MAX_SOURCES;
use nalgebra::Vector6;

/// Largest number of parameters with their own terms, without the dominating parameter.
///
/// The other six coordinates of a point belong to the terms of the merged parameters.
const MAX_OWN: usize = COORDINATES - 6;

/// Largest sum of absolute excess kurtoses at which all bounded parameters without their own term are merged.
/// The sum excludes the dominating parameter and the parameters with their own term.
///
/// The excess kurtosis of each parameter is multiplied by its [`weight`] before the sum.
const MAX_REST_EXCESS: f64 = 0.008;

/// Factor in [`weight`] for a parameter whose effect is perpendicular to all other effects.
///
/// The factor multiplies the size of this effect divided by the standard deviation of the error.
const THIN_WEIGHT: f64 = 0.5;

/// Random term of an error: `effect` times a function of a random variable z.
#[derive(Clone, Copy)]
pub struct RandomTerm {
    /// Effect of the term at one standard deviation.
    pub effect: Vector6<f64>,
    pub distribution: Distribution,
    /// Function of z by which `effect` is multiplied; z has the distribution `distribution`.
    pub shape: PowerNormal,
}

impl RandomTerm {
    const NONE: Self = Self {
        effect: Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        distribution: Distribution::Normal,
        shape: PowerNormal::IDENTITY,
    };

    /// Returns independent terms, the largest first; their sum has approximately the distribution of the
    /// error.
    ///
    /// `effects` holds the effects of independent parameters on the `m` components of the error, at one
    /// standard deviation. If a parameter gets its own term, the function sets the effect of this parameter
    /// to zero.
    pub fn of_parameters(
        m: usize,
        effects: &mut [Vector6<f64>],
        distributions: &[Distribution],
    ) -> [Self; COORDINATES] {
        let mut terms = [Self::NONE; COORDINATES];
        let own = take_dominating(m, effects, distributions, &mut terms);
        principal_axes(m, effects, distributions, &mut terms[own..]);
        terms.sort_by(|a, b| b.effect.norm_squared().total_cmp(&a.effect.norm_squared()));
        terms
    }
}

/// Moves the bounded parameters with the largest weighted excess kurtosis from `effects` to `terms`, and
/// returns their number.
fn take_dominating(
    m: usize,
    effects: &mut [Vector6<f64>],
    distributions: &[Distribution],
    terms: &mut [RandomTerm],
) -> usize {
    let dominance = Dominance::among(m, effects);
    let (mut order, mut excess) = ([0; MAX_SOURCES], [0.0; MAX_SOURCES]);
    for (k, (effect, distribution)) in effects.iter().zip(distributions).enumerate() {
        (order[k], excess[k]) = (k, distribution.excess_kurtosis().abs() * weight(dominance.shares(effect)));
    }
    let order = &mut order[..effects.len()];
    order.sort_unstable_by(|a, b| excess[*b].total_cmp(&excess[*a]).then(a.cmp(b)));
    let mut left: f64 = excess.iter().sum();
    let mut own = 0;
    for (&k, term) in order.iter().zip(terms).take(MAX_OWN) {
        if left <= MAX_REST_EXCESS {
            break;
        }
        left -= excess[k];
        let effect = std::mem::take(&mut effects[k]);
        *term = RandomTerm { effect, distribution: distributions[k], shape: PowerNormal::IDENTITY };
        own += 1;
    }
    own
}

/// Returns the influence of the distribution of a parameter on the distribution of the norm, from 0 to 1.
///
/// `share` is the share of the parameter in the variance of the error. `alone` is its share in the variance
/// along its own effect.
///
/// The result is at least `share^2`. If `alone` is 1, all other effects are perpendicular to the effect of
/// this parameter. Then its influence on the probabilities of small norms is proportional to `sqrt(share)`.
/// This root is the size of the effect divided by the standard deviation of the error.
fn weight((share, alone): (f64, f64)) -> f64 {
    (share * share).max(THIN_WEIGHT * alone * alone * share.sqrt())
}

/// Writes one term for each principal axis of the covariance of the merged parameters.
///
/// The terms are independent, and their sum has this covariance.
///
/// The term along axis a has the variance v and the excess kurtosis `sum_k gamma_k (g_k.a)^2 |g_k|^2 / v^2`.
/// Here parameter k has the excess kurtosis `gamma_k` and the effect `g_k`. Let e be the part of the error
/// that the merged parameters cause. Then the squared length of the sum of these terms has the same variance
/// as `|e|^2`.
fn principal_axes(
    m: usize,
    effects: &[Vector6<f64>],
    distributions: &[Distribution],
    terms: &mut [RandomTerm],
) {
    let largest = effects.iter().map(|g| g.amax()).fold(0.0, f64::max);
    if largest == 0.0 {
        return;
    }
    let mut s = covariance(m, effects, 1.0 / largest);
    let axes = diagonalize(m, &mut s);
    for ((k, axis), term) in axes.iter().enumerate().take(m).zip(terms) {
        let axis = Vector6::from_fn(|i, _| if i < m { axis[i] } else { 0.0 });
        let fourth = effects.iter().zip(distributions).map(|(effect, distribution)| {
            let g = effect / largest;
            distribution.excess_kurtosis() * g.dot(&axis).powi(2) * g.norm_squared()
        });
        let variance = s[k][k].max(0.0);
        let kurtosis = fourth.sum::<f64>() / (variance * variance);
        let shape = PowerNormal::with_excess_kurtosis(kurtosis);
        let effect = largest * variance.sqrt() * axis;
        *term = RandomTerm { effect, distribution: Distribution::Normal, shape };
    }
}
