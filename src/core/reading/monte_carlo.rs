//! Quasi-Monte Carlo check of the statistical reading by samples of the nonlinear model.
//!
//! Each replicate is a Richtmyer sequence with a random shift, which follows from an explicit seed. The
//! scatter of the replicates gives the confidence interval.

use super::normal_quantile::normal_quantile;
use super::work_context::WorkContext;
use super::{ErrorEvaluator, Figures};
use crate::cell::{Distribution, Model, Spread};
use crate::low_discrepancy::richtmyer_steps;
use crate::robot::Frames;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Number of independently shifted replicates.
const REPLICATES: usize = 32;

/// Quantile of Student's t distribution for 97.5 % and 31 degrees of freedom.
const STUDENT_T: f64 = 2.039_513_446;

/// Relative deviation up to which a first-order figure agrees with an estimate, even outside the confidence
/// interval.
pub const RELATIVE_TOLERANCE: f64 = 0.01;

/// Number of bins of a [`Histogram`].
const BINS: usize = 72;

/// Estimated figure with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl Estimate {
    /// Returns whether `figure` agrees: it is inside the confidence interval, or within 1 % of the value.
    pub fn agrees(&self, figure: f64) -> bool {
        (self.low..=self.high).contains(&figure)
            || (figure - self.value).abs() <= RELATIVE_TOLERANCE * self.value.abs()
    }
}

/// Monte Carlo estimates of the error's size in a sense, m or rad.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarlo {
    pub samples: usize,
    pub rms: Estimate,
    pub mean: Estimate,
    pub p95: Estimate,
    pub p99: Estimate,
    /// Probability that |error| <= limit; None for an operation without a limit.
    pub success: Option<Estimate>,
    /// Share of samples that exceed the given first-order p95.
    pub above: Estimate,
    pub histogram: Histogram,
}

/// Histogram of the error: numbers of samples in bins of equal width from `low` to `high`, m or rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    pub low: f64,
    pub high: f64,
    pub counts: Vec<u32>,
}

impl Histogram {
    /// Returns the histogram of sorted values.
    fn of(sorted: &[f64]) -> Self {
        let (low, high) = (sorted.first().copied().unwrap_or(0.0), sorted.last().copied().unwrap_or(0.0));
        let mut counts = vec![0; BINS];
        for value in sorted {
            let share = if high > low { (value - low) / (high - low) } else { 0.0 };
            counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        Self { low, high, counts }
    }

    /// Returns the width of a bin.
    pub fn width(&self) -> f64 {
        (self.high - self.low) / self.counts.len().max(1) as f64
    }
}

impl MonteCarlo {
    /// Returns whether the first-order figures agree with the estimates.
    pub fn confirms(&self, first_order: &Figures) -> bool {
        let pairs = [
            (self.rms, first_order.rms),
            (self.mean, first_order.mean),
            (self.p95, first_order.p95),
            (self.p99, first_order.p99),
        ];
        pairs.iter().all(|(estimate, figure)| estimate.agrees(*figure))
    }
}

/// Estimates the figures of the error in the operation's sense at one posture, by samples of the nonlinear
/// model.
///
/// `p95` is the first-order 95th percentile; the share of samples above it is estimated, too.
pub fn monte_carlo(
    evaluator: &ErrorEvaluator,
    context: &WorkContext,
    frames: &Frames,
    samples: usize,
    seed: u64,
    p95: f64,
) -> MonteCarlo {
    let each = samples.div_ceil(REPLICATES).max(1);
    let measure = evaluator.measure(&evaluator.sense, context, frames);
    let propagation = evaluator.propagation();
    let replicate = |r: usize| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(r as u64);
        let mut points = SampleStream::new(evaluator, &mut rng);
        let mut sizes: Vec<f64> = (0..each)
            .map(|_| {
                let sample = propagation.sample(points.next(), Model::Nonlinear);
                measure.size(&propagation.error(context, frames, &sample, Model::Nonlinear))
            })
            .collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    };
    let replicates: Vec<Vec<f64>> = (0..REPLICATES).into_par_iter().map(replicate).collect();
    let mut all: Vec<f64> = replicates.iter().flatten().copied().collect();
    all.sort_by(f64::total_cmp);
    let estimate = |figure: &dyn Fn(&[f64]) -> f64| {
        let value = figure(&all);
        let values: Vec<f64> = replicates.iter().map(|r| figure(r)).collect();
        let mean = values.iter().sum::<f64>() / REPLICATES as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (REPLICATES - 1) as f64;
        let half = STUDENT_T * (variance / REPLICATES as f64).sqrt();
        Estimate { value, low: value - half, high: value + half }
    };
    let share =
        |sizes: &[f64], limit: f64| sizes.partition_point(|v| *v <= limit) as f64 / sizes.len() as f64;
    MonteCarlo {
        samples: all.len(),
        rms: estimate(&|s| (s.iter().map(|v| v * v).sum::<f64>() / s.len() as f64).sqrt()),
        mean: estimate(&|s| s.iter().sum::<f64>() / s.len() as f64),
        p95: estimate(&|s| percentile(s, 0.95)),
        p99: estimate(&|s| percentile(s, 0.99)),
        success: evaluator.limit.map(|limit| estimate(&|s| share(s, limit))),
        above: estimate(&|s| 1.0 - share(s, p95)),
        histogram: Histogram::of(&all),
    }
}

/// Returns a percentile of sorted values, interpolated between ranks (Hazen's rule).
fn percentile(sorted: &[f64], p: f64) -> f64 {
    let at = (p * sorted.len() as f64 - 0.5).clamp(0.0, (sorted.len() - 1) as f64);
    let (k, f) = (at.floor() as usize, at.fract());
    let next = sorted[(k + 1).min(sorted.len() - 1)];
    sorted[k] + (next - sorted[k]) * f
}

/// Stream of samples, one value per source.
struct SampleStream<'a> {
    evaluator: &'a ErrorEvaluator,
    /// Coordinate of the current point of the unit cube and step of the sequence, for each dimension.
    at: Vec<(f64, f64)>,
    values: Vec<f64>,
}

impl<'a> SampleStream<'a> {
    fn new(evaluator: &'a ErrorEvaluator, rng: &mut ChaCha8Rng) -> Self {
        let sources = &evaluator.sources;
        let dimensions = sources.list.len() + sources.factors.len();
        let steps = richtmyer_steps().take(dimensions);
        let at = steps.map(|step| (rng.random::<f64>(), step)).collect();
        Self { evaluator, at, values: vec![0.0; sources.list.len()] }
    }

    fn next(&mut self) -> &[f64] {
        for (at, step) in &mut self.at {
            *at = (*at + *step).fract();
        }
        let sources = &self.evaluator.sources;
        let (own, factors) = self.at.split_at(sources.list.len());
        for ((value, source), (u, _)) in self.values.iter_mut().zip(&sources.list).zip(own) {
            *value = source.spread.map_or(0.0, |spread| drawn(&spread, *u));
        }
        for (factor, (u, _)) in sources.factors.iter().zip(factors) {
            let z = bounded_normal(*u);
            factor.iter().for_each(|&(k, v)| self.values[k] += v * z);
        }
        &self.values
    }
}

/// Returns the quantile of the distribution of a parameter at the probability `u`.
fn drawn(spread: &Spread, u: f64) -> f64 {
    match spread.distribution {
        Distribution::Normal => spread.deviation() * bounded_normal(u),
        Distribution::Uniform => spread.plus_minus * (2.0 * u - 1.0),
        Distribution::Triangular if u < 0.5 => spread.plus_minus * ((2.0 * u).sqrt() - 1.0),
        Distribution::Triangular => spread.plus_minus * (1.0 - (2.0 - 2.0 * u).sqrt()),
    }
}

/// Returns the standard normal quantile at the probability `u`, clamped away from 0 and 1 to keep it finite.
fn bounded_normal(u: f64) -> f64 {
    normal_quantile(u.clamp(1e-16, 1.0 - 1e-16))
}
