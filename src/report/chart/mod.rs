//! The charts of a report: each a pure function from records to one `<svg>` that stands alone as a file
//! and inline in a page.
//!
//! A chart has no style element and no style attribute, which a content security policy would forbid:
//! colours are presentation attributes, and beside each stands a class (`fill-blue`, `line-grid`) by which
//! the style sheet of a page repaints it, as [`dark_rules`] does. It has no ids either, so that any number
//! of them can stand in one page.

mod axes;
mod canvas;
pub mod convergence;
pub mod heat_map;
mod iso;
mod labels;
pub mod signs;
pub mod tornado;
mod words;

pub use canvas::{Ink, dark_rules};
pub use convergence::convergence;
pub use heat_map::heat_map;
pub use tornado::tornado;

/// Every chart is drawn for so many px; it is to be scaled to what the page has.
pub const WIDTH: f64 = 720.0;
