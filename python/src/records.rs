//! Records as typed objects of `sweetspot.records`, the comparison of cells, and the schemas of all
//! documents.

use crate::cell::Cell;
use crate::faults;
use crate::interrupt::all_or_nothing;
use crate::search::Search;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::Serialize;
use std::sync::Arc;
use sweetspot::assess::{Assessment, Comparison};
use sweetspot::files::fault::did_you_mean;
use sweetspot::files::{self, FileKind};
use sweetspot::layout::Workcell;
use sweetspot::record::{ComparisonDocument, DocumentKind};

/// Returns a record as an object of the class `class` of `sweetspot.records`.
pub fn object<'py>(py: Python<'py>, class: &str, record: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(record).map_err(|e| PyValueError::new_err(e.to_string()))?;
    of_json(py, class, &text)
}

/// Returns the record with the JSON text `text` as an object of the class `class` of `sweetspot.records`.
pub fn of_json<'py>(py: Python<'py>, class: &str, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("sweetspot.records")?.getattr(class)?.call_method1("from_json", (text,))
}

/// Compares the start layouts of cells and the best layouts of searches. The first layout is the reference.
#[pyfunction]
#[pyo3(signature = (*layouts, names=None))]
pub fn compare<'py>(
    py: Python<'py>,
    layouts: &Bound<'py, PyTuple>,
    names: Option<Vec<String>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut cells: Vec<(String, Arc<Workcell>)> = Vec::new();
    for (k, given) in layouts.iter().enumerate() {
        let cell = match given.cast::<Search>() {
            Ok(search) => search.get().best_cell(py)?,
            Err(_) => given
                .cast::<Cell>()
                .map_err(|_| PyTypeError::new_err("compare() takes cells and results of searches"))?
                .get()
                .clone(),
        };
        let name = names.as_ref().and_then(|names| names.get(k).cloned());
        cells.push((name.unwrap_or_else(|| format!("{} {}", cell.cell().name, k + 1)), cell.prepared(py)?));
    }
    if cells.is_empty() {
        return Err(PyValueError::new_err("compare() needs at least one cell"));
    }
    let compared = all_or_nothing(py, |_| {
        let columns = cells.iter().map(|(name, w)| Assessment::new(name, w, w.cell.start())).collect();
        Comparison::new(columns).map(|comparison| ComparisonDocument::new(&comparison))
    })?;
    let document = compared.map_err(|why| {
        faults::refused(py, "compare", why, "compare layouts that answer the same question")
    })?;
    object(py, "ComparisonDocument", &document)
}

/// Returns the JSON Schema of a kind of file or document, such as `cell` or `map`, as a dict.
#[pyfunction]
#[pyo3(signature = (kind="cell"))]
pub fn schema<'py>(py: Python<'py>, kind: &str) -> PyResult<Bound<'py, PyAny>> {
    let document = DocumentKind::ALL.into_iter().find(|known| known.name() == kind).map(DocumentKind::schema);
    let of_file = || FileKind::ALL.into_iter().find(|known| known.name() == kind).map(files::schema);
    let known = || {
        let documents = DocumentKind::ALL.into_iter().map(DocumentKind::name);
        FileKind::ALL.into_iter().map(FileKind::name).chain(documents)
    };
    let schema = document.or_else(of_file).ok_or_else(|| {
        let near = did_you_mean(kind, known());
        let listed = || format!("known: {}", known().collect::<Vec<_>>().join(", "));
        let help = near.map_or_else(listed, |near| format!("did you mean {near}?"));
        PyValueError::new_err(format!("there is no schema `{kind}`; {help}"))
    })?;
    py.import("json")?.call_method1("loads", (schema.to_string(),))
}
