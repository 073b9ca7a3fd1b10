//! Prices of nodes: the cost of the cheapest tolerances with which an operation stays within its limit at a
//! node.
//!
//! A search compares thousands of nodes, so a price uses the linear error model. [`super::allocate_judged`]
//! judges the resulting layout by the full model. Prices by the full model would differ by a few per cent if
//! the tolerances are wide.

use super::dual_ascent::priced_scales;
use super::limit_row::LimitRow;
use super::linear_figure::{FigureScratch, LinearFigure};
use super::node_figure::NodeFigure;
use super::problem::{ToleranceProblem, ToleranceRequirement};
use super::solution::allocate;
use crate::cell::{Cell, Operation, Parameter, ToleranceCost};
use crate::reading::{ErrorEvaluator, EvaluatorScratch};
use std::sync::Arc;

/// Share of arms that must stay within a limit if the quantity is the yield and no other share is stated.
pub const DEFAULT_YIELD: f64 = 0.99;

/// Largest relative gap between a price and the lower bound that proves it.
pub(super) const GAP: f64 = 1e-6;

/// Effort of a rough bound: the largest number of error directions, and the largest number of Newton steps
/// per direction.
const ROUGH: (usize, usize) = (1, 2);
/// Effort of a sharp bound, with the same two numbers as [`ROUGH`].
const SHARP: (usize, usize) = (4, 8);
/// Largest relative amount by which rounding may raise a bound.
pub(super) const ROUNDING: f64 = 1e-9;

/// Tolerances of a cell with their cost models.
#[derive(Debug, Clone, PartialEq)]
pub struct TolerancePricing {
    pub parameters: Vec<Parameter>,
    costs: Vec<ToleranceCost>,
    /// Cost of the tightest tolerances.
    most: f64,
    /// Cost of the loosest tolerances.
    least: f64,
    /// Logarithm of the multiplier with which the search for a bound starts. It is the logarithm of the
    /// present cost, which is near the multiplier if the limits are near the present figures.
    first_multiplier: f64,
}

/// Data for the prices of one operation: the tolerances of the cell, and the limit of the operation. The
/// price of a node is the cost of the cheapest tolerances with which the error stays within this limit.
#[derive(Debug, Clone)]
pub struct OperationPricing {
    pub tolerances: Arc<TolerancePricing>,
    /// Limit, m or rad, greater than 0.
    pub limit: f64,
    /// Lower bound of the ratio of the squared figure to the mean square of the error; None for a worst case.
    least_ratio: Option<f64>,
}

impl TolerancePricing {
    /// Collects the tolerances that act on the operations of a cell; None if there are no such tolerances.
    ///
    /// Measured and correlated errors are left out, because they have no tolerance of their own.
    pub fn new(cell: &Cell, evaluators: &[&ErrorEvaluator]) -> Option<Self> {
        let mut parameters: Vec<Parameter> = Vec::new();
        for source in evaluators.iter().flat_map(|evaluator| &evaluator.sources.list) {
            if source.is_own_tolerance() && !parameters.contains(&source.parameter) {
                parameters.push(source.parameter);
            }
        }
        let costs: Vec<ToleranceCost> = parameters.iter().map(|p| cell.tolerance_cost(*p)).collect();
        let total = |end: fn(&ToleranceCost) -> f64| -> f64 { costs.iter().map(|c| c.cost(end(c))).sum() };
        let (most, least, present) = (total(|c| c.range.0), total(|c| c.range.1), total(|_| 1.0));
        let first_multiplier = present.clamp(f64::MIN_POSITIVE, most.max(f64::MIN_POSITIVE)).ln();
        (!parameters.is_empty()).then_some(Self { parameters, costs, most, least, first_multiplier })
    }

    /// Returns the cost model of every tolerance.
    pub fn costs(&self) -> &[ToleranceCost] {
        &self.costs
    }

    /// Returns the cost of the tightest tolerances. If [`Self::price`] exceeds this cost, no tolerances meet
    /// the limits.
    pub fn most(&self) -> f64 {
        self.most
    }

    /// Returns the cost of the cheapest tolerances with which no figure exceeds its limit of 1.
    ///
    /// If a figure exceeds its limit even at the tightest tolerances, no tolerances meet the limits. The
    /// result is then the cost of the tightest tolerances multiplied by the largest figure at these
    /// tolerances.
    pub fn price(&self, figures: &[LinearFigure], scratch: &mut FigureScratch) -> f64 {
        let mut largest = |end: fn(&ToleranceCost) -> f64| {
            let scales: Vec<f64> = self.costs.iter().map(end).collect();
            figures.iter().map(|figure| figure.value(&scales, scratch)).fold(0.0, f64::max)
        };
        let tightest = largest(|c| c.range.0);
        if tightest > 1.0 {
            return self.most * tightest;
        }
        if largest(|c| c.range.1) <= 1.0 {
            return self.least;
        }
        let is_continuous = self.costs.iter().all(|cost| cost.grades().is_empty());
        let priced = match figures {
            _ if !is_continuous => None,
            [LinearFigure::RootSumSquare { squares, constant }] => {
                let (squares, constant) = (squares.clone(), *constant);
                Some(LimitRow { squares, constant, ..LimitRow::default() }.least_cost(&self.costs))
            }
            several => {
                let found = priced_scales(&self.costs, several, GAP, scratch);
                found.filter(|found| found.gap() <= GAP).map(|found| found.cost)
            }
        };
        priced.unwrap_or_else(|| self.solved(figures))
    }

    /// Returns the cost that the cone programs find. If these programs fail, returns the cost of the tightest
    /// tolerances.
    fn solved(&self, figures: &[LinearFigure]) -> f64 {
        let requirement = |figure: &LinearFigure| ToleranceRequirement { figure: figure.clone(), limit: 1.0 };
        let requirements = figures.iter().map(requirement).collect();
        match allocate(&ToleranceProblem { costs: self.costs.clone(), requirements }) {
            Ok(found) => found.cost,
            Err(_) => self.most,
        }
    }

    /// Returns a lower bound of the price of one figure, from at most `directions` directions of the error.
    ///
    /// The bound for one direction gives scales. The direction of the worst case at these scales is tried
    /// next, because this direction is often the best.
    fn bound(
        &self,
        figure: &LinearFigure,
        (directions, steps): (usize, usize),
        scratch: &mut FigureScratch,
    ) -> f64 {
        let (mut row, mut scales) = std::mem::take(&mut scratch.bound);
        scales.clear();
        scales.extend(self.costs.iter().map(|c| c.range.1.min(1.0)));
        let (mut best, mut x) = (f64::NEG_INFINITY, self.first_multiplier);
        for _ in 0..directions {
            figure.along_worst(&scales, &mut row, scratch);
            let tightest = row.sum(&self.costs, |c| c.range.0);
            if tightest > 1.0 {
                best = self.most * if row.linear.is_empty() { tightest.sqrt() } else { tightest };
                break;
            }
            if row.sum(&self.costs, |c| c.range.1) <= 1.0 {
                best = best.max(self.least);
                break;
            }
            best = best.max(row.quick_bound(&self.costs, &mut x, steps, &mut scales));
            if row.linear.is_empty() {
                break;
            }
        }
        scratch.bound = (row, scales);
        best * (1.0 - ROUNDING)
    }
}

impl OperationPricing {
    /// Prepares the pricing of an operation; None if the operation has no limit. `evaluator` must belong to
    /// this operation.
    pub fn new(
        tolerances: Arc<TolerancePricing>,
        operation: &Operation,
        evaluator: &ErrorEvaluator,
    ) -> Option<Self> {
        let least_ratio = NodeFigure::least_square_ratio(evaluator, DEFAULT_YIELD);
        operation.limit.map(|limit| Self { tolerances, limit, least_ratio })
    }

    /// Returns the figure of a node, divided by the limit.
    pub fn figure(&self, node: &NodeFigure<'_>, memory: &mut EvaluatorScratch) -> LinearFigure {
        let parameters = &self.tolerances.parameters;
        let figure = match self.least_ratio {
            None => node.worst_case(parameters, memory),
            Some(_) => node.normal_percentile(parameters, memory).unwrap_or_else(|| {
                let value = node.value(memory);
                node.linear(parameters, &vec![1.0; parameters.len()], value, memory)
            }),
        };
        figure.scaled(1.0 / self.limit)
    }

    /// Returns the price of a node: the cost of the cheapest tolerances with which the node stays within the
    /// limit.
    pub fn price(
        &self,
        node: &NodeFigure<'_>,
        memory: &mut EvaluatorScratch,
        scratch: &mut FigureScratch,
    ) -> f64 {
        let figure = self.figure(node, memory);
        let price = self.tolerances.price(&[figure], scratch);
        match self.least_ratio {
            // The linear figure of a percentile and the bounding figures are all below the percentile, so a
            // bound may exceed the price.
            Some(ratio) if ratio != 1.0 => {
                let rough = self.rough_bound(node, memory, scratch);
                price.max(rough).max(self.bound(node, memory, scratch))
            }
            _ => price,
        }
    }

    /// Returns a lower bound of [`Self::price`] that takes little computing time.
    pub fn rough_bound(
        &self,
        node: &NodeFigure<'_>,
        memory: &mut EvaluatorScratch,
        scratch: &mut FigureScratch,
    ) -> f64 {
        self.tolerances.bound(&self.bounding_figure(node, memory), ROUGH, scratch)
    }

    /// Returns a lower bound of [`Self::price`] that is often close to the price. This bound takes more
    /// computing time than [`Self::rough_bound`].
    pub fn bound(
        &self,
        node: &NodeFigure<'_>,
        memory: &mut EvaluatorScratch,
        scratch: &mut FigureScratch,
    ) -> f64 {
        self.tolerances.bound(&self.bounding_figure(node, memory), SHARP, scratch)
    }

    /// Returns a lower bound of the figure of a node, divided by the limit.
    fn bounding_figure(&self, node: &NodeFigure<'_>, memory: &mut EvaluatorScratch) -> LinearFigure {
        let parameters = &self.tolerances.parameters;
        match self.least_ratio {
            None => node.worst_case(parameters, memory).scaled(1.0 / self.limit),
            Some(ratio) => node.mean_square(parameters, ratio, memory).scaled(1.0 / self.limit),
        }
    }
}
