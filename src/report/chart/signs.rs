//! Symbols on a chart, for unusable nodes and for spots.

use super::canvas::{Ink, LegendEntry};
use crate::cell::NodeAggregation;
use crate::drawing::{GlyphRing, GlyphTone, NodeGlyph, node_glyph};
use crate::error_map::NodeSign;
use crate::svg_text::{PathEnd, path_data};
use std::f64::consts::SQRT_2;

/// Returns the symbol that shows why a node cannot be used, centred on a point and about `2 r` wide.
/// Returns an empty text for a usable node.
pub fn sign(sign: NodeSign, at: (f64, f64), r: f64) -> String {
    node_glyph(sign).map_or(String::new(), |glyph| draw_glyph(&glyph, at, r))
}

fn draw_glyph(glyph: &NodeGlyph, at: (f64, f64), r: f64) -> String {
    let paint = match glyph.tone {
        GlyphTone::Quiet => Ink::Faint.line(1.3),
        GlyphTone::Warning => Ink::Orange.line(1.8),
        GlyphTone::Alarm => Ink::Vermilion.line(1.6),
    };
    let circle = match glyph.ring {
        GlyphRing::None => String::new(),
        GlyphRing::Full => ring(at, r, &paint),
        GlyphRing::Dashed => ring(at, r, &format!("{paint} stroke-dasharray=\"2 1.6\"")),
    };
    let reach = SQRT_2 * r;
    let stroke = |points: &&[(f64, f64)]| {
        let points: Vec<_> = points.iter().map(|(x, y)| (x * reach, y * reach)).collect();
        path(at, &points, &paint)
    };
    circle + &glyph.strokes.iter().map(stroke).collect::<String>()
}

/// Returns the name of the node that the ring marks.
pub fn ring_name(over: NodeAggregation) -> &'static str {
    match over {
        NodeAggregation::Best => "chosen spot",
        NodeAggregation::Max => "worst node, which gives the value of the operation",
        NodeAggregation::Mean | NodeAggregation::P95 => "worst node",
    }
}

/// Returns the ring that marks the spot.
pub fn spot(at: (f64, f64)) -> String {
    ring(at, 8.0, &Ink::Paper.line(5.0)) + &ring(at, 8.0, &Ink::Spot.line(2.4))
}

/// Returns the diamond that marks the spot refined between the nodes.
pub fn refined(at: (f64, f64)) -> String {
    let corners = [(-5.0, 0.0), (0.0, 5.0), (5.0, 0.0), (0.0, -5.0), (-5.0, 0.0), (0.0, 5.0)];
    path(at, &corners, &Ink::Paper.line(4.5)) + &path(at, &corners, &Ink::Spot.line(2.0))
}

/// Returns the dashed ring that marks the spot under a reading other than the reading of the cell.
pub fn other_spot(at: (f64, f64)) -> String {
    let dashed = format!("{} stroke-dasharray=\"4 3\"", Ink::Text.line(2.0));
    ring(at, 8.0, &Ink::Paper.line(5.0)) + &ring(at, 8.0, &dashed)
}

/// Returns one legend entry per symbol that occurs, with the number of its nodes. Usable nodes get no entry.
pub fn entries(signs: impl Iterator<Item = NodeSign>) -> Vec<LegendEntry> {
    let all: Vec<NodeSign> = signs.collect();
    let entry = |known: NodeSign| {
        let glyph = node_glyph(known)?;
        let count = all.iter().filter(|s| **s == known).count();
        let mark = draw_glyph(&glyph, (0.0, 0.0), 5.0);
        (count > 0).then(|| LegendEntry { mark, said: format!("{} ({count})", known.label()) })
    };
    NodeSign::ALL.into_iter().filter_map(entry).collect()
}

fn ring((x, y): (f64, f64), r: f64, paint: &str) -> String {
    format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" {paint}/>")
}

fn path((x, y): (f64, f64), points: &[(f64, f64)], paint: &str) -> String {
    let d = path_data(points.iter().map(|(dx, dy)| (x + dx, y + dy)), PathEnd::Open, 1);
    format!("<path d=\"{d}\" {paint}/>")
}
