//! Stopping rules of a search.
//!
//! Every rule depends only on the layouts evaluated so far and their costs. So a search stops at the same
//! evaluation on any machine and after any interruption.

use crate::cell::{Goals, SearchSettings};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Fraction of the evaluation budget for the final Nelder-Mead polish, in a search that keeps only the best
/// layout.
const POLISH_SHARE: f64 = 0.1;
/// Fraction of the evaluation budget for polish and local search together, in a search that keeps a front or
/// a shortlist.
const POLISH_AND_LOCAL_SHARE: f64 = 0.25;
/// Fraction of [`POLISH_AND_LOCAL_SHARE`] that the polish may use; the local search uses the remainder.
const POLISH_PART: f64 = 0.3;

/// Reason why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchEnd {
    /// The search used up its budget, or its final refinement converged. The final refinement improves the
    /// layouts that the search found.
    Done,
    /// The objective of the best layout exceeds the proven lower bound by at most the requested gap.
    Gap,
    /// The requested number of evaluations brought no significant improvement. A significant improvement
    /// lowers the cost by more than 1e-6 of the cost, or adds a member to the Pareto front.
    Stagnation,
    /// The search was interrupted.
    Interrupted,
    /// The time limit was reached. The caller sets this variant, because the search itself sees only an
    /// interruption.
    TimeLimit,
    /// The resumed search did not evaluate the points that its checkpoint records.
    ///
    /// The checkpoint comes from another build, or from a machine that rounds differently.
    Diverged,
    /// Every placement and attitude is fixed.
    NothingToSearch,
}

impl SearchEnd {
    /// Returns the name of this reason as it is written in documents, for example `time-limit`.
    pub fn name(self) -> &'static str {
        match self {
            SearchEnd::Done => "done",
            SearchEnd::Gap => "gap",
            SearchEnd::Stagnation => "stagnation",
            SearchEnd::Interrupted => "interrupted",
            SearchEnd::TimeLimit => "time-limit",
            SearchEnd::Diverged => "diverged",
            SearchEnd::NothingToSearch => "nothing-to-search",
        }
    }

    /// Describes how the search ended.
    pub fn in_words(self) -> &'static str {
        match self {
            SearchEnd::Done => "the budget is used up, or the final refinement has converged",
            SearchEnd::Gap => {
                "the objective of the best layout exceeds the lower bound by at most the requested gap"
            }
            SearchEnd::Stagnation => "no better layout was found within the requested number of evaluations",
            SearchEnd::Interrupted => "interrupted",
            SearchEnd::TimeLimit => "the time limit was reached",
            SearchEnd::Diverged => "the search could not reproduce the checkpoint",
            SearchEnd::NothingToSearch => "nothing to search: every placement and attitude is fixed",
        }
    }
}

/// Stopping rules of a search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stopping {
    /// Largest number of layout evaluations.
    pub budget: u64,
    /// Relative gap: the search ends when the best objective is at most `bound (1 + gap)`.
    pub gap: Option<f64>,
    /// Proven lower bound of the objective, m or rad.
    pub bound: Option<f64>,
    /// Number of consecutive evaluations without improvement after which the global solver stops. A
    /// Nelder-Mead polish of the best layout follows.
    ///
    /// An improvement counts if it lowers the cost by more than 1e-6 of a reference cost. The reference cost
    /// is the cost at the last improvement that counted.
    pub stagnation: Option<u64>,
    /// Goals of a Pareto search; empty for a search that minimizes the objective alone.
    ///
    /// The rule [`Self::gap`] does not end a Pareto search, because the bound applies to the objective alone.
    /// For the rule [`Self::stagnation`], a new member of the front counts as an improvement.
    #[serde(default)]
    pub pareto: Goals,
    /// Number of layouts to keep; 0 keeps only the best layout, or the whole front of a Pareto search.
    #[serde(default)]
    pub keep: usize,
}

impl Stopping {
    /// Returns the stopping rules that the search settings state. `bound` is the proven lower bound of the
    /// objective, m or rad; None if no bound is known.
    pub fn new(settings: &SearchSettings, bound: Option<f64>) -> Self {
        let SearchSettings { budget, gap, stagnation, pareto, keep, .. } = *settings;
        Self { budget, gap, bound, stagnation, pareto, keep }
    }

    /// Returns the number of evaluations for the global solver.
    pub fn exploration(&self) -> u64 {
        let share = if self.keeps_more() { POLISH_AND_LOCAL_SHARE } else { POLISH_SHARE };
        self.budget - (self.budget as f64 * share) as u64
    }

    /// Returns the largest number of evaluations for the Nelder-Mead polish of the best layout.
    pub fn polish(&self) -> u64 {
        let rest = self.budget - self.exploration();
        if self.keeps_more() { (rest as f64 * POLISH_PART) as u64 } else { rest }
    }

    /// Returns whether layouts other than the best are kept.
    pub fn keeps_more(&self) -> bool {
        self.keep > 0 || !self.pareto.is_empty()
    }
}
