//! Tests each format of a report separately.

mod colours;
mod controller;
mod dxf;
mod page;
pub mod planar_face;
mod raster;
mod sheet;
mod signs;
mod simplified;
