//! When a search has done enough. Every rule is a function of the record alone, so that it stops at
//! the same evaluation on any machine and after any interruption.

use super::record::Record;
use crate::cell::{Goals, SearchSettings};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Share of the budget kept for the polish; with a front or a shortlist, whose members are polled after
/// it, that and the part of it that the polish may take.
const POLISH_SHARE: f64 = 0.1;
const POLL_SHARE: f64 = 0.25;
const POLISH_PART: f64 = 0.3;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// Every evaluation of the budget was used, or the polish had nothing left to gain.
    Done,
    /// The best layout is as near to the proven bound as asked.
    Gap,
    /// Nothing better was found for as many evaluations as asked.
    Stagnation,
    /// Somebody asked to stop.
    Interrupted,
    /// The time was over; said by who holds the clock, to a search it is an interruption.
    TimeLimit,
    /// A checkpoint was not met again: made by another build, or where numbers round otherwise.
    Diverged,
    /// No placement has a range.
    NothingToSearch,
}

impl Ended {
    /// The word in documents.
    pub fn name(self) -> &'static str {
        match self {
            Ended::Done => "done",
            Ended::Gap => "gap",
            Ended::Stagnation => "stagnation",
            Ended::Interrupted => "interrupted",
            Ended::TimeLimit => "time-limit",
            Ended::Diverged => "diverged",
            Ended::NothingToSearch => "nothing-to-search",
        }
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Ended::Done => "the budget is used, or the polish had nothing left to gain",
            Ended::Gap => "it is as near to the bound as asked",
            Ended::Stagnation => "nothing better was found for as long as asked",
            Ended::Interrupted => "interrupted",
            Ended::TimeLimit => "the time was over",
            Ended::Diverged => "the checkpoint could not be followed",
            Ended::NothingToSearch => "nothing to search: every placement is fixed",
        }
    }
}

/// The rules of a search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stopping {
    /// Layout evaluations in all.
    pub budget: u64,
    /// Ends when the best objective is at most `bound (1 + gap)`.
    pub gap: Option<f64>,
    /// Proven lower bound of the objective, m.
    pub bound: Option<f64>,
    /// The global solver ends after so many evaluations without an improvement by more than 1e-6 of
    /// the objective; the polish follows.
    pub stagnation: Option<u64>,
    /// If any, the search is for a front in these goals: the gap, which is of the error alone, does not
    /// end it, and an improvement is a new member of the front.
    #[serde(default)]
    pub pareto: Goals,
    /// How many layouts are kept; 0: the best alone, or the whole front.
    #[serde(default)]
    pub keep: usize,
}

impl Stopping {
    pub fn new(settings: &SearchSettings, bound: Option<f64>) -> Self {
        let SearchSettings { budget, gap, stagnation, pareto, keep, .. } = *settings;
        Self { budget, gap, bound, stagnation, pareto, keep }
    }

    /// Evaluations that leave the polish its share.
    pub fn exploration(&self) -> u64 {
        let share = if self.keeps_more() { POLL_SHARE } else { POLISH_SHARE };
        self.budget - (self.budget as f64 * share) as u64
    }

    /// Evaluations of the polish, at most.
    pub fn polish(&self) -> u64 {
        let rest = self.budget - self.exploration();
        if self.keeps_more() { (rest as f64 * POLISH_PART) as u64 } else { rest }
    }

    /// Whether other layouts than the best are kept.
    pub fn keeps_more(&self) -> bool {
        self.keep > 0 || !self.pareto.is_empty()
    }

    pub fn closed(&self, record: &Record) -> bool {
        if !self.pareto.is_empty() {
            return false;
        }
        let enough = self.gap.zip(self.bound).map(|(gap, bound)| bound + gap * bound.abs());
        enough.zip(record.best()).is_some_and(|(enough, best)| best <= enough)
    }

    pub fn stagnated(&self, record: &Record) -> bool {
        self.stagnation.is_some_and(|n| record.stillness >= n)
    }

    /// What would have ended the search before this record, if anything.
    pub fn ended_before(&self, record: &Record) -> Option<Ended> {
        match () {
            () if self.closed(record) => Some(Ended::Gap),
            () if self.stagnated(record) => Some(Ended::Stagnation),
            () if record.evaluations >= self.exploration().max(1) => Some(Ended::Done),
            () => None,
        }
    }
}
