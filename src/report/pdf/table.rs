//! Tables of a printed report: widths of the columns, lines of the cells.

use crate::report::chart::words;
use crate::report::page::PageTable;
use crate::report::sheet::ink::{TextAnchor, TextStyle, put, stroke};

/// Height of the font of a table, mm.
const FONT: f64 = 2.5;
/// Height of the font of a table that would otherwise be too wide, mm.
const SMALL: f64 = 2.0;
/// Distance between two columns, mm.
const GAP: f64 = 2.5;
/// Distance between successive lines of a table cell as a multiple of the height of the font.
const LEADING: f64 = 1.35;
/// Space above and below the text of a row, mm.
const PADDING: f64 = 0.5;

/// Table with the widths of its columns and the lines of its cells.
pub struct TypesetTable {
    size: f64,
    widths: Vec<f64>,
    is_number: Vec<bool>,
    head: Vec<Vec<String>>,
    rows: Vec<Vec<Vec<String>>>,
}

impl TypesetTable {
    pub fn new(table: &PageTable, room: f64) -> Self {
        let natural = |size: f64| natural_widths(table, size);
        let total = |widths: &[f64]| widths.iter().sum::<f64>() + GAP * widths.len().saturating_sub(1) as f64;
        // The texts of a single wide column are broken into lines. If the other columns alone take more than
        // 60 % of the width, the table gets a smaller font.
        let full = natural(FONT);
        let others = total(&full) - full.iter().copied().fold(0.0, f64::max);
        let size = if total(&full) <= room || others <= 0.6 * room { FONT } else { SMALL };
        let mut widths = natural(size);
        // Wide columns are narrowed step by step, and their texts get more lines.
        while total(&widths) > room {
            let Some(widest) = widths.iter_mut().max_by(|a, b| a.total_cmp(b)) else { break };
            if *widest < 4.0 * size {
                break;
            }
            *widest *= 0.95;
        }
        let broken = |row: &Vec<String>, is_head: bool| {
            let share = if is_head { 1.08 } else { 1.0 };
            let cell = |(text, width): (&String, &f64)| match words::wrapped(
                text,
                size * share,
                *width + 0.01,
                usize::MAX,
            ) {
                lines if lines.is_empty() => vec![String::new()],
                lines => lines,
            };
            row.iter().zip(&widths).map(cell).collect::<Vec<_>>()
        };
        Self {
            size,
            head: broken(&table.head, true),
            rows: table.rows.iter().map(|row| broken(row, false)).collect(),
            is_number: table.is_number.clone(),
            widths,
        }
    }

    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    fn height(&self, cells: &[Vec<String>]) -> f64 {
        let lines = cells.iter().map(Vec::len).max().unwrap_or(1);
        self.size * LEADING * lines as f64 + 2.0 * PADDING
    }

    pub fn row_height(&self, row: usize) -> f64 {
        self.height(&self.rows[row])
    }

    /// Returns the height of the head and the first two rows, mm. These rows stay with the head.
    pub fn least_height(&self) -> f64 {
        self.height(&self.head) + self.rows.iter().take(2).map(|row| self.height(row)).sum::<f64>()
    }

    /// Draws the head with a line below it; a table whose columns have no names has only the line.
    pub fn draw_head(&self, out: &mut String, left: f64, y: &mut f64) {
        if self.head.iter().flatten().any(|line| !line.is_empty()) {
            self.draw(out, (left, y), &self.head, true);
        }
        stroke(out, &format!("M{left} {:.2}h{:.2}", *y, self.width()), "#000000", 0.25);
    }

    pub fn draw_row(&self, out: &mut String, left: f64, y: &mut f64, row: usize) {
        self.draw(out, (left, y), &self.rows[row], false);
        stroke(out, &format!("M{left} {:.2}h{:.2}", *y, self.width()), "#d0d7de", 0.1);
    }

    fn width(&self) -> f64 {
        self.widths.iter().sum::<f64>() + GAP * self.widths.len().saturating_sub(1) as f64
    }

    fn draw(&self, out: &mut String, (left, y): (f64, &mut f64), cells: &[Vec<String>], is_head: bool) {
        let pitch = self.size * LEADING;
        let mut x = left;
        for (k, lines) in cells.iter().enumerate() {
            let width = self.widths[k];
            let is_number = self.is_number.get(k).copied().unwrap_or_default();
            let (at, anchor) = if is_number { (x + width, TextAnchor::End) } else { (x, TextAnchor::Start) };
            for (n, line) in lines.iter().enumerate().filter(|(_, line)| !line.is_empty()) {
                let style = TextStyle::plain(self.size).anchored(anchor);
                let style = if is_head { style.bold() } else { style };
                put(out, (at, *y + PADDING + pitch * (n as f64 + 0.8)), style, "", line);
            }
            x += width + GAP;
        }
        *y += self.height(cells);
    }
}

/// Returns the natural width of every column, mm: the larger of the widths of its widest cell and its head.
/// Only a head that is wider than 8 font heights may be broken between words.
fn natural_widths(table: &PageTable, size: f64) -> Vec<f64> {
    let of_head = |word: &str| 1.08 * words::width(word, size);
    let column = |(k, head): (usize, &String)| {
        let cells = table.rows.iter().filter_map(|row| row.get(k)).map(|cell| words::width(cell, size));
        let widest = cells.fold(0.0, f64::max);
        let longest_word = head.split(' ').map(of_head).fold(0.0, f64::max);
        widest.max(longest_word).max(of_head(head).min(8.0 * size))
    };
    table.head.iter().enumerate().map(column).collect()
}
