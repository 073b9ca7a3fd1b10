//! Allocation judged by the full error model: rounds that adapt the linear requirements to the judged figures.
//!
//! In each round, the figure of the linear model is scaled so that it equals the judged figure at the scales of
//! the last round. A fixed point keeps the limits by the full model. If the linear figures also have the slopes of
//! the judged ones there, as those of a percentile do, a fixed point is a stationary point of the judged problem.

use super::linear_figure::{FigureScratch, LinearFigure};
use super::problem::{
    AllocationFailure, ToleranceAllocation, ToleranceProblem, ToleranceRequirement, allocate,
};
use super::uniform::uniform_scale;
use crate::cell::ToleranceCost;

/// Largest number of rounds.
const MAX_ROUNDS: usize = 12;
/// Relative excess of a judged figure over its limit up to which it counts as kept.
pub const JUDGED_EXCESS: f64 = 1e-6;

/// Figure of one requirement as judged by the full model, with a linear figure near it.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedFigure {
    pub value: f64,
    pub linear: LinearFigure,
}

/// Allocation with the figures that the full model gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedAllocation {
    pub allocation: ToleranceAllocation,
    /// Judged figure of every requirement.
    pub judged: Vec<f64>,
    /// Number of rounds after the first.
    pub rounds: usize,
    /// Largest relative excess of a judged figure over its limit after the first round; what the linear
    /// programme missed.
    pub missed: f64,
    /// Largest relative excess of a judged figure over its limit at the end.
    pub excess: f64,
    /// Common scale of uniform tightening, and its cost; None if it cannot keep the limits.
    pub uniform: Option<(f64, f64)>,
}

/// Finds the cheapest tolerances that keep the limits as `judge` judges them.
///
/// `judge` returns the figure of every requirement at given scales. Limits are in the unit of the figures.
///
/// # Errors
/// Returns by how much limits are exceeded if even the tightest tolerances exceed them.
pub fn allocate_judged(
    costs: &[ToleranceCost],
    limits: &[f64],
    judge: &mut dyn FnMut(&[f64]) -> Vec<JudgedFigure>,
) -> Result<JudgedAllocation, AllocationFailure> {
    let mut scratch = FigureScratch::default();
    let mut at: Vec<f64> = costs.iter().map(|cost| cost.ordered(1.0)).collect();
    let mut judged = judge(&at);
    if judged.len() != limits.len() {
        return Err(AllocationFailure::NotSolved);
    }
    let (mut missed, mut best): (f64, Option<JudgedAllocation>) = (0.0, None);
    for round in 0..MAX_ROUNDS {
        let problem = ToleranceProblem {
            costs: costs.to_vec(),
            requirements: requirements(&judged, limits, &at, &mut scratch),
        };
        let allocation = allocate(&problem)?;
        at.clone_from(&allocation.scales);
        judged = judge(&at);
        let excesses = judged.iter().zip(limits).map(|(j, limit)| j.value / limit - 1.0);
        let excess = excesses.fold(f64::NEG_INFINITY, f64::max);
        if round == 0 {
            missed = excess;
        }
        let uniform = uniform_scale(&problem)
            .map(|(u, scales)| (u, costs.iter().zip(scales).map(|(cost, u)| cost.cost(u)).sum()));
        let values = judged.iter().map(|j| j.value).collect();
        let before = best.as_ref().map(|b| b.allocation.cost);
        let found = JudgedAllocation { allocation, judged: values, rounds: round, missed, excess, uniform };
        let is_settled = excess <= JUDGED_EXCESS
            && before.is_none_or(|cost| (found.allocation.cost - cost).abs() <= JUDGED_EXCESS * cost)
            && (round > 0
                || excess >= -JUDGED_EXCESS
                || found.allocation.shadow_prices.iter().all(|s| *s == 0.0));
        // A later round replaces an earlier one unless it exceeds the limits more.
        if best.as_ref().is_none_or(|b| excess <= b.excess.max(JUDGED_EXCESS)) {
            best = Some(found);
        }
        if is_settled {
            break;
        }
    }
    best.ok_or(AllocationFailure::NotSolved)
}

/// Returns the requirements whose linear figures equal the judged ones at the scales `at`.
fn requirements(
    judged: &[JudgedFigure],
    limits: &[f64],
    at: &[f64],
    scratch: &mut FigureScratch,
) -> Vec<ToleranceRequirement> {
    let pairs = judged.iter().zip(limits);
    let each = pairs.map(|(judged, limit)| {
        let linear = judged.linear.value(at, scratch);
        let factor = if linear > 0.0 && judged.value > 0.0 { judged.value / linear } else { 1.0 };
        ToleranceRequirement { figure: judged.linear.scaled(factor), limit: *limit }
    });
    each.collect()
}
