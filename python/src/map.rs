//! Error maps in Python: a table of nodes, a record and a picture.

use crate::cell::Cell;
use crate::interrupt::all_or_nothing;
use crate::node_columns::node_columns;
use crate::{records, table};
use arrow_array::RecordBatch;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use serde_json::Value;
use sweetspot::assess::Assessment;
use sweetspot::cli::front_end::remember;
use sweetspot::layout::Workcell;
use sweetspot::record::{MapDocument, MapNodes};
use sweetspot::report;

/// Error map of the start layout of a cell: a table of nodes, a record and a picture.
#[pyclass(frozen, module = "sweetspot")]
pub struct Map {
    nodes: RecordBatch,
    document: Py<PyAny>,
    svg: String,
}

/// Content of a map that is computed without the interpreter lock.
struct Mapped {
    nodes: RecordBatch,
    document: Value,
    svg: String,
}

impl Map {
    /// Maps one operation or all of them. `every_sense` adds the figures in all senses to the figures in
    /// the sense of the operation.
    pub fn new(py: Python<'_>, cell: &Cell, operation: Option<usize>, every_sense: bool) -> PyResult<Self> {
        let workcell = cell.prepared(py)?;
        let mapped = all_or_nothing(py, |_| match every_sense {
            true => mapped(&workcell, operation, true),
            false => {
                let own = Workcell::remembering(workcell.cell.clone(), &mut remember);
                let own = own.map_err(PyValueError::new_err)?;
                mapped(&own.in_own_senses(), operation, false)
            }
        })??;
        let Mapped { nodes, document, svg } = mapped;
        let document = records::object(py, "MapDocument", &document)?.unbind();
        Ok(Self { nodes, document, svg })
    }
}

fn mapped(workcell: &Workcell, operation: Option<usize>, every_sense: bool) -> PyResult<Mapped> {
    let mut assessment = Assessment::new("start", workcell, workcell.cell.start());
    let svg = report::chart::error_map(&assessment);
    let mut document = MapDocument::new(&assessment);
    if let Some(k) = operation {
        let one = document.operations.swap_remove(k);
        document.operations = vec![one];
    }
    let nodes = node_columns(&document, every_sense)?;
    for operation in &mut document.operations {
        operation.nodes = MapNodes::Read(Vec::new());
    }
    let mut document = serde_json::to_value(&document).map_err(|e| PyValueError::new_err(e.to_string()))?;
    assessment.maps.clear();
    // The document leaves out the nodes, which are the rows of the table.
    for operation in document["operations"].as_array_mut().into_iter().flatten() {
        operation.as_object_mut().and_then(|operation| operation.remove("nodes"));
    }
    Ok(Mapped { nodes, document, svg })
}

#[pymethods]
impl Map {
    /// Returns the nodes as an Arrow stream, for data frames.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore the requested schema; the consumer then casts the table to this schema.
        drop(requested_schema);
        table::stream(py, &self.nodes)
    }

    /// Returns a column of the table of nodes as a numpy array, in which a missing number is NaN.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        table::column(py, &self.nodes, name)
    }

    fn __len__(&self) -> usize {
        self.nodes.num_rows()
    }

    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.nodes.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Memory that the nodes take, in bytes.
    #[getter]
    fn nbytes(&self) -> usize {
        self.nodes.get_array_memory_size()
    }

    /// Record of `sweetspot map --json`, without the nodes.
    #[getter]
    fn document(&self, py: Python<'_>) -> Py<PyAny> {
        self.document.clone_ref(py)
    }

    #[getter]
    fn operations(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "operations")
    }

    #[getter]
    fn feasible(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "feasible")
    }

    #[getter]
    fn objective(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "objective")
    }

    #[getter]
    fn unit(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "unit")
    }

    /// Picture of the map as the text of an SVG file.
    #[getter]
    fn svg(&self) -> &str {
        &self.svg
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let cell: String = self.document.getattr(py, "cell")?.extract(py)?;
        Ok(format!("<Map of {cell}: {} nodes>", self.nodes.num_rows()))
    }

    fn _repr_html_(&self) -> String {
        format!("<div style=\"max-width: 60em\">{}</div>", self.svg)
    }
}
