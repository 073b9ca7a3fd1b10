//! Tests forward and inverse kinematics and the error models against an independent D-H product, its
//! derivatives in dual numbers, references with 60 digits and cases calculated by hand.

mod derivatives;
pub mod errors;
mod general_six_axes;
mod identification;
mod inverse;
mod modified;
mod numeric;
mod offset_wrist;
pub mod product;
mod refined_solver;
mod rotations;
mod six_axes;
mod six_axes_edges;
mod six_axes_missing;
