//! Tables for data frames: the Arrow PyCapsule interface, and columns as numpy arrays.

use arrow_array::builder::{ListBuilder, PrimitiveBuilder, StringDictionaryBuilder};
use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int32Type, Int64Type, UInt32Type};
use arrow_array::{ArrayRef, BooleanArray, RecordBatch, RecordBatchIterator, StringArray};
use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyCapsule, PyInt, PyList};
use std::sync::Arc;
use sweetspot::files::fault::did_you_mean;

/// Returns a table as the Arrow capsule that the Python method `__arrow_c_stream__` must return.
pub fn stream<'py>(py: Python<'py>, table: &RecordBatch) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = table.schema();
    let reader = RecordBatchIterator::new([Ok(table.clone())], schema);
    PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), c"arrow_array_stream")
}

/// Makes a table of named columns; all columns must have the same length.
pub fn table(columns: Vec<(String, ArrayRef)>) -> PyResult<RecordBatch> {
    RecordBatch::try_from_iter_with_nullable(columns.into_iter().map(|(name, column)| (name, column, true)))
        .map_err(|why| PyValueError::new_err(why.to_string()))
}

/// Returns a column of a table as a numpy array. A missing number is NaN; a missing text is None.
pub fn column<'py>(py: Python<'py>, table: &RecordBatch, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let schema = table.schema();
    let names = || schema.fields().iter().map(|field| field.name().as_str());
    let column = table.column_by_name(name).ok_or_else(|| {
        let near = did_you_mean(name, names());
        let listed = || format!("columns: {}", names().collect::<Vec<_>>().join(", "));
        let help = near.map_or_else(listed, |near| format!("did you mean {near}?"));
        PyKeyError::new_err(format!("the table has no column `{name}`; {help}"))
    })?;
    if let Some(numbers) = column.as_primitive_opt::<Float64Type>() {
        return Ok(PyArray1::from_iter(py, numbers.iter().map(|v| v.unwrap_or(f64::NAN))).into_any());
    }
    if let Some(counts) = column.as_primitive_opt::<UInt32Type>() {
        return Ok(PyArray1::from_slice(py, counts.values()).into_any());
    }
    if let Some(flags) = column.as_boolean_opt() {
        return Ok(PyArray1::from_iter(py, flags.iter().map(|v| v == Some(true))).into_any());
    }
    let texts = column.as_dictionary_opt::<Int32Type>().and_then(|d| d.downcast_dict::<StringArray>());
    let texts = texts.ok_or_else(|| PyValueError::new_err(format!("column `{name}` has an unknown type")))?;
    let list = PyList::new(py, texts)?;
    py.import("numpy")?.call_method1("array", (list,))
}

/// Returns columns of Python values as the capsule of an Arrow stream, for `sweetspot.records.Table`.
///
/// A column is a list of texts, of numbers, of flags, or of lists of numbers; None is a missing value.
#[pyfunction]
pub fn arrow_stream<'py>(
    py: Python<'py>,
    names: Vec<String>,
    columns: Vec<Bound<'py, PyList>>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let arrays = columns.iter().map(of_values).collect::<PyResult<Vec<_>>>()?;
    stream(py, &table(names.into_iter().zip(arrays).collect())?)
}

/// Returns a column of Python values as an Arrow array whose type fits all values.
fn of_values(values: &Bound<'_, PyList>) -> PyResult<ArrayRef> {
    let present = || values.iter().filter(|value| !value.is_none());
    let all = |is: fn(&Bound<'_, PyAny>) -> bool| present().next().is_some() && present().all(|v| is(&v));
    if all(|v| v.is_instance_of::<PyBool>()) {
        let flags = values.extract::<Vec<Option<bool>>>()?;
        return Ok(Arc::new(BooleanArray::from(flags)));
    }
    if all(|v| v.is_instance_of::<PyInt>()) {
        let mut counts = PrimitiveBuilder::<Int64Type>::new();
        values.extract::<Vec<Option<i64>>>()?.into_iter().for_each(|v| counts.append_option(v));
        return Ok(Arc::new(counts.finish()));
    }
    if all(|v| v.extract::<f64>().is_ok()) {
        let mut numbers = PrimitiveBuilder::<Float64Type>::new();
        values.extract::<Vec<Option<f64>>>()?.into_iter().for_each(|v| numbers.append_option(v));
        return Ok(Arc::new(numbers.finish()));
    }
    if all(|v| v.extract::<Vec<f64>>().is_ok()) {
        let mut lists = ListBuilder::new(PrimitiveBuilder::<Float64Type>::new());
        for list in values.extract::<Vec<Option<Vec<f64>>>>()? {
            lists.append_option(list.map(|list| list.into_iter().map(Some)));
        }
        return Ok(Arc::new(lists.finish()));
    }
    let mut texts = StringDictionaryBuilder::<Int32Type>::new();
    values.extract::<Vec<Option<String>>>()?.into_iter().for_each(|text| texts.append_option(text));
    Ok(Arc::new(texts.finish()))
}
