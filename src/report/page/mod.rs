//! What runs in the browser: the 3-D viewer and the pages round it.

pub mod assets;
mod live;
#[cfg(test)]
mod tests;

pub use live::live;

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
