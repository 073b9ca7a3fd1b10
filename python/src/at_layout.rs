//! Cells whose free coordinates are fixed at a layout, such as the best layout of a search.

use crate::cell::{Cell, CellOrigin};
use pyo3::prelude::*;
use std::sync::Arc;
use sweetspot::cell::Layout;
use sweetspot::cli::front_end::FileSnapshot;
use sweetspot::files::toml_string;
use sweetspot::report;

/// Name of a file that inherits from the cell file and contains the settings (`--set`) of a cell.
const WITH_SETS: &str = ".with-settings.toml";

/// Returns a name that no file of `files` has. If `name` is taken, the result has underscores before `name`.
fn unused(name: &str, files: &[(String, Vec<u8>)]) -> String {
    let mut name = name.to_string();
    while files.iter().any(|(known, _)| known.eq_ignore_ascii_case(&name)) {
        name.insert(0, '_');
    }
    name
}

/// Returns a cell whose start layout is the layout `layout` of `cell`. The text of its file begins with
/// `comment`.
///
/// The cell is read from the text that `sweetspot search` would write into a layout file. All numbers of the
/// cell therefore equal the numbers of that file, bit for bit.
pub fn at_layout(py: Python<'_>, cell: &Cell, layout: &Layout, name: &str, comment: &str) -> PyResult<Cell> {
    let file = cell.origin.path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let lines: Vec<String> =
        cell.settings.iter().filter(|s| s.flag.is_none()).map(|setting| setting.line()).collect();
    let mut files: Vec<_> =
        cell.loaded.sources.iter().map(|source| (source.path.clone(), source.bytes.clone())).collect();
    let from = if lines.is_empty() {
        file
    } else {
        let (name, text) =
            (unused(WITH_SETS, &files), format!("from = {}\n{}\n", toml_string(&file), lines.join("\n")));
        files.push((name.clone(), text.into_bytes()));
        name
    };
    let (name, text) = (unused(name, &files), report::toml::fixed(&from, comment, cell.cell(), layout));
    files.push((name.clone(), text.into_bytes()));
    let origin = CellOrigin {
        path: cell.origin.path.with_file_name(name),
        packages: cell.origin.packages.clone(),
        files: FileSnapshot::with(files),
    };
    Cell::new(py, Arc::new(origin), Vec::new())
}
