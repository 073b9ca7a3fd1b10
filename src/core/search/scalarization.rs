//! Scalarization: combines several goals into one number, which a run of a Pareto search minimizes.
//!
//! The losses of the ideal point are the least losses on the front. The scalarization s of a layout is its
//! augmented weighted Chebyshev distance from the ideal point,
//!
//! ```text
//! s = max_i w_i g_i + rho sum_i g_i,     g_i = (loss_i - least_i) / (greatest_i - least_i),
//! ```
//!
//! where w_i is the weight and g_i the scaled loss of goal i, and least_i and greatest_i are the extreme
//! losses on the front. The factor rho is small. If the front is not convex, some of its points minimize no
//! weighted sum of the goals. Minima of s include such points (A. P. Wierzbicki, "The use of reference
//! objectives in multiobjective optimization", 1980; R. E. Steuer, E.-U. Choo, Mathematical Programming 26
//! (1983) 326-344). The first runs minimize one goal each. Later runs use weights that fill the simplex
//! evenly.

use super::pareto_front::{ParetoFront, Span};
use crate::low_discrepancy::halton;

/// Factor rho of the sum of all scaled losses in the scalarization.
///
/// If two layouts have the same largest weighted loss, the layout with the smaller sum of scaled losses costs
/// less.
const AUGMENTATION: f64 = 1e-3;

/// Factor that converts the scalarization, which is mostly between 0 and 1, to the cost in a run.
///
/// The costs are then similar to errors in m, for which the temperatures of annealing are chosen.
const COST_SCALE: f64 = 0.02;

/// Largest cost of a feasible layout in a run; every infeasible layout costs more.
const MAX_COST: f64 = 100.0;

/// Scalarized goals of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalarization {
    weights: Vec<f64>,
    /// Range of the losses in each goal on the front; None while the front is empty.
    spans: Option<Vec<Span>>,
}

impl Scalarization {
    /// Returns the scalarization of the run with the number `run`. `front` is the Pareto front at the start
    /// of this run.
    pub fn new(front: &ParetoFront, run: u64) -> Self {
        Self { weights: weights(front.goals().count(), run), spans: front.spans() }
    }

    /// Returns the cost of a layout, given its loss in every goal.
    pub fn cost(&self, losses: &[f64]) -> f64 {
        let share = |k: usize| self.spans.as_ref().map_or(losses[k], |spans| spans[k].share(losses[k]));
        let weighted = self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0);
        let farthest = weighted.map(|(k, w)| w * share(k)).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = (0..losses.len()).map(share).sum();
        // Losses in different units must not be added before their spans are known.
        let augment = if self.spans.is_some() { AUGMENTATION * sum } else { 0.0 };
        (COST_SCALE * (farthest + augment)).min(MAX_COST)
    }
}

/// Returns the weights of the goals in a run; their sum is 1.
///
/// In each of the first runs, one goal has the weight 1 and the other goals have the weight 0. Later weights
/// are the differences between successive sorted coordinates of a Halton point. Such weights fill the simplex
/// evenly (L. Devroye, Non-Uniform Random Variate Generation, 1986, section V.2).
pub fn weights(goals: usize, run: u64) -> Vec<f64> {
    if run < goals as u64 {
        return (0..goals as u64).map(|k| if k == run { 1.0 } else { 0.0 }).collect();
    }
    let number = run + 1 - goals as u64;
    let mut cuts: Vec<f64> = halton(number).take(goals - 1).collect();
    cuts.extend([0.0, 1.0]);
    cuts.sort_by(f64::total_cmp);
    cuts.windows(2).map(|pair| pair[1] - pair[0]).collect()
}
