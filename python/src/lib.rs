//! Native half of the Python package `sweetspot`: classes that only wrap the library.
//!
//! Every result is a record of the library, so the numbers of a result equal the numbers that the commands
//! print, bit for bit. `records` converts records to typed objects of `sweetspot.records`, `table` passes
//! tables to Arrow, and `evaluator` passes layouts and costs to numpy. Long work runs without the interpreter
//! lock (`interrupt`).

mod at_layout;
mod calibration;
mod cell;
mod evaluations;
mod evaluator;
mod faults;
mod interrupt;
mod live;
mod map;
mod node_columns;
mod page;
mod records;
mod robot;
mod search;
mod settings;
mod table;
mod workspaces;

use pyo3::prelude::*;

/// Module of the native classes and functions, which `sweetspot/__init__.py` exports.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::calibration::{Calibration, Errors, calibrate};
    #[pymodule_export]
    use super::cell::Cell;
    #[pymodule_export]
    use super::evaluations::Evaluations;
    #[pymodule_export]
    use super::evaluator::{Evaluator, evaluator};
    #[pymodule_export]
    use super::live::View;
    #[pymodule_export]
    use super::map::Map;
    #[pymodule_export]
    use super::records::{compare, schema};
    #[pymodule_export]
    use super::robot::{Robot, robot, robots};
    #[pymodule_export]
    use super::search::Search;
    #[pymodule_export]
    use super::table::arrow_stream;
    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
