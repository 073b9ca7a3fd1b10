//! Records to bytes: pure renderers, one per format.

pub mod chart;
pub mod colours;
pub mod csv;
pub mod envelope;
pub mod fig8;
pub mod front;
pub mod goals;
pub mod json;
mod legend;
mod names;
pub mod page;
pub mod svg;
pub mod sweep;
pub mod text;
pub mod toml;
pub mod urdf;
mod view;
