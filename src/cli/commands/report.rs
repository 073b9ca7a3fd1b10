//! `report`: writes one HTML page about a layout or a search result.

use super::{measured, refuse_other_pages, suggest_with, warn_of_distrust, within_size, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::ReportArguments;
use crate::cli::output::path_word;
use crate::cli::results_folder;
use crate::cli::results_folder::SearchFolder;
use crate::cli::{Exit, arguments, asked, json_text, loading, output};
use crate::drawing::Drawing;
use crate::files::{Fault, Loaded, Source};
use crate::record::{SearchResult, SpotEntry, VerdictAnswer};
use crate::report::page;
use crate::report::page::{Manifest, Report, Subject};
use crate::search::SearchEnd;
use std::path::{Path, PathBuf};

/// Runs `sweetspot report`.
pub fn report(a: &ReportArguments) -> Result<Exit, Exit> {
    refuse_other_pages(&a.out)?;
    let read = if a.of.is_dir() { of_folder(a)? } else { of_cell(a)? };
    let workcell = workcell(read.loaded.cell, &read.file)?;
    let start = Assessment::new("start", &workcell, workcell.cell.start());
    let best = read.best.map(|layout| Assessment::new("best", &workcell, layout).misplaced().with_regions());
    let start = if best.is_some() { start } else { start.misplaced().with_regions() };
    let warnings = read.loaded.warnings.iter().map(warning).collect();
    let compared = measured::compared(&a.measured, &workcell.cell)?;
    let mut manifest = read.manifest;
    let tables = measured::sources(&a.measured)?;
    manifest.inputs.extend(tables.iter().map(hashed));
    let subject = Subject { start, best, found: read.found, measured: compared, manifest, warnings };
    if a.of.is_dir() {
        refuse_other_numbers(&a.of, &subject)?;
    }
    let mut verdict = None;
    let html = within_size(|detail| {
        let drawings = subject.layouts().map(|a| Drawing::new(a, detail)).collect::<Result<Vec<_>, _>>()?;
        let Report { html, verdict: told } = page::report(&subject, &drawings)?;
        verdict = Some(told);
        Ok(html)
    })?;
    let Some(verdict) = verdict else { return Err(Exit::Io) };
    let report = Report { html, verdict };
    loading::write_whole(&a.out, report.html.as_bytes())?;
    tell(a, &read.file, &subject, &report)?;
    Ok(if report.verdict.answer == VerdictAnswer::Yes { Exit::Done } else { Exit::AnswerIsNo })
}

/// Data for a report, as read from files; no layout is assessed yet.
struct ReportSource {
    loaded: Loaded,
    file: PathBuf,
    best: Option<crate::cell::Layout>,
    found: Option<SearchResult>,
    manifest: Manifest,
}

fn of_folder(a: &ReportArguments) -> Result<ReportSource, Exit> {
    if !a.question.words().is_empty() {
        output::error("flags cannot change the settings of a finished search");
        let best = path_word(&a.of.join("best.toml"));
        output::talk(&format!(
            "  help: report its best layout: sweetspot report {best}{}",
            a.question.words()
        ));
        return Err(Exit::BadInput);
    }
    let SearchFolder { loaded, file, best, found, mut manifest } = results_folder::read(&a.of, &a.packages)?;
    manifest.seed = found.seed;
    Ok(ReportSource { loaded, file, best, found: Some(found), manifest })
}

fn of_cell(a: &ReportArguments) -> Result<ReportSource, Exit> {
    let loaded = asked::load(&a.of, &a.packages, &a.question)?;
    let manifest = Manifest {
        command: arguments::typed(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: loaded.cell.search.seed,
        inputs: loaded.sources.iter().map(hashed).collect(),
        outputs: Vec::new(),
        csv: format!("the map.csv of sweetspot map {}{} --out DIR", path_word(&a.of), a.question.words()),
        source: a.of.to_string_lossy().into_owned(),
        is_complete: true,
    };
    Ok(ReportSource { loaded, file: a.of.clone(), best: None, found: None, manifest })
}

/// Returns the path of an input with the hash of its bytes.
fn hashed(source: &Source) -> (String, String) {
    (source.path.clone(), loading::sha256(&source.bytes))
}

fn warning(fault: &Fault) -> String {
    format!("{}:{}: {}", fault.file, fault.line, fault.message)
}

/// Refuses a search.json if its objectives or limits differ from those that this program computes.
fn refuse_other_numbers(folder: &Path, subject: &Subject<'_>) -> Result<(), Exit> {
    let Some(found) = &subject.found else { return Ok(()) };
    let best = subject.best.as_ref().and_then(Assessment::objective);
    let pairs = [
        ("best", found.objective_value, best),
        ("start", found.start.objective_value, subject.start.objective()),
    ];
    for (which, says, is) in pairs {
        let same = match (says, is) {
            // Another machine may round differently.
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

/// Refuses a search.json whose limits differ from those of the cell in inputs/.
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

fn tell(a: &ReportArguments, file: &Path, subject: &Subject<'_>, report: &Report) -> Result<(), Exit> {
    let verdict = &report.verdict;
    if a.json {
        json_text::print(verdict)?;
    } else {
        let facts = verdict.facts.iter().map(|f| format!("  {}: {} ({})\n", f.label, f.text, f.note));
        let reasons = verdict.reasons.iter().map(|r| format!("  {r}\n"));
        let rest: String = facts.chain(reasons).collect();
        output::data(&format!("{}\n{rest}", verdict.headline))?;
    }
    if verdict.ended.is_some_and(|ended| matches!(ended, SearchEnd::Interrupted | SearchEnd::TimeLimit)) {
        output::talk("note: the search was stopped early: resume it to look for a better layout");
    }
    output::talk(&format!("wrote {} ({} kB)", path_word(&a.out), report.html.len().div_ceil(1 << 10)));
    warn_of_distrust(subject.shown());
    if !a.json {
        let of = path_word(&a.of);
        let movable = !subject.cell().free().is_empty();
        let next = match (&subject.found, movable) {
            (Some(_), _) if subject.best.is_some() => {
                format!("compare {} {of} -o compare.html", path_word(file))
            }
            (Some(_), _) => format!("map {} --svg map.svg", path_word(file)),
            (None, true) => format!("search {of}"),
            (None, false) => format!("map {of} --svg map.svg"),
        };
        suggest_with(&next, &a.packages);
    }
    Ok(())
}
