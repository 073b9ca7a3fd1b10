//! Tests of the files, documents, reports and commands, and of the house rules. They are one program, so that
//! the library is linked once. `cargo test --test it cli::` runs the tests of one file or folder.
//!
//! All tests run in parallel in one process. None may set an environment variable or the current directory,
//! nor write outside a temporary folder of its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod architecture;
mod broken_cells;
mod charts;
mod cli;
#[path = "../common/mod.rs"]
mod common;
mod docs;
mod fuzz;
mod hostile_numbers;
mod plans;
mod records;
mod report;
mod schema;
mod schema_keys;
mod study;
mod urdf;
mod variables;
