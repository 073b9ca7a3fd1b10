//! A worker that shares the combinations of a sweep with other workers.

use super::combination::{CheckedSweep, run_one};
use super::threads::pools;
use crate::cli::output::{counted, path_word};
use crate::cli::shared_work::{BEATS_PER_LEASE, MAX_LOSSES, NextStep, SharedWork};
use crate::cli::sweep::continuing;
use crate::cli::sweep_claims::ClaimState;
use crate::cli::{Exit, output};
use indicatif::ProgressBar;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time after which a worker reports that it waits for other workers.
const SILENT_WAIT: Duration = Duration::from_secs(2);

/// Processes combinations together with other workers until none is left, or until a signal stops this
/// worker.
///
/// Fails if the workers have given up a combination.
pub fn run_shared(sweep: &CheckedSweep, missing: Vec<usize>, jobs: usize, lease: u16) -> Result<(), Exit> {
    let pools = pools(jobs, missing.len())?;
    let run = SharedRun {
        sweep,
        total: missing.len(),
        work: SharedWork::new(&sweep.folder, lease, missing)?,
        pause: (Duration::from_secs(lease.into()) / 10).min(Duration::from_millis(500)),
        told: AtomicBool::new(false),
        processed: AtomicUsize::new(0),
        bar: output::combinations_bar(),
    };
    let period = Duration::from_secs(lease.into()) / BEATS_PER_LEASE;
    let result = std::thread::scope(|scope| {
        let (ended, is_ended) = channel();
        let heart = scope.spawn(|| run.beat(period, is_ended));
        let workers: Vec<_> = pools.into_iter().map(|pool| scope.spawn(|| run.work(pool))).collect();
        let results: Vec<_> = workers.into_iter().map(|worker| worker.join()).collect();
        drop(ended);
        results.into_iter().chain([heart.join()]).try_for_each(|ended| ended.unwrap_or(Err(Exit::Io)))
    });
    run.bar.finish_and_clear();
    let processed = counted(run.processed.load(Ordering::Relaxed), "combination");
    output::talk(&format!("this worker has processed {processed}"));
    result?;
    run.refuse_given_up()
}

/// State of the run of one worker.
struct SharedRun<'s> {
    sweep: &'s CheckedSweep,
    work: SharedWork<'s>,
    /// Number of combinations that were missing at the start.
    total: usize,
    /// Time between two checks of the claims of other workers.
    pause: Duration,
    /// Whether the worker has reported that it waits.
    told: AtomicBool,
    /// Number of combinations that this worker has processed.
    processed: AtomicUsize,
    bar: ProgressBar,
}

impl SharedRun<'_> {
    /// Processes one combination after another. A failure stops the other threads of this worker.
    fn work(&self, pool: rayon::ThreadPool) -> Result<(), Exit> {
        let result = self.work_until_stopped(&pool);
        if result.is_err() {
            self.sweep.stop.store(true, Ordering::Relaxed);
        }
        result
    }

    fn work_until_stopped(&self, pool: &rayon::ThreadPool) -> Result<(), Exit> {
        let mut idle = Instant::now();
        while !self.sweep.stop.load(Ordering::Relaxed) {
            match self.work.next()? {
                NextStep::Finish => break,
                NextStep::Wait => {
                    self.tell_of_waiting(idle.elapsed());
                    std::thread::sleep(self.pause);
                }
                NextStep::Process(index) => {
                    self.process(pool, index)?;
                    idle = Instant::now();
                }
            }
            let done = (self.total - self.work.left().min(self.total)) as u64;
            output::advance(&self.bar, done.saturating_sub(self.bar.position()), self.total as u64);
        }
        Ok(())
    }

    fn process(&self, pool: &rayon::ThreadPool, index: usize) -> Result<(), Exit> {
        match pool.install(|| run_one(self.sweep, index)) {
            Ok(true) => {
                self.processed.fetch_add(1, Ordering::Relaxed);
                self.work.end(index, ClaimState::Done, None)
            }
            Ok(false) => self.work.end(index, ClaimState::Stopped, None),
            Err(exit) => {
                // A failure to write the claim is ignored: the first failure is already printed, and often
                // has the same cause.
                let _ = self.work.end(index, ClaimState::Failed, output::last_error());
                Err(exit)
            }
        }
    }

    /// Writes a heartbeat in every period until the work has ended. A failure stops the worker.
    fn beat(&self, period: Duration, is_ended: Receiver<()>) -> Result<(), Exit> {
        while is_ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
            if let Err(exit) = self.work.beat() {
                self.sweep.stop.store(true, Ordering::Relaxed);
                return Err(exit);
            }
        }
        Ok(())
    }

    fn tell_of_waiting(&self, idle: Duration) {
        let others = self.work.of_others();
        if idle >= SILENT_WAIT && !others.is_empty() && !self.told.swap(true, Ordering::Relaxed) {
            let folder = path_word(&self.sweep.folder);
            output::talk(&format!(
                "note: waiting for {} of other workers",
                counted(others.len(), "combination")
            ));
            output::talk(&format!("  help: sweetspot sweep --status {folder} shows them"));
        }
    }

    fn refuse_given_up(&self) -> Result<(), Exit> {
        let given_up = self.work.given_up();
        if given_up.is_empty() || self.sweep.stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let list = given_up.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
        let again = continuing(&self.sweep.plan, &self.sweep.folder, "--resume");
        output::error(&format!(
            "{} given up ({list}), because {MAX_LOSSES} workers per combination have died",
            counted(given_up.len(), "combination")
        ));
        output::talk(&format!(
            "  help: sweetspot {again} computes the remaining combinations in a single process"
        ));
        Err(Exit::Limit)
    }
}
