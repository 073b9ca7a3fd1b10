//! Display of text from files: the text can neither send control codes to a terminal nor flood it.

/// Returns text from a file in a form that is safe to display.
///
/// Special characters are escaped. At most 80 characters are kept, and a longer text ends with "...".
pub fn shown(text: &str) -> String {
    let safe: String = text
        .chars()
        .take(80)
        .flat_map(|c| {
            let plain = !c.is_control() && !hides(c);
            let escaped = (!plain).then(|| c.escape_default());
            escaped.into_iter().flatten().chain(plain.then_some(c))
        })
        .collect();
    if text.chars().nth(80).is_some() { safe + "..." } else { safe }
}

/// Returns whether a character reorders or hides text on a terminal.
pub fn hides(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}
