//! Texts of DXF files.

use crate::files::shown;

/// Returns a text of one line without anything that a CAD program reads as a command: control characters,
/// `%%` and `^` codes, backslashes. Other characters than ASCII become `\U+` and their number.
pub fn safe(text: &str) -> String {
    let mut safe = String::new();
    for c in shown(text).chars() {
        match c {
            '\\' => safe.push('/'),
            '^' => safe.push_str("^ "),
            '%' if safe.ends_with('%') => safe.push_str(" %"),
            ' '..='~' => safe.push(c),
            '\u{80}'..='\u{ffff}' => safe.push_str(&format!("\\U+{:04X}", c as u32)),
            // The code has room for four digits alone.
            _ => safe.push('?'),
        }
    }
    safe
}
