//! Records to bytes: pure renderers, one per format.

pub mod csv;
pub mod envelope;
pub mod fig8;
pub mod figures;
pub mod front;
pub mod goals;
pub mod json;
mod legend;
mod names;
pub mod raster;
pub mod svg;
pub mod sweep;
pub mod text;
pub mod toml;
pub mod urdf;
mod view;
