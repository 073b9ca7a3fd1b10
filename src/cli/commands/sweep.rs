//! `sweep`: searches or maps every combination of settings.

mod alone;
mod check;
pub mod combination;
mod on_slurm;
mod status;
pub mod table;
mod threads;
mod worker;
pub mod workforce;

use super::{stem, suggest};
use crate::cli::arguments::{IndexRanges, SweepArguments};
use crate::cli::output::path_word;
use crate::cli::output_folder::Sharing;
use crate::cli::results::keep_inputs;
use crate::cli::signals::stop_at_signals;
use crate::cli::slurm::ArrayOptions;
use crate::cli::sweep::{StoredRow, asked_plan, continuing, number, open, row, stored_cell_name};
use crate::cli::{Exit, loading, output};
use combination::CheckedSweep;
use std::path::Path;
use workforce::{Workforce, jobs};

/// Runs `sweetspot sweep`.
pub fn sweep(a: &SweepArguments) -> Result<Exit, Exit> {
    if let Some(folder) = &a.status {
        return status::status(folder, a.json);
    }
    let (mut plan, kept) = asked_plan(a)?;
    let asked = asked(a.only.as_ref(), plan.combinations)?;
    let jobs = jobs(a.jobs);
    // The process that stored the plan has checked it, and the inputs match the hashes of the plan.
    let is_checked = a.claim.is_some() && a.cell.is_none();
    let sources = if is_checked { Vec::new() } else { check::check_all(&mut plan, &kept, jobs)? };
    // Array jobs and workers write different files into one folder.
    let is_shared = a.only.is_some() || a.claim.is_some() || a.engine.on.is_some() || a.plan_only;
    let sharing = if is_shared { Sharing::WithOthers } else { Sharing::Alone };
    let folder = open(&plan, a.folder(), &stem(&plan.cell), sharing)?;
    keep_inputs(&folder, &sources)?;
    let cell_name = stored_cell_name(&plan);
    if a.plan_only {
        output::talk(&format!("wrote {}: plan.json, inputs", path_word(&folder)));
        suggest(&format!("sweep --claim {}", path_word(&folder)));
        return Ok(Exit::Done);
    }
    let missing: Vec<usize> = asked.into_iter().filter(|k| is_missing(&folder, *k)).collect();
    let mut sweep = CheckedSweep { plan, kept, folder, cell_name, stop: stop_at_signals(), proof: None };
    let options = ArrayOptions { flags: &a.engine, time: a.time.as_deref() };
    let workforce = Workforce { claims: a.claim.is_some(), jobs, options };
    if let Some(exit) = workforce.process(&sweep, missing)? {
        return Ok(exit);
    }
    if let Some(only) = &a.only {
        tell_part(&sweep, only);
        return Ok(Exit::Done);
    }
    if is_shared {
        sweep.folder.sweep_when_last();
    } else {
        // No other program writes to this folder, so its unfinished files come from killed jobs.
        loading::sweep(&sweep.folder);
    }
    table::gather(&sweep, a.json)
}

/// Returns the combinations of the option `--only`, or all combinations.
fn asked(only: Option<&IndexRanges>, combinations: usize) -> Result<Vec<usize>, Exit> {
    let Some(only) = only else { return Ok((0..combinations).collect()) };
    if only.last() < combinations {
        return Ok(only.below(combinations));
    }
    let (wrong, last) = (only.last(), combinations.saturating_sub(1));
    output::error(&format!(
        "there is no combination {wrong}: the combinations are numbered from 0 to {last}"
    ));
    Err(Exit::BadInput)
}

/// Returns whether a combination must be computed. Prints a warning if one of its files is damaged.
pub fn is_missing(folder: &Path, index: usize) -> bool {
    match row(folder, index) {
        StoredRow::Whole(_) => false,
        StoredRow::Missing => true,
        StoredRow::Damaged(why) => {
            output::talk(&format!("warning: {why}; combination {index} is computed again"));
            true
        }
    }
}

/// Reports the files of a run with `--only`. Such a run writes no table.
fn tell_part(sweep: &CheckedSweep, only: &IndexRanges) {
    let folder = path_word(&sweep.folder);
    match &only.below(sweep.plan.combinations)[..] {
        [index] => {
            output::talk(&format!("wrote {}", path_word(&sweep.folder.join(number(*index) + ".json"))));
        }
        several => {
            let count = output::counted(several.len(), "combination");
            output::talk(&format!("wrote the files of {count} into {folder}"));
        }
    }
    suggest(&continuing(&sweep.plan, &sweep.folder, "--resume"));
}
