//! The charts of a report: each a pure function from records to one `<svg>` that stands alone as a file
//! and inline in a page.
//!
//! A chart has no style element and no style attribute, which a content security policy would forbid:
//! colours are presentation attributes, and beside each stands a class (`fill-blue`, `line-grid`) by which
//! the style sheet of a page repaints it, as [`dark_rules`] does. It has no ids either, so that any number
//! of them can stand in one page.

#[doc(hidden)] // open for tests/it
pub mod axes;
mod canvas;
#[doc(hidden)] // open for tests/it
pub mod colour_scale;
mod convergence;
#[doc(hidden)] // open for tests/it
pub mod difference;
mod discrepancy;
mod envelope;
mod error_map;
mod error_map_legend;
mod heat_map;
#[doc(hidden)] // open for tests/it
pub mod histogram;
#[doc(hidden)] // open for tests/it
pub mod iso;
#[doc(hidden)] // open for tests/it
pub mod labels;
mod layout;
mod misplacement;
mod pareto;
mod plane_view;
mod signs;
mod solids;
mod tornado;
#[doc(hidden)] // open for tests/it
pub mod words;

pub use canvas::{Ink, dark_rules};
pub use convergence::{Course, convergence};
pub use difference::difference;
pub use discrepancy::discrepancy;
pub use envelope::envelope;
pub use error_map::error_map;
pub use heat_map::heat_map;
pub use histogram::histogram;
pub use layout::{layout_plan, layout_section};
pub use misplacement::misplacement;
pub use pareto::pareto;
pub use tornado::tornado;

/// Every chart is drawn for so many px; it is to be scaled to what the page has.
pub const WIDTH: f64 = 720.0;
