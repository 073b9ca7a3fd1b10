//! Readers of each kind of file. The readers convert trees of TOML values to the model of the cell. Tables of
//! keys define names, kinds and ranges.

pub mod attitude;
pub mod cell;
pub mod constraints;
pub mod coordinate;
mod cost;
pub mod covariance;
pub mod elastic;
mod equipment;
pub mod error_set;
pub mod frame_error;
pub mod header;
pub mod joint;
mod measured_ranges;
pub mod operation;
mod periodic;
pub mod place;
pub mod placement;
mod plan;
pub mod plausible;
pub mod question;
mod rate;
pub mod robot;
pub mod row_order;
pub mod sense;
pub mod solid;
pub mod teach;
pub mod tolerance;
pub mod tool;
