//! Subject of a report, read from a cell file or from the result folder of a search.

use super::arguments::QuestionFlags;
use super::output::path_word;
use super::packages::PackageFolders;
use super::results_folder::SearchFolder;
use super::{Exit, arguments, asked, loading, output, results_folder};
use crate::assess::Assessment;
use crate::cell::Layout;
use crate::files::{Fault, Loaded, Source};
use crate::layout::Workcell;
use crate::record::{SearchResult, SpotEntry};
use crate::report::page::{Manifest, Subject};
use std::path::{Path, PathBuf};

/// Data for a report, as read from files, before any layout is assessed.
pub struct ReportSource {
    pub loaded: Loaded,
    /// The cell file.
    pub file: PathBuf,
    best: Option<Layout>,
    found: Option<SearchResult>,
    manifest: Manifest,
    /// Result folder of the search; None for a cell file.
    folder: Option<PathBuf>,
}

impl ReportSource {
    /// Reads a cell file, or the result folder of a search.
    pub fn read(of: &Path, packages: &PackageFolders, question: &QuestionFlags) -> Result<Self, Exit> {
        if of.is_dir() { of_folder(of, packages, question) } else { of_cell(of, packages, question) }
    }

    /// Assesses the layouts. `workcell` is the prepared cell of this source.
    ///
    /// # Errors
    /// Refuses a result folder whose numbers this program does not reproduce.
    pub fn subject(self, workcell: &Workcell) -> Result<Subject<'_>, Exit> {
        let start = Assessment::new("start", workcell, workcell.cell.start());
        let best =
            self.best.map(|layout| Assessment::new("best", workcell, layout).misplaced().with_regions());
        let start = if best.is_some() { start } else { start.misplaced().with_regions() };
        let warnings = self.loaded.warnings.iter().map(warning).collect();
        let (found, manifest) = (self.found, self.manifest);
        let subject = Subject { start, best, found, measured: Vec::new(), manifest, warnings };
        if let Some(folder) = &self.folder {
            refuse_other_numbers(folder, &subject)?;
        }
        Ok(subject)
    }
}

fn of_folder(of: &Path, packages: &PackageFolders, question: &QuestionFlags) -> Result<ReportSource, Exit> {
    if !question.words().is_empty() {
        output::error("flags cannot change the settings of a finished search");
        let best = path_word(&of.join("best.toml"));
        output::talk(&format!("  help: report its best layout: sweetspot report {best}{}", question.words()));
        return Err(Exit::BadInput);
    }
    let SearchFolder { loaded, file, best, found, mut manifest } = results_folder::read(of, packages)?;
    manifest.seed = found.seed;
    Ok(ReportSource { loaded, file, best, found: Some(found), manifest, folder: Some(of.to_path_buf()) })
}

fn of_cell(of: &Path, packages: &PackageFolders, question: &QuestionFlags) -> Result<ReportSource, Exit> {
    let loaded = asked::load(of, packages, question)?;
    let manifest = Manifest {
        command: arguments::typed(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: loaded.cell.search.seed,
        inputs: loaded.sources.iter().map(hashed).collect(),
        outputs: Vec::new(),
        csv: format!(
            "the file map.csv, which this command writes: sweetspot map {}{} --out DIR",
            path_word(of),
            question.words()
        ),
        source: of.to_string_lossy().into_owned(),
        is_complete: true,
    };
    Ok(ReportSource { loaded, file: of.to_path_buf(), best: None, found: None, manifest, folder: None })
}

/// Returns the path of an input with the hash of its bytes.
pub fn hashed(source: &Source) -> (String, String) {
    (source.path.clone(), loading::sha256(&source.bytes))
}

fn warning(fault: &Fault) -> String {
    format!("{}:{}: {}", fault.file, fault.line, fault.message)
}

/// Refuses a search.json if its objectives differ from the values that this program computes. Also refuses a
/// search.json whose limits differ from the limits in the inputs.
fn refuse_other_numbers(folder: &Path, subject: &Subject<'_>) -> Result<(), Exit> {
    let Some(found) = &subject.found else { return Ok(()) };
    let best = subject.best.as_ref().and_then(Assessment::objective);
    let pairs = [
        ("best", found.objective_value, best),
        ("start", found.start.objective_value, subject.start.objective()),
    ];
    for (which, says, is) in pairs {
        let same = match (says, is) {
            // The search may have run on another machine, which may round differently.
            (Some(says), Some(is)) => (says - is).abs() <= 1e-6 * says.abs().max(1e-3),
            (says, is) => says.is_none() == is.is_none(),
        };
        if !same {
            let word = |v: Option<f64>| v.map_or("none".into(), |v| format!("{v:.9}"));
            let why = format!(
                "it gives the objective of the {which} layout as {}, but this program computes {}",
                word(says),
                word(is)
            );
            return Err(results_folder::refused(folder, "search.json", &why));
        }
    }
    refuse_other_limits(folder, found, subject.best.as_ref())
}

/// Refuses a search.json whose limits differ from the limits of the cell in inputs/.
fn refuse_other_limits(
    folder: &Path,
    found: &SearchResult,
    best: Option<&Assessment<'_>>,
) -> Result<(), Exit> {
    let Some(best) = best else { return Ok(()) };
    for (k, operation) in found.operations.iter().enumerate().take(best.maps.len()) {
        let says = operation.requirement.map(|requirement| requirement.limit);
        let is = SpotEntry::new(best, k).requirement.map(|requirement| requirement.limit);
        if says != is {
            let word = |v: Option<f64>| v.map_or("none".into(), |v| v.to_string());
            let name = &operation.name;
            let why =
                format!("it gives the limit of {name} as {}, but the inputs say {}", word(says), word(is));
            return Err(results_folder::refused(folder, "search.json", &why));
        }
    }
    Ok(())
}
