//! Faults of files: what is wrong, where, and what to do.

use super::content::{FileContent, not_needed};
use crate::safe_text::hides;
pub use crate::safe_text::shown;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Severity of a fault. An error makes the file invalid; a warning does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    Error,
    Warning,
}

/// Kind of a fault. The kind decides the exit code and whether a command prints a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FaultKind {
    /// Wrong content, or an unreadable file other than the cell or robot file.
    #[default]
    Content,
    /// The cell or robot file itself cannot be read.
    Unreadable,
    /// The content of the file given as the cell or robot file shows that this file is of another kind.
    Foreign(FileContent),
    /// Warning from the import of a URDF. Only a few commands print this warning, because it stays the same
    /// until the URDF changes.
    Import,
}

/// Fault in one file: where it is, what is wrong and what to do. Lines and columns count from 1.
///
/// A setting on the command line has no position in a file. If the fault is in such a setting, `file` holds
/// the setting as typed, and line and column are zero.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    pub severity: Severity,
    pub file: String,
    pub line: usize,
    pub column: usize,
    pub message: String,
    pub help: String,
    #[serde(skip)]
    pub kind: FaultKind,
    /// Path of the faulty mesh if the fault concerns a mesh of a URDF; None for any other fault.
    #[serde(skip)]
    pub mesh: Option<String>,
    /// Line of the file that contains the fault, for display. A long line is cut to the part around the
    /// fault.
    #[serde(skip)]
    pub excerpt: String,
    /// Position of the fault in the excerpt: the number of characters before it.
    #[serde(skip)]
    pub caret: usize,
}

impl Fault {
    /// Returns an error that concerns a file as a whole (missing, too large, not text).
    pub fn of_file(file: &str, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            kind: FaultKind::Content,
            mesh: None,
            file: file.to_string(),
            line: 1,
            column: 1,
            message: message.into(),
            help: help.into(),
            excerpt: String::new(),
            caret: 0,
        }
    }

    /// Returns the error for a cell or robot file that cannot be read.
    pub fn unreadable(file: &str, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { kind: FaultKind::Unreadable, ..Self::of_file(file, message, help) }
    }

    /// Returns the error for the case that the file given as the cell or robot file is of another kind. The
    /// help text of the error states what the user can do with the file.
    pub fn foreign(path: &str, content: FileContent, needed: &str) -> Self {
        let fault = Self::of_file(path, not_needed(path, content, needed), content.next_step(&shown(path)));
        Self { kind: FaultKind::Foreign(content), ..fault }
    }

    /// Returns an error at a byte offset of the text of a file.
    pub fn in_text(file: &str, text: &str, offset: usize, message: String, help: String) -> Self {
        let offset = (0..=offset.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0);
        let start = text[..offset].rfind('\n').map_or(0, |i| i + 1);
        let line = text[..start].matches('\n').count() + 1;
        let before = text[start..offset].chars().count();
        let skipped = if before > WIDEST { before - WIDEST / 2 } else { 0 };
        let shown = text[start..].lines().next().unwrap_or("").chars().skip(skipped).take(WIDEST + 20);
        let blank = |c: char| if c.is_control() || hides(c) { ' ' } else { c };
        let cut = if skipped > 0 { "..." } else { "" };
        let excerpt = cut.chars().chain(shown.map(blank)).collect();
        let caret = before - skipped + cut.len();
        Self { line, column: before + 1, excerpt, caret, ..Self::of_file(file, message, help) }
    }

    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// Largest number of characters shown before the fault. If more characters precede the fault, the start of
/// the line is cut off.
const WIDEST: usize = 100;

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_error() { "error" } else { "warning" };
        write!(f, "{}:", shown(&self.file))?;
        if self.line > 0 {
            write!(f, "{}:{}:", self.line, self.column)?;
        }
        write!(f, " {kind}: {}", self.message)?;
        if !self.excerpt.trim().is_empty() {
            let number = self.line.to_string();
            let caret = " ".repeat(self.caret);
            write!(f, "\n  {number} | {}\n  {:w$} | {caret}^", self.excerpt, "", w = number.len())?;
        }
        if !self.help.is_empty() {
            write!(f, "\n  help: {}", self.help)?;
        }
        Ok(())
    }
}

/// Returns at most 20 names as a list for a help text, and "..." if there are more.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names: Vec<_> = names.into_iter().take(21).map(shown).collect();
    match names.len() {
        0 => return "none".into(),
        21 => names[20] = "...".into(),
        _ => {}
    }
    names.join(", ")
}

/// Largest number of names that are compared with a mistyped name.
const MAX_CANDIDATES: usize = 100;

/// Returns the candidate nearest to a mistyped `word`; None if no candidate is near enough to suggest.
///
/// A candidate is near if it differs from `word` by only a few letters. A candidate is also near if it names
/// the same quantity in another unit or without a unit (`x_m` or `x` for `x_mm`).
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    let quantity = word.rsplit_once('_').map_or(word, |(stem, _)| stem);
    let distance = |c: &str| {
        let stem = c.strip_suffix("_mm").or(c.strip_suffix("_deg"));
        if stem.is_some_and(|s| s == word || s == quantity) {
            return Some((0, 0));
        }
        let other = c.chars().count();
        let most = (length.max(other) / 3).max(1);
        // The edit distance needs a table whose size is the product of both lengths, so long words are
        // skipped.
        let comparable = length.max(other) <= 100 && length.abs_diff(other) <= most;
        let apart = comparable.then(|| strsim::damerau_levenshtein(word, c))?;
        // Many candidates differ by few letters from a short word. The second condition refuses most of them:
        // for example, `cm` must not suggest `mm`.
        let near = apart <= most && (2 * apart < length || sorted(word) == sorted(c));
        near.then_some((apart, length.abs_diff(other)))
    };
    let candidates = candidates.into_iter().take(MAX_CANDIDATES);
    candidates.filter_map(|c| Some((distance(c)?, c))).min_by_key(|(d, _)| *d).map(|(_, c)| c)
}

fn sorted(word: &str) -> Vec<char> {
    let mut letters: Vec<_> = word.chars().collect();
    letters.sort_unstable();
    letters
}
