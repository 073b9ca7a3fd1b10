//! Charts of a report. Each chart is a pure function that converts records to one `<svg>` element. This
//! element can be a file of its own or an inline part of a page.
//!
//! A chart has neither a style element nor a style attribute, because a Content-Security-Policy would forbid
//! them. Colours are presentation attributes. An element with such a colour also has a class, for example
//! `fill-blue` or `line-grid`. The style sheet of a page can repaint all elements of a class, as
//! [`dark_rules`] does.

mod allocation;
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
mod error_map_picture;
mod heat_map;
#[doc(hidden)] // open for tests/it
pub mod histogram;
#[doc(hidden)] // open for tests/it
pub mod iso;
mod joint_residuals;
#[doc(hidden)] // open for tests/it
pub mod labels;
mod layout;
mod measured;
mod misplacement;
mod pareto;
mod plane_view;
mod residuals;
mod signs;
mod solids;
mod tornado;
#[doc(hidden)] // open for tests/it
pub mod words;

pub use allocation::allocation;
pub use canvas::{Ink, dark_rules};
pub use convergence::{ConvergenceHistory, convergence};
pub use difference::difference;
pub use discrepancy::discrepancy;
pub use envelope::envelope;
pub use error_map::error_map;
pub use heat_map::heat_map;
pub use histogram::histogram;
pub use joint_residuals::joint_residuals;
pub use layout::{layout_plan, layout_section};
pub use measured::measured;
pub use misplacement::misplacement;
pub use pareto::pareto;
pub use residuals::residuals;
pub use tornado::tornado;

/// Width of a chart, px; a page scales the chart to the width of the page.
pub const WIDTH: f64 = 720.0;
