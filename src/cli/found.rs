//! The folder of a search read again: every file of it, checked against the hashes of its manifest.

use super::arguments::{Arguments, Command, SearchArguments};
use super::output::path_word;
use super::packages::Packages;
use super::results::{INPUTS, portable};
use super::{Exit, asked, checkpoint, loading, output};
use crate::cell::Layout;
use crate::files::{Loaded, shown};
use crate::record::{HashedFile, ManifestDocument, SearchResult};
use crate::report::page::Manifest;
use clap::Parser;
use std::path::{Path, PathBuf};

/// What a search has left.
pub struct Folder {
    /// The cell as the search was asked for it.
    pub loaded: Loaded,
    /// The cell file inside the folder.
    pub file: PathBuf,
    /// Of best.toml; None if no layout is feasible.
    pub best: Option<Layout>,
    pub found: SearchResult,
    pub manifest: Manifest,
}

/// Reads the folder of a search; says what is wrong with it.
pub fn read(folder: &Path, packages: &Packages) -> Result<Folder, Exit> {
    let manifest = manifest(folder)?;
    let arguments = arguments(folder, &manifest.command)?;
    untouched(folder, &manifest)?;
    let name = manifest.inputs.first().map(|(path, _)| portable(path)).ok_or(Exit::BadInput)?;
    let file = folder.join(INPUTS).join(name);
    let packages = kept_packages(folder, packages);
    let loaded = asked::load_for_search(&SearchArguments { packages: packages.clone(), ..arguments }, &file)?;
    let found: SearchResult = serde_json::from_slice(&bytes(folder, "search.json")?)
        .map_err(|e| refused(folder, "search.json", &format!("it is not that of a search: {e}")))?;
    let best = match found.objective_value {
        Some(_) => Some(loading::load(&folder.join("best.toml"), &packages)?.cell.start()),
        None => None,
    };
    let best = best.map(|layout| fitting(folder, layout, &loaded)).transpose()?;
    Ok(Folder { loaded, file, best, found, manifest })
}

/// best.toml of the folder of a search, and that nothing in the folder was changed since.
pub fn best_of(folder: &Path) -> Result<PathBuf, Exit> {
    untouched(folder, &manifest(folder)?)?;
    let best = folder.join("best.toml");
    if best.is_file() {
        return Ok(best);
    }
    let word = path_word(folder);
    output::error(&format!("the search in {word} has found no feasible layout: there is none to show"));
    output::talk(&format!("  help: sweetspot report {word} tells what was in the way"));
    Err(Exit::BadInput)
}

/// A layout of as many things as the cell has.
fn fitting(folder: &Path, layout: Layout, loaded: &Loaded) -> Result<Layout, Exit> {
    let start = loaded.cell.start();
    let sizes = |l: &Layout| (l.placements.len(), l.attitudes.len());
    match sizes(&layout) == sizes(&start) {
        true => Ok(layout),
        false => Err(refused(folder, "best.toml", "it is of another cell than the files in inputs/")),
    }
}

/// From manifest.json; of a search that was stopped, from its checkpoint.
fn manifest(folder: &Path) -> Result<Manifest, Exit> {
    let name = "manifest.json";
    let pairs = |files: Vec<HashedFile>| files.into_iter().map(|f| (f.path, f.sha256)).collect();
    let (source, csv) = (folder.to_string_lossy().into_owned(), "map.csv beside search.json".to_string());
    if folder.join(name).is_file() {
        let ManifestDocument { version, command, seed, inputs, outputs, .. } =
            serde_json::from_slice(&bytes(folder, name)?)
                .map_err(|e| refused(folder, name, &format!("it is not that of a search: {e}")))?;
        let (Some(command), Some(seed)) = (command, seed) else {
            return Err(refused(folder, name, "it is not that of a search: it has no command or no seed"));
        };
        let (inputs, outputs) = (pairs(inputs), pairs(outputs));
        return Ok(Manifest { command, version, seed, inputs, outputs, csv, source, is_complete: true });
    }
    if !folder.join(loading::CHECKPOINT).is_file() {
        output::error(&format!("{} holds no manifest.json and no checkpoint", path_word(folder)));
        output::talk("  help: name a cell file, or a folder that sweetspot search has written");
        return Err(Exit::BadInput);
    }
    let (command, inputs) = checkpoint::begun(folder)?;
    let (version, seed) = (env!("CARGO_PKG_VERSION").into(), 0);
    Ok(Manifest { command, version, seed, inputs, outputs: Vec::new(), csv, source, is_complete: false })
}

/// The search that the command asks for.
fn arguments(folder: &Path, command: &[String]) -> Result<SearchArguments, Exit> {
    let words = std::iter::once("sweetspot").chain(command.iter().map(String::as_str));
    match Arguments::try_parse_from(words) {
        Ok(Arguments { command: Command::Search(arguments) }) => Ok(arguments),
        _ => Err(refused(folder, "manifest.json", "its command is no search")),
    }
}

/// Every file is as the search wrote it.
fn untouched(folder: &Path, manifest: &Manifest) -> Result<(), Exit> {
    let mut all = places(&manifest.inputs).chain(manifest.outputs.iter().cloned());
    all.try_for_each(|(place, hash)| check(folder, &place, &hash))
}

/// Where the inputs lie in the folder, with their hashes.
fn places(inputs: &[(String, String)]) -> impl Iterator<Item = (String, String)> {
    inputs.iter().enumerate().map(|(k, (path, hash))| {
        let place = path.replacen("package://", "packages/", 1);
        (format!("{INPUTS}/{}", if k == 0 { portable(&place) } else { place }), hash.clone())
    })
}

fn check(folder: &Path, place: &str, hash: &str) -> Result<(), Exit> {
    if loading::sha256(&bytes(folder, place)?) == hash {
        return Ok(());
    }
    Err(refused(folder, place, "it is not as the search wrote it: its hash is not that of the manifest"))
}

fn bytes(folder: &Path, place: &str) -> Result<Vec<u8>, Exit> {
    loading::read_inside(folder, place, "the search")
        .map_err(|why| refused(folder, place, &format!("it cannot be read: {why}")))
}

/// Says which file of the folder cannot be trusted.
pub fn refused(folder: &Path, place: &str, why: &str) -> Exit {
    output::error(&format!("{}: {}", path_word(&folder.join(place)), shown(why)));
    output::talk("  help: search again; or report the cell file alone");
    Exit::BadInput
}

/// The packages of a URDF are kept with the inputs.
fn kept_packages(folder: &Path, packages: &Packages) -> Packages {
    let mut all = packages.clone();
    for entry in folder.join(INPUTS).join("packages").read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !all.folders.iter().any(|(given, _)| *given == name) {
            all.folders.push((name, entry.path()));
        }
    }
    all
}
