//! The core of sweetspot: the mathematics from the model of a cell to the best layout.
//!
//! The core does no input or output. The crate `sweetspot` adds files, documents, reports and the command.
//! The documentation of that crate explains the problem and the flow of data. Separate crates can have
//! different compiler settings. The core is fully optimized. The code for files and reports is optimized
//! less, because it must compile quickly.

pub mod allocation;
pub mod assess;
pub mod calibration;
pub mod cell;
pub mod certificate;
pub mod clearance;
pub mod colours;
pub mod contour;
pub mod correction;
pub mod cycle_time;
pub mod drawing;
pub mod error_map;
pub mod geometry;
pub mod kinematic_error;
pub mod layout;
pub mod low_discrepancy;
pub mod mesh;
pub mod motion;
pub mod pose;
pub mod pose_accuracy;
pub mod proof;
pub mod raster;
pub mod reach;
pub mod reading;
pub mod region;
pub mod robot;
pub mod safe_text;
pub mod search;
pub mod svg_text;
pub mod units;
pub mod verification;
