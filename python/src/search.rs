//! Searches in Python: the best layout found, with bound, gap and front.

use crate::at_layout::at_layout;
use crate::cell::Cell;
use crate::interrupt::{Worked, all_or_nothing, interruptible};
use crate::{page, records};
use numpy::PyArray2;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use sweetspot::assess::Comparison;
use sweetspot::cell::Layout;
use sweetspot::layout::Workcell;
use sweetspot::proof::{Proof, ProofOptions, prove};
use sweetspot::record::SearchResult;
use sweetspot::search::{Progress, SearchEnd, SearchJob, SearchRecord, Watch, search_job};

/// Result of a search.
#[pyclass(frozen, module = "sweetspot")]
pub struct Search {
    pub cell: Cell,
    pub result: SearchResult,
    /// The best layout; None if no layout is feasible.
    pub best: Option<Layout>,
    layouts: Vec<Layout>,
    document: Py<PyAny>,
}

/// Searches for the best layout of a cell, for at most `time` seconds.
pub fn searched(
    py: Python<'_>,
    cell: &Cell,
    time: Option<f64>,
    threads: Option<u16>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Search> {
    if time.is_some_and(|time| time.is_nan() || time < 0.0) {
        return Err(PyValueError::new_err("`time` must be a number of seconds, not less than 0"));
    }
    let workcell = cell.prepared(py)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from)).build();
    let pool = pool.map_err(|e| PyRuntimeError::new_err(format!("cannot start threads: {e}")))?;
    let (clock, is_late, latest) = (Instant::now(), AtomicBool::new(false), Mutex::new(None));
    let work = |stop: &AtomicBool| {
        pool.install(|| {
            let proof = prove(&workcell, &ProofOptions::default(), stop);
            let told = |p: Progress| {
                *latest.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(p);
                if time.is_some_and(|limit| clock.elapsed().as_secs_f64() >= limit) {
                    is_late.store(true, Ordering::Relaxed);
                    stop.store(true, Ordering::Relaxed);
                }
            };
            let mut record = run(&workcell, &proof, &Watch { progress: &told, stop });
            if is_late.load(Ordering::Relaxed) && record.ended == SearchEnd::Interrupted {
                record.ended = SearchEnd::TimeLimit;
            }
            (proof, record)
        })
    };
    let tell = |py: Python<'_>| {
        let now = latest.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take();
        match (progress, now) {
            (Some(tell), Some(Progress { evaluations, budget, best, .. })) => {
                let best = best.map(|best| workcell.cell.unit().from_si(best));
                py.check_signals().and_then(|()| tell.call1((evaluations, budget, best))).map(drop)
            }
            _ => Ok(()),
        }
    };
    let Worked { result: (proof, record), interrupted } = interruptible(py, work, tell);
    // After Ctrl-C, the search returns what it has found. Any other exception, such as one of
    // `progress`, is raised.
    if let Some(why) = interrupted.filter(|why| !why.is_instance_of::<PyKeyboardInterrupt>(py)) {
        return Err(why);
    }
    let result = all_or_nothing(py, |_| {
        let compared = Comparison::of_search(&workcell, &record);
        SearchResult::of_comparison(&record, &proof, &compared)
    })?;
    let result = result.ok_or_else(|| PyRuntimeError::new_err("a search compares two layouts"))?;
    let document = records::object(py, "SearchResult", &result)?.unbind();
    let best = record.found().then(|| record.best.layout.clone());
    let layouts = record.alternatives.iter().map(|a| a.candidate.layout.clone()).collect();
    Ok(Search { cell: cell.clone(), result, best, layouts, document })
}

fn run(workcell: &Workcell, proof: &Proof, watch: &Watch<'_>) -> SearchRecord {
    let job = SearchJob { bound: proof.bound, from: None, keep: &|_, _| () };
    search_job(workcell, &workcell.cell.search, watch, &job)
}

impl Search {
    /// Returns the cell at the best layout.
    pub fn best_cell(&self, py: Python<'_>) -> PyResult<Cell> {
        let none = || PyValueError::new_err("no layout is feasible: see `reasons` of the document");
        let best = self.best.as_ref().ok_or_else(none)?;
        at_layout(py, &self.cell, best, "best.toml", "Best layout of a search in Python")
    }
}

#[pymethods]
impl Search {
    /// Objective of the best layout, in `unit`; None if no layout is feasible.
    #[getter]
    fn objective(&self) -> Option<f64> {
        self.result.objective_value
    }

    #[getter]
    fn unit(&self) -> &'static str {
        self.result.unit.word()
    }

    /// Proven lower bound of the objective of every layout, in `unit`; None if no bound is proven.
    #[getter]
    fn bound(&self) -> Option<f64> {
        self.result.bound
    }

    /// Relative gap: objective of the best layout / proven lower bound - 1 (0.01 is 1 %); None if there is no
    /// bound.
    #[getter]
    fn gap(&self) -> Option<f64> {
        self.result.gap_percent.map(|percent| percent / 100.0)
    }

    /// Cell at the best layout. Raises ValueError if no layout is feasible.
    #[getter]
    fn cell(&self, py: Python<'_>) -> PyResult<Cell> {
        self.best_cell(py)
    }

    /// Cells at the layouts of `front`, in the same order; empty if neither `pareto` nor `keep` is used.
    #[getter]
    fn cells(&self, py: Python<'_>) -> PyResult<Vec<Cell>> {
        let count = self.layouts.len();
        let cell = |(k, layout): (usize, &Layout)| {
            let name = sweetspot::record::goals::file_name(k, count);
            at_layout(py, &self.cell, layout, &name, &format!("Layout {} of {count}", k + 1))
        };
        self.layouts.iter().enumerate().map(cell).collect()
    }

    /// Improvements of the search, shape (n, 2): number of evaluations, and least objective so far in `unit`.
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> =
            self.result.trace.iter().map(|(n, value)| vec![*n as f64, *value]).collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 2], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// Record of `sweetspot search --json`.
    #[getter]
    fn document(&self, py: Python<'_>) -> Py<PyAny> {
        self.document.clone_ref(py)
    }

    /// Writes one HTML page about the result. Returns the record of the verdict, which is the answer at the
    /// top of the page. An existing page is replaced.
    fn report<'py>(&self, py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyAny>> {
        page::written(py, &path, page::of_search(py, self)?)
    }

    /// Spots of the operations in the best layout.
    #[getter]
    fn operations(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "operations")
    }

    /// Layouts of the Pareto front (`pareto`) or of the shortlist (`keep`); None if neither setting is used.
    #[getter]
    fn front(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "front")
    }

    /// Placement of every piece of equipment in the best layout.
    #[getter]
    fn layout(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "layout")
    }

    /// Reason why the search ended, such as `interrupted`.
    #[getter]
    fn ended(&self) -> &'static str {
        self.result.ended.name()
    }

    /// Number of layouts evaluated.
    #[getter]
    fn evaluations(&self) -> u64 {
        self.result.evaluations
    }

    fn __repr__(&self) -> String {
        let unit = self.unit();
        let best = self.objective().map_or("none feasible".into(), |best| format!("{best} {unit}"));
        let ended = self.result.ended.in_words();
        format!("<Search of {}: {best}, {} evaluations; {ended}>", self.result.cell, self.result.evaluations)
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let html = page::plain_of_search(py, self)?;
        Ok(page::framed(&html))
    }
}
