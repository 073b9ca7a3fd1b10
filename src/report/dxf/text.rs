//! Texts of DXF files.

use crate::files::shown;

/// Returns the text as one line that contains no formatting code of CAD programs. Control characters are
/// escaped, and backslashes become slashes. A space follows each `^` and separates the characters of `%%`, so
/// that neither begins a code. The characters U+00B0 (degree) and U+00B1 (plus-minus) become `%%d` and `%%p`,
/// which every CAD program knows. Other characters outside ASCII become `\U+` and their code point;
/// characters beyond U+FFFF become `?`.
pub fn safe(text: &str) -> String {
    let mut safe = String::new();
    for c in shown(text).chars() {
        match c {
            '\\' => safe.push('/'),
            '^' => safe.push_str("^ "),
            '%' if safe.ends_with('%') => safe.push_str(" %"),
            '\u{b0}' => safe.push_str("%%d"),
            '\u{b1}' => safe.push_str("%%p"),
            ' '..='~' => safe.push(c),
            '\u{80}'..='\u{ffff}' => safe.push_str(&format!("\\U+{:04X}", c as u32)),
            // A `\U+` code has only four hexadecimal digits.
            _ => safe.push('?'),
        }
    }
    safe
}

/// Width of a character of the font `txt` as a multiple of its height.
const CHARACTER: f64 = 0.95;

/// Returns an upper estimate of the width of a text, in the unit of its height.
pub fn width(text: &str, height: f64) -> f64 {
    CHARACTER * height * text.chars().count() as f64
}

/// Breaks a text between words into lines of at most `most` characters. A word longer than a line gets a
/// separate line.
pub fn broken(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}
