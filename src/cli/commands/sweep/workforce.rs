//! Workforce of a sweep: this process alone, this process with other workers, or a batch system.

use super::alone::run_all;
use super::combination::CheckedSweep;
use super::on_slurm::{run_on_slurm, show_script};
use super::worker::run_shared;
use crate::cli::Exit;
use crate::cli::commands::suggest;
use crate::cli::slurm::ArrayOptions;
use crate::cli::sweep::continuing;
use std::sync::atomic::Ordering;

/// Workforce that processes the combinations of a sweep.
pub struct Workforce<'a> {
    /// Whether other workers share the work.
    pub claims: bool,
    /// Number of combinations to process in parallel.
    pub jobs: usize,
    pub options: ArrayOptions<'a>,
}

impl Workforce<'_> {
    /// Processes the missing combinations. If --dry-run is given, only shows the job that would be submitted.
    ///
    /// Returns the exit code of the command if combinations may still be missing: the job was only shown, or
    /// a signal has stopped this program.
    pub fn process(&self, sweep: &CheckedSweep, missing: Vec<usize>) -> Result<Option<Exit>, Exit> {
        let flags = self.options.flags;
        match (self.claims, flags.on) {
            _ if flags.dry_run => show_script(sweep, missing, self.options),
            (true, _) => run_shared(sweep, missing, self.jobs, flags.lease),
            (false, Some(_)) => run_on_slurm(sweep, missing, self.options),
            (false, None) => run_all(sweep, &missing, self.jobs),
        }?;
        let exit = match sweep.stop.load(Ordering::Relaxed) {
            _ if flags.dry_run => Exit::Done,
            true => Exit::Interrupted,
            false => return Ok(None),
        };
        suggest(&self.again(sweep));
        Ok(Some(exit))
    }

    /// Returns the command that continues a stopped sweep.
    fn again(&self, sweep: &CheckedSweep) -> String {
        let option = if self.claims { "--claim" } else { "--resume" };
        let engine = if self.options.flags.on.is_some() { " --on slurm" } else { "" };
        continuing(&sweep.plan, &sweep.folder, option) + engine
    }
}

/// Returns the number of combinations to process in parallel: the number that the user states, or one per
/// core.
pub fn jobs(asked: Option<u16>) -> usize {
    asked.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from)
}
