//! Pure renderers from records to bytes, one per format.

pub mod allocated_table;
pub mod chart;
pub mod correction;
pub mod csv;
pub mod dxf;
pub mod error_table;

pub mod figures;
pub mod glb;
pub mod json;
pub mod measured;
pub mod measured_errors;
pub mod measuring_plan;
pub mod page;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "pdf")]
pub mod pdf;
pub mod sheet;
pub mod sweep;
pub mod text;
pub mod toml;
