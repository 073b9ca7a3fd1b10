//! The readings of the errors against brute force, sampling, closed forms and other people's figures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
#[path = "../kinematics/product.rs"]
#[allow(dead_code)]
mod product;

mod bench;
mod norm;
mod registration;
mod sampling;
mod spread;
mod worst;
mod zonotope;
