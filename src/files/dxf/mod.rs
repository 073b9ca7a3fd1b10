//! Reader of floor plans: closed outlines on named layers of a DXF drawing (ASCII), as bodies of a given
//! height.
//!
//! The reader supports LWPOLYLINE, POLYLINE, CIRCLE, LINE and ARC, in blocks and in the model space. Open
//! lines whose ends meet form outlines, too. Other entities on the named layers are reported. The group codes
//! follow Autodesk's DXF reference. Each submodule declares the limits that it applies.

mod bodies;
mod chords;
mod convex;
mod drawing;
mod entities;
mod expand;
mod joined;
mod outlines;
mod pairs;
mod unit;

pub use bodies::{PlanBody, bodies};
pub use drawing::PlanDrawing;
pub use outlines::{FloorOutline, OutlineShape, outlines};
pub use unit::DrawingUnit;

/// Fault or warning about a drawing, with its line in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct DxfFault {
    /// Line of the file, counted from 0.
    pub line: usize,
    pub message: String,
    pub help: String,
}

impl DxfFault {
    fn new(line: usize, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { line, message: message.into(), help: help.into() }
    }
}

/// Returns the text of a drawing, decoded as UTF-8. If the bytes are not UTF-8, they are decoded as ISO
/// 8859-1, which older drawings use.
pub fn text_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    }
}
