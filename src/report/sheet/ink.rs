//! Lines and texts of a sheet, in mm on paper.

use crate::report::chart::words;
use crate::svg_text::escaped;
use std::fmt::Write;

/// Position of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAnchor {
    Start,
    Middle,
    End,
}

impl TextAnchor {
    fn word(self) -> &'static str {
        match self {
            TextAnchor::Start => "start",
            TextAnchor::Middle => "middle",
            TextAnchor::End => "end",
        }
    }
}

/// Look of a text: height of the font (mm), position, weight, and rotation (degrees, clockwise).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    pub size: f64,
    pub anchor: TextAnchor,
    pub is_bold: bool,
    pub turned: f64,
    /// Whether a white rim separates the text from the lines below it.
    pub has_rim: bool,
}

impl TextStyle {
    pub const fn plain(size: f64) -> Self {
        Self { size, anchor: TextAnchor::Start, is_bold: false, turned: 0.0, has_rim: false }
    }

    pub const fn anchored(self, anchor: TextAnchor) -> Self {
        Self { anchor, ..self }
    }

    pub const fn bold(self) -> Self {
        Self { is_bold: true, ..self }
    }

    pub const fn rimmed(self) -> Self {
        Self { has_rim: true, ..self }
    }

    /// Reduces the size until the text fits into `room` (mm).
    pub fn fitted(self, said: &str, room: f64) -> Self {
        Self { size: self.size.min(self.size * room / self.width(said).max(1e-9)), ..self }
    }

    /// Returns an upper estimate of the width of a text, mm.
    pub fn width(&self, said: &str) -> f64 {
        words::width(said, self.size) * if self.is_bold { 1.08 } else { 1.0 }
    }
}

/// Writes a text; `paint` contains further SVG attributes.
pub fn put(out: &mut String, (x, y): (f64, f64), style: TextStyle, paint: &str, said: &str) {
    let weight = if style.is_bold { " font-weight=\"600\"" } else { "" };
    let turned = match style.turned {
        0.0 => String::new(),
        angle => format!(" transform=\"rotate({angle:.2} {x:.2} {y:.2})\""),
    };
    let start = format!(
        "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{:.2}\" text-anchor=\"{}\"{weight}{turned}",
        style.size,
        style.anchor.word()
    );
    let said = escaped(said);
    // Writing to a String cannot fail. The rim is a separate text, because not every viewer supports
    // `paint-order`.
    if style.has_rim {
        let _ = writeln!(
            out,
            "{start} fill=\"none\" stroke=\"#ffffff\" stroke-width=\"0.8\" aria-hidden=\"true\">{said}</text>"
        );
    }
    let _ = writeln!(out, "{start}{paint}>{said}</text>");
}

/// Draws lines along a path; `width` is in mm.
pub fn stroke(out: &mut String, path: &str, colour: &str, width: f64) {
    let _ = writeln!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>");
}
