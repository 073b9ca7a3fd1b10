//! Who processes the combinations of a sweep: this process alone, this and other workers, or a batch system.

use super::alone::run_all;
use super::combination::CheckedSweep;
use super::on_slurm::{run_on_slurm, show_script};
use super::worker::run_shared;
use crate::cli::Exit;
use crate::cli::commands::suggest;
use crate::cli::slurm::ArrayOptions;
use crate::cli::sweep::continuing;

/// Who processes the combinations of a sweep.
pub struct Workforce<'a> {
    /// Whether other workers share the work.
    pub claims: bool,
    /// Number of combinations to process in parallel.
    pub jobs: usize,
    pub options: ArrayOptions<'a>,
}

impl Workforce<'_> {
    /// Processes the missing combinations, or returns early if a signal stops this program.
    pub fn process(&self, sweep: &CheckedSweep, missing: Vec<usize>) -> Result<(), Exit> {
        match (self.claims, self.options.flags.on) {
            (true, _) => run_shared(sweep, missing, self.jobs, self.options.lease),
            (false, Some(_)) => run_on_slurm(sweep, missing, self.options),
            (false, None) => run_all(sweep, &missing, self.jobs),
        }
    }

    /// Shows what would be submitted.
    pub fn show(&self, sweep: &CheckedSweep, missing: Vec<usize>) -> Result<Exit, Exit> {
        show_script(sweep, missing, self.options)?;
        suggest(&self.again(sweep));
        Ok(Exit::Done)
    }

    /// Returns the command that continues a stopped sweep.
    pub fn again(&self, sweep: &CheckedSweep) -> String {
        let option = if self.claims { "--claim" } else { "--resume" };
        let engine = if self.options.flags.on.is_some() { " --on slurm" } else { "" };
        continuing(&sweep.plan, &sweep.folder, option) + engine
    }
}

/// Returns the number of combinations to process in parallel, given the number that the user asks for.
pub fn jobs(asked: Option<u16>) -> usize {
    asked.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from)
}
