//! Title and legend of a picture: the meaning of colours, arrows and symbols.

use super::ink::PixelImage;
use super::palette::{Colour, Palette, hex, scale as colour_of};
use super::scale::Show;
use super::{FittedScene, Shot, font};
use crate::cell::Unit;
use crate::drawing::round_numbers::{ONE_TWO_FIVE, round_down};
use crate::drawing::{Drawing, Field, GlyphRing, GlyphStroke, NodeGlyph, node_glyph};
use crate::error_map::NodeSign;
use crate::safe_text::shown;
use crate::svg_text::escaped;
use crate::units::{m_from_mm, mm_from_m};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Height of the legend, as a multiple of the height of capital letters.
pub const HEIGHT: f64 = 8.6;

/// Ratio of the SVG font size to the height of capital letters.
pub const TEXT: f64 = 1.38;

/// Symbol of the picture that the legend explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LegendSign {
    Spot,
    /// Node with the greatest value of an operation that happens at every node.
    WorstNode,
    /// Glyph of a class of unusable nodes. The [`NodeSign`] states why these nodes are unusable.
    Node(NodeSign),
    Envelope,
}

impl LegendSign {
    /// Returns the text of the symbol in the legend.
    pub fn label(self) -> &'static str {
        match self {
            Self::Spot => "chosen spot",
            Self::WorstNode => "worst node",
            Self::Node(sign) => sign.label(),
            Self::Envelope => "reach of the arm",
        }
    }
}

/// Scale bar that states the length of the arrows.
pub struct ArrowScale {
    /// Length of the bar, m in the world.
    pub length: f64,
    /// What the arrows show, and their factor.
    pub heading: String,
    /// Error that the bar represents.
    pub error: String,
}

/// Content of the title and the legend.
pub struct LegendTexts {
    pub title: String,
    pub line: String,
    /// Texts of the colour scale (heading, least value and greatest value); None if the picture has no colour
    /// scale.
    pub colours: Option<[String; 3]>,
    /// Scale bar of the arrows; None if the picture has no arrows.
    pub arrows: Option<ArrowScale>,
    pub signs: Vec<LegendSign>,
}

impl LegendTexts {
    /// Returns the texts of the title and the legend of a picture.
    pub fn of(drawing: &Drawing<'_>, stage: &FittedScene, shot: &Shot) -> Self {
        let (cell, lens) = (drawing.cell, drawing.lenses[shot.take]);
        let is_map = shot.show != Show::Nothing;
        let model = format!(
            ", error set {}, {} model, {}",
            shown(cell.error_set().name()),
            lens.model.name(),
            lens.reading_word()
        );
        let line = format!("{}{}", shown(&cell.robot.name), if is_map { model.as_str() } else { "" });
        let scale = &stage.scale;
        let colours = scale.range.filter(|_| is_map).map(|(low, high)| {
            let what = match (scale.unit, lens.is_signed()) {
                (Unit::Share, _) => "share of failures",
                (_, true) => "error",
                (_, false) => lens.reading_word(),
            };
            [
                format!("{what} in {}", scale.senses.iter().map(|s| shown(s)).collect::<Vec<_>>().join(", ")),
                scale.said(low),
                scale.said(high),
            ]
        });
        let enlarged = drawing.exaggeration(shot.take);
        let longest = mm_from_m(16.0 * shot.capital() / (stage.camera.scale * enlarged));
        let error = m_from_mm(round_down(longest.clamp(1e-9, 1e9), ONE_TWO_FIVE));
        let what = match shot.show {
            Show::X | Show::Y | Show::Z => format!("error along {}", shot.show.sense().unwrap_or("")),
            Show::InPlane => "error in x and y".into(),
            Show::Nothing | Show::Resultant => "error".into(),
        };
        let arrows = (is_map && colours.is_some()).then(|| ArrowScale {
            length: error * enlarged,
            heading: format!("{what}: arrows enlarged {enlarged} times"),
            error: format!("{} mm", mm_from_m(error)),
        });
        Self { title: shown(&cell.name), line, colours, arrows, signs: signs(drawing, shot) }
    }
}

/// Returns every symbol that occurs in the picture, for the legend.
pub fn signs(drawing: &Drawing<'_>, shot: &Shot) -> Vec<LegendSign> {
    let shown = || drawing.fields.iter().filter(|f| shot.operation.is_none_or(|o| o == f.operation));
    let occurs = |sign: &NodeSign| shown().flat_map(|f| &f.nodes).any(|n| n.sign == *sign);
    let mut signs: Vec<LegendSign> = Vec::new();
    if shot.show != Show::Nothing {
        // Usable nodes are dots in the colours of the scale. A ring marks the spot or the worst node.
        let has_usable = |f: &&Field| f.nodes.iter().any(|n| n.sign.is_usable());
        let is_worst = |f: &Field| drawing.cell.operations[f.operation].over.needs_every_node();
        let rings = [(LegendSign::Spot, false), (LegendSign::WorstNode, true)];
        let occurring =
            rings.into_iter().filter(|(_, worst)| shown().filter(has_usable).any(|f| is_worst(f) == *worst));
        signs.extend(occurring.map(|(sign, _)| sign));
        let unusable = NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable() && occurs(sign));
        signs.extend(unusable.map(LegendSign::Node));
    }
    if shot.envelope && !drawing.envelopes.is_empty() {
        signs.push(LegendSign::Envelope);
    }
    signs
}

/// Distances of the legend's columns from the left edge, as multiples of the height of capital letters.
pub const COLUMNS: [f64; 3] = [2.2, 38.5, 78.0];
/// Largest number of symbols in a column of the legend.
const MAX_ROWS: usize = 4;
pub const BAR: f64 = 31.0;

/// Item of the title or legend to draw, px.
pub enum LegendItem {
    /// Text with its position, the height of its capital letters, and its colour.
    Text(String, Vector2<f64>, f64, Colour),
    Line(Vec<Vector2<f64>>, f64, Colour),
    Area(Vector2<f64>, Vector2<f64>, Colour),
}

/// Returns the title and the legend as items to draw.
pub fn items(drawing: &Drawing<'_>, stage: &FittedScene, shot: &Shot) -> Vec<LegendItem> {
    let (unit, palette) = (shot.capital(), &stage.palette);
    let words = LegendTexts::of(drawing, stage, shot);
    let top = shot.height as f64 / unit - HEIGHT;
    let at = |x: f64, y: f64| Vector2::new(x * unit, y * unit);
    // In a small picture, the columns move closer together, and the letters keep their size.
    let narrow = (shot.width as f64 / unit / 125.0).min(1.0);
    let [first, second, third] = [COLUMNS[0], COLUMNS[1] * narrow, COLUMNS[2] * narrow];
    let bar = BAR * narrow;
    let text = |s: &str, x: f64, y: f64| LegendItem::Text(s.to_string(), at(x, y), unit, palette.text);
    let (width, line) = (shot.width as f64 / unit, vec![at(0.0, top), at(shot.width as f64 / unit, top)]);
    let mut items = vec![
        LegendItem::Area(at(0.0, top), at(width, top + HEIGHT), palette.paper),
        LegendItem::Line(line, 0.1 * unit, palette.grid),
        LegendItem::Text(words.title, at(2.2, 2.9), 1.35 * unit, palette.text),
        LegendItem::Text(words.line, at(2.2, 4.9), unit, palette.faint),
    ];
    if let Some([what, least, most]) = &words.colours {
        let width = font::width(most, 1.0);
        items.push(text(what, first, top + 2.0));
        items.push(text(least, first, top + 6.4));
        items.push(text(most, first + bar - width, top + 6.4));
        const STEPS: u32 = 64;
        items.extend((0..STEPS).map(|k| {
            let x = |k: u32| first + bar * f64::from(k) / f64::from(STEPS);
            let colour = colour_of(f64::from(k) / f64::from(STEPS - 1));
            // Each step extends to the right end of the bar, so that no gap shows.
            LegendItem::Area(at(x(k), top + 3.1), at(x(STEPS), top + 4.5), colour)
        }));
    }
    if let Some(arrows) = &words.arrows {
        // A heading that is too wide for its column becomes smaller.
        let size = unit * ((third - second - 1.0) / font::width(&arrows.heading, 1.0)).min(1.0);
        let heading = arrows.heading.clone();
        items.push(LegendItem::Text(heading, at(second, top + 2.0), size, palette.text));
        items.push(text(&arrows.error, second, top + 6.4));
        let (left, right) = (second, second + arrows.length * stage.camera.scale / unit);
        let lines = [[(left, 3.8), (right, 3.8)], [(left, 3.2), (left, 4.4)], [(right, 3.2), (right, 4.4)]];
        let line = |l: [(f64, f64); 2]| {
            LegendItem::Line(l.map(|(x, y)| at(x, top + y)).to_vec(), 0.18 * unit, palette.text)
        };
        items.extend(lines.map(line));
    }
    let column = if words.colours.is_some() { third } else { first };
    let place = Vector2::new(column * unit, top * unit);
    items.extend(sign_table(&words.signs, place, width * unit - place.x, unit, palette));
    items
}

/// Returns the symbols with their labels, column by column. The table is scaled down if it is wider than
/// `room` px.
fn sign_table(
    signs: &[LegendSign],
    place: Vector2<f64>,
    room: f64,
    unit: f64,
    palette: &Palette,
) -> Vec<LegendItem> {
    let rows = if signs.len() <= 6 { 3 } else { MAX_ROWS };
    let columns: Vec<&[LegendSign]> = signs.chunks(rows).collect();
    // A symbol is 3 capital heights wide, and the gap between two columns is 1.5 capital heights wide.
    let wide = |column: &&[LegendSign]| {
        4.5 + column.iter().map(|sign| font::width(sign.label(), 1.0)).fold(0.0, f64::max)
    };
    let needed: f64 = columns.iter().map(wide).sum();
    let size = unit * (room / (needed * unit)).min(1.0);
    let step = 5.7 / rows as f64;
    let (mut left, mut items) = (0.0, Vec::new());
    for column in &columns {
        for (k, sign) in column.iter().enumerate() {
            let y = place.y + (1.9 + step * k as f64) * unit;
            let at = |x: f64, down: f64| Vector2::new(place.x + (left + x) * size, y + down * size);
            items.extend(sign_items(*sign, at(0.8, 0.0), size, palette));
            items.push(LegendItem::Text(sign.label().into(), at(3.0, 0.5), size, palette.text));
        }
        left += wide(column);
    }
    items
}

fn sign_items(sign: LegendSign, at: Vector2<f64>, unit: f64, palette: &Palette) -> Vec<LegendItem> {
    let thin = 0.14 * unit;
    match sign {
        LegendSign::Node(sign) => {
            node_glyph(sign).map_or(Vec::new(), |glyph| glyph_items(&glyph, at, unit, palette))
        }
        LegendSign::Spot | LegendSign::WorstNode => {
            vec![LegendItem::Line(arc(at, 0.75 * unit, 0.0, TAU), 0.3 * unit, palette.spot)]
        }
        LegendSign::Envelope => {
            let half = Vector2::new(unit, 0.0);
            vec![LegendItem::Line(vec![at - half, at + half], thin, palette.envelope)]
        }
    }
}

fn glyph_items(glyph: &NodeGlyph, at: Vector2<f64>, unit: f64, palette: &Palette) -> Vec<LegendItem> {
    let (radius, thin, colour) = (0.65 * unit, 0.14 * unit, palette.of_tone(glyph.tone));
    let dash = TAU / 6.0;
    let arcs = match glyph.ring {
        GlyphRing::None => Vec::new(),
        GlyphRing::Full => vec![arc(at, radius, 0.0, TAU)],
        GlyphRing::Dashed => {
            (0..6).map(|k| dash * f64::from(k)).map(|from| arc(at, radius, from, from + dash / 2.0)).collect()
        }
    };
    let stroke = |points: &GlyphStroke| -> Vec<Vector2<f64>> {
        points.iter().map(|(x, y)| at + Vector2::new(*x, *y) * radius).collect()
    };
    let lines = arcs.into_iter().chain(glyph.strokes.iter().map(stroke));
    lines.map(|points| LegendItem::Line(points, thin, colour)).collect()
}

/// Returns points on a circular arc from angle `from` to angle `to`, rad.
fn arc(at: Vector2<f64>, radius: f64, from: f64, to: f64) -> Vec<Vector2<f64>> {
    let angle = |k: usize| from + (to - from) * k as f64 / 24.0;
    (0..=24).map(|k| at + Vector2::new(angle(k).cos(), angle(k).sin()) * radius).collect()
}

/// Draws the items into a picture of pixels.
pub fn write(sheet: &mut PixelImage, items: &[LegendItem]) {
    for item in items {
        match item {
            LegendItem::Text(text, at, capital, colour) => sheet.text(text, *at, *capital, *colour),
            LegendItem::Line(points, width, colour) => sheet.line(points, *width, *colour),
            LegendItem::Area(low, high, colour) => {
                sheet.rectangle(low.map(f64::round), high.map(f64::round), *colour)
            }
        }
    }
}

/// Appends the items to `out` as SVG elements.
pub fn draw(out: &mut String, items: &[LegendItem]) {
    for item in items {
        // Writing to a String cannot fail.
        let _ = match item {
            LegendItem::Text(text, at, capital, colour) => writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.1}\" fill=\"{}\">{}</text>",
                at.x,
                at.y,
                capital * TEXT,
                hex(*colour),
                escaped(text)
            ),
            LegendItem::Line(points, width, colour) => {
                let points: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
                let (points, stroke) = (points.join(" "), hex(*colour));
                writeln!(
                    out,
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width:.2}\"/>"
                )
            }
            LegendItem::Area(low, high, colour) => {
                let ([x, y], size, fill) = ([low.x, low.y], high - low, hex(*colour));
                writeln!(
                    out,
                    "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{fill}\"/>",
                    size.x, size.y
                )
            }
        };
    }
}
