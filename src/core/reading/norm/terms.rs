//! Random terms that represent all parameters of an error, one per coordinate of a point.
//!
//! The normal parameters act as one vector along the principal axes of its covariance. The least bounded parameters
//! join it if their share in the excess kurtosis is small: fewer coordinates need fewer points. Each axis then has
//! the excess kurtosis that they cause there ([`PowerNormal`]).

use super::dominance::Dominance;
use super::jacobi::{covariance, diagonalize};
use super::points::COORDINATES;
use super::power_normal::PowerNormal;
use crate::cell::Distribution;
use crate::reading::MAX_SOURCES;
use nalgebra::Vector6;

/// Largest number of parameters beside the dominating one that keep their own distributions.
///
/// The other coordinates of a point belong to the principal axes of the rest.
const MAX_OWN: usize = COORDINATES - 6;

/// Largest excess kurtosis of the error without the dominating parameter that may come from bounded parameters without
/// a distribution of their own.
const MAX_REST_EXCESS: f64 = 0.008;

/// Weight of a parameter that alone varies the error in its direction, relative to its share.
const THIN_WEIGHT: f64 = 0.5;

/// Random term of an error.
#[derive(Clone, Copy)]
pub struct RandomTerm {
    /// Effect at one standard deviation.
    pub effect: Vector6<f64>,
    pub distribution: Distribution,
    /// Function of the variable that scales the effect.
    pub shape: PowerNormal,
}

impl RandomTerm {
    const NONE: Self = Self {
        effect: Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        distribution: Distribution::Normal,
        shape: PowerNormal::IDENTITY,
    };

    /// Returns independent terms whose sum has the distribution of the error, the largest first.
    ///
    /// The error has `m` components, and `effects` are those of independent parameters at one standard deviation. The
    /// effects of parameters that keep their own distributions are set to zero there.
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

/// Moves the bounded parameters whose distributions matter most from `effects` to `terms`, and returns their number.
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

/// Returns how much the distribution of a parameter matters, 0 to 1, from its shares in the variance of the error and
/// in the variance along its own effect.
///
/// This is the squared share of the parameter in the variance. A parameter that alone varies the error in its
/// direction also matters for small probabilities, in proportion to its size.
fn weight((share, alone): (f64, f64)) -> f64 {
    (share * share).max(THIN_WEIGHT * alone * alone * share.sqrt())
}

/// Writes independent terms along the principal axes of all effects, whose sum has their covariance.
///
/// The excess kurtosis of the term along axis a, with the variance v, is `sum_k gamma_k (g_k.a)^2 |g_k|^2 / v^2`, where
/// `gamma_k` is that of parameter k, and `g_k` its effect. So the variance of the squared length of the sum is kept.
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
