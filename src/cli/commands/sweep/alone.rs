//! Sweep by one process, which shares no combination with other processes.

use super::combination::{CheckedSweep, run_one};
use super::threads::pools;
use crate::cli::mutex::locked;
use crate::cli::{Exit, output};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Processes the missing combinations in parallel. Each combination gets an equal share of the threads.
pub fn run_all(sweep: &CheckedSweep, missing: &[usize], jobs: usize) -> Result<(), Exit> {
    let (next, failed, bar) = (AtomicUsize::new(0), Mutex::new(None), output::combinations_bar());
    let work = |pool: rayon::ThreadPool| {
        while let Some(&index) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            if sweep.stop.load(Ordering::Relaxed) {
                break;
            }
            if let Err(exit) = pool.install(|| run_one(sweep, index)) {
                // The other threads finish their current combination.
                next.store(missing.len(), Ordering::Relaxed);
                *locked(&failed) = Some(exit);
            }
            output::advance(&bar, 1, missing.len() as u64);
        }
    };
    let pools = pools(jobs, missing.len())?;
    std::thread::scope(|scope| pools.into_iter().for_each(|p| drop(scope.spawn(|| work(p)))));
    bar.finish_and_clear();
    failed.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()).map_or(Ok(()), Err)
}
