//! Reading of the result folder of a search. Every file is checked against its hash in the manifest.

use super::json_text::{DAMAGED, unsealed};
use super::output::path_word;
use super::packages::PackageFolders;
use super::results::{INPUTS, input_places};
use super::{Exit, asked, checkpoint, loading, output};
use crate::cell::Layout;
use crate::files::{Loaded, Setting, shown};
use crate::record::{HashedFile, ManifestDocument, ResolvedSettings, SearchResult};
use crate::report::page::Manifest;
use std::path::{Path, PathBuf};

/// Content of the result folder of a search.
pub struct SearchFolder {
    /// Cell in the folder `inputs`, read with the settings of the search.
    pub loaded: Loaded,
    /// The cell file inside the folder.
    pub file: PathBuf,
    /// The layout of best.toml; None if no layout is feasible.
    pub best: Option<Layout>,
    pub found: SearchResult,
    pub manifest: Manifest,
}

/// Manifest of a result folder, and the settings of its run.
struct FolderOrigin {
    manifest: Manifest,
    /// Settings from the command-line flags. They override the cell file.
    settings: Vec<Setting>,
    /// All settings of the run, including defaults; None for a search that was stopped.
    resolved: Option<ResolvedSettings>,
}

/// Reads the result folder of a search. Prints the reason if the folder cannot be used.
pub fn read(folder: &Path, packages: &PackageFolders) -> Result<SearchFolder, Exit> {
    let FolderOrigin { manifest, settings, resolved } = origin(folder)?;
    untouched(folder, &manifest)?;
    let place = places(&manifest.inputs).next().map(|(place, _)| place);
    let file = folder.join(place.ok_or_else(|| refused(folder, "manifest.json", "it names no inputs"))?);
    let packages = packages.clone().with_kept(&folder.join(INPUTS));
    let loaded = asked::load_for_search(&file, &packages, &settings)?;
    if resolved.is_some_and(|resolved| resolved != ResolvedSettings::new(&loaded.cell)) {
        let why = "the settings that this program reads from inputs/ differ from those in the manifest: the defaults of this program have changed";
        return Err(refused(folder, "manifest.json", why));
    }
    let found: SearchResult = serde_json::from_slice(&bytes(folder, "search.json")?)
        .map_err(|e| refused(folder, "search.json", &format!("it is not the result of a search: {e}")))?;
    if manifest.is_complete && found.seed != manifest.seed {
        return Err(refused(folder, "search.json", "its seed differs from the seed in the manifest"));
    }
    let best = match found.objective_value {
        Some(_) => Some(loading::load(&folder.join("best.toml"), &packages)?.cell.start()),
        None => None,
    };
    let best = best.map(|layout| fitting(folder, layout, &loaded)).transpose()?;
    Ok(SearchFolder { loaded, file, best, found, manifest })
}

/// Returns the path of best.toml. Refuses a folder whose files have changed since the search.
pub fn best_of(folder: &Path) -> Result<PathBuf, Exit> {
    untouched(folder, &origin(folder)?.manifest)?;
    let best = folder.join("best.toml");
    if best.is_file() {
        return Ok(best);
    }
    let word = path_word(folder);
    output::error(&format!("the search in {word} has found no feasible layout, so there is no best.toml"));
    output::talk(&format!("  help: sweetspot report {word} shows why no layout is feasible"));
    Err(Exit::BadInput)
}

/// Returns the layout of best.toml if it fits the cell in inputs/. Otherwise refuses best.toml.
fn fitting(folder: &Path, layout: Layout, loaded: &Loaded) -> Result<Layout, Exit> {
    match loaded.cell.misfit(&layout) {
        None => Ok(layout),
        Some(misfit) => {
            let why = format!("it does not fit the cell in inputs/: {}", misfit.in_words(&loaded.cell));
            Err(refused(folder, "best.toml", &why))
        }
    }
}

/// Reads the manifest or, for a search that was stopped, the checkpoint.
fn origin(folder: &Path) -> Result<FolderOrigin, Exit> {
    let name = "manifest.json";
    let (source, csv) = (folder.to_string_lossy().into_owned(), "map.csv beside search.json".to_string());
    if folder.join(name).is_file() {
        let text = unsealed(&bytes(folder, name)?).ok_or_else(|| refused(folder, name, DAMAGED))?;
        let document: ManifestDocument = serde_json::from_slice(&text)
            .map_err(|e| refused(folder, name, &format!("it is not the manifest of a search: {e}")))?;
        let ManifestDocument { version, command, seed, settings, resolved, inputs, outputs, .. } = document;
        let is_search = outputs.iter().any(|file| file.path == "search.json");
        let (true, Some(command), Some(seed), Some(settings)) = (is_search, command, seed, settings) else {
            return Err(refused(folder, name, "it is not the manifest of a search"));
        };
        let pairs = |files: Vec<HashedFile>| files.into_iter().map(|f| (f.path, f.sha256)).collect();
        let (inputs, outputs) = (pairs(inputs), pairs(outputs));
        let manifest = Manifest { command, version, seed, inputs, outputs, csv, source, is_complete: true };
        return Ok(FolderOrigin { manifest, settings, resolved });
    }
    if !folder.join(loading::CHECKPOINT).is_file() {
        output::error(&format!("{} holds no manifest.json and no checkpoint", path_word(folder)));
        output::talk("  help: give a cell file, or a folder that sweetspot search has written");
        return Err(Exit::BadInput);
    }
    let (request, inputs) = checkpoint::begun(folder)?;
    let manifest = Manifest {
        command: request.command,
        version: env!("CARGO_PKG_VERSION").into(),
        seed: 0,
        inputs,
        outputs: Vec::new(),
        csv,
        source,
        is_complete: false,
    };
    Ok(FolderOrigin { manifest, settings: request.settings, resolved: None })
}

/// Refuses a folder in which a file has changed since the search wrote it.
fn untouched(folder: &Path, manifest: &Manifest) -> Result<(), Exit> {
    let mut all = places(&manifest.inputs).chain(manifest.outputs.iter().cloned());
    all.try_for_each(|(place, hash)| check(folder, &place, &hash))
}

/// Returns the path of each input inside the folder, with its hash.
fn places(inputs: &[(String, String)]) -> impl Iterator<Item = (String, String)> {
    let places = input_places(inputs.iter().map(|(path, _)| path.as_str()));
    places.into_iter().zip(inputs).map(|(place, (_, hash))| (format!("{INPUTS}/{place}"), hash.clone()))
}

fn check(folder: &Path, place: &str, hash: &str) -> Result<(), Exit> {
    if loading::sha256(&bytes(folder, place)?) == hash {
        return Ok(());
    }
    Err(refused(
        folder,
        place,
        "it has changed since the search wrote it: its hash differs from the hash in the manifest",
    ))
}

fn bytes(folder: &Path, place: &str) -> Result<Vec<u8>, Exit> {
    loading::read_inside(folder, place, "the search")
        .map_err(|why| refused(folder, place, &format!("it cannot be read: {why}")))
}

/// Prints why the file `place` of the folder cannot be used, and returns the exit code.
pub fn refused(folder: &Path, place: &str, why: &str) -> Exit {
    output::error(&format!("{}: {}", path_word(&folder.join(place)), shown(why)));
    output::talk("  help: run the search again, or report the cell file alone");
    Exit::BadInput
}
