//! Records to bytes: pure renderers, one per format.

pub mod chart;
pub mod colours;
pub mod csv;
pub mod dxf;
pub mod envelope;
pub mod fig8;
pub mod figures;
pub mod front;
pub mod glb;
pub mod json;
mod legend;
pub mod page;
pub mod parquet;
pub mod raster;
pub mod sheet;
pub mod svg;
pub mod sweep;
pub mod text;
pub mod toml;
mod view;
