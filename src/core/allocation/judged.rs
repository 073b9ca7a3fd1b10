//! Tolerance allocation under the full error model, as a series of linear problems. Each round adapts the
//! linear figures to the judged figures, which the full error model gives.
//!
//! In each round, the linear figure of a requirement is multiplied by a factor. The scaled figure equals the
//! judged figure at the scales of the previous round. The square of a judged figure may be a convex function
//! of the squared scales, for example if the figure is a high percentile. In that case every linear figure is
//! a lower bound of the judged figure. The linear figures of all rounds then stay in the problem as cuts:
//! constraints that every solution must satisfy. Kelley's method then converges to the cheapest tolerances
//! (J. E. Kelley, "The cutting-plane method for solving convex programs", J. SIAM 8, 1960). Otherwise each
//! round replaces the linear figures of the previous round.

use super::linear_figure::{FigureScratch, LinearFigure};
use super::problem::{ToleranceProblem, ToleranceRequirement};
use super::solution::{AllocationFailure, ToleranceAllocation, allocate};
use super::uniform::uniform_scale;
use crate::cell::ToleranceCost;

/// Largest number of rounds if the linear figures of all rounds are kept as cuts.
const MAX_ROUNDS: usize = 40;
/// Largest number of rounds if each round replaces the linear figures.
const MAX_REPLACING_ROUNDS: usize = 10;
/// Largest number of reductions of all tolerances after the last round.
const MAX_REDUCTIONS: usize = 8;
/// Allowed relative excess of a judged figure over its limit. Up to this excess, the limit counts as met.
pub const JUDGED_EXCESS: f64 = 1e-6;
/// Share of the largest ratio of figure to limit at the initial scales. In the first round, a requirement
/// gets a cut only if its ratio reaches this share. This rule applies only if linear figures are kept as
/// cuts. Otherwise every requirement gets a linear figure in every round.
const NEAR_LARGEST: f64 = 0.8;
/// Relative change of the common scale at which uniform tightening has converged.
const SAME_SCALE: f64 = 1e-9;

/// Judge of tolerances: evaluates all requirements with the full error model.
pub trait ToleranceJudge {
    /// Returns the figure of every requirement at these scales; None if a figure cannot be judged.
    fn values(&mut self, scales: &[f64]) -> Option<Vec<f64>>;

    /// Returns the linear figures of the requirements whose indices are in `which`. They approximate the
    /// judged figures near the scales that were last passed to [`Self::values`].
    fn linear(&mut self, which: &[usize]) -> Option<Vec<LinearFigure>>;

    /// Returns whether every linear figure is a lower bound of its judged figure. If so, [`allocate_judged`]
    /// keeps the linear figures of all rounds as constraints.
    fn is_bounded_by_linear(&self) -> bool;
}

/// Allocation with the figures of its requirements, as the full error model judges them.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedAllocation {
    pub allocation: ToleranceAllocation,
    /// Judged figure of every requirement.
    pub judged: Vec<f64>,
    /// Zero-based index of the round that gave this allocation. Each round solves one linear problem.
    pub rounds: usize,
    /// Largest relative excess of a judged figure over its limit at the scales of the first round. This
    /// excess measures the error of the linear problem.
    pub missed: f64,
    /// Largest relative excess of a figure in [`Self::judged`] over its limit.
    pub excess: f64,
    /// Common scale of uniform tightening, and its cost; None if no common scale meets the limits.
    pub uniform: Option<(f64, f64)>,
}

/// Linear figures that approximate the judged figures, each with the index of its requirement.
struct LinearModel<'a> {
    costs: &'a [ToleranceCost],
    limits: &'a [f64],
    figures: Vec<(usize, LinearFigure)>,
    scratch: FigureScratch,
}

impl LinearModel<'_> {
    /// Adds the linear figures of the requirements whose indices are in `which`. Each figure is scaled to its
    /// judged value at the scales `at`.
    fn add(&mut self, which: &[usize], linear: Vec<LinearFigure>, values: &[f64], at: &[f64]) {
        for (&requirement, figure) in which.iter().zip(linear) {
            let value = figure.value(at, &mut self.scratch);
            let is_positive = value > 0.0 && values[requirement] > 0.0;
            let factor = if is_positive { values[requirement] / value } else { 1.0 };
            self.figures.push((requirement, figure.scaled(factor)));
        }
    }

    fn problem(&self) -> ToleranceProblem {
        let requirements = self.figures.iter().map(|(requirement, figure)| ToleranceRequirement {
            figure: figure.clone(),
            limit: self.limits[*requirement],
        });
        ToleranceProblem { costs: self.costs.to_vec(), requirements: requirements.collect() }
    }

    /// Solves the linear problem. The shadow price of a requirement is the sum of the shadow prices of its
    /// figures.
    fn solved(&self) -> Result<ToleranceAllocation, AllocationFailure> {
        let owner = |k: usize| self.figures.get(k).map_or(0, |(requirement, _)| *requirement);
        let mut found = allocate(&self.problem()).map_err(|failure| match failure {
            AllocationFailure::Infeasible(mut shortfalls) => {
                shortfalls.iter_mut().for_each(|s| s.requirement = owner(s.requirement));
                shortfalls.dedup_by_key(|s| s.requirement);
                AllocationFailure::Infeasible(shortfalls)
            }
            other => other,
        })?;
        let mut prices = vec![0.0; self.limits.len()];
        found.shadow_prices.iter().enumerate().for_each(|(k, price)| prices[owner(k)] += price);
        found.shadow_prices = prices;
        Ok(found)
    }

    /// Returns the largest relative excess of judged figures over their limits.
    fn excess(&self, values: &[f64]) -> f64 {
        let excesses = values.iter().zip(self.limits).map(|(value, limit)| value / limit - 1.0);
        excesses.fold(f64::NEG_INFINITY, f64::max)
    }

    fn cost(&self, scales: &[f64]) -> f64 {
        self.costs.iter().zip(scales).map(|(cost, u)| cost.cost(*u)).sum()
    }
}

/// Finds the cheapest tolerances with which the figures from `judge` meet the limits.
///
/// The limits are in the unit of the figures.
///
/// # Errors
///
/// Returns [`AllocationFailure::Infeasible`] if a figure exceeds its limit even at the tightest tolerances.
/// Returns [`AllocationFailure::NotSolved`] if the solver or the judge fails.
pub fn allocate_judged(
    costs: &[ToleranceCost],
    limits: &[f64],
    judge: &mut dyn ToleranceJudge,
) -> Result<JudgedAllocation, AllocationFailure> {
    let keeps_cuts = judge.is_bounded_by_linear();
    let mut model = LinearModel { costs, limits, figures: Vec::new(), scratch: FigureScratch::default() };
    let mut at: Vec<f64> = costs.iter().map(|cost| cost.ordered(1.0)).collect();
    let mut values = judge.values(&at).ok_or(AllocationFailure::NotSolved)?;
    let largest = 1.0 + model.excess(&values);
    let mut which: Vec<usize> = (0..limits.len())
        .filter(|&k| !keeps_cuts || values[k] / limits[k] >= NEAR_LARGEST * largest)
        .collect();
    let (mut missed, mut best): (f64, Option<JudgedAllocation>) = (0.0, None);
    for round in 0..if keeps_cuts { MAX_ROUNDS } else { MAX_REPLACING_ROUNDS } {
        let linear = judge.linear(&which).ok_or(AllocationFailure::NotSolved)?;
        if !keeps_cuts {
            model.figures.clear();
        }
        model.add(&which, linear, &values, &at);
        let allocation = model.solved()?;
        at.clone_from(&allocation.scales);
        values = judge.values(&at).ok_or(AllocationFailure::NotSolved)?;
        let excess = model.excess(&values);
        if round == 0 {
            missed = excess;
        }
        let before = best.as_ref().map(|b| (b.excess, b.allocation.cost));
        let is_same = before.is_some_and(|(_, cost)| (allocation.cost - cost).abs() <= JUDGED_EXCESS * cost);
        let is_free = allocation.shadow_prices.iter().all(|price| *price == 0.0);
        let is_settled =
            excess <= JUDGED_EXCESS && (keeps_cuts || is_same || is_free || excess >= -JUDGED_EXCESS);
        // A later round replaces the best earlier round unless the later one exceeds the limits by more.
        if before.is_none_or(|(least, _)| excess <= least.max(JUDGED_EXCESS)) {
            let judged = values.clone();
            best =
                Some(JudgedAllocation { allocation, judged, rounds: round, missed, excess, uniform: None });
        }
        if is_settled {
            break;
        }
        if keeps_cuts {
            which =
                (0..limits.len()).filter(|&k| values[k] > limits[k] * (1.0 + 0.1 * JUDGED_EXCESS)).collect();
        }
    }
    let mut found = best.ok_or(AllocationFailure::NotSolved)?;
    reduce(&model, &mut found, judge);
    found.uniform = uniform(&model, judge);
    Ok(found)
}

/// Divides all scales by the largest ratio of judged figure to limit, until the limits are met.
fn reduce(model: &LinearModel<'_>, found: &mut JudgedAllocation, judge: &mut dyn ToleranceJudge) {
    for _ in 0..MAX_REDUCTIONS {
        if found.excess <= JUDGED_EXCESS {
            return;
        }
        let factor = 1.0 / (1.0 + found.excess);
        let pairs = model.costs.iter().zip(&found.allocation.scales);
        let scales: Vec<f64> = pairs.map(|(cost, u)| cost.ordered(u * factor)).collect();
        let Some(values) = judge.values(&scales) else { return };
        found.excess = model.excess(&values);
        found.judged = values;
        found.allocation.cost = model.cost(&scales);
        found.allocation.scales = scales;
    }
}

/// Returns the loosest common scale that meets the judged limits, with its cost; None if no such scale was
/// found.
///
/// The judged figures are nearly proportional to the common scale. A few corrections by the largest ratio
/// of figure to limit therefore suffice.
fn uniform(model: &LinearModel<'_>, judge: &mut dyn ToleranceJudge) -> Option<(f64, f64)> {
    let (mut u, mut scales) = uniform_scale(&model.problem())?;
    let mut best: Option<(f64, f64)> = None;
    for _ in 0..MAX_REDUCTIONS {
        let ratio = 1.0 + model.excess(&judge.values(&scales)?);
        if ratio <= 1.0 + JUDGED_EXCESS && best.is_none_or(|(most, _)| u > most) {
            best = Some((u, model.cost(&scales)));
        }
        let next = u / ratio;
        let is_same = (next / u - 1.0).abs() <= SAME_SCALE;
        let moved: Vec<f64> = model.costs.iter().map(|cost| cost.ordered(next)).collect();
        if is_same || moved == scales {
            break;
        }
        (u, scales) = (next, moved);
    }
    best
}
