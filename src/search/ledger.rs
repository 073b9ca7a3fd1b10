//! The journal of a search, from which it can be continued.
//!
//! Every run of a solver is a function of the seed, its number and the costs it is answered. So a
//! checkpoint needs no state of a solver: it holds the record as it stood when the run under way
//! began, and the answers since. Continuing starts that run again, answers its first questions from
//! the journal, and goes on.

use super::aim::Aim;
use super::front::Front;
use super::record::{Answer, Record};
use super::space::Space;
use super::stopping::{Ended, Stopping};
use serde::{Deserialize, Serialize};

/// Evaluations of one run at most: bounds the journal to some hundred kilobytes.
const RUN: u64 = 20_000;

/// Evaluations per dimension, and one more, of one run for a front: many aims, none of them perfectly met.
const RUN_FOR_FRONT: u64 = 100;

/// Offset and prime of the 64-bit FNV-1a hash (G. Fowler, L. C. Noll, K.-P. Vo).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0000_0100_0000_01b3);

/// All that a search needs to go on; floats must be kept to the bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    stopping: Stopping,
    /// Number of the run under way.
    run: u64,
    /// As it stood when that run began.
    record: Record,
    /// Answers to that run, and to the polish that followed it.
    explored: Vec<Answer>,
    polished: Vec<Answer>,
    /// Hashes of the points that were answered.
    asked: [u64; 2],
}

/// Why a checkpoint cannot be continued.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unfit {
    /// It is of a search in another number of variables.
    Dimensions { has: usize, needs: usize },
    /// It has more evaluations than the new budget.
    Budget { used: u64 },
    /// It looked for other goals, or kept another number of layouts.
    Kept,
    /// Under the new rules the search would have ended before.
    Ended(Ended),
}

impl Checkpoint {
    /// Evaluations that need not be made again.
    pub fn evaluations(&self) -> u64 {
        self.record.evaluations + (self.explored.len() + self.polished.len()) as u64
    }

    /// As it stood when the run under way began.
    pub fn front(&self) -> Option<&Front> {
        self.record.front.as_ref()
    }

    pub fn stopping(&self) -> &Stopping {
        &self.stopping
    }

    /// # Errors
    /// Why a search of so many variables under these rules cannot go on from here with the bytes of
    /// one that was never interrupted.
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
        match stopping.ended_before(&self.record) {
            Some(ended) if *stopping != self.stopping => Err(Unfit::Ended(ended)),
            _ => Ok(()),
        }
    }
}

/// The two parts of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Explore,
    Polish,
}

/// The record with its journal.
pub struct Ledger {
    pub record: Record,
    pub phase: Phase,
    /// Evaluations at which the run under way, or the polish, ends.
    pub until: u64,
    pub diverged: bool,
    checkpoint: Checkpoint,
    /// How many answers of this phase have been told, and the hash of their points.
    told: usize,
    hash: u64,
}

impl Ledger {
    pub fn new(point: Vec<f64>, stopping: Stopping) -> Self {
        let record = Record::new(point, &stopping);
        let (explored, polished, asked) = (Vec::new(), Vec::new(), [FNV.0; 2]);
        Self::open(Checkpoint { stopping, run: 0, record, explored, polished, asked })
    }

    /// From a checkpoint that has been checked.
    pub fn resumed(checkpoint: &Checkpoint, stopping: Stopping) -> Self {
        let mut checkpoint = checkpoint.clone();
        if stopping != checkpoint.stopping {
            // The exploration may now go on where it ended before: another polish will follow.
            checkpoint.stopping = stopping;
            checkpoint.polished.clear();
            checkpoint.asked[1] = FNV.0;
        }
        Self::open(checkpoint)
    }

    fn open(checkpoint: Checkpoint) -> Self {
        let record = checkpoint.record.clone();
        let (phase, diverged, told, hash) = (Phase::Explore, false, 0, FNV.0);
        let mut ledger = Self { record, phase, until: 0, diverged, checkpoint, told, hash };
        ledger.allow();
        ledger
    }

    pub fn checkpoint(&self) -> &Checkpoint {
        &self.checkpoint
    }

    pub fn run(&self) -> u64 {
        self.checkpoint.run
    }

    pub fn begin_run(&mut self) {
        // A run that ends before its journal does is another one.
        self.diverged |= self.knows();
        let Checkpoint { run, record, explored, asked, .. } = &mut self.checkpoint;
        *run += 1;
        record.clone_from(&self.record);
        explored.clear();
        *asked = [FNV.0; 2];
        (self.told, self.hash) = (0, FNV.0);
        self.allow();
    }

    pub fn begin_polish(&mut self) {
        // Under new rules the exploration may end before its journal does.
        self.checkpoint.explored.truncate(self.told);
        self.checkpoint.asked[0] = self.hash;
        self.phase = Phase::Polish;
        (self.told, self.hash) = (0, FNV.0);
        self.allow();
    }

    /// What the polish has left may be used.
    pub fn begin_poll(&mut self) {
        self.until = self.checkpoint.stopping.budget.min(self.until + RUN);
    }

    fn allow(&mut self) {
        let stopping = &self.checkpoint.stopping;
        let most = match self.phase {
            Phase::Explore => stopping.exploration(),
            // An exploration that ended early leaves more.
            Phase::Polish if stopping.keeps_more() => self.record.evaluations + stopping.polish(),
            Phase::Polish => stopping.budget,
        };
        let run = match self.aim() {
            Some(_) => RUN_FOR_FRONT * (self.record.point.len() as u64 + 1),
            None => RUN,
        };
        self.until = most.min(self.record.evaluations + run);
    }

    /// What the run under way makes small instead of the error, told by the record as it stood when the
    /// run began; None: the error.
    pub fn aim(&self) -> Option<Aim> {
        let Checkpoint { run, record, .. } = &self.checkpoint;
        let front = record.front.as_ref().filter(|_| self.phase == Phase::Explore)?;
        Some(Aim::new(front, *run))
    }

    /// The rule of stopping that the record meets, if any.
    pub fn met(&self) -> Option<Ended> {
        let stopping = &self.checkpoint.stopping;
        match self.phase {
            _ if self.diverged => Some(Ended::Diverged),
            _ if stopping.closed(&self.record) => Some(Ended::Gap),
            Phase::Explore if stopping.stagnated(&self.record) => Some(Ended::Stagnation),
            _ => None,
        }
    }

    /// How a search ended that nobody stopped.
    pub fn ended(&self) -> Ended {
        let stopping = &self.checkpoint.stopping;
        match self.met() {
            Some(ended) => ended,
            None if stopping.stagnated(&self.record) => Ended::Stagnation,
            None => Ended::Done,
        }
    }

    /// Whether the next answer is in the journal.
    pub fn knows(&self) -> bool {
        self.told < self.answers().len()
    }

    fn answers(&self) -> &Vec<Answer> {
        if self.phase == Phase::Explore { &self.checkpoint.explored } else { &self.checkpoint.polished }
    }

    /// The next answers of the journal, at most so many.
    pub fn recall(&self, count: usize) -> Vec<Answer> {
        self.answers()[self.told..].iter().take(count).cloned().collect()
    }

    /// Takes the answers to these points into the record, and into the journal those that are new.
    pub fn note<'p>(
        &mut self,
        space: &Space<'_>,
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
