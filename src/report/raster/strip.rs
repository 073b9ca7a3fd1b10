//! Title and legend of a picture: what is shown, what colours, arrows and signs mean.

use super::ink::Sheet;
use super::palette::{Colour, Palette, hex, scale as colour_of};
use super::scale::Show;
use super::{Shot, Staged, font};
use crate::cell::Unit;
use crate::drawing::Drawing;
use crate::files::shown;
use crate::report::view::escaped;
use crate::units::{m_from_mm, mm_from_m};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Height of the legend in heights of capitals.
pub const HEIGHT: f64 = 8.6;

/// Size of the letters of a browser for capitals of height 1.
pub const TEXT: f64 = 1.38;

/// A sign and what it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    OutOfReach,
    Limit,
    Collides,
    Spot,
    Envelope,
}

impl Sign {
    pub fn word(self) -> &'static str {
        match self {
            Self::OutOfReach => "out of reach",
            Self::Limit => "joint limit, attitude",
            Self::Collides => "collides, no way in",
            Self::Spot => "best spot",
            Self::Envelope => "reach of the arm",
        }
    }
}

/// What is said beside the picture.
pub struct Words {
    pub title: String,
    pub line: String,
    /// Of the colour scale: what, least, greatest.
    pub colours: Option<[String; 3]>,
    /// Of the arrows: length of the bar (m of the world), and what it means.
    pub arrows: Option<(f64, String)>,
    pub signs: Vec<Sign>,
}

impl Words {
    pub fn of(drawing: &Drawing<'_>, stage: &Staged, shot: &Shot) -> Self {
        let (cell, lens) = (drawing.cell, drawing.lenses[shot.take]);
        let is_map = shot.show != Show::Nothing;
        let model = format!(
            ", errors {}, {} model, {}",
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
        let error = round_number(16.0 * shot.capital() / (stage.camera.scale * enlarged));
        let what = match shot.show {
            Show::X | Show::Y | Show::Z => format!("error along {}", shot.show.sense().unwrap_or("")),
            Show::InPlane => "error in x and y".into(),
            Show::Nothing | Show::Resultant => "error".into(),
        };
        let arrows = (is_map && colours.is_some())
            .then(|| (error * enlarged, format!("{what}, arrows {enlarged} x; bar {} mm", mm_from_m(error))));
        Self { title: shown(&cell.name), line, colours, arrows, signs: signs(drawing, shot) }
    }
}

/// Those that are in the picture.
fn signs(drawing: &Drawing<'_>, shot: &Shot) -> Vec<Sign> {
    let shown = || drawing.fields.iter().filter(|f| shot.operation.is_none_or(|o| o == f.operation));
    let sign = |status: &str| match status {
        "ok" => Sign::Spot,
        "out-of-reach" => Sign::OutOfReach,
        "joint-limit" | "attitude" | "not-converged" => Sign::Limit,
        _ => Sign::Collides,
    };
    let there = |s: Sign| shown().flat_map(|f| &f.nodes).any(|n| sign(n.status) == s);
    let all = [Sign::Spot, Sign::OutOfReach, Sign::Limit, Sign::Collides];
    let mut signs: Vec<Sign> = all.into_iter().filter(|s| shot.show != Show::Nothing && there(*s)).collect();
    if shot.envelope && !drawing.envelopes.is_empty() {
        signs.push(Sign::Envelope);
    }
    signs
}

/// 1, 2 or 5 times a power of ten mm, not above a length; m.
fn round_number(most: f64) -> f64 {
    let mm = mm_from_m(most).clamp(1e-9, 1e9);
    let digit = 10f64.powf(mm.log10().floor());
    let lead = [5.0, 2.0, 1.0].into_iter().find(|l| l * digit <= mm).unwrap_or(1.0);
    m_from_mm(lead * digit)
}

/// Places of the columns of the legend, in heights of capitals.
pub const COLUMNS: [f64; 3] = [2.2, 38.5, 78.0];
/// Of the signs, three below each other.
const WIDE: f64 = 21.5;
pub const BAR: f64 = 31.0;

/// A thing of the legend, px.
pub enum Item {
    /// With the height of its capitals.
    Text(String, Vector2<f64>, f64, Colour),
    Line(Vec<Vector2<f64>>, f64, Colour),
    Area(Vector2<f64>, Vector2<f64>, Colour),
}

/// Title and legend.
pub fn items(drawing: &Drawing<'_>, stage: &Staged, shot: &Shot) -> Vec<Item> {
    let (unit, palette) = (shot.capital(), &stage.palette);
    let words = Words::of(drawing, stage, shot);
    let top = shot.height as f64 / unit - HEIGHT;
    let at = |x: f64, y: f64| Vector2::new(x * unit, y * unit);
    // Letters do not shrink with a small picture, the space between the columns does.
    let narrow = (shot.width as f64 / unit / 125.0).min(1.0);
    let [first, second, third] = [COLUMNS[0], COLUMNS[1] * narrow, COLUMNS[2] * narrow];
    let (bar, wide) = (BAR * narrow, WIDE * narrow);
    let text = |s: &str, x: f64, y: f64| Item::Text(s.to_string(), at(x, y), unit, palette.text);
    let (width, line) = (shot.width as f64 / unit, vec![at(0.0, top), at(shot.width as f64 / unit, top)]);
    let mut items = vec![
        Item::Area(at(0.0, top), at(width, top + HEIGHT), palette.paper),
        Item::Line(line, 0.1 * unit, palette.grid),
        Item::Text(words.title, at(2.2, 2.9), 1.35 * unit, palette.text),
        Item::Text(words.line, at(2.2, 4.9), unit, palette.faint),
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
            // Each to the end, so that nothing shows between two.
            Item::Area(at(x(k), top + 3.1), at(x(STEPS), top + 4.5), colour)
        }));
    }
    if let Some((length, said)) = &words.arrows {
        items.push(text(said, second, top + 2.0));
        let (left, right) = (second, second + length * stage.camera.scale / unit);
        let lines = [[(left, 3.8), (right, 3.8)], [(left, 3.2), (left, 4.4)], [(right, 3.2), (right, 4.4)]];
        let line = |l: [(f64, f64); 2]| {
            Item::Line(l.map(|(x, y)| at(x, top + y)).to_vec(), 0.18 * unit, palette.text)
        };
        items.extend(lines.map(line));
    }
    let column = if words.colours.is_some() { third } else { first };
    for (k, sign) in words.signs.iter().enumerate() {
        let (column, y) = (column + wide * (k / 3) as f64, top + 1.9 + 1.9 * (k % 3) as f64);
        items.extend(sign_items(*sign, at(column + 0.8, y), unit, palette));
        items.push(text(sign.word(), column + 3.0, y + 0.5));
    }
    items
}

fn sign_items(sign: Sign, at: Vector2<f64>, unit: f64, palette: &Palette) -> Vec<Item> {
    let ring = |radius: f64, from: f64, to: f64| -> Vec<Vector2<f64>> {
        let angle = |k: usize| from + (to - from) * k as f64 / 24.0;
        (0..=24).map(|k| at + Vector2::new(angle(k).cos(), angle(k).sin()) * radius * unit).collect()
    };
    let thin = 0.14 * unit;
    let line = |a: Vector2<f64>, colour: Colour| Item::Line(vec![at - a, at + a], thin, colour);
    match sign {
        Sign::OutOfReach => vec![Item::Line(ring(0.65, 0.0, TAU), thin, palette.ring)],
        Sign::Limit => {
            let from = (0..6).map(|k| TAU * f64::from(k) / 6.0);
            from.map(|a| Item::Line(ring(0.65, a, a + TAU / 12.0), thin, palette.ring)).collect()
        }
        Sign::Collides => {
            [-0.5, 0.5].map(|y| line(Vector2::new(0.5, y) * unit, palette.cross)).into_iter().collect()
        }
        Sign::Spot => vec![Item::Line(ring(0.75, 0.0, TAU), 0.3 * unit, palette.spot)],
        Sign::Envelope => vec![line(Vector2::new(unit, 0.0), palette.envelope)],
    }
}

pub fn write(sheet: &mut Sheet, items: &[Item]) {
    for item in items {
        match item {
            Item::Text(text, at, capital, colour) => sheet.text(text, *at, *capital, *colour),
            Item::Line(points, width, colour) => sheet.line(points, *width, *colour),
            Item::Area(low, high, colour) => {
                sheet.rectangle(low.map(f64::round), high.map(f64::round), *colour)
            }
        }
    }
}

/// The same as SVG.
pub fn draw(out: &mut String, items: &[Item]) {
    for item in items {
        // Writing to a String cannot fail.
        let _ = match item {
            Item::Text(text, at, capital, colour) => writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.1}\" fill=\"{}\">{}</text>",
                at.x,
                at.y,
                capital * TEXT,
                hex(*colour),
                escaped(text)
            ),
            Item::Line(points, width, colour) => {
                let points: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
                let (points, stroke) = (points.join(" "), hex(*colour));
                writeln!(
                    out,
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width:.2}\"/>"
                )
            }
            Item::Area(low, high, colour) => {
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
