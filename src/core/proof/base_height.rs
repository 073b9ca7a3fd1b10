//! Bound of the objective for a robot base whose height is a search variable: all operations share one
//! height.
//!
//! Each operation alone would choose the height of the base that suits it best. Branch and bound over the
//! height minimizes the combined value of all operations, each at its best spot for an interval of the
//! height. An operation that happens at every node is first bounded like an operation at its best node. The
//! bound for every node takes longer, so it is computed only for the shortest intervals.

use super::operation_bound::{NodesBounded, of_regions};
use super::region::OperationRegion;
use super::{OperationBound, ProofOptions, WhyNot};
use crate::cell::{Cell, Coordinate, Objective};
use crate::layout::{Workcell, combined};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of the shortest intervals in the range of the height.
const PARTS: f64 = 128.0;
/// Number of intervals that are examined per round, in parallel.
const INTERVALS_PER_ROUND: usize = 4;

/// Interval of the height of the base, m, with lower bounds of the values of all operations.
#[derive(Clone)]
struct HeightInterval {
    range: (f64, f64),
    values: Vec<f64>,
    bound: f64,
    nodes: NodesBounded,
    /// Number of boxes that were examined for this interval.
    boxes: u64,
}

/// Returns whether the height of the robot base is a search variable that several operations share.
pub(super) fn is_shared(cell: &Cell) -> bool {
    let (low, high) = cell.base[2].range();
    low < high && cell.operations.len() > 1
}

/// Returns a lower bound of the objective over all heights of the robot base. `operations` are the bounds of
/// the operations over all heights.
///
/// Returns None if no height of the base suits all operations.
pub(super) fn least_of_shared_height(
    workcell: &Workcell,
    operations: &[OperationBound],
    options: &ProofOptions,
    stop: &AtomicBool,
) -> Option<f64> {
    let ranges = match &workcell.cell.base[2] {
        Coordinate::List(heights) => heights.iter().map(|z| (*z, *z)).collect(),
        height => vec![height.range()],
    };
    let shortest = ranges.iter().map(|(low, high)| high - low).fold(0.0, f64::max) / PARTS;
    let options = &ProofOptions { known: None, ..options.clone() };
    let most_boxes = options.boxes.saturating_mul(operations.len() as u64);
    let values: Vec<f64> = operations.iter().map(|o| o.value.unwrap_or(0.0)).collect();
    let bound = combined(&workcell.cell, &values);
    let start =
        |range| HeightInterval { range, values: values.clone(), bound, nodes: NodesBounded::One, boxes: 0 };
    let mut open: Vec<HeightInterval> = ranges.into_iter().map(start).collect();
    // Least bound of the intervals in which every node was taken into account.
    let (mut least, mut boxes) = (f64::INFINITY, 0);
    loop {
        open.retain(|interval| interval.bound < least);
        open.sort_by(|a, b| b.bound.total_cmp(&a.bound));
        let lowest = open.last().map_or(least, |interval| interval.bound);
        if open.is_empty() || boxes >= most_boxes || stop.load(Ordering::Relaxed) {
            return lowest.is_finite().then_some(lowest);
        }
        let round = open.split_off(open.len().saturating_sub(INTERVALS_PER_ROUND));
        let parts: Vec<HeightInterval> =
            round.into_iter().flat_map(|interval| interval.parts(shortest)).collect();
        let examined: Vec<HeightInterval> =
            parts.into_par_iter().filter_map(|part| part.bounded(workcell, least, options, stop)).collect();
        for interval in examined {
            boxes += interval.boxes;
            match interval.nodes {
                NodesBounded::Every => least = least.min(interval.bound),
                NodesBounded::One => open.push(interval),
            }
        }
    }
}

impl HeightInterval {
    /// Returns the halves of the interval. A shortest interval is returned whole, for the bound of every
    /// node.
    fn parts(self, shortest: f64) -> Vec<Self> {
        let (low, high) = self.range;
        if high - low <= shortest {
            return vec![Self { nodes: NodesBounded::Every, ..self }];
        }
        let middle = (low + high) / 2.0;
        vec![Self { range: (low, middle), ..self.clone() }, Self { range: (middle, high), ..self }]
    }

    /// Bounds all operations in the interval. An operation whose bound is 0 has no bound. A bound of the
    /// objective above `enough` is of no use.
    ///
    /// Returns None if an operation has no posture in this interval.
    fn bounded(
        mut self,
        workcell: &Workcell,
        enough: f64,
        options: &ProofOptions,
        stop: &AtomicBool,
    ) -> Option<Self> {
        let mut cell = workcell.cell.clone();
        let (min, max) = self.range;
        cell.base[2] = Coordinate::Range { min, max, start: min };
        self.boxes = 0;
        for k in 0..self.values.len() {
            if self.values[k] <= 0.0 {
                continue;
            }
            let regions = OperationRegion::beside_base(&cell, k, workcell);
            let known = sufficient(&cell, &self.values, k, enough);
            let (found, _) = of_regions(workcell, &regions, self.nodes, known, options, stop);
            self.boxes += found.boxes;
            match found.value {
                Ok(bound) => self.values[k] = bound.max(self.values[k]),
                Err(WhyNot::Infeasible) => return None,
                Err(_) => (),
            }
        }
        self.bound = combined(&cell, &self.values);
        Some(self)
    }
}

/// Returns the value of operation `k` with which the objective reaches `enough`, while the other values stay.
/// Returns None if it is not known.
fn sufficient(cell: &Cell, values: &[f64], k: usize, enough: f64) -> Option<f64> {
    let weight = cell.operations[k].weight;
    let value = match cell.search.objective {
        Objective::WeightedSum => values[k] + (enough - combined(cell, values)) / weight,
        Objective::WeightedMaximum => enough / weight,
        Objective::ToleranceCost | Objective::Lexicographic => f64::INFINITY,
    };
    (value.is_finite() && value > 0.0).then_some(value)
}
