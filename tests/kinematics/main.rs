//! Forward and inverse kinematics and both error models against a D-H product written here, its
//! derivative by dual numbers, a reference in 60 digits and cases done by hand.
#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
mod errors;
mod inverse;
mod product;
