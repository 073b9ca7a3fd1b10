//! Solids and floor spaces on a plan: how each kind of part looks, and its entry in a legend.

use super::canvas::{Ink, LegendEntry};
use crate::drawing::PartKind;
use crate::svg_text::{PathEnd, path_data};

/// Kinds of parts in the order in which they are drawn.
pub const KINDS: [PartKind; 7] = [
    PartKind::Fence,
    PartKind::KeepOut,
    PartKind::Equipment,
    PartKind::Obstacle,
    PartKind::HeldPart,
    PartKind::Robot,
    PartKind::Tool,
];

/// Returns the position of a kind in the order of drawing, [`KINDS`].
pub fn rank(kind: PartKind) -> usize {
    KINDS.iter().position(|k| *k == kind).unwrap_or(KINDS.len())
}

/// Returns the fill and line attributes of a kind of part. The fill of a part covers the inner half of its
/// line. The line of a filled part is therefore drawn twice as wide as it looks.
fn look(kind: PartKind) -> (String, String) {
    let none = "fill=\"none\"".to_string();
    match kind {
        PartKind::Equipment => (Ink::Ground.fill(), Ink::Faint.line(2.4)),
        PartKind::Obstacle => (Ink::Grid.fill(), Ink::Faint.line(2.4)),
        PartKind::Fence => (none, Ink::Text.line(1.8)),
        PartKind::KeepOut => (none, format!("{} stroke-dasharray=\"6 4\"", Ink::Vermilion.line(1.6))),
        PartKind::HeldPart => (Ink::Purple.fill(), Ink::Faint.line(2.0)),
        PartKind::Robot => (Ink::Orange.fill(), Ink::Faint.line(2.0)),
        PartKind::Tool => (Ink::Vermilion.fill(), Ink::Faint.line(2.0)),
    }
}

/// Returns SVG paths of closed rings (px): the line, then the fill over it. The fill follows the `nonzero`
/// rule of SVG.
pub fn drawn(rings: impl Iterator<Item = Vec<(f64, f64)>>, kind: PartKind) -> String {
    let d: String = rings.map(|ring| path_data(ring.into_iter(), PathEnd::Closed, 1)).collect();
    if d.is_empty() {
        return String::new();
    }
    let (fill, line) = look(kind);
    format!("<path d=\"{d}\" {line} stroke-linejoin=\"round\"/><path d=\"{d}\" {fill}/>")
}

/// Returns the legend entry of a kind.
pub fn entry(kind: PartKind) -> LegendEntry {
    let square = vec![(-9.0, -5.0), (9.0, -5.0), (9.0, 5.0), (-9.0, 5.0)];
    LegendEntry { mark: drawn([square].into_iter(), kind), said: kind.name().into() }
}
