//! Writing of a result folder: its files, copies of the inputs, and the manifest.

use super::arguments;
use super::json_text::{pretty, sealed};
use super::output::path_word;
use super::packages::PackageFolders;
use super::{Exit, loading, output, written_layout};
use crate::assess::{Assessment, Comparison};
use crate::cell::{Cell, Layout};
use crate::files::{Setting, Source};
use crate::record::{HashedFile, ManifestDocument, MapDocument, ResolvedSettings, SearchResult};
use crate::report;
use crate::search::{Alternative, SearchRecord};
use std::path::{Path, PathBuf};

/// Folder with copies of the inputs, which make a result folder self-contained.
pub const INPUTS: &str = "inputs";

/// Name of the cell file with the best layout of a search.
const BEST: &str = "best.toml";

/// Result folder with the names of the files written to it.
pub struct WrittenFolder {
    folder: PathBuf,
    names: Vec<String>,
}

impl WrittenFolder {
    /// Writes the manifest, which makes the folder complete.
    fn sealed<N: AsRef<str>>(
        mut self,
        cell: &Cell,
        sources: &[Source],
        run: RunDescription,
        outputs: &[(N, Vec<u8>)],
    ) -> Result<Self, Exit> {
        let inputs = sources.iter().map(|s| hashed(&s.path, &s.bytes)).collect();
        let outputs = outputs.iter().map(|(name, bytes)| hashed(name.as_ref(), bytes)).collect();
        let manifest = ManifestDocument {
            command: Some(run.command),
            settings: Some(run.settings),
            resolved: Some(ResolvedSettings::new(cell)),
            cell: Some(cell.name.clone()),
            seed: Some(cell.search.seed),
            ..ManifestDocument::new(inputs, outputs)
        };
        loading::write_changed(&self.folder.join("manifest.json"), &sealed(&manifest)?)?;
        self.names.push("manifest.json".into());
        Ok(self)
    }

    pub fn tell(&self) {
        output::talk(&format!("wrote {}: {}", path_word(&self.folder), self.names.join(", ")));
    }
}

/// Writes the files of a search.
///
/// Writes no best.toml if no layout is feasible. Writes no manifest if `run` is None, as for an interrupted
/// search.
pub fn write_search(
    folder: &Path,
    cell_file: &Path,
    sources: &[Source],
    (record, comparison): (&SearchRecord, &Comparison<'_>),
    document: &Option<SearchResult>,
    run: Option<RunDescription>,
) -> Result<WrittenFolder, Exit> {
    let best = &comparison.columns[1];
    let cell = best.cell;
    let mut outputs = Vec::new();
    let name = cell_file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let kept = keep_inputs(folder, sources)?;
    if let Some(objective) = best.objective() {
        let fixed = |which: &str, layout: &Layout, objective: f64| {
            let comment = format!(
                "{which} of {} found by sweetspot {} (seed {}): objective {objective:.6} {}",
                crate::files::shown(&name),
                env!("CARGO_PKG_VERSION"),
                cell.search.seed,
                cell.unit().word()
            );
            report::toml::fixed(&format!("{INPUTS}/{kept}"), &comment, cell, layout).into_bytes()
        };
        outputs.push((BEST.to_string(), fixed("Best layout", &best.layout, objective)));
        outputs.extend(alternatives(cell, record, fixed)?);
    }
    outputs.push(("search.json".into(), pretty(document)?));
    outputs.push(("map.csv".into(), csv(&MapDocument::new(best))?));
    outputs.push(("map.svg".into(), report::chart::error_map(best).into_bytes()));
    let written = write_outputs(folder, &outputs)?;
    check_layouts(folder, record, best)?;
    match run {
        Some(run) => written.sealed(cell, sources, run, &outputs),
        None => Ok(written),
    }
}

/// Description of a run: its command line, and the settings from its flags. These settings override the cell
/// file.
pub struct RunDescription {
    pub command: Vec<String>,
    pub settings: Vec<Setting>,
}

impl RunDescription {
    /// Describes the run of the current command line.
    pub fn typed(settings: Vec<Setting>) -> Self {
        Self { command: arguments::typed(), settings }
    }
}

/// Returns the files of the alternative layouts: one cell file per layout, and front.csv. A Pareto front also
/// gets front.svg.
fn alternatives(
    cell: &Cell,
    record: &SearchRecord,
    fixed: impl Fn(&str, &Layout, f64) -> Vec<u8>,
) -> Result<Vec<(String, Vec<u8>)>, Exit> {
    let count = record.alternatives.len();
    let mut outputs = Vec::new();
    for (k, Alternative { candidate, .. }) in record.alternatives.iter().enumerate() {
        let objective = candidate.evaluation.objective.map_or(0.0, |o| cell.unit().from_si(o));
        let which = format!("Layout {} of {count}", k + 1);
        outputs
            .push((crate::record::goals::file_name(k, count), fixed(&which, &candidate.layout, objective)));
    }
    if count > 0 {
        let table = report::csv::front(cell, record).map_err(|why| {
            output::error(&format!("cannot write front.csv: {why}"));
            Exit::Io
        })?;
        outputs.push(("front.csv".into(), table));
    }
    let picture = report::chart::pareto(cell, record);
    outputs.extend(picture.map(|picture| ("front.svg".into(), picture.into_bytes())));
    Ok(outputs)
}

/// Returns a name that every file system and every cell file accepts.
pub fn portable(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

/// Returns the path of every input relative to the folder of the inputs. The first input is the cell file.
///
/// Only the cell file is renamed, because no other file refers to it. The new name differs from the path of
/// every other input, even if the case of letters is ignored.
pub fn input_places<'p>(paths: impl IntoIterator<Item = &'p str>) -> Vec<String> {
    // Some file systems allow no colon in a name.
    let mut places: Vec<String> =
        paths.into_iter().map(|path| path.replacen("package://", "packages/", 1)).collect();
    if let Some((cell, others)) = places.split_first_mut() {
        *cell = portable(cell);
        while others.iter().any(|other| other.eq_ignore_ascii_case(cell)) {
            cell.insert(0, '_');
        }
    }
    places
}

/// Copies every input file into the result folder, unless the folder has it already. Returns the name of the
/// copied cell file.
pub fn keep_inputs(folder: &Path, sources: &[Source]) -> Result<String, Exit> {
    let places = input_places(sources.iter().map(|source| source.path.as_str()));
    for (place, source) in places.iter().zip(sources) {
        let path = folder.join(INPUTS).join(place);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|e| {
                output::error(&format!("cannot create the folder {}: {e}", path_word(parent)));
                Exit::Io
            })?;
        }
        loading::write_changed(&path, &source.bytes)?;
    }
    Ok(places.into_iter().next().unwrap_or_default())
}

/// Reads every written layout file back, and compares its evaluation with the evaluation in the search.
fn check_layouts(folder: &Path, record: &SearchRecord, best: &Assessment<'_>) -> Result<(), Exit> {
    // Only the packages inside the result folder are used: its layouts must be readable without other files.
    let packages = PackageFolders::default().with_kept(&folder.join(INPUTS));
    if best.objective().is_some() {
        written_layout::check_best(&folder.join(BEST), &packages, best)?;
    }
    let count = record.alternatives.len();
    record.alternatives.iter().enumerate().try_for_each(|(k, alternative)| {
        let file = folder.join(crate::record::goals::file_name(k, count));
        written_layout::check_alternative(&file, &packages, best.cell, &alternative.candidate)
    })
}

/// Writes files and then the manifest, so that a folder with a manifest is complete.
pub fn write<N: AsRef<str>>(
    folder: &Path,
    cell: &Cell,
    sources: &[Source],
    run: RunDescription,
    outputs: Vec<(N, Vec<u8>)>,
) -> Result<WrittenFolder, Exit> {
    write_outputs(folder, &outputs)?.sealed(cell, sources, run, &outputs)
}

/// Returns the path of a file with the SHA-256 hash of its content `bytes`.
pub fn hashed(path: &str, bytes: &[u8]) -> HashedFile {
    HashedFile { path: path.to_string(), sha256: loading::sha256(bytes) }
}

fn write_outputs<N: AsRef<str>>(folder: &Path, outputs: &[(N, Vec<u8>)]) -> Result<WrittenFolder, Exit> {
    for (name, bytes) in outputs {
        // Several workers may write the same merged result of islands, so a file that already has these bytes
        // is not replaced.
        loading::write_changed(&folder.join(name.as_ref()), bytes)?;
    }
    let names = outputs.iter().map(|(name, _)| name.as_ref().to_string()).collect();
    Ok(WrittenFolder { folder: folder.to_path_buf(), names })
}

/// Returns the table of the nodes of a map as CSV.
pub fn csv(document: &MapDocument<'_>) -> Result<Vec<u8>, Exit> {
    report::csv::map(document).map_err(|why| {
        output::error(&format!("cannot write map.csv: {why}"));
        Exit::Io
    })
}
