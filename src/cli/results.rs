//! The folder that a search or a map leaves: its files, the inputs they came from, the manifest.

use super::output::path_word;
use super::{Exit, files, output};
use crate::cell::{Cell, Source};
use crate::compare::{Assessment, Comparison};
use crate::report;
use crate::search::SearchRecord;
use crate::search::bound::Proof;
use serde::Serialize;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Where the inputs are kept, so that the folder can be mailed whole.
pub const INPUTS: &str = "inputs";

/// What was written where.
pub struct Written {
    folder: PathBuf,
    names: Vec<String>,
}

impl Written {
    pub fn tell(&self) {
        output::talk(&format!("wrote {}: {}", path_word(&self.folder), self.names.join(", ")));
    }
}

/// The files of a search. best.toml is left out if no layout is feasible, the manifest if there is no
/// command that makes this folder: the search was interrupted.
pub fn write_search(
    folder: &Path,
    cell_file: &Path,
    sources: &[Source],
    (record, proof): (&SearchRecord, &Proof),
    comparison: &Comparison<'_>,
    command: Option<&[String]>,
) -> Result<Written, Exit> {
    let best = &comparison.columns[1];
    let cell = best.cell;
    let mut outputs = Vec::new();
    if let Some(objective) = best.objective() {
        let name = cell_file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let kept = portable(&name);
        let comment = format!(
            "Best layout of {} found by sweetspot {} (seed {}): objective {objective:.6} {}",
            crate::cell::shown(&name),
            env!("CARGO_PKG_VERSION"),
            cell.search.seed,
            cell.unit().word()
        );
        let text = report::toml::fixed(&format!("{INPUTS}/{kept}"), &comment, cell, &best.layout);
        outputs.push(("best.toml", text.into_bytes()));
        keep_inputs(folder, &kept, sources)?;
    }
    outputs.push(("search.json", pretty(&report::json::search(cell, (record, proof), comparison, None))?));
    outputs.push(("map.csv", csv(best)?));
    outputs.push(("map.svg", report::svg::plan(best).into_bytes()));
    match command {
        Some(command) => write(folder, cell, sources, command, outputs),
        None => write_outputs(folder, &outputs),
    }
}

/// The command line as typed.
pub fn typed() -> Vec<String> {
    std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect()
}

/// A name that every file system and every cell file can hold.
pub fn portable(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

/// Copies of every file that was read, in their places; the cell file comes first and is renamed.
pub fn keep_inputs(folder: &Path, cell_name: &str, sources: &[Source]) -> Result<(), Exit> {
    for (k, source) in sources.iter().enumerate() {
        // A colon is no part of a folder's name everywhere.
        let place = source.path.replacen("package://", "packages/", 1);
        let path = folder.join(INPUTS).join(if k == 0 { cell_name } else { &place });
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|e| {
                output::error(&format!("cannot make the folder {}: {e}", path_word(parent)));
                Exit::Io
            })?;
        }
        files::write_whole(&path, &source.bytes)?;
    }
    Ok(())
}

/// Writes files and, last, the manifest: a folder with one is complete.
pub fn write(
    folder: &Path,
    cell: &Cell,
    sources: &[Source],
    command: &[String],
    outputs: Vec<(&str, Vec<u8>)>,
) -> Result<Written, Exit> {
    let hashed = |path: &str, bytes: &[u8]| json!({ "path": path, "sha256": files::sha256(bytes) });
    let manifest = json!({
        "schema": "sweetspot/manifest/1",
        "program": "sweetspot",
        "version": env!("CARGO_PKG_VERSION"),
        "command": command,
        "cell": cell.name,
        "seed": cell.search.seed,
        "inputs": sources.iter().map(|s| hashed(&s.path, &s.bytes)).collect::<Vec<_>>(),
        "outputs": outputs.iter().map(|(name, bytes)| hashed(name, bytes)).collect::<Vec<_>>(),
    });
    let mut written = write_outputs(folder, &outputs)?;
    files::write_whole(&folder.join("manifest.json"), &pretty(&manifest)?)?;
    written.names.push("manifest.json".into());
    Ok(written)
}

fn write_outputs(folder: &Path, outputs: &[(&str, Vec<u8>)]) -> Result<Written, Exit> {
    for (name, bytes) in outputs {
        files::write_whole(&folder.join(name), bytes)?;
    }
    let names = outputs.iter().map(|(name, _)| name.to_string()).collect();
    Ok(Written { folder: folder.to_path_buf(), names })
}

/// A document as a file of JSON.
pub fn pretty(document: &impl Serialize) -> Result<Vec<u8>, Exit> {
    let mut bytes = serde_json::to_vec_pretty(document).map_err(not_json)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A document as one line of JSON.
pub fn line(document: &impl Serialize) -> Result<String, Exit> {
    Ok(serde_json::to_string(document).map_err(not_json)? + "\n")
}

fn not_json(e: serde_json::Error) -> Exit {
    output::error(&format!("cannot make JSON: {e}"));
    Exit::Io
}

pub fn csv(assessment: &Assessment<'_>) -> Result<Vec<u8>, Exit> {
    report::csv::map(assessment).map_err(|why| {
        output::error(&format!("cannot make map.csv: {why}"));
        Exit::Io
    })
}
