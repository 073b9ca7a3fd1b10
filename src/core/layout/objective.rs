//! Objective: the values of the operations combined into one number.

use super::workcell::Workcell;
use crate::cell::{Cell, Objective, Unit};
use crate::error_map::{MapperWorkspace, PlacedLayout, Spot};

/// Penalty of a feasible layout that misses a limit, as a multiple of [`Workcell::weight`].
///
/// Such a layout ranks after every layout that is within its limits, and before every infeasible layout.
const LIMIT_PENALTY: f64 = 1e2;

/// Greatest excess over a limit that adds to a penalty, m or rad. For a cost of tolerances, the excess is a
/// share of the cost of the tightest tolerances. An infinite value, which means that no bound is known,
/// counts with this excess.
const UNKNOWN_EXCESS: f64 = 10.0;

/// Lower edge of the first step of [`lexicographic`] (m, rad, or share of failures).
///
/// A value below this edge also belongs to the first step.
const LEAST_STEP: f64 = 1e-9;
/// Scale of the combined value of the later operations in [`lexicographic`] (m, rad, or share of failures).
///
/// If the combined value equals this scale, the result lies in the middle of its step.
const HALF_STEP: f64 = 1e-3;

impl Workcell {
    /// Returns the weight by which the penalties in [`super::Evaluation::cost`] are multiplied.
    ///
    /// This weight is the sum of the operations' weights for a weighted sum, and the largest weight for a
    /// weighted maximum. The weight is 1 for a lexicographic objective. If the objective is the cost of
    /// tolerances, the weight is the cost of the tightest tolerances that the cost models allow.
    pub fn weight(&self) -> f64 {
        let weights = self.cell.operations.iter().map(|o| o.weight);
        match self.cell.search.objective {
            Objective::WeightedSum => weights.sum(),
            Objective::WeightedMaximum => weights.fold(0.0, f64::max),
            Objective::Lexicographic => 1.0,
            Objective::ToleranceCost => self.mapper.most_cost(),
        }
    }

    /// Returns the cost of the tightest tolerances that the cost models allow. Returns 0 if the search
    /// ignores the cost of tolerances.
    pub fn tightest_cost(&self) -> f64 {
        self.mapper.most_cost()
    }

    /// Returns the objective of a feasible layout (m, rad, share of failures, or cost) from the spots and the
    /// values of its operations.
    pub(super) fn objective(
        &self,
        placed: &PlacedLayout<'_>,
        spots: &[Option<Spot>],
        values: &[f64],
        memory: &mut MapperWorkspace,
    ) -> f64 {
        let bound = combined(&self.cell, values);
        let is_joint = self.cell.search.objective == Objective::ToleranceCost
            && (values.len() > 1 || self.cell.operations.iter().any(|o| o.over.needs_every_node()));
        match is_joint {
            // One set of tolerances must serve all operations.
            true => placed.joint_price(spots, memory).map_or(bound, |joint| joint.max(bound)),
            false => bound,
        }
    }

    /// Returns the cost of a feasible layout: `objective`, or a penalty if a limit is missed. A value in m or
    /// rad is compared with the limit of its operation.
    ///
    /// An infinite value, which means that no bound is known, has the excess [`UNKNOWN_EXCESS`] over the
    /// limit. The objective is then added to the penalty, because it is all that distinguishes such layouts.
    ///
    /// A share of failures is not compared with the limit. The share already counts the arms that exceed the
    /// limit.
    ///
    /// If the objective is the cost of tolerances, it is compared with the cost of the tightest tolerances. A
    /// greater cost means that an error exceeds its limit even with these tolerances. If the cost of
    /// tolerances is only one of several goals, no penalty applies. The limits then constrain the tolerances.
    pub(super) fn priced(&self, objective: f64, values: &[f64]) -> f64 {
        if self.cell.unit() == Unit::Cost {
            let excess = objective / self.mapper.most_cost() - 1.0;
            let is_kept = excess <= 0.0;
            return if is_kept {
                objective
            } else {
                self.weight() * (LIMIT_PENALTY + excess.min(UNKNOWN_EXCESS))
            };
        }
        let is_compared = self.cell.unit().is_error() && !self.cell.search.prices_tolerances();
        let limited = self.cell.operations.iter().zip(values).filter(|_| is_compared);
        let excess =
            limited.filter_map(|(o, value)| o.limit.map(|limit| (value - limit).clamp(0.0, UNKNOWN_EXCESS)));
        match excess.sum::<f64>() {
            excess if excess >= UNKNOWN_EXCESS => self.weight() * (LIMIT_PENALTY + excess) + objective,
            excess if excess > 0.0 => self.weight() * (LIMIT_PENALTY + excess),
            _ => objective,
        }
    }
}

/// Combines the values of all operations (m, rad, share of failures, or cost of tolerances) into the
/// objective of the cell.
///
/// Costs of tolerances are combined into their maximum. This maximum is a lower bound of the cost of
/// tolerances that serve all operations.
///
/// The objective never rises when a value falls. Lower bounds of the values therefore give a lower bound of
/// the objective.
pub fn combined(cell: &Cell, values: &[f64]) -> f64 {
    let weighted = cell.operations.iter().zip(values).map(|(operation, value)| operation.weight * value);
    match cell.search.objective {
        Objective::WeightedSum => weighted.sum(),
        Objective::WeightedMaximum => weighted.fold(0.0, |a, b| b.max(a)),
        Objective::ToleranceCost => values.iter().fold(0.0, |a: f64, b| a.max(*b)),
        Objective::Lexicographic => lexicographic(values, cell.search.indifference),
    }
}

/// Combines values so that an earlier operation takes priority over all later operations.
///
/// The range of the first value is divided into steps of relative width `indifference`. If the first values
/// of two layouts are in the same step, the second values decide. The later values follow in the same way.
/// The result is near the first value, and never falls if a value rises.
fn lexicographic(values: &[f64], indifference: f64) -> f64 {
    let [first, later @ ..] = values else { return 0.0 };
    if later.is_empty() {
        return *first;
    }
    let step = (first / LEAST_STEP).max(1.0).ln() / indifference.ln_1p();
    let edge = |step: f64| LEAST_STEP * (1.0 + indifference).powf(step.floor());
    let (low, high) = (edge(step), edge(step + 1.0));
    let rest = lexicographic(later, indifference);
    low + (high - low) * rest / (rest + HALF_STEP)
}
