//! When a search has done enough. Every rule is a function of the record alone, so that it stops at
//! the same evaluation on any machine and after any interruption.

use super::record::Record;
use crate::cell::SearchSettings;
use serde::{Deserialize, Serialize};

/// Share of the budget kept for the polish.
const POLISH_SHARE: f64 = 0.1;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
            Ended::Done => "the budget is used",
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
}

impl Stopping {
    pub fn new(settings: &SearchSettings, bound: Option<f64>) -> Self {
        let SearchSettings { budget, gap, stagnation, .. } = *settings;
        Self { budget, gap, bound, stagnation }
    }

    /// Evaluations that leave the polish its share.
    pub fn exploration(&self) -> u64 {
        self.budget - (self.budget as f64 * POLISH_SHARE) as u64
    }

    pub fn closed(&self, record: &Record) -> bool {
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
