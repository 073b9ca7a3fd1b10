//! Tests the formats of a report, each by itself.

mod colours;
mod controller;
mod dxf;
mod page;
pub mod planar_face;
mod raster;
mod sheet;
mod signs;
mod simplified;
