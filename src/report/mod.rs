//! Pure renderers from records to bytes, one per format.

pub mod chart;
pub mod colours;
pub mod csv;
pub mod dxf;
pub mod figures;
pub mod glb;
pub mod json;
pub mod page;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod raster;
pub mod sheet;
#[doc(hidden)] // open for tests/it
pub mod silhouette;
mod svg_text;
pub mod sweep;
pub mod text;
pub mod toml;
