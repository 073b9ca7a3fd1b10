//! Content of a page: sections, figures, tables.

use crate::safe_text::hides;
use serde::Serialize;

/// Section of a page with a heading.
#[derive(Debug, Clone, Serialize)]
pub struct Section {
    /// Anchor of links to the section.
    pub id: &'static str,
    pub title: String,
    /// Paragraphs of the section.
    pub text: Vec<String>,
    /// Hint on what the reader can do on a screen; empty if there is no hint.
    pub hint: &'static str,
    pub figures: Vec<PageFigure>,
    pub tables: Vec<PageTable>,
}

impl Section {
    pub fn new(id: &'static str, title: &str, text: Vec<String>) -> Self {
        Self { id, title: title.to_string(), text, hint: "", figures: Vec::new(), tables: Vec::new() }
    }

    pub fn is_empty(&self) -> bool {
        self.figures.is_empty() && self.tables.is_empty()
    }
}

/// Picture with its caption.
#[derive(Debug, Clone, Serialize)]
pub struct PageFigure {
    pub title: String,
    pub caption: String,
    /// SVG markup; names in it are escaped.
    pub svg: String,
}

impl PageFigure {
    pub fn new(title: impl Into<String>, caption: impl Into<String>, svg: String) -> Self {
        Self { title: title.into(), caption: caption.into(), svg }
    }
}

/// Table of a page: rows of text below a head.
#[derive(Debug, Clone, Serialize)]
pub struct PageTable {
    pub title: String,
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// Note below the table.
    pub note: String,
    /// For each column, whether it contains numbers. Numbers are aligned to the right.
    pub is_number: Vec<bool>,
    /// Whether the page hides the rows of the table until the reader opens it.
    pub is_folded: bool,
}

impl PageTable {
    pub fn new(title: impl Into<String>, head: &[&str], rows: Vec<Vec<String>>) -> Self {
        let head: Vec<String> = head.iter().map(|word| word.to_string()).collect();
        let is_number = (0..head.len()).map(|k| is_number(&rows, k)).collect();
        Self { title: title.into(), head, rows, note: String::new(), is_number, is_folded: false }
    }

    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    pub fn folded(mut self) -> Self {
        self.is_folded = true;
        self
    }
}

/// Text of a table cell without a value.
pub const NOTHING: &str = "–";

/// Returns whether a column contains only numbers, with or without a unit.
fn is_number(rows: &[Vec<String>], column: usize) -> bool {
    let starts = |text: &str| text.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
    let mut cells = rows.iter().filter_map(|row| row.get(column)).filter(|c| !c.is_empty() && *c != NOTHING);
    let mut some = false;
    let all = cells.all(|text| {
        some = true;
        starts(text) && text.split(' ').count() <= 2
    });
    some && all
}

/// Returns the text at full length. A blank replaces every character that a terminal or a browser would not
/// show.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || hides(c) { ' ' } else { c }).collect()
}
