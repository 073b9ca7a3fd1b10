//! Evaluations of many layouts as arrays and as a table.

use crate::table;
use arrow_array::builder::PrimitiveBuilder;
use arrow_array::types::Float64Type;
use arrow_array::{ArrayRef, BooleanArray, StringArray};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::sync::Arc;
use sweetspot::cell::{Cell, Operation, Unit};
use sweetspot::error_map::Outcome;
use sweetspot::layout::Evaluation;
use sweetspot::record::nine_digits;

/// Figures of one layout in the unit of the objective, rounded to 9 decimals as in the JSON documents.
#[derive(Default)]
pub struct Evaluated {
    pub cost: f64,
    objective: Option<f64>,
    is_accepted: bool,
    values: Vec<Option<f64>>,
    reasons: Vec<String>,
}

impl Evaluated {
    pub fn new(evaluation: &Evaluation, cell: &Cell, reasons: Vec<String>) -> Self {
        let in_unit = |si: f64| nine_digits(cell.unit().from_si(si));
        let value = |(outcome, operation): (&Outcome, &Operation)| match outcome {
            // As in a map, an operation has no value if its equipment overlaps another object.
            _ if evaluation.overlaps.iter().any(|overlap| overlap.concerns(operation.equipment)) => None,
            Outcome::Found(spot) => Some(in_unit(spot.value)),
            _ => None,
        };
        Self {
            cost: in_unit(evaluation.cost),
            objective: evaluation.objective.map(in_unit),
            is_accepted: evaluation.is_accepted(),
            values: evaluation.outcomes.iter().zip(&cell.operations).map(value).collect(),
            reasons,
        }
    }
}

/// Evaluations of n layouts.
#[pyclass(frozen, module = "sweetspot")]
pub struct Evaluations {
    operations: Vec<String>,
    unit: Unit,
    rows: Vec<Evaluated>,
    has_reasons: bool,
}

impl Evaluations {
    pub fn new(cell: &Cell, rows: Vec<Evaluated>, has_reasons: bool) -> Self {
        let operations = cell.operations.iter().map(|o| o.name.clone()).collect();
        Self { operations, unit: cell.unit(), rows, has_reasons }
    }
}

#[pymethods]
impl Evaluations {
    /// Costs in `unit`, shape (n,).
    #[getter]
    fn costs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.rows.iter().map(|row| row.cost))
    }

    /// Objectives in `unit`, shape (n,); NaN for a layout that is not feasible.
    #[getter]
    fn objectives<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.rows.iter().map(|row| row.objective.unwrap_or(f64::NAN)))
    }

    /// Whether each layout is feasible and within every limit, shape (n,).
    #[getter]
    fn feasible<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.rows.iter().map(|row| row.is_accepted))
    }

    /// Value of every operation at its spot in `unit`, shape (n, operations); NaN if the operation has no
    /// spot.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let all = self.rows.iter().flat_map(|row| row.values.iter().map(|v| v.unwrap_or(f64::NAN)));
        PyArray1::from_iter(py, all).reshape([self.rows.len(), self.operations.len()])
    }

    /// Reasons why each layout is not feasible; None unless `reasons=True`.
    #[getter]
    fn reasons(&self) -> Option<Vec<Vec<String>>> {
        self.has_reasons.then(|| self.rows.iter().map(|row| row.reasons.clone()).collect())
    }

    /// Names of the operations.
    #[getter]
    fn operations(&self) -> Vec<String> {
        self.operations.clone()
    }

    #[getter]
    fn unit(&self) -> &'static str {
        self.unit.word()
    }

    /// Returns the evaluations as an Arrow stream, for data frames.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore the requested schema; the consumer then casts the table to this schema.
        drop(requested_schema);
        let numbers = |values: &dyn Fn(&Evaluated) -> Option<f64>| {
            let mut column = PrimitiveBuilder::<Float64Type>::with_capacity(self.rows.len());
            self.rows.iter().for_each(|row| column.append_option(values(row)));
            Arc::new(column.finish()) as ArrayRef
        };
        let accepted: Vec<bool> = self.rows.iter().map(|row| row.is_accepted).collect();
        let mut columns = vec![
            ("cost".to_string(), numbers(&|row| Some(row.cost))),
            ("objective".to_string(), numbers(&|row| row.objective)),
            ("feasible".to_string(), Arc::new(BooleanArray::from(accepted)) as ArrayRef),
        ];
        for (k, name) in self.operations.iter().enumerate() {
            columns.push((format!("value_{name}"), numbers(&|row| row.values.get(k).copied().flatten())));
        }
        if self.has_reasons {
            let reasons: Vec<String> = self.rows.iter().map(|row| row.reasons.join("; ")).collect();
            columns.push(("reasons".to_string(), Arc::new(StringArray::from(reasons))));
        }
        table::stream(py, &table::table(columns)?)
    }

    fn __len__(&self) -> usize {
        self.rows.len()
    }

    fn __repr__(&self) -> String {
        let feasible = self.rows.iter().filter(|row| row.is_accepted).count();
        format!("<Evaluations of {} layouts, {feasible} feasible>", self.rows.len())
    }
}
