//! Cells in Python: files with settings, read and validated by the library.

use crate::calibration::Errors;
use crate::evaluator::Evaluator;
use crate::interrupt::all_or_nothing;
use crate::live::View;
use crate::map::Map;
use crate::page;
use crate::robot::Robot;
use crate::search::{Search, searched};
use crate::settings;
use crate::{faults, records};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use sweetspot::assess::{Assessment, BudgetReport, NoPosture, NodeChoice, PostureContext};
use sweetspot::cli::front_end::{FileSnapshot, PackageFolders, read_cell_with, remember, without_import};
use sweetspot::files::fault::did_you_mean;
use sweetspot::files::{Loaded, Setting, shown};
use sweetspot::layout::Workcell;
use sweetspot::record::{BudgetDocument, RobustDocument, caveats};

/// Origin of a cell: its file, its package folders, and the bytes of all files read so far.
pub struct CellOrigin {
    pub path: PathBuf,
    pub packages: PackageFolders,
    pub files: FileSnapshot,
}

/// Cell with its settings, which have been checked. A cell is immutable: `with_` returns another cell.
#[pyclass(frozen, module = "sweetspot")]
#[derive(Clone)]
pub struct Cell {
    pub origin: Arc<CellOrigin>,
    pub settings: Vec<Setting>,
    pub loaded: Arc<Loaded>,
    workcell: Arc<OnceLock<Arc<Workcell>>>,
}

/// Pickled state of a cell: path, packages, files and settings.
type Pickled =
    (PathBuf, Vec<(String, PathBuf)>, Vec<(String, Vec<u8>)>, Vec<(String, String, Option<String>)>);

impl Cell {
    /// Reads a cell with settings while the interpreter lock is released, and issues the warnings about
    /// the files.
    pub fn new(py: Python<'_>, origin: Arc<CellOrigin>, settings: Vec<Setting>) -> PyResult<Self> {
        let read = py.detach(|| read_cell_with(&origin.path, &origin.packages, &settings, &origin.files));
        let loaded = read.map_err(|found| faults::exception(py, &found))?;
        faults::warn(py, &without_import(&loaded.warnings))?;
        Ok(Self { origin, settings, loaded: Arc::new(loaded), workcell: Arc::default() })
    }

    pub fn cell(&self) -> &sweetspot::cell::Cell {
        &self.loaded.cell
    }

    /// Returns this cell with more settings.
    pub fn changed(&self, py: Python<'_>, added: Vec<Setting>) -> PyResult<Self> {
        if added.is_empty() {
            return Ok(self.clone());
        }
        Self::new(py, self.origin.clone(), settings::merged(self.settings.clone(), added))
    }

    /// Returns the cell prepared for evaluation. The preparation happens only once.
    pub fn prepared(&self, py: Python<'_>) -> PyResult<Arc<Workcell>> {
        if let Some(workcell) = self.workcell.get() {
            return Ok(workcell.clone());
        }
        let cell = self.cell().clone();
        let made = py.detach(|| Workcell::remembering(cell, &mut remember));
        let made = made.map_err(|why| self.unsolved(py, &why))?;
        Ok(self.workcell.get_or_init(|| Arc::new(made)).clone())
    }

    pub fn unsolved(&self, py: Python<'_>, why: &str) -> PyErr {
        let message = format!("the robot `{}` cannot do this: {why}", shown(&self.cell().robot.name));
        let help = "relax the orientation of the tool, or use another robot: see sweetspot.robots()";
        faults::refused(py, &self.place(), message, help)
    }

    /// Returns the path of the cell file as given.
    pub fn place(&self) -> String {
        self.origin.path.to_string_lossy().into_owned()
    }

    /// Returns the index of an operation by its name.
    pub fn operation(&self, py: Python<'_>, name: &str) -> PyResult<usize> {
        let names = || self.cell().operations.iter().map(|o| o.name.as_str());
        names().position(|known| known == name).ok_or_else(|| {
            let near = did_you_mean(name, names()).map(|near| format!("did you mean {}?", shown(near)));
            let listed = || format!("known: {}", names().map(shown).collect::<Vec<_>>().join(", "));
            let message = format!("the cell has no operation `{}`", shown(name));
            faults::refused(py, &self.place(), message, &near.unwrap_or_else(listed))
        })
    }
}

#[pymethods]
impl Cell {
    /// Reads a cell file and all files to which it refers.
    #[staticmethod]
    #[pyo3(signature = (path, *, packages=None))]
    fn read(py: Python<'_>, path: PathBuf, packages: Option<Vec<(String, PathBuf)>>) -> PyResult<Self> {
        let packages = PackageFolders { folders: packages.unwrap_or_default() };
        let origin = CellOrigin { path, packages, files: FileSnapshot::default() };
        Self::new(py, Arc::new(origin), Vec::new())
    }

    /// Reads a cell from the text of a cell file. The files to which the text refers are in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder=None, name="cell.toml", packages=None))]
    fn from_text(
        py: Python<'_>,
        text: String,
        folder: Option<PathBuf>,
        name: &str,
        packages: Option<Vec<(String, PathBuf)>>,
    ) -> PyResult<Self> {
        if Path::new(name).components().count() != 1 {
            return Err(PyValueError::new_err(
                "`name` must be a file name without a folder; give the folder as `folder`",
            ));
        }
        let path = folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
        let files = FileSnapshot::with([(name.to_string(), text.into_bytes())]);
        let packages = PackageFolders { folders: packages.unwrap_or_default() };
        Self::new(py, Arc::new(CellOrigin { path, packages, files }), Vec::new())
    }

    /// Returns the cell with other settings. Each of `sets` is a text `PATH=VALUE` as after `--set`, or a
    /// dict of paths and values. The keywords `question` choose the errors and their interpretation.
    #[pyo3(signature = (*sets, **question))]
    fn with_(
        &self,
        py: Python<'_>,
        sets: &Bound<'_, PyTuple>,
        question: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut added = settings::of_sets(sets)?;
        added.extend(settings::of_question("with_", question)?);
        self.changed(py, added)
    }

    /// Returns the cell with identified errors of the robot. If the cell states no reading (signed,
    /// worst-case or statistical), the default reading for these errors applies.
    fn with_errors(&self, py: Python<'_>, errors: &Errors) -> PyResult<Self> {
        self.changed(py, settings::of_errors(errors))
    }

    /// Maps the error over the surface of an operation, or of all operations.
    ///
    /// `senses="own"` leaves out the figures in all senses except the sense of the operation. The map is then
    /// computed several times faster, and takes half the memory.
    #[pyo3(signature = (operation=None, *, senses="all", **question))]
    fn map(
        &self,
        py: Python<'_>,
        operation: Option<&str>,
        senses: &str,
        question: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Map> {
        let every_sense = match senses {
            "all" => true,
            "own" => false,
            _ => return Err(PyValueError::new_err("`senses` must be \"all\" or \"own\"")),
        };
        let cell = self.changed(py, settings::of_question("map", question)?)?;
        let operation = operation.map(|name| cell.operation(py, name)).transpose()?;
        Map::new(py, &cell, operation, every_sense)
    }

    /// Searches for the layout of least error. Ctrl-C ends the search, which then returns the best layout so
    /// far.
    ///
    /// `time` is the limit of the computing time in seconds, and `threads` the number of threads (None: all
    /// cores). `progress` is called with the number of evaluations so far, the budget, and the least
    /// objective so far in the unit of the search (None if no layout is feasible yet).
    #[pyo3(signature = (*, time=None, threads=None, progress=None, **settings))]
    fn search(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Search> {
        let cell = self.changed(py, settings::of_search("search", settings)?)?;
        searched(py, &cell, time, threads, progress.as_ref())
    }

    /// Returns the share of each parameter in the error at the spot of every operation. If `operation` is
    /// given, the record contains only this operation. If `at` is given, the node `at` (i, j) of the
    /// operation replaces the spot.
    #[pyo3(signature = (operation=None, *, at=None, **question))]
    fn budget<'py>(
        &self,
        py: Python<'py>,
        operation: Option<&str>,
        at: Option<(usize, usize)>,
        question: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let cell = self.changed(py, settings::of_question("budget", question)?)?;
        let all = match operation {
            Some(name) => vec![cell.operation(py, name)?],
            None => (0..cell.cell().operations.len()).collect(),
        };
        if at.is_some() && all.len() > 1 {
            return Err(PyValueError::new_err("`at` is ambiguous: name one of the operations of the cell"));
        }
        let at = at.map_or(NodeChoice::Best, |(i, j)| NodeChoice::Node(i, j));
        let workcell = cell.prepared(py)?;
        let found = all_or_nothing(py, |_| {
            let layout = workcell.cell.start();
            let maps = workcell.maps(&layout);
            let of = |k: &usize| PostureContext::at(&workcell, &layout, &maps, *k, at).map(BudgetReport::new);
            let accounts = all.iter().map(of).collect::<Result<Vec<_>, _>>()?;
            Ok(BudgetDocument::new(&workcell.cell, &accounts))
        })?;
        let document = found.map_err(|why| match why {
            NoPosture::Outside(why) => faults::refused(py, &cell.place(), why, ""),
            NoPosture::Unusable(why) => {
                faults::no_answer(py, &cell.place(), why, "look at the map of the cell")
            }
        })?;
        records::object(py, "BudgetDocument", &document)
    }

    /// Returns the sensitivity of every operation to misplaced equipment. The record also states the largest
    /// misplacement at which the operation stays feasible and within its limit.
    #[pyo3(signature = (**question))]
    fn robust<'py>(
        &self,
        py: Python<'py>,
        question: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let workcell = self.changed(py, settings::of_question("robust", question)?)?.prepared(py)?;
        let document = all_or_nothing(py, |_| {
            let assessment = Assessment::new("start", &workcell, workcell.cell.start()).misplaced();
            RobustDocument::new(&assessment)
        })?;
        records::object(py, "RobustDocument", &document)
    }

    /// Writes one HTML page about the start layout. Returns the record of the verdict, which is the answer at
    /// the top of the page. An existing page is replaced.
    fn report<'py>(&self, py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyAny>> {
        page::written(py, &path, page::of_cell(py, self)?)
    }

    /// Serves a page on this machine on which the layout can be edited. Port 0 stands for any port that is
    /// not in use, and `open` opens the page in the browser.
    #[pyo3(signature = (*, port=0, open=false))]
    fn view(&self, py: Python<'_>, port: u16, open: bool) -> PyResult<View> {
        View::new(py, self, port, open)
    }

    /// Returns a function from layouts to costs, which your own optimizer can call.
    fn evaluator(&self, py: Python<'_>) -> PyResult<Evaluator> {
        Evaluator::new(py, self.clone())
    }

    #[getter]
    fn name(&self) -> &str {
        &self.cell().name
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.origin.path.clone()
    }

    #[getter]
    fn robot(&self) -> Robot {
        Robot::new(self.cell().robot.clone())
    }

    /// Names of the operations.
    #[getter]
    fn operations(&self) -> Vec<&str> {
        self.cell().operations.iter().map(|o| o.name.as_str()).collect()
    }

    /// Caveats on the interpretation of the errors.
    #[getter]
    fn notes(&self) -> Vec<String> {
        caveats(self.cell())
    }

    /// Warnings about the files of the cell.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        faults::listed(py, &self.loaded.warnings)
    }

    fn __repr__(&self) -> String {
        let cell = self.cell();
        let (robot, count) = (shown(&cell.robot.name), cell.operations.len());
        format!(
            "<Cell {}: {robot}, {count} operations, {} free coordinates>",
            shown(&cell.name),
            cell.free().len()
        )
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let html = page::plain_of_cell(py, self)?;
        Ok(page::framed(&html))
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, Pickled)> {
        let this = slf.get();
        let files = this.loaded.sources.iter().map(|source| (source.path.clone(), source.bytes.clone()));
        let settings = this.settings.iter().cloned().map(|s| (s.path, s.value, s.flag));
        let state = (
            this.origin.path.clone(),
            this.origin.packages.folders.clone(),
            files.collect(),
            settings.collect(),
        );
        Ok((slf.getattr("_restored")?.unbind(), state))
    }

    /// Makes a cell from its pickled state.
    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        path: PathBuf,
        packages: Vec<(String, PathBuf)>,
        files: Vec<(String, Vec<u8>)>,
        settings: Vec<(String, String, Option<String>)>,
    ) -> PyResult<Self> {
        let files = FileSnapshot::with(files);
        let origin = CellOrigin { path, packages: PackageFolders { folders: packages }, files };
        let settings = settings.into_iter().map(|(path, value, flag)| Setting { path, value, flag });
        Self::new(py, Arc::new(origin), settings.collect())
    }
}
