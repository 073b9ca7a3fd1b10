//! Journal of a search, from which the search can be resumed.
//!
//! Every run of a solver is a function of the seed, the number of the run and the costs that the solver
//! receives. So a checkpoint needs no state of a solver. The checkpoint holds the record at the start of the
//! current run and the results of all evaluations since then. A resumed search starts the current run again.
//! The resumed search takes the results of the first evaluations of this run from the journal and computes
//! the later results.

use super::pareto_front::ParetoFront;
use super::record::{Answer, Record};
use super::scalarization::Scalarization;
use super::search_space::SearchSpace;
use super::stopping::{SearchEnd, Stopping};
use serde::{Deserialize, Serialize};

/// Largest number of evaluations of one run, which limits the journal to several hundred kilobytes.
const MAX_RUN_EVALUATIONS: u64 = 20_000;

/// A run of a Pareto search with n variables has at most this number times `n + 1` evaluations.
///
/// Many scalarizations, each minimized roughly, give a better front than a few scalarizations, each minimized
/// exactly.
const PARETO_RUN_EVALUATIONS: u64 = 100;

/// Offset and prime of the 64-bit FNV-1a hash (G. Fowler, L. C. Noll, K.-P. Vo).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0000_0100_0000_01b3);

/// State from which a search can be resumed. Floating-point numbers must be stored without rounding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    stopping: Stopping,
    /// Number of the current run.
    run: u64,
    /// Record at the start of the current run.
    record: Record,
    /// Results of the evaluations in the current run.
    explored: Vec<Answer>,
    /// Results of the evaluations in the polish and local search that followed the current run.
    polished: Vec<Answer>,
    /// Hash of the evaluated points in each of two phases: exploration, and polish with local search.
    asked: [u64; 2],
}

/// Reason why a search cannot resume from a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unfit {
    /// The checkpoint belongs to a search with a different number of variables.
    Dimensions { has: usize, needs: usize },
    /// The checkpoint holds more evaluations than the new budget allows.
    Budget { used: u64 },
    /// The checkpoint belongs to a search with different goals or a different number of layouts to keep.
    Kept,
    /// The search would have ended before this checkpoint under the new stopping rules.
    Ended(SearchEnd),
}

impl Checkpoint {
    /// Returns the number of evaluations that a resumed search need not repeat.
    pub fn evaluations(&self) -> u64 {
        self.record.evaluations + (self.explored.len() + self.polished.len()) as u64
    }

    /// Returns the Pareto front at the start of the solver's current run; None unless the search is a Pareto
    /// search.
    pub fn front(&self) -> Option<&ParetoFront> {
        self.record.front.as_ref()
    }

    /// Returns the stopping rules of the search.
    pub fn stopping(&self) -> &Stopping {
        &self.stopping
    }

    /// Checks that a search resumed from this checkpoint would give the same bytes as a search without
    /// interruption.
    ///
    /// # Errors
    /// Returns the reason if a search with these dimensions and stopping rules cannot resume.
    pub fn check(&self, dimensions: usize, stopping: &Stopping) -> Result<(), Unfit> {
        let has = self.record.point.len();
        if has != dimensions {
            return Err(Unfit::Dimensions { has, needs: dimensions });
        }
        if (stopping.pareto, stopping.keep) != (self.stopping.pareto, self.stopping.keep) {
            return Err(Unfit::Kept);
        }
        if self.evaluations() > stopping.budget {
            return Err(Unfit::Budget { used: self.evaluations() });
        }
        match self.record.ended_before(stopping) {
            Some(ended) if *stopping != self.stopping => Err(Unfit::Ended(ended)),
            _ => Ok(()),
        }
    }
}

/// Phase of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Explore,
    Polish,
}

/// Record of a search, with the journal from which the search can be resumed.
pub struct SearchJournal {
    pub record: Record,
    pub phase: Phase,
    /// Number of evaluations at which the current run, polish or local search ends.
    pub until: u64,
    /// Whether the points that the resumed search has evaluated differ from the points in its journal.
    pub diverged: bool,
    checkpoint: Checkpoint,
    /// Number of evaluations in the current phase of the current run.
    told: usize,
    /// Hash of the points evaluated in the current phase of the current run.
    hash: u64,
}

impl SearchJournal {
    /// Begins a search at a point of the unit cube.
    pub fn new(point: Vec<f64>, stopping: Stopping) -> Self {
        let record = Record::new(point, &stopping);
        let (explored, polished, asked) = (Vec::new(), Vec::new(), [FNV.0; 2]);
        Self::open(Checkpoint { stopping, run: 0, record, explored, polished, asked })
    }

    /// Resumes from a checkpoint that [`Checkpoint::check`] has accepted.
    pub fn resumed(checkpoint: &Checkpoint, stopping: Stopping) -> Self {
        let mut checkpoint = checkpoint.clone();
        if stopping != checkpoint.stopping {
            // The exploration may now continue beyond its former end, and another polish will follow.
            checkpoint.stopping = stopping;
            checkpoint.polished.clear();
            checkpoint.asked[1] = FNV.0;
        }
        Self::open(checkpoint)
    }

    fn open(checkpoint: Checkpoint) -> Self {
        let record = checkpoint.record.clone();
        let (phase, diverged, told, hash) = (Phase::Explore, false, 0, FNV.0);
        let mut journal = Self { record, phase, until: 0, diverged, checkpoint, told, hash };
        journal.allow();
        journal
    }

    /// Returns the state from which the search can be resumed.
    pub fn checkpoint(&self) -> &Checkpoint {
        &self.checkpoint
    }

    /// Returns the number of the current run, counted from 0.
    pub fn run(&self) -> u64 {
        self.checkpoint.run
    }

    /// Begins the next run of the global solver.
    pub fn begin_run(&mut self) {
        // A run that ends before its journal ends is not the recorded run.
        self.diverged |= self.knows();
        let Checkpoint { run, record, explored, asked, .. } = &mut self.checkpoint;
        *run += 1;
        record.clone_from(&self.record);
        explored.clear();
        *asked = [FNV.0; 2];
        (self.told, self.hash) = (0, FNV.0);
        self.allow();
    }

    /// Begins the polish.
    pub fn begin_polish(&mut self) {
        // With new stopping rules, the exploration may end before its journal ends.
        self.checkpoint.explored.truncate(self.told);
        self.checkpoint.asked[0] = self.hash;
        self.phase = Phase::Polish;
        (self.told, self.hash) = (0, FNV.0);
        self.allow();
    }

    /// Begins the local search.
    ///
    /// The limit `until` increases by [`MAX_RUN_EVALUATIONS`], but not beyond the budget.
    pub fn begin_local_search(&mut self) {
        self.until = self.checkpoint.stopping.budget.min(self.until + MAX_RUN_EVALUATIONS);
    }

    fn allow(&mut self) {
        let stopping = &self.checkpoint.stopping;
        let most = match self.phase {
            Phase::Explore => stopping.exploration(),
            // An exploration that ended early leaves more of the budget to the polish.
            Phase::Polish if stopping.keeps_more() => self.record.evaluations + stopping.polish(),
            Phase::Polish => stopping.budget,
        };
        let run = match self.scalarization() {
            Some(_) => PARETO_RUN_EVALUATIONS * (self.record.point.len() as u64 + 1),
            None => MAX_RUN_EVALUATIONS,
        };
        self.until = most.min(self.record.evaluations + run);
    }

    /// Returns the scalarization that the current run minimizes; None if the current phase minimizes the cost
    /// of the layout.
    ///
    /// The scalarization depends only on the record at the start of the run.
    pub fn scalarization(&self) -> Option<Scalarization> {
        let Checkpoint { run, record, .. } = &self.checkpoint;
        let front = record.front.as_ref().filter(|_| self.phase == Phase::Explore)?;
        Some(Scalarization::new(front, *run))
    }

    /// Returns the stopping rule that ends the current phase now; None if the phase may continue.
    pub fn met(&self) -> Option<SearchEnd> {
        let stopping = &self.checkpoint.stopping;
        match self.phase {
            _ if self.diverged => Some(SearchEnd::Diverged),
            _ if self.record.has_closed_gap(stopping) => Some(SearchEnd::Gap),
            Phase::Explore if self.record.has_stagnated(stopping) => Some(SearchEnd::Stagnation),
            _ => None,
        }
    }

    /// Returns how the search ended, provided that it was not interrupted.
    pub fn ended(&self) -> SearchEnd {
        let stopping = &self.checkpoint.stopping;
        match self.met() {
            Some(ended) => ended,
            None if self.record.has_stagnated(stopping) => SearchEnd::Stagnation,
            None => SearchEnd::Done,
        }
    }

    /// Returns whether the journal holds the result of the next evaluation.
    pub fn knows(&self) -> bool {
        self.told < self.answers().len()
    }

    fn answers(&self) -> &Vec<Answer> {
        if self.phase == Phase::Explore { &self.checkpoint.explored } else { &self.checkpoint.polished }
    }

    /// Returns the results of the next evaluations that the journal holds, at most `count`.
    pub fn recall(&self, count: usize) -> Vec<Answer> {
        self.answers()[self.told..].iter().take(count).cloned().collect()
    }

    /// Adds evaluated points to the record. Results that the journal does not hold yet are added to the
    /// journal.
    pub fn note<'p>(
        &mut self,
        space: &SearchSpace<'_>,
        points: impl Iterator<Item = &'p Vec<f64>>,
        answers: &[Answer],
    ) {
        let phase = self.phase as usize;
        for (point, answer) in points.zip(answers) {
            self.record.note(space, point, answer);
            let bits = point.iter().flat_map(|u| u.to_bits().to_le_bytes());
            self.hash = bits.fold(self.hash, |h, byte| (h ^ u64::from(byte)).wrapping_mul(FNV.1));
            self.told += 1;
            let known = self.answers().len();
            if self.told < known {
                continue;
            }
            if self.told == known {
                self.diverged |= self.hash != self.checkpoint.asked[phase];
                continue;
            }
            let Checkpoint { explored, polished, asked, .. } = &mut self.checkpoint;
            let journal = if self.phase == Phase::Explore { explored } else { polished };
            journal.push(answer.clone());
            asked[phase] = self.hash;
        }
        self.record.pause();
    }
}
