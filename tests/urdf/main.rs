//! Robots from URDF files: the derived rows move as the URDF does, the same robot gives the same map,
//! and hostile files are refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod chains;
#[path = "../common/mod.rs"]
mod common;
mod faults;
mod hostile;
mod product;
mod same_map;
