//! `sweep`: searches or maps every combination of settings.

use super::{UNSOLVED, stem, suggest};
use crate::assess::Assessment;
use crate::cli::arguments::SweepArguments;
use crate::cli::json_text::{line, pretty, sealed};
use crate::cli::loading::FileSnapshot;
use crate::cli::output::path_word;
use crate::cli::output_folder::{OutputFolder, Sharing};
use crate::cli::results::{INPUTS, hashed, keep_inputs};
use crate::cli::sweep::{StoredRow, add_inputs, asked_plan, load, number, open, row};
use crate::cli::{Exit, cache, loading, output};
use crate::files::{Fault, Source, shown};
use crate::layout::Workcell;
use crate::proof::{ProofOptions, prove};
use crate::record::{HashedFile, ManifestDocument, SweepMode, SweepPlan, SweepRow, SweepTable};
use crate::report;
use crate::search;
use crate::search::{SearchEnd, SearchJob, SearchRecord, Watch};
use rayon::prelude::*;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// Sweep after all its combinations have been read and checked.
struct CheckedSweep {
    plan: SweepPlan,
    kept: FileSnapshot,
    folder: OutputFolder,
    /// Name of the copy of the cell file in the folder of the inputs.
    cell_name: String,
    stop: Arc<AtomicBool>,
}

/// Runs `sweetspot sweep`.
pub fn sweep(a: &SweepArguments) -> Result<Exit, Exit> {
    let mut plan = asked_plan(a)?;
    if let Some(index) = a.only.filter(|index| *index >= plan.combinations) {
        output::error(&format!(
            "there is no combination {index}: the combinations are numbered from 0 to {}",
            plan.combinations - 1
        ));
        return Err(Exit::BadInput);
    }
    let jobs =
        a.jobs.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let kept = FileSnapshot::default();
    let sources = check_all(&mut plan, &kept, jobs)?;
    // Array jobs write different files into one folder.
    let sharing = if a.only.is_some() { Sharing::WithOthers } else { Sharing::Alone };
    let folder = open(&plan, a.resume.as_deref().or(a.out.as_deref()), &stem(&plan.cell), sharing)?;
    let cell_name = keep_inputs(&folder, &sources)?;
    let all = 0..plan.combinations;
    let asked: Vec<usize> = a.only.map_or(all.clone().collect(), |index| vec![index]);
    let missing: Vec<usize> = asked.into_iter().filter(|k| is_missing(&folder, *k)).collect();
    let sweep = CheckedSweep { plan, kept, folder, cell_name, stop: Arc::new(AtomicBool::new(false)) };
    run_all(&sweep, &missing, jobs)?;
    if sweep.stop.load(Ordering::Relaxed) {
        suggest(&format!("sweep --resume {}", path_word(&sweep.folder)));
        return Ok(Exit::Interrupted);
    }
    if let Some(index) = a.only {
        output::talk(&format!("wrote {}", path_word(&sweep.folder.join(number(index) + ".json"))));
        suggest(&format!("sweep --resume {}", path_word(&sweep.folder)));
        return Ok(Exit::Done);
    }
    // Every combination is complete, so no job still writes here: unfinished files come from killed jobs.
    loading::sweep(&sweep.folder);
    let whole = |k: usize| match row(&sweep.folder, k) {
        StoredRow::Whole(row) => Ok(*row),
        StoredRow::Missing | StoredRow::Damaged(_) => {
            output::error(&format!("{} has changed meanwhile", path_word(&sweep.folder)));
            Err(Exit::Io)
        }
    };
    let rows = all.map(whole).collect::<Result<Vec<SweepRow>, Exit>>()?;
    finish(&sweep, rows, a.json)
}

/// Returns whether a combination must be computed. Prints a warning if one of its files is damaged.
fn is_missing(folder: &Path, index: usize) -> bool {
    match row(folder, index) {
        StoredRow::Whole(_) => false,
        StoredRow::Missing => true,
        StoredRow::Damaged(why) => {
            output::talk(&format!("warning: {why}; combination {index} is computed again"));
            true
        }
    }
}

/// Reads and checks every combination, and reports every fault once.
fn check_all(plan: &mut SweepPlan, kept: &FileSnapshot, jobs: usize) -> Result<Vec<Source>, Exit> {
    let check = |index: usize| -> Result<(Vec<Source>, Vec<Fault>), Vec<Fault>> {
        let loaded = load(plan, index, kept)?;
        match Workcell::remembering(loaded.cell, &mut cache::remember) {
            Ok(_) => Ok((loaded.sources, loaded.warnings)),
            Err(why) => Err(vec![Fault::of_file(&path_word(&plan.cell), why, UNSOLVED)]),
        }
    };
    let checked: Vec<_> = pool(jobs)?.install(|| (0..plan.combinations).into_par_iter().map(check).collect());
    let (mut all, mut told) = (Vec::new(), Vec::new());
    for (index, result) in checked.into_iter().enumerate() {
        let faults = match result {
            Ok((sources, warnings)) => {
                add_inputs(plan, &mut all, sources);
                warnings
            }
            Err(faults) => faults,
        };
        for fault in faults {
            match told.iter_mut().find(|(known, ..): &&mut (Fault, usize, usize)| *known == fault) {
                Some((.., count)) => *count += 1,
                None => told.push((fault, index, 1)),
            }
        }
    }
    let faults: Vec<Fault> = told.into_iter().map(|t| whose(plan, t)).collect();
    output::faults(&faults);
    if faults.iter().any(Fault::is_error) { Err(loading::exit_of(&faults)) } else { Ok(all) }
}

/// Adds to the help text of a fault how many combinations have the fault, and the settings of the first of
/// them. Adds nothing if every combination has the fault. Adds nothing either if the fault lies in a `--set`
/// value and every combination with that value has the fault.
fn whose(plan: &SweepPlan, (fault, first, count): (Fault, usize, usize)) -> Fault {
    let settings = plan.settings(first);
    let own = settings.iter().position(|s| fault.file == format!("--set {}", s.words()));
    if count * own.map_or(1, |k| plan.sets[k].values.len()) == plan.combinations {
        return fault;
    }
    let words: Vec<_> = settings.iter().map(|s| shown(&s.words())).collect();
    let those = format!("in {count} of {} combinations, first {}", plan.combinations, words.join(" "));
    let help = if fault.help.is_empty() { those } else { format!("{} ({those})", fault.help) };
    Fault { help, ..fault }
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, Exit> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
        output::error(&format!("cannot start threads: {e}"));
        Exit::Io
    })
}

/// Processes the missing combinations in parallel; each gets an equal share of the threads.
fn run_all(sweep: &CheckedSweep, missing: &[usize], jobs: usize) -> Result<(), Exit> {
    let asked = sweep.stop.clone();
    let _ = ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed));
    let workers = jobs.min(missing.len()).max(1);
    let (next, failed, bar) = (AtomicUsize::new(0), Mutex::new(None), output::combinations_bar());
    let work = |pool: rayon::ThreadPool| {
        while let Some(&index) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            if sweep.stop.load(Ordering::Relaxed) {
                break;
            }
            if let Err(exit) = pool.install(|| run_one(sweep, index)) {
                // The other workers finish their current combination.
                next.store(missing.len(), Ordering::Relaxed);
                *failed.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(exit);
            }
            output::advance(&bar, 1, missing.len() as u64);
        }
    };
    let pools: Vec<_> = (0..workers).map(|_| pool(jobs / workers)).collect::<Result<_, _>>()?;
    std::thread::scope(|scope| pools.into_iter().for_each(|p| drop(scope.spawn(|| work(p)))));
    bar.finish_and_clear();
    failed.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()).map_or(Ok(()), Err)
}

/// Processes one combination and writes its files. Writes nothing if the sweep is stopped.
fn run_one(sweep: &CheckedSweep, index: usize) -> Result<(), Exit> {
    let CheckedSweep { plan, kept, folder, .. } = sweep;
    let loaded = load(plan, index, kept).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let workcell = super::workcell(loaded.cell, &plan.cell)?;
    let record = if plan.search {
        let Some(record) = searched(&workcell, &sweep.stop) else { return Ok(()) };
        Some(record)
    } else {
        None
    };
    let layout = record.as_ref().map_or_else(|| workcell.cell.start(), |r| r.best.layout.clone());
    let assessment = Assessment::new("best", &workcell, layout);
    let mut row = SweepRow::new(&plan.sets, index, &assessment, record.as_ref());
    if row.feasible {
        row.files = write_cell(sweep, index, &assessment)?;
    }
    loading::write_whole(&folder.join(number(index) + ".json"), &sealed(&row)?)
}

/// Proves the lower bound and then searches, as `search` does. Returns None if the sweep is stopped.
fn searched(workcell: &Workcell, stop: &AtomicBool) -> Option<SearchRecord> {
    let proof = prove(workcell, &ProofOptions::default(), stop);
    let job = SearchJob { bound: proof.bound, from: None, keep: &|_, _| () };
    let watch = Watch { progress: &|_| {}, stop };
    let record = search::search_job(workcell, &workcell.cell.search, &watch, &job);
    // An interrupted proof would give another bound.
    (!proof.interrupted && record.ended != SearchEnd::Interrupted).then_some(record)
}

/// Writes NNNN.toml, the cell with its layout fixed. Also writes a file with the settings of the combination
/// to the folder of the inputs; NNNN.toml includes that file. Returns both files with their hashes.
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

/// Writes the table of all rows to files and stdout.
fn finish(sweep: &CheckedSweep, rows: Vec<SweepRow>, as_json: bool) -> Result<Exit, Exit> {
    let mode = if sweep.plan.search { SweepMode::Search } else { SweepMode::Map };
    let document = SweepTable::new(mode, rows);
    let csv = report::sweep::csv(&document).map_err(|why| {
        output::error(&format!("cannot write table.csv: {why}"));
        Exit::Io
    })?;
    write_table(sweep, vec![("table.csv", csv), ("table.json", pretty(&document)?)])?;
    let text = if as_json { line(&document)? } else { report::text::sweep(&document) };
    output::data(&text)?;
    let folder = path_word(&sweep.folder);
    output::talk(&format!("wrote {folder}: table.csv, table.json, manifest.json, a file per combination"));
    if let Some(best) = document.best.filter(|_| !as_json) {
        let best = sweep.folder.join(number(best) + ".toml");
        suggest(&format!("map {} --svg map.svg", path_word(&best)));
    }
    Ok(if document.feasible > 0 { Exit::Done } else { Exit::AnswerIsNo })
}

/// Writes the tables and then the manifest, so that a folder with a manifest is complete.
///
/// The manifest contains no command, so that a resumed sweep writes the same bytes.
fn write_table(sweep: &CheckedSweep, outputs: Vec<(&str, Vec<u8>)>) -> Result<(), Exit> {
    let write = |name: &str, bytes: &[u8]| loading::write_whole(&sweep.folder.join(name), bytes);
    outputs.iter().try_for_each(|(name, bytes)| write(name, bytes))?;
    let hashes = outputs.iter().map(|(name, bytes)| hashed(name, bytes)).collect();
    let manifest = ManifestDocument {
        plan: Some("plan.json".into()),
        ..ManifestDocument::new(sweep.plan.inputs.clone(), hashes)
    };
    write("manifest.json", &sealed(&manifest)?)
}
