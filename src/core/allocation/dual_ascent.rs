//! Dual ascent: Newton's method for the Lagrangian dual of a small allocation, without a cone program.
//!
//! A layout search prices thousands of nodes per second, but only a few requirements bind at each node. The
//! dual therefore has only a few variables. The minimum over each scale at given prices has a closed form
//! or takes a few Newton steps (`lagrangian`):
//!
//! ```text
//! maximize  sum_k min_u (c_k(u) + p_k u + q_k u^2)  -  sum_i (|y_i| - y_i . f_i)  -  sum_j mu_j (1 - f_j^2)
//!           p_k = sum_i y_i . g_ik,   q_k = sum_j mu_j w_jk
//! ```
//!
//! The function `c_k` is the cost of parameter k. A sign pattern of a worst case gives every error a sign.
//! Each vector `y_i` is the multiplier of one sign pattern. The vector `f_i` is the sum of the fixed errors
//! with the signs of this pattern. The vector `g_ik` is the error at the present tolerance of parameter k,
//! with the sign of the pattern. Each number `mu_j` belongs to a root sum square. This root sum square is
//! `sqrt(f_j^2 + sum_k w_jk u_k^2)`. A pattern or a root sum square enters the dual when the scales violate
//! its limit. For any multipliers, the value of the dual is a lower bound of the cost.
//!
//! At the end, all scales are divided once by the largest figure that exceeds its limit. No scale falls below
//! its range, and fixed errors do not change. A figure can therefore still exceed its limit
//! ([`priced_scales`]). If no figure does, the cost of the scales is an upper bound of the least cost. The
//! gap between the two bounds is then known.

use super::cone_cut::ConeCut;
use super::dual_terms::{DualPoint, DualTerm, charges, crossings, derivatives, dual, stepped};
use super::limit_row::LimitRow;
use super::linear_figure::{FigureScratch, LinearFigure};
use crate::cell::ToleranceCost;
use nalgebra::{DMatrix, DVector, Vector6};
use std::rc::Rc;

/// Largest number of rounds. Each round maximizes the dual and then adds constraints to it.
const MAX_ROUNDS: usize = 40;
/// Largest number of Newton steps in one round.
const MAX_STEPS: usize = 60;
/// Largest number of halvings of one step.
const MAX_HALVINGS: i32 = 40;
/// Factor between successive ridges (multiples of the identity that are added to the Hessian).
const RIDGE_GROWTH: f64 = 1000.0;
/// The dual has converged when the relative gain of a step is below this value.
const CONVERGED: f64 = 1e-12;
/// A coarse ascent ends when the largest derivative of the dual is at most this value. This derivative is the
/// relative violation of a limit. Coarse ascents find the constraints that bind.
const COARSE: f64 = 1e-2;
/// A fine ascent ends when the largest derivative of the dual is at most this value times the requested gap.
const FINE: f64 = 0.1;
/// Threshold of the relative violation of a limit after a fine ascent, as a multiple of the requested gap.
/// Only a larger violation adds a constraint.
const VIOLATION: f64 = 0.01;

/// Cheapest scales of the tolerances, found by dual ascent.
#[derive(Debug, Clone, PartialEq)]
pub struct PricedScales {
    /// Scales of the tolerances. A figure can still exceed its limit ([`priced_scales`]).
    pub scales: Vec<f64>,
    pub cost: f64,
    /// Lower bound of the cost of any set of scales that meets the limits.
    pub lower_bound: f64,
    /// Shadow price of the limit of every figure: the cost saved per relative increase of the limit.
    pub shadow_prices: Vec<f64>,
    /// Price of every scale: the derivative of the constraint terms of the Lagrangian with respect to this
    /// scale. The derivative is taken at the solution.
    pub(super) prices: Vec<f64>,
    /// Constraints that bind, each with the index of its figure.
    pub(super) cuts: Vec<(usize, ConeCut)>,
    /// Multiplier vector of each constraint in `cuts`, with the index of its figure.
    pub(super) multipliers: Vec<(usize, Vector6<f64>)>,
}

impl PricedScales {
    /// Returns the relative gap between cost and lower bound.
    pub fn gap(&self) -> f64 {
        (self.cost - self.lower_bound) / self.cost.abs().max(f64::MIN_POSITIVE)
    }
}

/// Returns the cheapest scales with which every figure is at most its limit of 1, and a lower bound of the
/// cost. The relative gap between cost and lower bound is at most `gap` unless the function ends early.
///
/// Each round maximizes the dual (ascent), and then adds the constraints that the scales violate. The first
/// ascents are coarse. Fine ascents end when the largest derivative of the dual is at most `FINE * gap`. The
/// function ends early after `MAX_ROUNDS` rounds. It also ends early if a fine ascent finds no further
/// constraint to add.
///
/// At the end, all scales are divided once by the largest figure if this figure exceeds 1. A figure can still
/// exceed its limit, because fixed errors and scales at their lower bounds do not decrease. The relative
/// excess is at most `gap` unless the function ends early. If it ends early, the excess is not checked.
///
/// The costs must be continuous, and the tightest scales must meet every limit. Returns None if the ascent
/// fails.
pub fn priced_scales(
    costs: &[ToleranceCost],
    figures: &[LinearFigure],
    gap: f64,
    scratch: &mut FigureScratch,
) -> Option<PricedScales> {
    let mut terms: Vec<DualTerm> = Vec::new();
    // Coarse ascents find the constraints that bind.
    let fine = FINE * gap;
    let mut tolerance = COARSE.max(fine);
    for round in 0..MAX_ROUNDS {
        let point = ascend(costs, &mut terms, tolerance)?;
        let scales: Vec<f64> = point.scales.iter().map(|c| c.scale).collect();
        let threshold = if tolerance > fine { tolerance } else { VIOLATION * gap };
        let (mut largest, mut is_new): (f64, bool) = (0.0, false);
        for (i, figure) in figures.iter().enumerate() {
            let (value, cut) = figure.cut(&scales, scratch);
            largest = largest.max(value);
            if value > 1.0 + threshold && !terms.iter().any(|own| own.figure == i && own.cut.is_same(&cut)) {
                // The terms that this round has added may already enforce this limit.
                let y = first_multipliers(costs, &terms, &cut, &scales);
                is_new |= y.is_some();
                terms.extend(y.map(|y| DualTerm { figure: i, cut: cut.into(), y }));
            }
        }
        let is_last = !is_new && tolerance <= fine || round + 1 == MAX_ROUNDS;
        let shrink = |(u, cost): (&f64, &ToleranceCost)| (u / largest.max(1.0)).max(cost.range.0);
        let kept: Vec<f64> = scales.iter().zip(costs).map(shrink).collect();
        let cost: f64 = costs.iter().zip(&kept).map(|(cost, u)| cost.cost(*u)).sum();
        // A scale at the lower end of its range is not reduced, so a larger violation could remain.
        let is_kept = largest <= 1.0 + gap;
        if is_kept && cost - point.value <= gap * cost.abs() || is_last {
            let (mut prices, q) = charges(costs.len(), &terms);
            prices.iter_mut().zip(q.iter().zip(&scales)).for_each(|(p, (q, u))| *p += 2.0 * q * u);
            let mut shadow_prices = vec![0.0; figures.len()];
            terms.iter().for_each(|term| shadow_prices[term.figure] += term.shadow_price());
            let (lower_bound, scales) = (point.value.min(cost), kept);
            let multipliers = terms.iter().map(|term| (term.figure, term.y)).collect();
            let cuts = terms.into_iter().map(|term| (term.figure, Rc::unwrap_or_clone(term.cut))).collect();
            return Some(PricedScales {
                scales,
                cost,
                lower_bound,
                shadow_prices,
                prices,
                cuts,
                multipliers,
            });
        }
        if !is_new {
            tolerance = fine;
        }
    }
    None
}

/// Returns the first multiplier vector of the constraint `cut`, which the scales `u` violate. The vector has
/// the direction of the error at `u`. The length of the vector is the least multiplier with which the
/// cheapest scales meet the limit along this direction. The terms `others` stay unchanged. The result is None
/// if the cheapest scales meet this limit with the terms `others` alone.
fn first_multipliers(
    costs: &[ToleranceCost],
    others: &[DualTerm],
    cut: &ConeCut,
    u: &[f64],
) -> Option<Vector6<f64>> {
    let (p, q) = charges(costs.len(), others);
    let direction = match cut {
        ConeCut::Vertex { columns, constant, .. } => {
            let vertex = constant + columns.iter().zip(u).map(|(c, u)| c * *u).sum::<Vector6<f64>>();
            vertex.try_normalize(0.0)?
        }
        _ => Vector6::x(),
    };
    let size = LimitRow::along(cut, &direction).multiplier(costs, &p, &q);
    (size > 0.0).then(|| direction * size)
}

/// Maximizes the dual over the multipliers of the terms, and drops terms that do not bind. Returns None if a
/// step cannot be computed.
fn ascend(costs: &[ToleranceCost], terms: &mut Vec<DualTerm>, tolerance: f64) -> Option<DualPoint> {
    let mut point = dual(costs, terms);
    for _ in 0..MAX_STEPS {
        if terms.is_empty() {
            return Some(point);
        }
        let (gradient, hessian) = derivatives(terms, &point);
        let largest = gradient.amax();
        if largest <= tolerance {
            return Some(point);
        }
        let step = newton_step(hessian, &gradient)?;
        let gain = gradient.dot(&step);
        let is_near = gain <= CONVERGED * point.value.abs();
        let next = match is_near {
            // Rounding hides the gain, so the derivatives decide whether the step is accepted.
            true => polished(costs, terms, &step, largest),
            false => line_search(costs, terms, &step, (&point, gain)),
        };
        let Some((next, moved)) = next else { return Some(point) };
        (point, *terms) = (next, moved);
    }
    Some(point)
}

/// Returns the dual and its terms after a full step. Returns None if the step drops a term, or if a
/// derivative remains greater than half of `largest`.
fn polished(
    costs: &[ToleranceCost],
    terms: &[DualTerm],
    step: &DVector<f64>,
    largest: f64,
) -> Option<(DualPoint, Vec<DualTerm>)> {
    let moved = stepped(terms, step, 1.0);
    let next = dual(costs, &moved);
    let is_better = moved.len() == terms.len() && derivatives(&moved, &next).0.amax() <= 0.5 * largest;
    is_better.then_some((next, moved))
}

/// Returns the Newton step with the first ridge that makes the matrix of second derivatives positive
/// definite.
///
/// Returns None if no ridge suffices.
fn newton_step(hessian: DMatrix<f64>, gradient: &DVector<f64>) -> Option<DVector<f64>> {
    let size = hessian.trace() / hessian.nrows() as f64;
    let mut ridge = 1e-14 * size;
    while ridge <= size {
        let mut damped = hessian.clone();
        (0..damped.nrows()).for_each(|i| damped[(i, i)] += ridge);
        if let Some(cholesky) = damped.cholesky() {
            let step = cholesky.solve(gradient);
            if step.iter().all(|v| v.is_finite()) {
                return Some(step);
            }
        }
        ridge *= RIDGE_GROWTH;
    }
    None
}

/// Returns the dual and its terms at the first step length that suffices. Returns None if no length raises
/// the dual enough.
///
/// A length suffices if the dual rises by at least 1e-4 of the gain that the gradient predicts. The lengths
/// are tried in descending order, beginning with the full step. The next lengths are those at which a
/// multiplier reaches 0. A step of such a length drops the term whose multiplier reaches 0. Halvings of the
/// shortest of these lengths come last.
fn line_search(
    costs: &[ToleranceCost],
    terms: &[DualTerm],
    step: &DVector<f64>,
    (point, gain): (&DualPoint, f64),
) -> Option<(DualPoint, Vec<DualTerm>)> {
    let ends = crossings(terms, step);
    let shortest = ends.last().copied().unwrap_or(1.0);
    let halved = (1..=MAX_HALVINGS).map(|k| shortest * 0.5_f64.powi(k));
    for length in std::iter::once(1.0).chain(ends).chain(halved) {
        let moved = stepped(terms, step, length);
        let next = dual(costs, &moved);
        if next.value >= point.value + 1e-4 * length * gain {
            return Some((next, moved));
        }
    }
    None
}
