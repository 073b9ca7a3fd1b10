//! Tests of the files, documents, reports and commands, and of the rules for the source text. They form one
//! program, so the library is linked once. The command `cargo test --test it cli::` runs the tests of one
//! file or folder.
//!
//! All tests run in parallel in one process. No test may set an environment variable or the current
//! directory, or write outside its own temporary folder.
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
