//! Processing of one combination of a sweep.

use crate::assess::Assessment;
use crate::cell::SearchSettings;
use crate::cli::combination_checkpoint::{CombinationCheckpoint, StoredSearch};
use crate::cli::commands::workcell;
use crate::cli::json_text::{line, sealed};
use crate::cli::loading::FileSnapshot;
use crate::cli::output_folder::OutputFolder;
use crate::cli::results::{INPUTS, hashed};
use crate::cli::sweep::{island_name, load, number};
use crate::cli::{Exit, loading, output};
use crate::files::shown;
use crate::layout::Workcell;
use crate::proof::{Proof, ProofOptions, prove};
use crate::record::{HashedFile, SweepPlan, SweepRow};
use crate::report;
use crate::search;
use crate::search::{Checkpoint, Island, SearchEnd, SearchJob, SearchRecord, Watch};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Sweep after all its combinations have been read and checked.
pub struct CheckedSweep {
    pub plan: SweepPlan,
    pub kept: FileSnapshot,
    pub folder: OutputFolder,
    /// Name of the copy of the cell file in the folder of the inputs.
    pub cell_name: String,
    pub stop: Arc<AtomicBool>,
    /// Proof that holds for every combination; None if each combination needs its own proof.
    pub proof: Option<Proof>,
}

/// Processes one combination and writes its files. If the sweep is stopped, returns false and writes at most
/// a checkpoint.
pub fn run_one(sweep: &CheckedSweep, index: usize) -> Result<bool, Exit> {
    let CheckedSweep { plan, kept, folder, .. } = sweep;
    let loaded = load(plan, index, kept).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let workcell = workcell(loaded.cell, &plan.cell)?;
    let checkpoint = CombinationCheckpoint::new(folder, index);
    let record = if plan.search {
        let Some(record) = searched(&workcell, sweep, &checkpoint) else { return Ok(false) };
        Some(record)
    } else {
        None
    };
    let layout = record.as_ref().map_or_else(|| workcell.cell.start(), |r| r.best.layout.clone());
    let assessment = Assessment::new("best", &workcell, layout);
    let mut row = SweepRow::new(&plan.sets, index, &assessment, record.as_ref());
    if plan.is_of_islands() {
        row.files = write_island(sweep, index, &workcell.cell.search, record.as_ref())?;
    } else if row.feasible {
        row.files = write_cell(sweep, index, &assessment)?;
    }
    loading::write_whole(&folder.join(number(index) + ".json"), &sealed(&row)?)?;
    checkpoint.remove();
    Ok(true)
}

/// Searches from the beginning, or continues from the checkpoint. Proves the lower bound first, unless the
/// sweep or the checkpoint already contains it. Returns None if the sweep is stopped.
fn searched(
    workcell: &Workcell,
    sweep: &CheckedSweep,
    checkpoint: &CombinationCheckpoint<'_>,
) -> Option<SearchRecord> {
    let stop = &sweep.stop;
    let known = sweep.proof.as_ref().map(|proof| proof.bound);
    let stored = checkpoint.read(workcell, known);
    let bound = match known.or(stored.as_ref().map(|stored| stored.bound)) {
        Some(bound) => bound,
        None => {
            let proof = prove(workcell, &ProofOptions::default(), stop);
            // An interrupted proof would give another bound.
            (!proof.interrupted).then_some(proof.bound)?
        }
    };
    let (settings, watch) = (&workcell.cell.search, Watch { progress: &|_| {}, stop });
    let keep = |state: &Checkpoint, moment| checkpoint.keep(&StoredSearch { bound, state }, moment);
    let search_from = |from: Option<&Checkpoint>| {
        search::search_job(workcell, settings, &watch, &SearchJob { bound, from, keep: &keep })
    };
    let mut record = search_from(stored.as_ref().map(|stored| &stored.state));
    if record.ended == SearchEnd::Diverged {
        checkpoint.tell_useless(
            "this program cannot reproduce the search, because another build or machine wrote the checkpoint",
        );
        record = search_from(None);
    }
    (record.ended != SearchEnd::Interrupted).then_some(record)
}

/// Writes NNNN.island.json, which the merging of the islands reads. Returns the file with its hash.
fn write_island(
    sweep: &CheckedSweep,
    index: usize,
    settings: &SearchSettings,
    record: Option<&SearchRecord>,
) -> Result<Vec<HashedFile>, Exit> {
    let Some(record) = record else { return Ok(Vec::new()) };
    let (name, text) = (island_name(index), line(&Island::new(settings, record))?);
    loading::write_whole(&sweep.folder.join(&name), text.as_bytes())?;
    Ok(vec![hashed(&name, text.as_bytes())])
}

/// Writes NNNN.toml, which is the cell with its layout fixed. Also writes a file with the settings of the
/// combination to the folder of the inputs; NNNN.toml includes that file. Returns both files with their
/// hashes.
fn write_cell(sweep: &CheckedSweep, index: usize, a: &Assessment<'_>) -> Result<Vec<HashedFile>, Exit> {
    let settings = sweep.plan.settings(index);
    let lines: Vec<_> = settings.iter().map(|s| s.line()).collect();
    let from = format!("from = \"{}\"\n{}\n", sweep.cell_name, lines.join("\n"));
    let mut name = format!("set-{}.toml", number(index));
    while sweep.plan.inputs.iter().any(|input| input.path == name) {
        name.insert(0, '_');
    }
    let inside = format!("{INPUTS}/{name}");
    let words: Vec<_> = settings.iter().map(|s| shown(&s.words())).collect();
    let objective = a.objective().unwrap_or_default();
    let comment = format!(
        "{} with {}, sweetspot {}: objective {objective:.6} {}",
        shown(&a.cell.name),
        words.join(" "),
        env!("CARGO_PKG_VERSION"),
        a.cell.unit().word()
    );
    let text = report::toml::fixed(&inside, &comment, a.cell, &a.layout);
    let files = [(inside, from), (number(index) + ".toml", text)];
    let write = |(name, text): &(String, String)| {
        loading::write_whole(&sweep.folder.join(name), text.as_bytes())?;
        Ok(hashed(name, text.as_bytes()))
    };
    files.iter().map(write).collect()
}
