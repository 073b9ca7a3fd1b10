//! Server of the live page of a cell, which runs in the process of Python.

use crate::cell::Cell;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use sweetspot::cli::front_end::{BackgroundView, Origin, open_in_browser, remember};
use sweetspot::layout::Workcell;

/// Server of a page on this machine on which a layout can be edited.
///
/// The server ends at `stop`, at the end of the `with` block, or with the process.
#[pyclass(frozen, module = "sweetspot")]
pub struct View {
    server: Mutex<BackgroundView>,
    url: String,
}

impl View {
    pub fn new(py: Python<'_>, cell: &Cell, port: u16, open: bool) -> PyResult<Self> {
        let model = cell.cell().clone();
        let workcell = py.detach(|| Workcell::remembering(model, &mut remember));
        let workcell = workcell.map_err(|why| cell.unsolved(py, &why))?;
        let path = &cell.origin.path;
        let folder = path.parent().unwrap_or(Path::new(""));
        let sources: Vec<PathBuf> = cell.loaded.sources.iter().map(|s| folder.join(&s.path)).collect();
        let origin = Origin { file: path.clone(), packages: cell.origin.packages.clone(), sources };
        let server = BackgroundView::new(workcell, origin, port).map_err(PyOSError::new_err)?;
        let url = server.url().to_string();
        if open {
            // The file that redirects the browser to the page must outlive this call.
            let redirect = open_in_browser(&url).map_err(PyOSError::new_err)?;
            let _ = redirect.keep();
        }
        Ok(Self { server: Mutex::new(server), url })
    }
}

#[pymethods]
impl View {
    /// Address of the page. It contains the secret that admits a browser.
    #[getter]
    fn url(&self) -> &str {
        &self.url
    }

    /// Ends the server.
    fn stop(&self, py: Python<'_>) {
        py.detach(|| self.server.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).stop());
    }

    fn __enter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, pyo3::types::PyTuple>) {
        self.stop(py);
    }

    fn __repr__(&self) -> String {
        format!("<View {}>", self.url)
    }

    fn _repr_html_(&self) -> String {
        let url = &self.url;
        format!("<a href=\"{url}\" target=\"_blank\" rel=\"noreferrer\">Edit the layout in another tab</a>")
    }
}
