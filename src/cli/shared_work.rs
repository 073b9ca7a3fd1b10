//! Distribution of the combinations of a sweep among workers.

use super::loading::make_folder;
use super::sweep::{StoredRow, row};
use super::sweep_claims::{CLAIMS, ClaimState, HeldClaim, SweepClaim, newest};
use super::{Exit, output};
use crate::cli::mutex::locked;
use crate::files::shown;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Number of dead workers at which the other workers give up a combination. Only workers that died while they
/// processed this combination count.
pub const MAX_LOSSES: u32 = 6;

/// Time for which a worker waits for the files of a combination that its owner reports as done. A network
/// share may show these files late. The unit is the lease, the time without a heartbeat after which a
/// combination may be taken over.
const LATE_LEASES: u32 = 3;

/// Number of heartbeats in one lease. It is greater than 1 so that a late heartbeat does not end the lease.
pub const BEATS_PER_LEASE: u32 = 6;

/// Next step of a worker.
pub enum NextStep {
    /// Process this combination, which the worker now owns.
    Process(usize),
    /// Other workers own all combinations that are left.
    Wait,
    Finish,
}

/// State of the combinations of a sweep, as far as this worker knows it.
pub struct SharedWork<'f> {
    folder: &'f Path,
    lease: u16,
    queue: Mutex<WorkQueue>,
    /// Claims of this worker. They have their own lock, so that a heartbeat does not wait for the queue.
    held: Mutex<Vec<HeldClaim>>,
}

#[derive(Default)]
struct WorkQueue {
    /// Combinations that nobody has claimed, as far as this worker knows.
    free: VecDeque<usize>,
    others: Vec<WatchedClaim>,
    given_up: Vec<usize>,
}

impl<'f> SharedWork<'f> {
    /// Makes the folder of the claims. `asked` are the combinations to process.
    pub fn new(folder: &'f Path, lease: u16, asked: Vec<usize>) -> Result<Self, Exit> {
        make_folder(&folder.join(CLAIMS))?;
        let queue = Mutex::new(WorkQueue { free: asked.into(), ..WorkQueue::default() });
        Ok(Self { folder, lease, queue, held: Mutex::new(Vec::new()) })
    }

    /// Claims the next combination: a free combination or, if none is free, a combination whose owner died,
    /// failed or was stopped.
    pub fn next(&self) -> Result<NextStep, Exit> {
        let mut queue = locked(&self.queue);
        while let Some(index) = queue.free.pop_front() {
            if matches!(row(self.folder, index), StoredRow::Whole(_)) {
                continue;
            }
            match HeldClaim::create(self.folder, index, 1, self.lease, 0)? {
                Some(claim) => return Ok(self.hold(claim)),
                None => queue.others.push(WatchedClaim::new(index)),
            }
        }
        let mut k = 0;
        while let Some(watched) = queue.others.get_mut(k) {
            match watched.verdict(self.folder, self.lease) {
                ClaimVerdict::Wait => k += 1,
                ClaimVerdict::Finished => drop(queue.others.swap_remove(k)),
                ClaimVerdict::GivenUp => {
                    let index = queue.others.swap_remove(k).index;
                    queue.given_up.push(index);
                }
                ClaimVerdict::TakeOver { losses, why } => {
                    let (index, number) = (watched.index, watched.number + 1);
                    let claim = HeldClaim::create(self.folder, index, number, self.lease, losses)?;
                    let Some(claim) = claim else {
                        // Another worker was faster.
                        k += 1;
                        continue;
                    };
                    output::talk(&format!("note: combination {index} is taken over: {why}"));
                    queue.others.swap_remove(k);
                    return Ok(self.hold(claim));
                }
            }
        }
        Ok(if queue.others.is_empty() { NextStep::Finish } else { NextStep::Wait })
    }

    fn hold(&self, claim: HeldClaim) -> NextStep {
        let index = claim.index;
        locked(&self.held).push(claim);
        NextStep::Process(index)
    }

    /// Writes a heartbeat to every claim of this worker.
    pub fn beat(&self) -> Result<(), Exit> {
        locked(&self.held).iter_mut().try_for_each(HeldClaim::beat)
    }

    /// Ends the claim of this worker to a combination.
    pub fn end(&self, index: usize, state: ClaimState, why: Option<String>) -> Result<(), Exit> {
        let mut held = locked(&self.held);
        let claim = held.iter().position(|claim| claim.index == index).map(|k| held.swap_remove(k));
        drop(held);
        claim.map_or(Ok(()), |claim| claim.end(state, why))
    }

    /// Returns the combinations that this worker has given up, because too many workers died while they
    /// processed them.
    pub fn given_up(&self) -> Vec<usize> {
        locked(&self.queue).given_up.clone()
    }

    /// Returns the unfinished combinations that other workers have claimed.
    pub fn of_others(&self) -> Vec<usize> {
        locked(&self.queue).others.iter().map(|watched| watched.index).collect()
    }

    /// Returns the number of combinations that are neither finished nor given up.
    pub fn left(&self) -> usize {
        let queue = locked(&self.queue);
        queue.free.len() + queue.others.len() + locked(&self.held).len()
    }
}

/// Newest claim of another worker to a combination, as this worker last read it.
struct WatchedClaim {
    index: usize,
    number: u32,
    bytes: Option<Vec<u8>>,
    /// Time of the last check.
    seen: Instant,
    /// Time for which this worker has seen no change of the claim.
    silent: Duration,
}

/// Decision of this worker about the claim of another worker.
enum ClaimVerdict {
    Finished,
    Wait,
    GivenUp,
    TakeOver { losses: u32, why: String },
}

impl WatchedClaim {
    fn new(index: usize) -> Self {
        Self { index, number: 1, bytes: None, seen: Instant::now(), silent: Duration::ZERO }
    }

    /// Checks the files of the combination and then its newest claim.
    fn verdict(&mut self, folder: &Path, own_lease: u16) -> ClaimVerdict {
        let is_damaged = match row(folder, self.index) {
            StoredRow::Whole(_) => return ClaimVerdict::Finished,
            StoredRow::Damaged(_) => true,
            StoredRow::Missing => false,
        };
        let (number, bytes) = newest(folder, self.index, self.number);
        let is_changed = (number, &bytes) != (self.number, &self.bytes);
        (self.number, self.bytes) = (number, bytes);
        let claim = self.bytes.as_deref().and_then(SweepClaim::parse);
        let seconds = claim.as_ref().map_or(own_lease, |claim| claim.lease);
        let lease = Duration::from_secs(seconds.into());
        // An outage of the file server stops the heartbeats of the owner and also the checks of this
        // worker. A long pause between two checks therefore counts as a short pause.
        let pause = self.seen.elapsed().min(lease / BEATS_PER_LEASE);
        self.silent = if is_changed { Duration::ZERO } else { self.silent + pause };
        self.seen = Instant::now();
        let (owner, losses) = match &claim {
            Some(claim) => (claim.owner(), claim.losses),
            None => ("its owner".into(), self.number.saturating_sub(1)),
        };
        let (patience, lost, why) = match claim.map(|claim| (claim.state, claim.why)) {
            Some((ClaimState::Stopped, _)) => (Duration::ZERO, 0, format!("{owner} was stopped")),
            Some((ClaimState::Failed, why)) => {
                (Duration::ZERO, 0, format!("{owner} failed: {}", shown(&why.unwrap_or_default())))
            }
            Some((ClaimState::Done, _)) if is_damaged => {
                (Duration::ZERO, 0, format!("the files of {owner} are damaged"))
            }
            Some((ClaimState::Done, _)) => {
                (lease * LATE_LEASES, 0, format!("the files of {owner} are missing"))
            }
            Some((ClaimState::Running, _)) | None => {
                (lease, 1, format!("{owner} has shown no heartbeat for {seconds} s"))
            }
        };
        let losses = losses.saturating_add(lost);
        if self.silent < patience {
            ClaimVerdict::Wait
        } else if losses >= MAX_LOSSES {
            ClaimVerdict::GivenUp
        } else {
            ClaimVerdict::TakeOver { losses, why }
        }
    }
}
