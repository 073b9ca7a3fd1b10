//! Quasi-Monte Carlo check of the statistical reading with samples of the nonlinear model.
//!
//! Each replicate is a randomly shifted Richtmyer sequence. The shift depends only on a given seed and the
//! index of the replicate. The scatter of the replicates gives the confidence interval of each figure except
//! the yield (see [`share_of`]).

use super::sample_space::{SampleSpace, SampleStream};
use super::work_context::WorkContext;
use super::{ErrorEvaluator, Figures, SenseRows};
use crate::cell::{Model, Quantity};
use crate::robot::Frames;
use rayon::prelude::*;

/// Number of independently shifted replicates.
const REPLICATES: usize = 32;

/// Quantile of Student's t distribution for 97.5 % and 31 degrees of freedom.
const STUDENT_T: f64 = 2.039_513_446;

/// Quantile of the standard normal distribution for 97.5 %.
const NORMAL_QUANTILE: f64 = 1.959_963_985;

/// Samples refute a first-order figure only if it lies outside the confidence interval by more than this
/// share of the estimate.
pub const RELATIVE_TOLERANCE: f64 = 0.01;

/// Samples refute a first-order yield only if it lies outside the confidence interval by more than this
/// value.
pub const YIELD_TOLERANCE: f64 = 0.005;

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
    /// Returns whether `figure` agrees with the estimate.
    ///
    /// The figure must lie in the confidence interval widened by 1 % of the estimate at both ends. So chance
    /// alone hardly ever contradicts an exact figure.
    pub fn agrees(&self, figure: f64) -> bool {
        self.is_near(figure, RELATIVE_TOLERANCE * self.value.abs())
    }

    /// Returns whether `figure` lies in the confidence interval widened by `tolerance` at both ends.
    fn is_near(&self, figure: f64, tolerance: f64) -> bool {
        (self.low - tolerance..=self.high + tolerance).contains(&figure)
    }
}

/// Monte Carlo estimates of the size of an operation's error in the sense of that operation, m or rad.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarlo {
    pub samples: usize,
    pub rms: Estimate,
    pub mean: Estimate,
    pub p95: Estimate,
    pub p99: Estimate,
    /// Probability that the size of the error does not exceed the limit; None for an operation without a
    /// limit.
    pub success: Option<Estimate>,
    /// Share of samples whose errors exceed the first-order 95th percentile [`SampledPosture::p95`].
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
    /// Returns the histogram of error sizes (m or rad) in ascending order.
    fn of(sorted: &[f64]) -> Self {
        let (low, high) = (sorted.first().copied().unwrap_or(0.0), sorted.last().copied().unwrap_or(0.0));
        let mut counts = vec![0; BINS];
        for value in sorted {
            let share = if high > low { (value - low) / (high - low) } else { 0.0 };
            counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        Self { low, high, counts }
    }

    /// Returns the error size below which the share `p` of the samples lies, interpolated within a bin.
    pub fn quantile(&self, p: f64) -> f64 {
        let wanted = p * self.counts.iter().map(|n| f64::from(*n)).sum::<f64>();
        let mut below = 0.0;
        for (k, count) in self.counts.iter().map(|n| f64::from(*n)).enumerate() {
            if below + count >= wanted && count > 0.0 {
                return self.low + self.width() * (k as f64 + (wanted - below) / count);
            }
            below += count;
        }
        self.high
    }

    /// Returns the width of a bin.
    pub fn width(&self) -> f64 {
        (self.high - self.low) / self.counts.len().max(1) as f64
    }
}

impl MonteCarlo {
    /// Compares first-order figures and yield with the estimates, and returns whether all agree.
    ///
    /// If a figure or the yield disagrees, the estimates replace all statistical figures in `figures`. The
    /// estimated yield replaces `success`. The estimate of `quantity` replaces `value`. If `quantity` is a
    /// yield, the estimated share of failures replaces `value`.
    pub fn check(
        &self,
        quantity: Quantity,
        figures: &mut Figures,
        success: &mut Option<f64>,
        value: &mut f64,
    ) -> bool {
        if self.confirms(figures) && self.confirms_yield(*success) {
            return true;
        }
        let Self { rms, mean, p95, p99, .. } = self;
        (figures.rms, figures.mean) = (rms.value, mean.value);
        (figures.p95, figures.p99) = (p95.value, p99.value);
        *success = self.success.map(|estimate| estimate.value);
        *value = figures.statistic(quantity, *success);
        false
    }

    /// Returns whether a first-order yield agrees with the estimate; true if the operation has no limit.
    pub fn confirms_yield(&self, first_order: Option<f64>) -> bool {
        self.success.zip(first_order).is_none_or(|(estimate, share)| estimate.is_near(share, YIELD_TOLERANCE))
    }

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

/// Posture of an operation at which the error of the operation is sampled.
pub struct SampledPosture<'a> {
    pub evaluator: &'a ErrorEvaluator,
    pub context: &'a WorkContext,
    pub frames: &'a Frames,
    /// First-order 95th percentile of the error, m or rad. [`MonteCarlo::above`] estimates the share of
    /// samples above this percentile.
    pub p95: f64,
}

/// Estimates for several operations of one cell, from the same samples.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSamples {
    /// Estimates for each operation alone.
    pub operations: Vec<MonteCarlo>,
    /// Probability that every operation with a limit stays within its limit; None if no operation has a
    /// limit.
    pub together: Option<Estimate>,
}

/// Estimates the figures of the error in the operation's sense at one posture, from samples of the nonlinear
/// model.
///
/// `p95` is the first-order 95th percentile. The result also estimates the share of samples whose errors
/// exceed `p95`.
pub fn monte_carlo(
    evaluator: &ErrorEvaluator,
    context: &WorkContext,
    frames: &Frames,
    samples: usize,
    seed: u64,
    p95: f64,
) -> MonteCarlo {
    let space = SampleSpace::of([evaluator.sources.clone()].into_iter());
    SampledPosture { evaluator, context, frames, p95 }.monte_carlo(&space, samples, seed)
}

/// Estimates the figures of several operations of one cell from the same samples of the nonlinear model.
///
/// Each sample from `space` is one realization of the arm and the equipment. The parameter errors of a sample
/// apply to all operations.
pub fn joint_monte_carlo(
    space: &SampleSpace,
    postures: &[SampledPosture<'_>],
    samples: usize,
    seed: u64,
) -> JointSamples {
    let each = samples.div_ceil(REPLICATES).max(1);
    let replicate = |r: usize| Replicate::new(SampleStream::new(space, seed, r), space, postures, each);
    let mut replicates: Vec<Replicate> = (0..REPLICATES).into_par_iter().map(replicate).collect();
    let kept: usize = replicates.iter().map(|r| r.kept).sum();
    let is_limited = postures.iter().any(|p| p.evaluator.limit.is_some());
    let operations = postures.iter().enumerate().map(|(k, posture)| {
        let sizes = replicates.iter_mut().map(|r| std::mem::take(&mut r.sizes[k])).collect();
        posture.estimates(sizes)
    });
    let operations = operations.collect();
    JointSamples { operations, together: is_limited.then(|| share_of(kept, each * REPLICATES)) }
}

/// Samples of one randomly shifted point set.
struct Replicate {
    /// Sizes of the errors of each operation, in ascending order.
    sizes: Vec<Vec<f64>>,
    /// Number of samples that stay within the limits of all operations.
    kept: usize,
}

impl Replicate {
    fn new(
        mut stream: SampleStream<'_>,
        space: &SampleSpace,
        postures: &[SampledPosture<'_>],
        count: usize,
    ) -> Self {
        let measure = |p: &SampledPosture<'_>| p.evaluator.measure(&p.evaluator.sense, p.context, p.frames);
        let measures: Vec<SenseRows> = postures.iter().map(measure).collect();
        let places: Vec<_> = postures.iter().map(|p| space.places(&p.evaluator.sources)).collect();
        let mut sizes = vec![Vec::with_capacity(count); postures.len()];
        let (mut kept, mut values) = (0, Vec::new());
        for _ in 0..count {
            let (drawn, mut is_kept) = (stream.next(), true);
            for (k, p) in postures.iter().enumerate() {
                values.clear();
                values.extend(places[k].iter().map(|&place| drawn[place]));
                let propagation = p.evaluator.propagation();
                let sample = propagation.sample(&values, Model::Nonlinear);
                let error = propagation.error(p.context, p.frames, &sample, Model::Nonlinear);
                let size = measures[k].size(&error);
                is_kept &= p.evaluator.limit.is_none_or(|limit| size <= limit);
                sizes[k].push(size);
            }
            kept += usize::from(is_kept);
        }
        sizes.iter_mut().for_each(|sizes| sizes.sort_by(f64::total_cmp));
        Self { sizes, kept }
    }
}

impl SampledPosture<'_> {
    /// Estimates the figures of this operation alone, from the samples that [`joint_monte_carlo`] draws with
    /// the same seed.
    pub fn monte_carlo(self, space: &SampleSpace, samples: usize, seed: u64) -> MonteCarlo {
        let each = samples.div_ceil(REPLICATES).max(1);
        let one = std::slice::from_ref(&self);
        let replicate =
            |r: usize| Replicate::new(SampleStream::new(space, seed, r), space, one, each).sizes.remove(0);
        self.estimates((0..REPLICATES).into_par_iter().map(replicate).collect())
    }

    /// Returns the estimates from the sorted sizes of the errors in each replicate.
    fn estimates(&self, replicates: Vec<Vec<f64>>) -> MonteCarlo {
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
        let within = |sizes: &[f64], limit: f64| sizes.partition_point(|v| *v <= limit);
        let share = |sizes: &[f64], limit: f64| within(sizes, limit) as f64 / sizes.len() as f64;
        MonteCarlo {
            samples: all.len(),
            rms: estimate(&|s| (s.iter().map(|v| v * v).sum::<f64>() / s.len() as f64).sqrt()),
            mean: estimate(&|s| s.iter().sum::<f64>() / s.len() as f64),
            p95: estimate(&|s| percentile(s, 0.95)),
            p99: estimate(&|s| percentile(s, 0.99)),
            success: self.evaluator.limit.map(|limit| share_of(within(&all, limit), all.len())),
            above: estimate(&|s| 1.0 - share(s, self.p95)),
            histogram: Histogram::of(&all),
        }
    }
}

/// Returns the share `count / samples` with Wilson's 95 % score interval for independent samples. The source
/// of the interval is E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
/// J. Amer. Statist. Assoc. 22, 1927.
///
/// An estimate from quasi-random points scatters less than an estimate from independent samples. The interval
/// is therefore conservative for quasi-random points.
///
/// The interval has a positive width even if the estimated share is 0 or 1. If repeated estimates are all 0
/// or all 1, an interval computed from their scatter has no width.
pub fn share_of(count: usize, samples: usize) -> Estimate {
    let (n, z2) = (samples as f64, NORMAL_QUANTILE * NORMAL_QUANTILE);
    let value = count as f64 / n;
    let centre = (value + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half = (z2 * value * (1.0 - value) / n + 0.25 * z2 * z2 / (n * n)).sqrt() / (1.0 + z2 / n);
    Estimate { value, low: (centre - half).clamp(0.0, value), high: (centre + half).clamp(value, 1.0) }
}

/// Returns the quantile of sorted values at the probability `p`, interpolated between ranks (Hazen's rule).
fn percentile(sorted: &[f64], p: f64) -> f64 {
    let at = (p * sorted.len() as f64 - 0.5).clamp(0.0, (sorted.len() - 1) as f64);
    let (k, f) = (at.floor() as usize, at.fract());
    let next = sorted[(k + 1).min(sorted.len() - 1)];
    sorted[k] + (next - sorted[k]) * f
}
