//! Record of the layouts that a search has evaluated.

use super::pareto_front::ParetoFront;
use super::search_space::SearchSpace;
use super::shortlist::Shortlist;
use super::stopping::{SearchEnd, Stopping};
use serde::{Deserialize, Serialize};

/// For the stagnation rule, an improvement counts if it lowers the cost by more than this share. The share
/// refers to the cost at the last improvement that counted.
const MIN_IMPROVEMENT: f64 = 1e-6;

/// Result of one evaluation, as the journal stores it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "CompactAnswer", into = "CompactAnswer")]
pub struct Answer {
    pub cost: f64,
    pub feasible: bool,
    /// Loss in every goal ([`crate::cell::Goal::loss`]) of a feasible layout in a Pareto search; otherwise
    /// empty.
    pub losses: Vec<f64>,
}

/// Compact form of an [`Answer`], which keeps a journal of thousands of evaluations small.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum CompactAnswer {
    Plain(f64, u8),
    WithLosses(f64, u8, Vec<f64>),
}

impl From<CompactAnswer> for Answer {
    fn from(row: CompactAnswer) -> Self {
        let (cost, feasible, losses) = match row {
            CompactAnswer::Plain(cost, feasible) => (cost, feasible, Vec::new()),
            CompactAnswer::WithLosses(cost, feasible, losses) => (cost, feasible, losses),
        };
        Self { cost, feasible: feasible != 0, losses }
    }
}

impl From<Answer> for CompactAnswer {
    fn from(Answer { cost, feasible, losses }: Answer) -> Self {
        let feasible = u8::from(feasible);
        if losses.is_empty() {
            CompactAnswer::Plain(cost, feasible)
        } else {
            CompactAnswer::WithLosses(cost, feasible, losses)
        }
    }
}

/// Summary of all evaluations so far, with the best point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub evaluations: u64,
    pub feasible: u64,
    /// Point of the unit cube with the least cost.
    pub point: Vec<f64>,
    pub cost: Option<f64>,
    /// Number of evaluations and objective (m, rad, a share or a cost) at each improvement of the best
    /// feasible layout.
    pub trace: Vec<(u64, f64)>,
    /// Greatest number of consecutive evaluations without significant improvement, updated after each batch.
    pub stillness: u64,
    /// Number of evaluations and cost at the last significant improvement.
    ///
    /// In a Pareto search, the number of evaluations is also updated at each new member of the front.
    improved: (u64, f64),
    /// Pareto front; None unless the search is a Pareto search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<ParetoFront>,
    /// Shortlist of the best layouts; None in a Pareto search, and in a search that keeps only the best
    /// layout.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortlist: Option<Shortlist>,
}

impl Record {
    /// Returns an empty record of a search that starts at a point.
    pub fn new(point: Vec<f64>, stopping: &Stopping) -> Self {
        let Stopping { pareto, keep, .. } = *stopping;
        let front = (!pareto.is_empty()).then(|| ParetoFront::new(pareto));
        // In a Pareto search `keep` is the number of reported members of the front.
        let shortlist = (front.is_none() && keep > 0).then(|| Shortlist::new(keep));
        Self { point, front, shortlist, ..Self::default() }
    }

    /// Returns the objective of the best feasible layout (m, rad, a share or a cost), if there is one.
    pub fn best(&self) -> Option<f64> {
        self.trace.last().map(|t| t.1)
    }

    /// Adds one evaluated point.
    pub fn note(&mut self, space: &SearchSpace<'_>, point: &[f64], answer: &Answer) {
        let Answer { cost, feasible, .. } = *answer;
        self.evaluations += 1;
        self.feasible += u64::from(feasible);
        if feasible && (self.front.is_some() || self.shortlist.is_some()) {
            self.collect(&space.settled(point), answer);
        }
        if self.cost.is_some_and(|best| cost >= best) {
            return;
        }
        if self.cost.is_none() || cost < self.improved.1 - MIN_IMPROVEMENT * self.improved.1.abs() {
            self.improved = (self.evaluations, cost);
        }
        self.cost = Some(cost);
        self.point = point.to_vec();
        if feasible {
            self.trace.push((self.evaluations, cost));
        }
    }

    /// Offers a feasible layout to the front or the shortlist.
    fn collect(&mut self, settled: &[f64], answer: &Answer) {
        if let Some(front) = &mut self.front
            && !answer.losses.is_empty()
            && front.take(settled, &answer.losses)
        {
            self.improved.0 = self.evaluations;
        }
        if let Some(shortlist) = &mut self.shortlist {
            shortlist.take(settled, answer.cost);
        }
    }

    /// Updates `stillness` after a batch of evaluations, just before the stopping rules are checked.
    pub fn pause(&mut self) {
        self.stillness = self.stillness.max(self.evaluations - self.improved.0);
    }

    /// Returns whether the objective of the best layout is within the requested gap to the proven bound.
    pub fn has_closed_gap(&self, stopping: &Stopping) -> bool {
        if !stopping.pareto.is_empty() {
            return false;
        }
        let enough = stopping.gap.zip(stopping.bound).map(|(gap, bound)| bound + gap * bound.abs());
        enough.zip(self.best()).is_some_and(|(enough, best)| best <= enough)
    }

    /// Returns whether the longest series of evaluations without significant improvement has reached the
    /// limit of the stopping rules.
    pub fn has_stagnated(&self, stopping: &Stopping) -> bool {
        stopping.stagnation.is_some_and(|n| self.stillness >= n)
    }

    /// Returns how a search with these stopping rules would have ended before this record; None if the search
    /// would go on.
    pub fn ended_before(&self, stopping: &Stopping) -> Option<SearchEnd> {
        match () {
            () if self.has_closed_gap(stopping) => Some(SearchEnd::Gap),
            () if self.has_stagnated(stopping) => Some(SearchEnd::Stagnation),
            () if self.evaluations >= stopping.exploration().max(1) => Some(SearchEnd::Done),
            () => None,
        }
    }
}
