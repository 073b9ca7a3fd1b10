//! Forward and inverse kinematics and the error models against a D-H product written here, its
//! derivatives by dual numbers, references in 60 digits and cases done by hand.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;
mod derivatives;
mod errors;
mod identification;
mod inverse;
mod modified;
mod numeric;
mod product;
mod rotations;
mod six_axes;
mod six_axes_edges;
mod six_axes_missing;
#[path = "../common/ur.rs"]
mod ur;
