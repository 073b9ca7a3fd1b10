//! Texts of DXF files.

use crate::files::shown;

/// Returns the text as one line that contains no formatting code of CAD programs. Control characters are
/// escaped, backslashes become slashes, and a space breaks `^` and `%%` codes. Characters outside ASCII
/// become `\U+` and their code point; those beyond U+FFFF become `?`.
pub fn safe(text: &str) -> String {
    let mut safe = String::new();
    for c in shown(text).chars() {
        match c {
            '\\' => safe.push('/'),
            '^' => safe.push_str("^ "),
            '%' if safe.ends_with('%') => safe.push_str(" %"),
            ' '..='~' => safe.push(c),
            '\u{80}'..='\u{ffff}' => safe.push_str(&format!("\\U+{:04X}", c as u32)),
            // A `\U+` code has only four hexadecimal digits.
            _ => safe.push('?'),
        }
    }
    safe
}
