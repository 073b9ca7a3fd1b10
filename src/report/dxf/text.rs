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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_name_is_a_command() {
        let cases = [
            ("table", "table"),
            ("a\r\n  0\r\nEOF", "a/r/n  0/r/nEOF"),
            ("%%c 50%%%", "% %c 50% % %"),
            ("caret ^J", "caret ^ J"),
            ("\\P \\U+0041", "/P /U+0041"),
            ("T\u{fc}r \u{1f916}", "T\\U+00FCr ?"),
            ("\u{1b}[2J\u{0}", "/u{1b}[2J/u{0}"),
            ("\u{202e}x", "/u{202e}x"),
        ];
        for (name, written) in cases {
            assert_eq!(safe(name), written);
            assert!(!safe(name).contains("%%") && safe(name).is_ascii());
        }
    }
}
