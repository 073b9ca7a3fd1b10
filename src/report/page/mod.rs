//! Pages for the browser: the report with its 3-D viewer, the comparison, and the live page of `view`. A
//! report is one file of HTML that needs no network.
//!
//! The sections of a page are plain data made from a [`Subject`], and one template renders them. The
//! Content-Security-Policy allows only scripts and styles with known hashes. A cell file may
//! contain a name with a hidden script, but this script never runs.

mod allocated;
pub mod assets;
mod assumptions;
mod compare;
mod content;
mod cycle;
mod facts;
mod figures;
#[cfg(feature = "view")]
mod live;
mod measured;
mod nodes;
mod places;
mod quantities;
mod readings;
mod report;
mod runner_up;
mod shell;
mod size;
mod subject;
mod verdict;

pub use compare::{SearchFacts, compare};
pub use content::{NOTHING, PageFigure, PageTable, Section};
#[cfg(feature = "view")]
pub use live::live;
pub use quantities::told;
pub use report::{Report, report, sections};
pub use shell::scoped;
pub use size::{SizedPage, sized};
pub use subject::{Manifest, Subject};
pub use verdict::verdict;

use serde_json::Value;

/// Returns JSON that is safe inside `<script type="application/json">`: it cannot end the element or begin a
/// comment.
pub fn script_json(value: &Value) -> String {
    let mut safe = String::new();
    for c in value.to_string().chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe.push_str(&format!("\\u{:04x}", c as u32)),
            _ => safe.push(c),
        }
    }
    safe
}
