//! Text that a DXF file can hold.

use crate::files::shown;

/// Text of one line without anything that a CAD program reads as a command: no control characters, no
/// `%%` and `^` codes, no backslashes; what is not ASCII as `\U+` and its number.
pub fn safe(text: &str) -> String {
    let mut safe = String::new();
    for c in shown(text).chars() {
        match c {
            '\\' => safe.push('/'),
            '^' => safe.push_str("^ "),
            '%' if safe.ends_with('%') => safe.push_str(" %"),
            ' '..='~' => safe.push(c),
            '\u{80}'..='\u{ffff}' => safe.push_str(&format!("\\U+{:04X}", c as u32)),
            // No room for more than four digits.
            _ => safe.push('?'),
        }
    }
    safe
}
