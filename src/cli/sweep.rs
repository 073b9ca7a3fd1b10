//! Plan and folder of a sweep. A sweep can be stopped and resumed.
//!
//! A combination depends only on the plan and on its index. The file `NNNN.json` of a combination is complete
//! or absent. The table is made from these files.

use super::arguments::{SweepArguments, common_settings};
use super::json_text::{DAMAGED, sealed, unsealed};
use super::loading;
use super::loading::FileSnapshot;
use super::output::path_word;
use super::output_folder::{OutputFolder, Sharing, new_folder};
use super::packages::PackageFolders;
use super::results::{INPUTS, hashed, input_places};
use super::{Exit, output};
use crate::cell::Solver;
use crate::files::{Choices, Fault, Loaded, Source, of_setting, shown};
use crate::record::{SweepPlan, SweepRow};
use std::path::Path;

/// Largest number of combinations of one sweep.
const MAX_COMBINATIONS: usize = 10_000;

const PLAN: &str = "plan.json";

/// Returns the plan that the command line states or, without a cell file, the plan stored in the folder. Also
/// returns the files of the cell. A worker that joins a sweep reads these files from the folder of the sweep.
pub fn asked_plan(a: &SweepArguments) -> Result<(SweepPlan, FileSnapshot), Exit> {
    let Some(cell) = &a.cell else {
        let folder = a.folder().unwrap_or(Path::new("."));
        let plan = joined_plan(folder)?;
        if a.claim.is_some() {
            let kept = stored_inputs(folder, &plan)?;
            return Ok((plan, kept));
        }
        return Ok((SweepPlan { inputs: Vec::new(), ..plan }, FileSnapshot::default()));
    };
    let sets = read_sets(&a.sets)?;
    let named = |name: &String| Solver::ALL.into_iter().find(|s| s.name() == name);
    let plan = SweepPlan {
        search: !a.map,
        combinations: count(&sets)?,
        sets,
        seed: a.seed,
        budget: a.budget,
        solver: a.solver.as_ref().and_then(named),
        ..SweepPlan::of_cell(cell, &a.packages.folders)
    };
    Ok((plan, FileSnapshot::default()))
}

/// Returns the plan stored in a folder, but with the version of this program. [`open`] compares this plan
/// with the stored plan, and thus refuses a plan that another version has written.
pub fn joined_plan(folder: &Path) -> Result<SweepPlan, Exit> {
    let version = env!("CARGO_PKG_VERSION").to_string();
    Ok(SweepPlan { version, sha256: None, ..stored_plan(folder)? })
}

/// Returns the command that continues a sweep. `option` is the option whose value is the folder.
pub fn continuing(plan: &SweepPlan, folder: &Path, option: &str) -> String {
    let (command, folder) = match folder.parent() {
        Some(parent) if plan.is_of_islands() => ("search", parent),
        _ => ("sweep", folder),
    };
    format!("{command} {option} {}", path_word(folder))
}

/// Returns whether a folder has a plan.
pub fn has_plan(folder: &Path) -> bool {
    folder.join(PLAN).is_file()
}

/// Reads the plan of a folder, and refuses a folder without a plan.
pub fn stored_plan(folder: &Path) -> Result<SweepPlan, Exit> {
    read_plan(folder)?.ok_or_else(|| {
        let folder = path_word(folder);
        output::error(&format!("{folder} has no {PLAN}: it is not the folder of a sweep"));
        output::talk(&format!(
            "  help: sweetspot sweep CELL --set PATH=A,B --out {folder} --plan-only writes a plan"
        ));
        Exit::BadInput
    })
}

/// Returns the name of the copy of the cell file in the folder of the inputs.
pub fn stored_cell_name(plan: &SweepPlan) -> String {
    input_places(plan.inputs.iter().map(|input| input.path.as_str())).into_iter().next().unwrap_or_default()
}

/// Reads the inputs in the folder of a sweep. Refuses inputs that have changed.
pub fn stored_inputs(folder: &Path, plan: &SweepPlan) -> Result<FileSnapshot, Exit> {
    let places = input_places(plan.inputs.iter().map(|input| input.path.as_str()));
    let (mut files, mut is_whole) = (Vec::new(), true);
    for (place, input) in places.iter().zip(&plan.inputs) {
        let place = format!("{INPUTS}/{place}");
        let why = match loading::read_inside(folder, &place, "the sweep") {
            Ok(bytes) if loading::sha256(&bytes) == input.sha256 => {
                files.push((input.path.clone(), bytes));
                continue;
            }
            Ok(_) => format!("it has changed: its hash is not the one in {PLAN}"),
            Err(why) => why,
        };
        output::error(&format!("{}: {}", path_word(&folder.join(&place)), shown(&why)));
        is_whole = false;
    }
    if is_whole {
        return Ok(FileSnapshot::closed(files));
    }
    let option = if plan.is_of_islands() { "--islands" } else { "--set" };
    output::talk(&format!(
        "  help: start a worker with --claim, CELL and {option}: this worker writes the inputs again"
    ));
    Err(Exit::BadInput)
}

/// Reads the cell of a combination.
pub fn load(plan: &SweepPlan, index: usize, kept: &FileSnapshot) -> Result<Loaded, Vec<Fault>> {
    let packages = PackageFolders { folders: plan.packages.clone() };
    let mut settings = plan.settings(index);
    let solver = plan.solver.map(|solver| solver.name().to_string());
    settings.extend(common_settings(plan.seed, plan.budget, solver.as_ref()));
    loading::read_cell_with(&plan.cell, &packages, &settings, kept)
}

/// Adds files that a combination has read (`sources`) to the inputs of the plan and to `all`. Skips files
/// that `all` already contains.
pub fn add_inputs(plan: &mut SweepPlan, all: &mut Vec<Source>, sources: Vec<Source>) {
    for source in sources {
        if !all.iter().any(|s| s.path == source.path) {
            plan.inputs.push(hashed(&source.path, &source.bytes));
            all.push(source);
        }
    }
}

/// Returns the differences between a plan and the earlier plan `old`, in words. Any difference prevents a
/// resumption.
fn changes(plan: &SweepPlan, old: &SweepPlan) -> Vec<String> {
    let mut changed = Vec::new();
    let mut note = |same: bool, what: &str| {
        if !same {
            changed.push(what.to_string());
        }
    };
    note(plan.schema == old.schema, "the schema of the plan");
    let versions = format!("the version of the program ({}, not {})", plan.version, shown(&old.version));
    note(plan.version == old.version, &versions);
    note(plan.cell.file_name() == old.cell.file_name(), "the cell file");
    note(plan.search == old.search, "search or map");
    let sets = if plan.is_of_islands() { "the seeds of the islands" } else { "the sets" };
    note(plan.sets == old.sets, sets);
    note(plan.island_flags == old.island_flags, "the flags of the search");
    note((plan.seed, plan.budget) == (old.seed, old.budget), "seed or budget");
    note(plan.solver == old.solver, "the solver");
    let hash =
        |plan: &SweepPlan, path: &str| plan.inputs.iter().find(|i| i.path == path).map(|i| i.sha256.clone());
    let own = plan.inputs.iter().filter(|i| !old.inputs.iter().any(|o| o.path == i.path));
    for input in old.inputs.iter().chain(own) {
        note(hash(plan, &input.path) == hash(old, &input.path), &shown(&input.path));
    }
    changed
}

fn read_sets(texts: &[String]) -> Result<Vec<Choices>, Exit> {
    let mut sets: Vec<Choices> = Vec::new();
    let mut faults = Vec::new();
    for text in texts {
        match Choices::parse(text) {
            Err(found) => faults.extend(found),
            Ok(set) => {
                if let Some(other) = sets.iter().find(|other| set.meets(other)) {
                    let message = format!("{} is set already", shown(&other.path));
                    faults.push(of_setting(text, message, "give all its values in one --set"));
                }
                sets.push(set);
            }
        }
    }
    output::faults(&faults);
    if faults.is_empty() { Ok(sets) } else { Err(Exit::BadInput) }
}

fn count(sets: &[Choices]) -> Result<usize, Exit> {
    let lengths = sets.iter().map(|s| s.values.len());
    let count = lengths.clone().try_fold(1usize, |n, values| n.checked_mul(values));
    count.filter(|n| *n <= MAX_COMBINATIONS).ok_or_else(|| {
        let factors: Vec<_> = lengths.map(|n| n.to_string()).collect();
        let factors = factors.join(" times ");
        output::error(&format!(
            "the values of --set make {factors} combinations, more than the allowed {MAX_COMBINATIONS}; nothing was done"
        ));
        output::talk("  help: set fewer values, or split them into several sweeps");
        Exit::BadInput
    })
}

/// Reads the plan of a folder; returns None if the folder has no plan.
fn read_plan(folder: &Path) -> Result<Option<SweepPlan>, Exit> {
    let path = folder.join(PLAN);
    if path.symlink_metadata().is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound) {
        return Ok(None);
    }
    let bytes = loading::read_inside(folder, PLAN, "the sweep").map_err(|why| {
        output::error(&format!("cannot read {}: {why}", path_word(&path)));
        Exit::Io
    })?;
    let read = |text: Vec<u8>| serde_json::from_slice(&text).map_err(|e| e.to_string());
    let plan = unsealed(&bytes).ok_or_else(|| DAMAGED.to_string()).and_then(read);
    plan.map(Some).map_err(|why| {
        output::error(&format!("{} is not the plan of a sweep: {why}", path_word(&path)));
        output::talk("  help: start the sweep again in a new folder with --out");
        Exit::BadInput
    })
}

/// Opens the folder of an earlier run of this plan, or makes a new folder and writes the plan to it.
pub fn open(
    plan: &SweepPlan,
    asked: Option<&Path>,
    stem: &str,
    sharing: Sharing,
) -> Result<OutputFolder, Exit> {
    let is_unused = |folder: &Path| {
        let names = folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.file_name());
        names.map(|n| n.to_string_lossy().into_owned()).all(|n| n.starts_with(loading::UNFINISHED))
    };
    loop {
        if let Some(folder) = asked
            && let Some(old) = read_plan(folder)?
        {
            refuse_changes(plan, &old, folder)?;
            return OutputFolder::existing(folder, sharing);
        }
        // Jobs and workers may start at the same time: the first one writes the plan, and the others join it.
        let folder = match asked.filter(|_| sharing == Sharing::WithOthers) {
            Some(folder) if is_unused(folder) => {
                loading::make_folder(folder)?;
                OutputFolder::existing(folder, sharing)?
            }
            Some(folder) if folder.join(PLAN).exists() => continue,
            _ => new_folder(asked, stem, sharing)?,
        };
        if loading::write_new(&folder.join(PLAN), &sealed(plan)?)? {
            return Ok(folder);
        }
        drop(folder);
    }
}

fn refuse_changes(plan: &SweepPlan, old: &SweepPlan, folder: &Path) -> Result<(), Exit> {
    let changed = changes(plan, old);
    if changed.is_empty() {
        return Ok(());
    }
    let folder = path_word(folder);
    output::error(&format!("{folder} belongs to another sweep; these differ: {}", changed.join(", ")));
    output::talk("  help: undo the changes, or name a new folder");
    Err(Exit::BadInput)
}

/// Returns the stem of the file names of a combination.
pub fn number(index: usize) -> String {
    format!("{index:04}")
}

/// Returns the name of the file with the result of an island.
pub fn island_name(index: usize) -> String {
    number(index) + ".island.json"
}

/// State of one combination in the folder of a sweep.
pub enum StoredRow {
    Missing,
    /// A file of the combination is damaged or missing. The text names the file and the fault.
    Damaged(String),
    Whole(Box<SweepRow>),
}

/// Reads the row of a combination, and checks every file of the combination against its hash.
pub fn row(folder: &Path, index: usize) -> StoredRow {
    let name = number(index) + ".json";
    if folder.join(&name).symlink_metadata().is_err() {
        return StoredRow::Missing;
    }
    match whole_row(folder, &name) {
        Ok(row) if row.index == index => StoredRow::Whole(Box::new(row)),
        Ok(row) => StoredRow::Damaged(format!("{name} is the row of combination {}", row.index)),
        Err(why) => StoredRow::Damaged(why),
    }
}

/// Reads a row. Fails with the reason if the row, or a file that the row names, is damaged.
fn whole_row(folder: &Path, name: &str) -> Result<SweepRow, String> {
    let read = |place: &str| {
        loading::read_inside(folder, place, "the sweep").map_err(|why| format!("{}: {why}", shown(place)))
    };
    let text = unsealed(&read(name)?).ok_or_else(|| format!("{name}: {DAMAGED}"))?;
    let row: SweepRow = serde_json::from_slice(&text).map_err(|e| format!("{name}: {e}"))?;
    for file in &row.files {
        if loading::sha256(&read(&file.path)?) != file.sha256 {
            return Err(format!("{}: its hash is not the one in {name}", shown(&file.path)));
        }
    }
    Ok(row)
}
