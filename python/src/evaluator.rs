//! Evaluation of layouts for your own optimizer: a function from layouts to costs.

use crate::at_layout::at_layout;
use crate::cell::Cell;
use crate::evaluations::{Evaluated, Evaluations};
use crate::interrupt::all_or_nothing;
use crate::workspaces::{Borrowed, Workspaces};
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLikeDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use sweetspot::assess::Feasibility;
use sweetspot::cell::{Coordinate, Layout, Slot};
use sweetspot::files::toml_string;
use sweetspot::layout::{Workcell, evaluate_in};
use sweetspot::proof::{LAYOUTS_WORTH_A_FIELD, rank_nodes};
use sweetspot::record::nine_digits;
use sweetspot::search::SearchSpace;
use sweetspot::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg};

/// Least number of layouts that one thread evaluates as one task.
const MIN_LAYOUTS: usize = 50;

/// Largest number of layouts that are evaluated in the calling thread instead of on all cores.
const FEW_LAYOUTS: usize = 2;

/// Array of layouts (n, dim), or one layout (dim,), as Python passes it.
type Given<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// Function from layouts to costs.
///
/// A layout is given as a point of the unit cube or, with `units=True`, by its free coordinates in mm and
/// degrees.
#[pyclass(frozen, module = "sweetspot")]
pub struct Evaluator {
    cell: Cell,
    workcell: Arc<Workcell>,
    workspaces: Workspaces,
    /// Number of layouts that were evaluated so far.
    count: AtomicU64,
}

/// Layouts as rows of numbers.
struct Rows {
    values: Vec<f64>,
    /// Whether one layout was given instead of an array of layouts.
    is_one: bool,
}

/// Returns a function from layouts to costs, which your own optimizer can call.
#[pyfunction]
pub fn evaluator(py: Python<'_>, cell: &Cell) -> PyResult<Evaluator> {
    Evaluator::new(py, cell.clone())
}

impl Evaluator {
    pub fn new(py: Python<'_>, cell: Cell) -> PyResult<Self> {
        let workcell = cell.prepared(py)?;
        Ok(Self { cell, workcell, workspaces: Workspaces::default(), count: AtomicU64::new(0) })
    }

    fn free(&self) -> Vec<(Slot, &Coordinate)> {
        self.workcell.cell.free()
    }

    /// Returns the layouts as rows, after checks of their shape and of their numbers.
    fn rows(&self, given: &Given<'_>) -> PyResult<Rows> {
        let (shape, dim) = (given.shape(), self.dim());
        let is_one = shape.len() == 1;
        if dim == 0 {
            return Err(PyValueError::new_err("the cell has no free coordinate: its layout is fixed"));
        }
        if !(1..=2).contains(&shape.len()) || shape.last() != Some(&dim) {
            let message = format!("expected layouts of shape (n, {dim}) or ({dim},), not {shape:?}");
            return Err(PyValueError::new_err(message));
        }
        let values: Vec<f64> = given.as_array().iter().copied().collect();
        if let Some(k) = values.iter().position(|v| !v.is_finite()) {
            let (row, name) = (k / dim, self.names().swap_remove(k % dim));
            return Err(PyValueError::new_err(format!("{name} of layout {row} is not a finite number")));
        }
        Ok(Rows { values, is_one })
    }

    /// Returns the layout of one row. A point of the unit cube is rounded to the resolution of the search;
    /// values in mm and degrees are not rounded.
    fn layout(&self, row: &[f64], units: bool) -> Layout {
        let cell = &self.workcell.cell;
        if !units {
            return SearchSpace::new(cell).layout(row);
        }
        let free = cell.free();
        cell.layout(|slot, coordinate| {
            let place = free.iter().position(|(known, _)| *known == slot);
            place.map_or_else(|| coordinate.start(), |k| to_si(slot, row[k]))
        })
    }

    /// Evaluates layouts on all cores, or in the calling thread if there are at most [`FEW_LAYOUTS`].
    fn evaluated(&self, rows: &[f64], units: bool, reasons: bool, stop: &AtomicBool) -> Vec<Evaluated> {
        let one = |workspace: &mut Borrowed<'_>, row: &[f64]| {
            if stop.load(Ordering::Relaxed) {
                return Evaluated::default();
            }
            let layout = self.layout(row, units);
            let evaluation = evaluate_in(&self.workcell, &layout, workspace);
            let is_asked = reasons && evaluation.objective.is_none();
            let why = is_asked.then(|| Feasibility::new(&self.workcell, &layout).reasons);
            Evaluated::new(&evaluation, &self.workcell.cell, why.unwrap_or_default())
        };
        let borrow = || Borrowed::new(&self.workspaces);
        let dim = self.dim();
        let more = (rows.len() / dim) as u64;
        // The costs are the same with and without value fields, bit for bit.
        if self.count.fetch_add(more, Ordering::Relaxed) + more >= LAYOUTS_WORTH_A_FIELD {
            rank_nodes(&self.workcell, stop);
        }
        if rows.len() <= dim * FEW_LAYOUTS {
            return rows.chunks(dim).map(|row| one(&mut borrow(), row)).collect();
        }
        // Reasons take much longer to compute than costs, so layouts with reasons are distributed to threads
        // one by one.
        let least =
            if reasons { 1 } else { MIN_LAYOUTS.min(rows.len() / dim / rayon::current_num_threads()).max(1) };
        rows.par_chunks(dim).with_min_len(least).map_init(borrow, one).collect()
    }

    fn run(&self, py: Python<'_>, rows: &[f64], units: bool, reasons: bool) -> PyResult<Vec<Evaluated>> {
        if rows.len() <= self.dim() * FEW_LAYOUTS && !reasons {
            return Ok(py.detach(|| self.evaluated(rows, units, reasons, &AtomicBool::new(false))));
        }
        all_or_nothing(py, |stop| self.evaluated(rows, units, reasons, stop))
    }
}

/// Converts a value of a layout from mm or degrees to SI.
fn to_si(slot: Slot, value: f64) -> f64 {
    if slot.is_angle() { rad_from_deg(value) } else { m_from_mm(value) }
}

/// Converts a value of a layout from SI to mm or degrees.
fn from_si(slot: Slot, value: f64) -> f64 {
    nine_digits(if slot.is_angle() { deg_from_rad(value) } else { mm_from_m(value) })
}

/// Returns a name as a key of TOML, in quotes if it needs them.
fn key(name: &str) -> String {
    let is_bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
    if is_bare { name.to_string() } else { toml_string(name) }
}

#[pymethods]
impl Evaluator {
    /// Number of free coordinates.
    #[getter]
    fn dim(&self) -> usize {
        self.free().len()
    }

    /// Path of every free coordinate in the cell file, in the form that `Cell.with_` accepts.
    #[getter]
    fn names(&self) -> Vec<String> {
        let cell = &self.workcell.cell;
        let name = |slot: Slot| match slot {
            Slot::Base(axis) => format!("robot.base.{}", AXES[axis]),
            Slot::Equipment(k, axis) => {
                format!("equipment.{}.placement.{}", key(&cell.equipment[k].name), AXES[axis])
            }
            Slot::Attitude(k, angle) => {
                format!("operation.{}.{}", key(&cell.operations[k].name), ANGLES[angle])
            }
        };
        self.free().into_iter().map(|(slot, _)| name(slot)).collect()
    }

    /// Unit of the costs.
    #[getter]
    fn unit(&self) -> &'static str {
        self.workcell.cell.unit().word()
    }

    /// Least and greatest value of every free coordinate in mm or degrees, shape (dim, 2).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let bound = |(slot, coordinate): (Slot, &Coordinate)| {
            let (low, high) = match coordinate {
                Coordinate::Fixed(value) => (*value, *value),
                Coordinate::Range { min, max, .. } => (*min, *max),
                Coordinate::List(values) => {
                    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)))
                }
            };
            vec![from_si(slot, low), from_si(slot, high)]
        };
        matrix(py, self.free().into_iter().map(bound).collect(), 2)
    }

    /// Point of the unit cube for the start layout.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, SearchSpace::new(&self.workcell.cell).start())
    }

    /// Cell whose layouts are evaluated.
    #[getter]
    fn cell(&self) -> Cell {
        self.cell.clone()
    }

    /// Returns the costs (n,) of layouts (n, dim), or the cost of one layout (dim,).
    ///
    /// The cost of a layout within every limit is its objective, in `unit`. A layout that misses a limit
    /// costs more than 100 w, and an infeasible layout costs at least 1000 w. The cost of an infeasible
    /// layout increases with its distance from feasibility.
    ///
    /// The weight w depends on the objective. For `sum`, w is the sum of the weights of the operations. For
    /// `max`, w is the largest of these weights. For `lexicographic`, w is 1. For `tolerance-cost`, w is the
    /// cost of the tightest tolerances. If the objective is an error, the multiples of w are in m or rad, and
    /// are converted to `unit`. If `unit` is mm and w is 2, for example, 100 w is 200 m = 200 000 mm.
    #[pyo3(signature = (layouts, *, units=false))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        layouts: Given<'py>,
        units: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Rows { values, is_one } = self.rows(&layouts)?;
        let costs: Vec<f64> = self.run(py, &values, units, false)?.into_iter().map(|e| e.cost).collect();
        match costs[..] {
            [cost] if is_one => Ok(cost.into_pyobject(py)?.into_any()),
            _ => Ok(PyArray1::from_vec(py, costs).into_any()),
        }
    }

    /// Evaluates layouts: costs, objectives, values of the operations and, if `reasons` is True, the reasons
    /// why a layout is not feasible.
    #[pyo3(signature = (layouts, *, units=false, reasons=false))]
    fn evaluate(
        &self,
        py: Python<'_>,
        layouts: Given<'_>,
        units: bool,
        reasons: bool,
    ) -> PyResult<Evaluations> {
        let Rows { values, .. } = self.rows(&layouts)?;
        let evaluated = self.run(py, &values, units, reasons)?;
        Ok(Evaluations::new(&self.workcell.cell, evaluated, reasons))
    }

    /// Returns the coordinates in mm and degrees of the layouts at points of the unit cube.
    fn to_units<'py>(&self, py: Python<'py>, points: Given<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.rows(&points)?;
        let (cell, free) = (&self.workcell.cell, self.free());
        let values = |row: &[f64]| {
            let layout = self.layout(row, false);
            free.iter().map(|(slot, _)| from_si(*slot, layout.value(cell, *slot))).collect::<Vec<_>>()
        };
        matrix(py, rows.values.chunks(self.dim()).map(values).collect(), self.dim())
    }

    /// Returns the points of the unit cube for layouts in mm and degrees, which must be inside the bounds.
    #[pyo3(name = "from_units")]
    fn points<'py>(&self, py: Python<'py>, layouts: Given<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.rows(&layouts)?;
        let space = SearchSpace::new(&self.workcell.cell);
        let point = |row: &[f64]| space.point(&self.layout(row, true));
        matrix(py, rows.values.chunks(self.dim()).map(point).collect(), self.dim())
    }

    /// Returns the cell at one layout.
    #[pyo3(signature = (layout, *, units=false))]
    fn cell_at(&self, py: Python<'_>, layout: Given<'_>, units: bool) -> PyResult<Cell> {
        let Rows { values, is_one } = self.rows(&layout)?;
        if !is_one {
            return Err(PyValueError::new_err("cell_at() takes one layout"));
        }
        at_layout(
            py,
            &self.cell,
            &self.layout(&values, units),
            "layout.toml",
            "Layout of an evaluator in Python",
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "<Evaluator of {}: {} coordinates, costs in {}>",
            self.workcell.cell.name,
            self.dim(),
            self.unit()
        )
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (Cell,))> {
        let make = slf.py().import("sweetspot")?.getattr("evaluator")?;
        Ok((make.unbind(), (slf.get().cell.clone(),)))
    }
}

/// Keys of the coordinates of a placement.
const AXES: [&str; 4] = ["x_mm", "y_mm", "z_mm", "yaw_deg"];

/// Keys of the angles of an attitude.
const ANGLES: [&str; 3] = ["bend_deg", "azimuth_deg", "spin_deg"];

/// Returns rows as a numpy array of shape (n, `columns`).
fn matrix(py: Python<'_>, rows: Vec<Vec<f64>>, columns: usize) -> PyResult<Bound<'_, PyArray2<f64>>> {
    if rows.is_empty() {
        return Ok(PyArray2::zeros(py, [0, columns], false));
    }
    PyArray2::from_vec2(py, &rows).map_err(|e| PyValueError::new_err(e.to_string()))
}
