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
//! The mean is taken over a fixed set of weighted low-discrepancy points. The integrand has kinks but no
//! jumps, so low-discrepancy points integrate it accurately (A. Griewank, F. Y. Kuo, H. Leovey, I. H. Sloan,
//! "High dimensional integration of kinks and jumps: smoothing by preintegration", J. Comput. Appl. Math. 344
//! (2018) 259-274).

use super::points::{PointSet, half_width};
use super::terms::RandomTerm;
use crate::cell::Distribution;
use crate::reading::MAX_SOURCES;
use nalgebra::Vector6;

/// Number of partial sums over the points. The processor updates these sums together. The number divides
/// [`PointSet::count`].
const LANES: usize = 4;

/// Distribution of the norm `|e|` of a random vector `e`, in which one bounded parameter dominates. A bounded
/// parameter has a uniform or triangular distribution.
pub struct ConditionalNorm<'a> {
    /// Component of the error along the effect of the dominating parameter, at each point. The error excludes
    /// this parameter.
    along: &'a [f64],
    /// Squared length of the part of the error perpendicular to the effect of the dominating parameter, at
    /// each point. The error excludes this parameter.
    across: &'a [f64],
    /// Weight of each point; the weights add up to 1.
    weights: &'a [f64],
    /// Size of the effect of the dominating parameter at the limit of its range.
    width: f64,
    distribution: Distribution,
    rms: f64,
}

/// Working memory of a [`ConditionalNorm`]: the weight of each quasi-random point, and the components of the
/// error at this point.
#[derive(Default)]
pub struct ConditionalScratch(Vec<f64>);

impl ConditionalScratch {
    /// Allocates the memory for errors of at most `m` components. Also prepares the quasi-random points that
    /// all evaluations share.
    pub fn of_components(m: usize) -> Self {
        let mut scratch = Self::default();
        (1..=m).for_each(|m| {
            scratch.at_least(m, PointSet::of_components(m));
        });
        scratch
    }

    /// Returns memory for errors of `m` components at `points`; enlarges the memory if it is too small.
    fn at_least(&mut self, m: usize, points: &PointSet) -> &mut [f64] {
        // The memory holds the weights, the component along the dominating effect, and at least one component
        // perpendicular to this effect.
        let size = (1 + m.max(2)) * points.count;
        if self.0.len() < size {
            self.0.resize(size, 0.0);
        }
        &mut self.0[..size]
    }
}

impl<'a> ConditionalNorm<'a> {
    /// Returns the distribution of `|e|`, where `e` are the first `m` components of a random vector.
    ///
    /// `columns` are the effects of independent parameters at one standard deviation, and `mean` is the mean
    /// of `e`. Returns None if no bounded parameter has an effect.
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

        let terms = RandomTerm::of_parameters(m, effects, distributions);
        let used = terms.iter().take_while(|term| term.effect != Vector6::zeros()).count();
        let reflection = Reflection::onto_first(&dominating);
        let points = PointSet::of_components(m);
        let memory = scratch.at_least(m, points);
        sample(m, points, &reflection.of(&mean), &terms[..used], &reflection, memory);

        let (weights, components) = memory.split_at(points.count);
        let (along, across) = components.split_at(points.count);
        let distribution = distributions[first];
        let width = dominating.norm() * half_width(distribution);
        let rms = (trace + mean.norm_squared()).sqrt();
        Some(Self { along, across: &across[..points.count], weights, width, distribution, rms })
    }

    /// Returns the RMS `sqrt(E |e|^2)`, which is exact.
    pub fn rms(&self) -> f64 {
        self.rms
    }

    /// Returns the mean of `|e|`: the weighted mean of the conditional means at all quasi-random points.
    ///
    /// A point fixes all parameters except the dominating parameter. The conditional mean over this parameter
    /// has a closed form.
    ///
    /// At each point `|e| = sqrt(r + s^2)`, where `s` is the component of `e` along the effect of the
    /// dominating parameter. The squared length `r` of the perpendicular part of `e` does not depend on this
    /// parameter. The density of this parameter is constant or piecewise linear. So the conditional mean
    /// follows from the first or second antiderivative of `sqrt(r + s^2)`.
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

    /// Returns `P(|e| <= c)` and its derivative with respect to c.
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

/// Returns the first and second antiderivatives of `sqrt(r + s^2)` with respect to s.
fn antiderivatives(s: f64, r: f64) -> [f64; 2] {
    let q = (r + s * s).sqrt();
    let turn = if r > 0.0 { (s / r.sqrt()).asinh() } else { 0.0 };
    [0.5 * (s * q + r * turn), q * q * q / 6.0 + 0.5 * r * (s * turn - q)]
}

/// Householder reflection that maps a vector onto the first axis.
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

/// Writes three figures of each point: its weight, the first component of the error, and the squared length
/// of the other components.
///
/// The error is the sum of `mean` and all `terms`. The components refer to the axes after `reflection`, and
/// `mean` is already reflected.
fn sample(
    m: usize,
    points: &PointSet,
    mean: &Vector6<f64>,
    terms: &[RandomTerm],
    reflection: &Reflection,
    out: &mut [f64],
) {
    let (weights, components) = out.split_at_mut(points.count);
    weights.fill(1.0);
    for (component, mean) in components.chunks_exact_mut(points.count).zip(mean) {
        component.fill(*mean);
    }
    for (k, term) in terms.iter().enumerate() {
        let (values, densities) = points.coordinate(k, term.distribution);
        let (effect, shape) = (reflection.of(&term.effect), term.shape);
        let densities = densities.into_iter().flatten();
        weights.iter_mut().zip(densities).for_each(|(weight, density)| *weight *= density);
        for (i, component) in components.chunks_exact_mut(points.count).enumerate().take(m) {
            component.iter_mut().zip(values).for_each(|(sum, z)| *sum += effect[i] * shape.value(*z));
        }
    }
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let (across, others) = components[points.count..].split_at_mut(points.count);
    across.iter_mut().for_each(|a| *a *= *a);
    for component in others.chunks_exact(points.count) {
        across.iter_mut().zip(component).for_each(|(sum, a)| *sum += a * a);
    }
}
