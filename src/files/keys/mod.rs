//! Readers of the keys of each kind of file, one file per table.

pub mod attitude;
pub mod cell;
pub mod constraints;
pub mod coordinate;
pub mod covariance;
pub mod equipment;
pub mod error_set;
pub mod frame;
pub mod misplacement;
pub mod operation;
pub mod place;
pub mod robot;
pub mod rows;
pub mod sense;
pub mod solid;
pub mod teach;
pub mod tolerance;
pub mod tool;
