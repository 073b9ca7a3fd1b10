//! Tests forward and inverse kinematics and the error models against a D-H product written here, its
//! derivatives by dual numbers, references in 60 digits and cases done by hand.

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
