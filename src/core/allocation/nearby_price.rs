//! Price of figures that differ a little from figures whose cheapest tolerances are known.
//!
//! The known scales, reduced until they meet the limits of the new figures, give an upper bound of the new
//! price. The known multipliers give a lower bound, which differs from the price by about the square of the
//! change. The two bounds decide most comparisons of a price with a limit, at a tenth of the effort of an
//! ascent.

use super::dual_ascent::{PricedScales, priced_scales};
use super::linear_figure::{FigureScratch, LinearFigure};
use super::pricing::{GAP, ROUNDING, TolerancePricing};
use crate::cell::ToleranceCost;
use nalgebra::Vector6;

/// Largest number of Newton steps to find the factor by which all known multipliers are scaled.
const STEPS: usize = 3;

/// Cheapest tolerances that meet the limits of some figures, with their Lagrange multipliers. The price of a
/// set of figures is the cost of the cheapest tolerances with which none of these figures exceeds its limit.
/// The known tolerances and multipliers give bounds of the prices of similar figures.
#[derive(Debug, Clone, PartialEq)]
pub struct NearbyPrice {
    /// Scale of every tolerance.
    scales: Vec<f64>,
    /// Multiplier vectors, each with the index of its figure. For a root sum square, the multiplier is the
    /// first component.
    multipliers: Vec<(usize, Vector6<f64>)>,
}

impl NearbyPrice {
    /// Finds the cheapest tolerances with which no figure exceeds its limit of 1.
    ///
    /// Returns None if a cost has discrete grades, or if the ascent does not find these tolerances.
    pub fn new(
        costs: &[ToleranceCost],
        figures: &[LinearFigure],
        scratch: &mut FigureScratch,
    ) -> Option<Self> {
        let is_continuous = costs.iter().all(|cost| cost.grades().is_empty());
        let found = priced_scales(costs, figures, GAP, scratch).filter(|_| is_continuous)?;
        let PricedScales { scales, multipliers, .. } = found;
        let near = Self { scales, multipliers };
        near.reduced_cost(costs, figures, scratch).map(|_| near)
    }

    /// Returns an upper bound of the price of `figures`. A returned bound never exceeds `most`. Returns None
    /// if the price exceeds `most`.
    ///
    /// The bound is [`Self::reduced_cost`]. If this cost is missing or exceeds `most`, the price itself is
    /// computed.
    pub fn within(
        &self,
        tolerances: &TolerancePricing,
        figures: &[LinearFigure],
        most: f64,
        scratch: &mut FigureScratch,
    ) -> Option<f64> {
        let reduced = self.reduced_cost(tolerances.costs(), figures, scratch).filter(|cost| *cost <= most);
        reduced.or_else(|| {
            let is_below = self.bound(tolerances.costs(), figures, scratch) <= most;
            is_below.then(|| tolerances.price(figures, scratch)).filter(|price| *price <= most)
        })
    }

    /// Divides all known scales (from [`Self::new`]) by the same number, so that `figures` meet their limits
    /// of 1. Returns the cost of the divided scales. The number is the largest of `figures` at the known
    /// scales, but at least 1.
    ///
    /// Returns None if a divided scale leaves its range, or if a figure still exceeds its limit.
    pub fn reduced_cost(
        &self,
        costs: &[ToleranceCost],
        figures: &[LinearFigure],
        scratch: &mut FigureScratch,
    ) -> Option<f64> {
        let largest = figures.iter().map(|figure| figure.value(&self.scales, scratch)).fold(0.0, f64::max);
        let reduced: Vec<f64> = self.scales.iter().map(|u| u / largest.max(1.0)).collect();
        let is_kept = costs.iter().zip(&reduced).all(|(cost, u)| *u >= cost.range.0);
        // Errors that no tolerance changes do not shrink with the scales.
        let is_kept = is_kept && figures.iter().all(|figure| figure.value(&reduced, scratch) <= 1.0 + GAP);
        is_kept.then(|| costs.iter().zip(&reduced).map(|(cost, u)| cost.cost(*u)).sum())
    }

    /// Returns a lower bound of the price of `figures`.
    pub fn bound(
        &self,
        costs: &[ToleranceCost],
        figures: &[LinearFigure],
        scratch: &mut FigureScratch,
    ) -> f64 {
        let size: f64 = self.multipliers.iter().map(|(_, y)| y.norm()).sum();
        if size <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let (mut row, mut scales) = std::mem::take(&mut scratch.bound);
        row.clear(costs.len());
        for (i, y) in &self.multipliers {
            if let Some(figure) = figures.get(*i) {
                figure.add_along(&(y / size), &mut row);
            }
        }
        let bound = row.quick_bound(costs, &mut size.ln(), STEPS, &mut scales);
        scratch.bound = (row, scales);
        bound * (1.0 - ROUNDING)
    }
}
