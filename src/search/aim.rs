//! One number of many goals: what a run of a search for a front makes small.
//!
//! The augmented weighted Chebyshev distance from the best that has been seen of each goal,
//!
//! ```text
//! s = max_i w_i g_i + rho sum_i g_i,     g_i = (loss_i - least_i) / (greatest_i - least_i),
//! ```
//!
//! reaches points of a front that no weighted sum does, where it is not convex (A. P. Wierzbicki, "The use
//! of reference objectives in multiobjective optimization", 1980; R. E. Steuer, E.-U. Choo, Mathematical
//! Programming 26 (1983) 326-344). The first runs aim at one goal each, those after at weights that fill
//! the simplex evenly.

use super::front::{Front, Span};
use crate::low_discrepancy::halton;

/// rho: so that of two layouts with the same maximum the better one wins.
const AUGMENT: f64 = 1e-3;

/// The cost of a run spans about so much, as errors in m do: the temperatures of annealing are of that
/// size.
const SCALE: f64 = 0.02;

/// Below the cost of every infeasible layout.
const MOST: f64 = 100.0;

/// What a run aims at.
#[derive(Debug, Clone, PartialEq)]
pub struct Aim {
    weights: Vec<f64>,
    /// None while nothing is known.
    spans: Option<Vec<Span>>,
}

impl Aim {
    /// The aim of a run that begins with this front.
    pub fn new(front: &Front, run: u64) -> Self {
        Self { weights: weights(front.goals().count(), run), spans: front.spans() }
    }

    pub fn cost(&self, losses: &[f64]) -> f64 {
        let share = |k: usize| self.spans.as_ref().map_or(losses[k], |spans| spans[k].share(losses[k]));
        let weighted = self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0);
        let farthest = weighted.map(|(k, w)| w * share(k)).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = (0..losses.len()).map(share).sum();
        // Losses of different units do not add up before their spans are known.
        let augment = if self.spans.is_some() { AUGMENT * sum } else { 0.0 };
        (SCALE * (farthest + augment)).min(MOST)
    }
}

/// Weights of a run, of sum 1: all on one goal in the first runs; then the gaps between the sorted
/// coordinates of a Halton point, which are even on the simplex (L. Devroye, Non-Uniform Random Variate
/// Generation, 1986, section V.2).
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
