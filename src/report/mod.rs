//! Conversion of records and drawings to the bytes or the text of files and pages. This module neither reads
//! nor writes files.

pub mod allocated_table;
pub mod chart;
pub mod controller;
pub mod correction;
pub mod csv;
pub mod dxf;
pub mod error_table;
pub mod figures;
pub mod glb;
pub mod identifiers;
pub mod json;
pub mod layout_frames;
pub mod measured;
pub mod measured_errors;
pub mod measuring_plan;
pub mod moveit;
pub mod page;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "pdf")]
pub mod pdf;
pub mod scene_objects;
pub mod sheet;
pub mod sweep;
pub mod text;
pub mod toml;
pub mod urdf;
