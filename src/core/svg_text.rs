//! Text and path data that are safe to write into SVG.

use crate::units::rounded;
use std::fmt::Write;

/// Escapes a text for use in markup.
///
/// U+FFFE, U+FFFF and control characters other than tab and line breaks become U+FFFD.
pub fn escaped(text: &str) -> String {
    let is_bad =
        |c: char| c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.replace(is_bad, "\u{fffd}")
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// End of a path: open, or closed by a line to the first point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnd {
    Open,
    Closed,
}

/// Returns the path data of a polyline, with at most `decimals` decimal places. The result is empty if there
/// are no points.
pub fn path_data(points: impl Iterator<Item = (f64, f64)>, end: PathEnd, decimals: i32) -> String {
    let mut d = String::new();
    for (k, (x, y)) in points.enumerate() {
        let letter = if k == 0 { 'M' } else { 'L' };
        // Writing to a String cannot fail.
        let _ = write!(d, "{letter}{} {}", rounded(x, decimals), rounded(y, decimals));
    }
    if end == PathEnd::Closed && !d.is_empty() {
        d.push('Z');
    }
    d
}
