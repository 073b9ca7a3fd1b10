//! Text tables: columns as wide as their widest cell.

use std::fmt::Write;

/// Table of text cells. The first `left` columns are aligned left, all other columns right.
pub struct TextTable {
    rows: Vec<Vec<String>>,
    left: usize,
    indent: &'static str,
}

impl TextTable {
    /// Makes an empty table whose first `left` columns are aligned left.
    pub fn new(left: usize) -> Self {
        Self { rows: Vec::new(), left, indent: "" }
    }

    /// Makes an empty table that is indented under a heading; its first `left` columns are aligned left.
    pub fn indented(left: usize) -> Self {
        Self { indent: "  ", ..Self::new(left) }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Adds a row that begins with a group and a label.
    pub fn labelled(&mut self, group: &str, label: &str, cells: impl Iterator<Item = String>) {
        self.row([group.to_string(), label.to_string()].into_iter().chain(cells));
    }

    /// Returns the rows as they were added.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Returns the table as aligned text.
    pub fn render(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let cell_width = |row: &Vec<String>, k: usize| row.get(k).map_or(0, |c| c.chars().count());
        let widths: Vec<usize> =
            (0..columns).map(|k| self.rows.iter().map(|r| cell_width(r, k)).max().unwrap_or(0)).collect();
        let mut out = String::new();
        for row in &self.rows {
            let mut line = self.indent.to_string();
            for (k, cell) in row.iter().enumerate() {
                let width = widths[k];
                // Writing to a String cannot fail.
                let _ = match k < self.left {
                    true => write!(line, "{cell:<width$}  "),
                    false => write!(line, "{cell:>width$}   "),
                };
            }
            let _ = writeln!(out, "{}", line.trim_end());
        }
        out
    }
}
