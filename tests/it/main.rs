//! Every test but those of tests/allocation.rs, which counts what its own process allocates. They are one
//! program, so that the library is linked once. `cargo test --test it clearance::` runs the tests of one file
//! or folder.
//!
//! All tests run in parallel in one process. None may set an environment variable or the current directory,
//! nor write outside a temporary folder of its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod architecture;
mod assessment;
mod attitude;
mod bound;
mod broken_cells;
mod calibration;
mod cells;
mod charts;
mod clearance;
mod cli;
mod common;
mod compare;
mod drawing;
mod envelope;
mod families;
mod front;
mod fuzz;
mod hostile_numbers;
mod kinematics;
mod layout;
mod library;
mod low_discrepancy;
mod meshes;
mod motion;
mod moving;
mod optimum;
mod paper;
mod parry;
mod peers;
mod proof;
mod ranking;
mod reach;
mod readings;
mod records;
mod report;
mod resume;
mod robust;
mod schema;
mod schema_keys;
mod search;
mod solvers;
mod urdf;
mod variables;
