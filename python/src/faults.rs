//! Faults as exceptions of `sweetspot.errors`, which carry file, line, column, message and help.

use pyo3::prelude::*;
use sweetspot::files::{Fault, FaultKind};

/// Place, message and help of a fault in the order of the fields of `sweetspot.errors.Fault`.
type FaultFields<'f> = (&'static str, &'f str, usize, usize, &'f str, &'f str, String);

fn fields(fault: &Fault) -> FaultFields<'_> {
    let Fault { file, line, column, message, help, .. } = fault;
    let severity = if fault.is_error() { "error" } else { "warning" };
    (severity, file, *line, *column, message, help, fault.to_string())
}

/// Returns the exception that carries these faults.
pub fn exception(py: Python<'_>, faults: &[Fault]) -> PyErr {
    let is_unreadable = faults.iter().any(|fault| fault.kind == FaultKind::Unreadable);
    let class = if is_unreadable { "UnreadableError" } else { "InputError" };
    raised(py, class, faults)
}

/// Returns the exception for a question that the cell at `place` cannot answer.
pub fn refused(py: Python<'_>, place: &str, message: impl Into<String>, help: &str) -> PyErr {
    let fault = Fault { line: 0, column: 0, ..Fault::of_file(place, message, help) };
    raised(py, "InputError", &[fault])
}

/// Returns the exception for a valid question that has no answer, such as the budget at a node that no
/// posture reaches.
pub fn no_answer(py: Python<'_>, place: &str, message: impl Into<String>, help: &str) -> PyErr {
    let fault = Fault { line: 0, column: 0, ..Fault::of_file(place, message, help) };
    raised(py, "NoAnswerError", &[fault])
}

fn raised(py: Python<'_>, class: &str, faults: &[Fault]) -> PyErr {
    let all: Vec<_> = faults.iter().map(fields).collect();
    let made =
        py.import("sweetspot.errors").and_then(|errors| errors.getattr(class)?.call_method1("_of", (all,)));
    made.map_or_else(|why| why, PyErr::from_value)
}

/// Issues each warning as a `sweetspot.InputWarning`.
pub fn warn(py: Python<'_>, warnings: &[Fault]) -> PyResult<()> {
    if warnings.is_empty() {
        return Ok(());
    }
    let all: Vec<_> = warnings.iter().map(fields).collect();
    py.import("sweetspot.errors")?.call_method1("_warn", (all,))?;
    Ok(())
}

/// Returns the faults as a tuple of `sweetspot.Fault`.
pub fn listed<'py>(py: Python<'py>, faults: &[Fault]) -> PyResult<Bound<'py, PyAny>> {
    let all: Vec<_> = faults.iter().map(fields).collect();
    py.import("sweetspot.errors")?.call_method1("_listed", (all,))
}
