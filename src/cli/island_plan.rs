//! Plan of the islands of a search: searches that differ only in their seeds.

use super::arguments::SearchArguments;
use super::loading::{FileSnapshot, UNFINISHED};
use super::output::path_word;
use super::output_folder::{Sharing, new_folder};
use super::packages::PackageFolders;
use super::results::hashed;
use super::search_request::SearchRequest;
use super::sweep::{has_plan, joined_plan, stored_inputs};
use super::{Exit, loading, output};
use crate::files::{Choices, Loaded};
use crate::record::SweepPlan;
use std::path::{Path, PathBuf};

/// Folder of the islands, inside the folder of the result.
pub const ISLANDS: &str = "islands";

/// Key of the cell file whose value differs between islands.
const SEED: &str = "search.seed";

/// Plan of islands, with the cell that all islands search.
pub struct IslandPlan {
    pub plan: SweepPlan,
    /// Files of the cell. A worker that joins other workers reads these files from the folder of the islands.
    pub kept: FileSnapshot,
    /// Cell, read with the flags of the search and the first seed.
    pub loaded: Loaded,
}

/// Makes the plan from the command line. `cell` is the cell file.
pub fn planned(a: &SearchArguments, cell: &Path) -> Result<IslandPlan, Exit> {
    let Some(count) = a.islands.map(usize::from) else {
        output::error("the number of islands is missing");
        output::talk("  help: add --islands N to run N searches with successive seeds");
        return Err(Exit::BadInput);
    };
    let settings = a.settings();
    let first = SearchRequest::new(a)?.load()?.cell;
    if first.free().is_empty() {
        output::error(
            "nothing to search: every placement and attitude is fixed, so all islands would be equal",
        );
        output::talk(&format!("  help: sweetspot map {} assesses the layout as drawn", path_word(cell)));
        return Err(Exit::BadInput);
    }
    let first = first.search.seed;
    let Some(last) = first.checked_add(count.saturating_sub(1) as u64) else {
        output::error(&format!(
            "{count} successive seeds that begin at {first} exceed the largest seed, {}",
            u64::MAX
        ));
        return Err(Exit::BadInput);
    };
    let values = (first..=last).map(|seed| seed.to_string()).collect();
    let mut plan = SweepPlan {
        sets: vec![Choices { path: SEED.into(), values }],
        combinations: count,
        island_flags: Some(settings.clone()),
        ..SweepPlan::of_cell(cell, &a.packages.folders)
    };
    let kept = FileSnapshot::default();
    let loaded = load(&plan, &kept)?;
    plan.inputs = loaded.sources.iter().map(|source| hashed(&source.path, &source.bytes)).collect();
    Ok(IslandPlan { plan, kept, loaded })
}

/// Reads the plan of the islands in the folder that the command line names. Refuses flags, because the plan
/// already states them.
pub fn joined(a: &SearchArguments) -> Result<IslandPlan, Exit> {
    let parent = a.folder().unwrap_or(Path::new("."));
    let folder = parent.join(ISLANDS);
    if !has_plan(&folder) {
        output::error(&format!("{} holds no islands", path_word(parent)));
        output::talk(&format!(
            "  help: sweetspot search CELL --islands N --claim {} starts them",
            path_word(parent)
        ));
        return Err(Exit::BadInput);
    }
    refuse_flags(a, parent)?;
    let plan = joined_plan(&folder)?;
    let kept = stored_inputs(&folder, &plan)?;
    let loaded = load(&plan, &kept)?;
    Ok(IslandPlan { plan, kept, loaded })
}

fn refuse_flags(a: &SearchArguments, parent: &Path) -> Result<(), Exit> {
    let settings = a.settings();
    let flags = settings.iter().filter_map(|setting| setting.flag.clone());
    let others = [
        a.cell.as_ref().map(|cell| path_word(cell)),
        a.question.errors.sets.first().map(|_| "--set".to_string()),
        a.packages.folders.first().map(|_| "--package".to_string()),
        a.rules.time.map(|_| "--time".to_string()),
        a.progress.as_ref().map(|_| "--progress".to_string()),
    ];
    let given: Vec<String> = others.into_iter().flatten().chain(flags).collect();
    if given.is_empty() {
        return Ok(());
    }
    let parent = path_word(parent);
    output::error(&format!(
        "{} cannot be used with the islands in {parent}: the plan of the islands already states their settings",
        given.join(", ")
    ));
    output::talk(
        "  help: leave out these arguments, or start other islands in a new folder with CELL, --islands and \
    --out",
    );
    Err(Exit::BadInput)
}

/// Reads the cell with the flags of the search.
fn load(plan: &SweepPlan, kept: &FileSnapshot) -> Result<Loaded, Exit> {
    let packages = PackageFolders { folders: plan.packages.clone() };
    let flags = plan.island_flags.as_deref().unwrap_or_default();
    loading::read_cell_with(&plan.cell, &packages, flags, kept).map_err(|faults| {
        output::faults(&faults);
        loading::exit_of(&faults)
    })
}

/// Makes the result folder if it does not exist, and returns its path. Refuses a folder that has files but no
/// islands.
pub fn parent_folder(asked: Option<&Path>, stem: &str, sharing: Sharing) -> Result<PathBuf, Exit> {
    let Some(folder) = asked else { return Ok(new_folder(None, stem, sharing)?.to_path_buf()) };
    let names = folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.file_name());
    let names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    // Another worker may have made the folder of the islands just now.
    let is_own = |name: &String| name == ISLANDS || name.starts_with(UNFINISHED);
    match names.iter().all(is_own) || has_plan(&folder.join(ISLANDS)) {
        true => loading::make_folder(folder).map(|()| folder.to_path_buf()),
        false => Ok(new_folder(asked, stem, sharing)?.to_path_buf()),
    }
}
