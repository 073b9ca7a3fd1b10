//! Reports as pages: written to a file, or framed for a notebook.

use crate::cell::Cell;
use crate::interrupt::all_or_nothing;
use crate::search::Search;
use crate::{faults, records};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use std::path::Path;
use sweetspot::assess::Assessment;
use sweetspot::cli::front_end::{replace, sha256};
use sweetspot::drawing::{Detail, Drawing};
use sweetspot::record::VerdictDocument;
use sweetspot::report::page::{Manifest, Report, SizedPage, Subject, report, sized};

/// Height of the frame of a page in a notebook, CSS pixels.
const FRAME_HEIGHT: usize = 640;

/// HTML page, and the record of the verdict, which is the answer at the top of the page.
pub struct Page {
    html: String,
    verdict: VerdictDocument,
}

/// Makes the page about the start layout of a cell.
pub fn of_cell(py: Python<'_>, cell: &Cell) -> PyResult<Page> {
    page(py, cell, None, &[])
}

/// Makes the page about the result of a search.
pub fn of_search(py: Python<'_>, search: &Search) -> PyResult<Page> {
    page(py, &search.cell, Some(search), &[])
}

/// Makes the page about the start layout of a cell for a notebook, with few details in its 3-D view.
pub fn plain_of_cell(py: Python<'_>, cell: &Cell) -> PyResult<String> {
    Ok(page(py, cell, None, &[Detail { nodes: 400, ..Detail::PLAIN }])?.html)
}

/// Makes the page about the result of a search for a notebook, with few details in its 3-D view.
pub fn plain_of_search(py: Python<'_>, search: &Search) -> PyResult<String> {
    Ok(page(py, &search.cell, Some(search), &[Detail { nodes: 400, ..Detail::PLAIN }])?.html)
}

/// Makes a page with the level of detail `details[0]`. If `details` is empty, the page has as much
/// detail as its size limit allows.
fn page(py: Python<'_>, cell: &Cell, search: Option<&Search>, details: &[Detail]) -> PyResult<Page> {
    let workcell = cell.prepared(py)?;
    let found = search.map(|search| (search.best.clone(), search.result.clone()));
    let manifest = manifest(cell, search);
    let warnings =
        cell.loaded.warnings.iter().map(|w| format!("{}:{}: {}", w.file, w.line, w.message)).collect();
    let made = all_or_nothing(py, |_| {
        let start = Assessment::new("start", &workcell, workcell.cell.start());
        let (best, found) = found.map_or((None, None), |(best, found)| (best, Some(found)));
        let best = best.map(|layout| Assessment::new("best", &workcell, layout).misplaced().with_regions());
        let start = if best.is_some() { start } else { start.misplaced().with_regions() };
        let subject = Subject { start, best, found, measured: Vec::new(), manifest, warnings };
        let mut verdict = None;
        let mut drawn = |detail: &Detail| {
            let drawings =
                subject.layouts().map(|a| Drawing::new(a, detail)).collect::<Result<Vec<_>, _>>()?;
            let Report { html, verdict: told } = report(&subject, &drawings)?;
            verdict = Some(told);
            Ok(html)
        };
        let html = match details.first() {
            Some(detail) => drawn(detail)?,
            None => {
                let SizedPage { html, .. } = sized(&mut drawn)?;
                html
            }
        };
        verdict.map(|verdict| Page { html, verdict }).ok_or_else(|| "the page has no verdict".to_string())
    })?;
    made.map_err(|why| PyRuntimeError::new_err(format!("cannot render the page: {why}")))
}

fn manifest(cell: &Cell, search: Option<&Search>) -> Manifest {
    let command = if search.is_some() { "search" } else { "map" };
    Manifest {
        command: [vec![command.to_string()], words(cell)].concat(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: cell.cell().search.seed,
        inputs: cell.loaded.sources.iter().map(|s| (s.path.clone(), sha256(&s.bytes))).collect(),
        outputs: Vec::new(),
        csv: "the table of the map in Python".into(),
        source: cell.place(),
        is_complete: true,
    }
}

/// Returns the command-line arguments that describe a cell: its file and its settings.
fn words(cell: &Cell) -> Vec<String> {
    let mut words = vec![cell.place()];
    let mut said = Vec::new();
    for setting in &cell.settings {
        let (option, value) = match setting.flag.as_deref() {
            Some(flag) => flag.split_once(' ').map_or((flag, String::new()), |(o, v)| (o, v.to_string())),
            None => ("--set", setting.words()),
        };
        if !said.contains(&(option, value.clone())) {
            words.push(option.to_string());
            words.extend(Some(value.clone()).filter(|value| !value.is_empty()));
            said.push((option, value));
        }
    }
    words
}

/// Writes a page to a file and returns the verdict of the page. An existing file is replaced as a whole.
pub fn written<'py>(py: Python<'py>, path: &Path, page: Page) -> PyResult<Bound<'py, PyAny>> {
    let is_page =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if !is_page {
        let place = path.to_string_lossy();
        return Err(faults::refused(py, &place, "the name of an HTML page must end in .html or .htm", ""));
    }
    py.detach(|| replace(path, page.html.as_bytes()))
        .map_err(|e| PyOSError::new_err(format!("cannot write {}: {e}", path.display())))?;
    records::object(py, "VerdictDocument", &page.verdict)
}

/// Returns an HTML frame that shows a page inside a notebook. The page may run its scripts, but has no other
/// rights.
pub fn framed(html: &str) -> String {
    let escaped = html.replace('&', "&amp;").replace('"', "&quot;");
    format!(
        "<iframe srcdoc=\"{escaped}\" sandbox=\"allow-scripts\" width=\"100%\" height=\"{FRAME_HEIGHT}\" \
         style=\"border: 0\"></iframe>"
    )
}
