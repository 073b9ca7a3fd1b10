//! What is wrong with a file, where, and what to do about it.

use serde::Serialize;
use std::fmt;

/// An error refuses the file; a warning lets it through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    Error,
    Warning,
}

/// One fault of one file: located (line and column from 1), with what is wrong and what to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    pub severity: Severity,
    pub file: String,
    pub line: usize,
    pub column: usize,
    pub message: String,
    pub help: String,
    /// The line of the file, for the reader.
    #[serde(skip)]
    pub excerpt: String,
}

impl Fault {
    /// A fault of a file as a whole (missing, too large, not text).
    pub fn of_file(file: &str, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            file: file.to_string(),
            line: 1,
            column: 1,
            message: message.into(),
            help: help.into(),
            excerpt: String::new(),
        }
    }

    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_error() { "error" } else { "warning" };
        write!(f, "{}:{}:{}: {kind}: {}", shown(&self.file), self.line, self.column, self.message)?;
        if !self.excerpt.trim().is_empty() {
            let number = self.line.to_string();
            let caret = " ".repeat(self.column.saturating_sub(1));
            write!(f, "\n  {number} | {}\n  {:w$} | {caret}^", self.excerpt, "", w = number.len())?;
        }
        if !self.help.is_empty() {
            write!(f, "\n  help: {}", self.help)?;
        }
        Ok(())
    }
}

/// Text from a file made safe to show: control characters and the like escaped, at most 80 characters.
pub fn shown(text: &str) -> String {
    let safe: String = text
        .chars()
        .take(80)
        .flat_map(|c| {
            let plain = !c.is_control() && !is_bidi_control(c);
            let escaped = (!plain).then(|| c.escape_default());
            escaped.into_iter().flatten().chain(plain.then_some(c))
        })
        .collect();
    if text.chars().nth(80).is_some() { safe + "..." } else { safe }
}

/// Characters that reorder or hide text on a terminal.
fn is_bidi_control(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// The candidate nearest to a mistyped `word`, if one is near enough to suggest.
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(word, c), c))
        .filter(|(d, c)| *d <= (c.len().max(word.len()) / 3).max(1))
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}
