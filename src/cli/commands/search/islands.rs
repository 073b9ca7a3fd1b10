//! Search with several successive seeds. The search with one of these seeds is an island. The islands are the
//! combinations of a sweep over the seed, in the folder `islands` of the result. When no island is missing,
//! the islands are merged into the result of one search.

use super::outcome::SearchOutcome;
use super::session::{proven, threads};
use crate::cli::arguments::SearchArguments;
use crate::cli::commands::sweep::combination::CheckedSweep;
use crate::cli::commands::sweep::workforce::{Workforce, jobs};
use crate::cli::commands::sweep::{is_missing, table};
use crate::cli::commands::{stem, warn_of_hopeless, workcell};
use crate::cli::island_plan::{ISLANDS, IslandPlan, joined, parent_folder, planned};
use crate::cli::output::path_word;
use crate::cli::output_folder::Sharing;
use crate::cli::results::{RunDescription, keep_inputs};
use crate::cli::signals::stop_at_signals;
use crate::cli::slurm::ArrayOptions;
use crate::cli::sweep::{has_plan, island_name, open, stored_cell_name, stored_plan};
use crate::cli::{Exit, loading, output};
use crate::files::{Source, shown};
use crate::layout::Workcell;
use crate::record::IslandEntry;
use crate::search::{Island, merged};
use std::path::Path;
use std::time::Instant;

/// Returns whether the command line asks for islands, or resumes a search with islands.
pub fn are_asked(a: &SearchArguments) -> bool {
    let is_stored = a.resume.as_ref().is_some_and(|folder| has_plan(&folder.join(ISLANDS)));
    a.islands.is_some() || a.claim.is_some() || a.engine.on.is_some() || is_stored
}

/// Processes the missing islands as the command line states, and merges all islands.
pub fn search_islands(a: &SearchArguments) -> Result<Exit, Exit> {
    let clock = Instant::now();
    let IslandPlan { plan, kept, loaded } = match a.cell.as_ref().filter(|_| a.resume.is_none()) {
        Some(cell) => planned(a, cell)?,
        None => joined(a)?,
    };
    let workcell = workcell(loaded.cell, &plan.cell)?;
    warn_of_hopeless(&workcell);
    let pool = threads(a.threads)?;
    let proof = pool.install(|| proven(&workcell));
    let is_shared = a.claim.is_some() || a.engine.on.is_some();
    let sharing = if is_shared { Sharing::WithOthers } else { Sharing::Alone };
    let stem = stem(&plan.cell);
    let parent = parent_folder(a.folder(), &stem, sharing)?;
    let folder = open(&plan, Some(&parent.join(ISLANDS)), &stem, sharing)?;
    keep_inputs(&folder, &loaded.sources)?;
    let missing: Vec<usize> = (0..plan.combinations).filter(|k| is_missing(&folder, *k)).collect();
    let (cell_name, stop) = (stored_cell_name(&plan), stop_at_signals());
    let mut sweep = CheckedSweep { plan, kept, folder, cell_name, stop, proof: Some(proof) };
    let options = ArrayOptions { flags: &a.engine, time: a.task_time.as_deref() };
    let workforce = Workforce { claims: a.claim.is_some(), jobs: jobs(a.threads), options };
    if let Some(exit) = workforce.process(&sweep, missing)? {
        return Ok(exit);
    }
    sweep.folder.sweep_when_last();
    table::written(&sweep)?;
    pool.install(|| publish(&sweep, &workcell, &loaded.sources, &parent, (clock, a.json)))
}

/// Merges the islands and writes the result to the folder `parent`.
fn publish(
    sweep: &CheckedSweep,
    workcell: &Workcell,
    sources: &[Source],
    parent: &Path,
    (clock, as_json): (Instant, bool),
) -> Result<Exit, Exit> {
    let islands =
        (0..sweep.plan.combinations).map(|k| read(sweep, workcell, k)).collect::<Result<Vec<_>, _>>()?;
    let Some(proof) = &sweep.proof else { return Err(Exit::Io) };
    let Some(record) = merged(workcell, &islands, proof.bound) else { return Err(Exit::Io) };
    // Every worker records the command line of the worker that wrote the plan.
    let author = stored_plan(&sweep.folder)?;
    let run = RunDescription { command: author.command(), settings: author.island_flags.unwrap_or_default() };
    let outcome = SearchOutcome::new(workcell, &record, proof, IslandEntry::all(&workcell.cell, &islands));
    let written = outcome.write(parent, &author.cell, sources, Some(run))?;
    outcome.tell(&written, clock.elapsed().as_secs_f64(), as_json)?;
    outcome.suggest_report(parent, as_json);
    Ok(outcome.exit())
}

/// Reads the result of an island. The hash of the file has already been checked. Refuses layouts of another
/// cell.
fn read(sweep: &CheckedSweep, workcell: &Workcell, index: usize) -> Result<Island, Exit> {
    let name = island_name(index);
    let parse = |bytes: Vec<u8>| serde_json::from_slice(&bytes).map_err(|e| e.to_string());
    let fitting = |island: Island| {
        let layouts = island.alternatives.iter().map(|a| &a.layout).chain([&island.best]);
        let misfit = layouts.filter_map(|layout| workcell.cell.misfit(layout)).next();
        misfit.map_or(Ok(island), |misfit| Err(misfit.in_words(&workcell.cell)))
    };
    let bytes = loading::read_inside(&sweep.folder, &name, "the islands");
    bytes.and_then(parse).and_then(fitting).map_err(|why| {
        output::error(&format!("{}: {}", path_word(&sweep.folder.join(&name)), shown(&why)));
        Exit::Io
    })
}
