//! Tests of the mathematics. They belong to the package `sweetspot-core`, which the compiler optimizes,
//! because many of them need much computing time. The command `cargo test --test maths clearance::` runs the
//! tests of one file or folder.
//!
//! The tests read cells with the package `sweetspot`. All tests run in parallel in one process, so no test
//! may set an environment variable or the current directory.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod allocation;
mod assessment;
mod attitude;
mod bound;
mod bound_conditions;
mod calibration;
mod cells;
mod certificate;
mod clearance;
#[path = "../common/mod.rs"]
mod common;
mod compare;
mod correction;
mod cycle_time;
mod drawing;
mod elastic;
mod envelope;
mod families;
mod front;
mod heights;
mod hypotheses;
mod islands;
mod jacobian_change;
mod kinematics;
mod layout;
mod library;
mod low_discrepancy;
mod measured_robots;
mod measuring_plan;
mod meshes;
mod misfit;
mod motion;
mod moving;
mod optimum;
mod paper;
mod parry;
mod pedestal;
mod peers;
mod pose_accuracy;
mod proof;
mod ranking;
mod reach;
mod readings;
mod redundant_coordinates;
mod regions;
mod relative;
mod resume;
mod robust;
mod search;
mod solvers;
mod value_field;
mod verification;
