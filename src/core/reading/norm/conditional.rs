//! Distribution of the norm `|e|` where parameters with bounded distributions dominate: conditional Monte
//! Carlo with quasi-random points.
//!
//! Let `u` be the bounded parameter with the largest effect `g`. Given all other parameters, `|e| <= c` holds
//! on an interval of `u`, because a ball is convex. The conditional probability of this interval has a
//! closed form, and its mean over the other parameters is `P(|e| <= c)`:
//!
//! ```text
//! e = a + g u,   t = a . g / |g|,   h = sqrt(c^2 - |a|^2 + t^2)
//! P(|e| <= c) = E_a P(-h <= t + |g| u <= h)
//! ```
//!
//! The mean is taken over a fixed set of weighted low-discrepancy points. The integrand has kinks but no jumps, which is
//! what such points need (A. Griewank, F. Y. Kuo, H. Leovey, I. H. Sloan, "High dimensional integration of
//! kinks and jumps: smoothing by preintegration", J. Comput. Appl. Math. 344 (2018) 259-274).
//!
//! The normal parameters act as one vector along the principal axes of its covariance. The least bounded parameters
//! join it if their share in the excess kurtosis is small: fewer coordinates need fewer points. Each axis then has
//! the excess kurtosis that they cause there ([`PowerNormal`]).

use super::jacobi::{covariance, diagonalize};
use super::points::{COORDINATES, POINTS, coordinate, half_width};
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

/// Number of points that are added up side by side; a divisor of [`POINTS`].
const LANES: usize = 4;

/// Distribution of the norm of a random vector with a dominating bounded parameter.
pub struct ConditionalNorm<'a> {
    /// Component of the other parameters' error along the effect of the dominating one, at each point.
    along: &'a [f64],
    /// Squared length of the component across that effect, at each point.
    across: &'a [f64],
    /// Weight of each point; the weights add up to 1.
    weights: &'a [f64],
    /// Half width of the dominating parameter's effect.
    width: f64,
    distribution: Distribution,
    rms: f64,
}

/// Working memory of a [`ConditionalNorm`]: the weight of each point, and the components of its error.
#[derive(Default)]
pub struct ConditionalScratch(Vec<f64>);

impl ConditionalScratch {
    /// Allocates the memory, and prepares the points that all evaluations share.
    pub fn new() -> Self {
        coordinate(0, Distribution::Uniform);
        Self(vec![0.0; 7 * POINTS])
    }
}

/// Random term of the error.
#[derive(Clone, Copy)]
struct RandomTerm {
    /// Effect at one standard deviation.
    effect: Vector6<f64>,
    distribution: Distribution,
    /// Function of the variable that scales the effect.
    shape: PowerNormal,
}

impl RandomTerm {
    const NONE: Self = Self {
        effect: Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        distribution: Distribution::Normal,
        shape: PowerNormal::IDENTITY,
    };
}

impl<'a> ConditionalNorm<'a> {
    /// Returns the distribution of `|e|`, where `e` are the first `m` components of a random vector.
    ///
    /// `columns` are the effects of independent parameters at one standard deviation, and `mean` is the mean
    /// of `e`. Returns None without a bounded parameter that has an effect.
    pub fn new(
        m: usize,
        columns: &[Vector6<f64>],
        distributions: &[Distribution],
        mean: &Vector6<f64>,
        scratch: &'a mut ConditionalScratch,
    ) -> Option<Self> {
        let cut = |v: &Vector6<f64>| Vector6::from_fn(|i, _| if i < m { v[i] } else { 0.0 });
        let (mut effects, mean) = ([Vector6::zeros(); MAX_SOURCES], cut(mean));
        columns.iter().zip(&mut effects).for_each(|(column, effect)| *effect = cut(column));
        let effects = &mut effects[..columns.len()];
        let trace: f64 = effects.iter().map(Vector6::norm_squared).sum();
        let size = |k: &usize| effects[*k].norm_squared();
        let is_bounded = |k: &usize| distributions[*k] != Distribution::Normal && size(k) > 0.0;
        let largest = |a: &usize, b: &usize| size(a).total_cmp(&size(b)).then(b.cmp(a));
        let first = (0..columns.len()).filter(is_bounded).max_by(largest)?;
        let dominating = std::mem::take(&mut effects[first]);

        let mut terms = [RandomTerm::NONE; COORDINATES];
        let own = take_dominating(effects, distributions, &mut terms);
        principal_axes(m, effects, distributions, &mut terms[own..]);
        terms.sort_by(|a, b| b.effect.norm_squared().total_cmp(&a.effect.norm_squared()));
        let used = terms.iter().take_while(|term| term.effect != Vector6::zeros()).count();
        let reflection = Reflection::onto_first(&dominating);
        sample(m, &reflection.of(&mean), &terms[..used], &reflection, &mut scratch.0);

        let (weights, components) = scratch.0.split_at(POINTS);
        let (along, across) = components.split_at(POINTS);
        let distribution = distributions[first];
        let width = dominating.norm() * half_width(distribution);
        let rms = (trace + mean.norm_squared()).sqrt();
        Some(Self { along, across: &across[..POINTS], weights, width, distribution, rms })
    }

    /// Returns the RMS `sqrt(E |e|^2)`, which is exact.
    pub fn rms(&self) -> f64 {
        self.rms
    }

    /// Returns the mean of `|e|`: the conditional mean has a closed form, too.
    ///
    /// The density of the dominating parameter is constant or piecewise linear. So the conditional mean of
    /// `sqrt(r + s^2)` is a difference of its first or second antiderivatives at the ends of the interval.
    pub fn mean(&self) -> f64 {
        let w = self.width;
        let given = |t: f64, r: f64| match self.distribution {
            Distribution::Triangular => {
                (antiderivatives(t + w, r)[1] - 2.0 * antiderivatives(t, r)[1] + antiderivatives(t - w, r)[1])
                    / (w * w)
            }
            _ => (antiderivatives(t + w, r)[0] - antiderivatives(t - w, r)[0]) / (2.0 * w),
        };
        let points = self.along.iter().zip(self.across).zip(self.weights);
        points.map(|((t, r), weight)| weight * given(*t, *r)).sum::<f64>().min(self.rms)
    }

    /// Returns the probability `P(|e| <= c)`.
    pub fn cdf(&self, c: f64) -> f64 {
        if c < 0.0 { 0.0 } else { self.cdf_and_density(c)[0].clamp(0.0, 1.0) }
    }

    /// Returns the least c with `P(|e| <= c) = p`, by Newton's method within a bracket.
    pub fn quantile(&self, p: f64) -> f64 {
        const MAX_STEPS: usize = 100;
        const CONVERGED: f64 = 1e-10;
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut x = 1.6 * self.rms;
        for _ in 0..MAX_STEPS {
            let [f, density] = self.cdf_and_density(x);
            if f < p {
                low = x;
            } else {
                high = x;
            }
            let next = x + (p - f) / density;
            if (next - x).abs() <= CONVERGED * x || high - low <= CONVERGED * low {
                return x;
            }
            x = match next > low && next < high {
                true => next,
                false if high == f64::INFINITY => 2.0 * x,
                false => 0.5 * (low + high),
            };
        }
        x
    }

    /// Returns `P(|e| <= c)` and its derivative by c.
    fn cdf_and_density(&self, c: f64) -> [f64; 2] {
        let scale = 1.0 / self.width;
        // Independent sums in each lane let the processor add several points at once.
        let mut sums = [[0.0; LANES]; 4];
        let [linear, bent, level, tilt] = &mut sums;
        let lanes = |values: &'a [f64]| values.chunks_exact(LANES);
        for ((t, r), weight) in lanes(self.along).zip(lanes(self.across)).zip(lanes(self.weights)) {
            for l in 0..LANES {
                let h = (c * c - r[l]).max(0.0).sqrt();
                let slope = if h > 0.0 { weight[l] * c / h } else { 0.0 };
                let high = ((h - t[l]) * scale).clamp(-1.0, 1.0);
                let low = ((-h - t[l]) * scale).clamp(-1.0, 1.0);
                let (a, b) = (high.abs(), low.abs());
                linear[l] += weight[l] * (high - low);
                bent[l] += weight[l] * (high * a - low * b);
                level[l] += if a < 1.0 { slope } else { 0.0 } + if b < 1.0 { slope } else { 0.0 };
                tilt[l] += slope * (2.0 - a - b);
            }
        }
        let [linear, bent, level, tilt] = sums.map(|lanes| lanes.iter().sum::<f64>());
        match self.distribution {
            Distribution::Triangular => [linear - 0.5 * bent, tilt * scale],
            _ => [0.5 * linear, 0.5 * level * scale],
        }
    }
}

/// Moves the bounded parameters whose distributions matter most from `effects` to `terms`, and returns their number.
fn take_dominating(
    effects: &mut [Vector6<f64>],
    distributions: &[Distribution],
    terms: &mut [RandomTerm],
) -> usize {
    let (mut order, mut excess) = ([0; MAX_SOURCES], [0.0; MAX_SOURCES]);
    for (k, (effect, distribution)) in effects.iter().zip(distributions).enumerate() {
        (order[k], excess[k]) = (k, distribution.excess_kurtosis().abs() * weight(effect, effects));
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

/// Returns how much the distribution of a parameter with the effect `g` matters among the effects, 0 to 1.
///
/// This is the squared share of the parameter in the variance. A parameter that alone varies the error in its
/// direction also matters for small probabilities, in proportion to its size.
fn weight(g: &Vector6<f64>, effects: &[Vector6<f64>]) -> f64 {
    let (own, mut trace, mut along) = (g.norm_squared(), 0.0, 0.0);
    if own == 0.0 {
        return 0.0;
    }
    for effect in effects {
        let product = g.dot(effect);
        along += product * product;
        trace += effect.norm_squared();
    }
    let (share, alone) = (own / trace, own * own / along);
    (share * share).max(THIN_WEIGHT * alone * alone * share.sqrt())
}

/// Returns the first and second antiderivative of `sqrt(r + s^2)` by s.
fn antiderivatives(s: f64, r: f64) -> [f64; 2] {
    let q = (r + s * s).sqrt();
    let turn = if r > 0.0 { (s / r.sqrt()).asinh() } else { 0.0 };
    [0.5 * (s * q + r * turn), q * q * q / 6.0 + 0.5 * r * (s * turn - q)]
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

/// Householder reflection that turns a vector onto the first axis.
struct Reflection {
    normal: Vector6<f64>,
    scale: f64,
}

impl Reflection {
    fn onto_first(v: &Vector6<f64>) -> Self {
        let mut normal = v / v.amax();
        normal[0] += normal.norm().copysign(normal[0]);
        Self { normal, scale: 2.0 / normal.norm_squared() }
    }

    fn of(&self, v: &Vector6<f64>) -> Vector6<f64> {
        v - self.normal * (self.scale * self.normal.dot(v))
    }
}

/// Writes the weight of each point, the first component of the error of all terms there, and the squared
/// length of the other components.
fn sample(m: usize, mean: &Vector6<f64>, terms: &[RandomTerm], reflection: &Reflection, out: &mut [f64]) {
    let (weights, components) = out.split_at_mut(POINTS);
    weights.fill(1.0);
    for (i, component) in components.chunks_exact_mut(POINTS).enumerate().take(m.max(2)) {
        component.fill(mean[i]);
    }
    for (k, term) in terms.iter().enumerate() {
        let (values, densities) = coordinate(k, term.distribution);
        let (effect, shape) = (reflection.of(&term.effect), term.shape);
        weights.iter_mut().zip(densities).for_each(|(weight, density)| *weight *= density);
        for (i, component) in components.chunks_exact_mut(POINTS).enumerate().take(m) {
            component.iter_mut().zip(values).for_each(|(sum, z)| *sum += effect[i] * shape.value(*z));
        }
    }
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let (across, others) = components[POINTS..].split_at_mut(POINTS);
    across.iter_mut().for_each(|a| *a *= *a);
    for component in others.chunks_exact(POINTS).take(m.saturating_sub(2)) {
        across.iter_mut().zip(component).for_each(|(sum, a)| *sum += a * a);
    }
}
