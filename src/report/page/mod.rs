//! What runs in the browser: the report, one page of HTML that needs nothing else, not even a network, the
//! 3-D viewer in it, and the live page of `view`.
//!
//! A [`Subject`] is what is reported; the sections of the page are plain data made from it, and one
//! template puts them into markup. Script and style are inside and named by their hashes in the
//! Content-Security-Policy, so that nothing else runs, whatever a name in a file says.

pub mod assets;
mod assumptions;
mod compare;
mod content;
mod figures;
#[cfg(feature = "view")]
mod live;
mod nodes;
mod places;
mod readings;
mod report;
mod runner_up;
mod shell;
mod subject;
mod verdict;

pub use compare::{Told, compare};
pub use content::{PageFigure, PageTable, Section};
#[cfg(feature = "view")]
pub use live::live;
pub use report::{Report, report};
pub use subject::{Manifest, Subject};

use serde_json::Value;

/// JSON that is safe inside `<script type="application/json">`: no text in it can end the element or
/// begin a comment.
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
