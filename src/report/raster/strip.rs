//! Title and legend of a picture: what is shown, what colours, arrows and signs mean.

use super::ink::Sheet;
use super::palette::{Palette, scale as colour_of};
use super::scale::Show;
use super::{Shot, Staged};
use crate::cell::{Unit, shown};
use crate::drawing::Drawing;
use crate::units::{m_from_mm, mm_from_m};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Height of the legend in heights of capitals.
pub const HEIGHT: f64 = 8.6;

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
            Self::Spot => "spot chosen",
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
            cell.error_set().name(),
            lens.model.name(),
            lens.reading_word()
        );
        let line = format!("{}{}", cell.robot.name, if is_map { model.as_str() } else { "" });
        let scale = &stage.scale;
        let colours = scale.range.filter(|_| is_map).map(|(low, high)| {
            let what = if scale.unit == Unit::Share { "share of failures" } else { "error" };
            [format!("{what} in {}", scale.senses.join(", ")), scale.said(low), scale.said(high)]
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
        Self { title: shown(&cell.name), line: shown(&line), colours, arrows, signs: signs(drawing, shot) }
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
pub const COLUMNS: [f64; 3] = [2.2, 41.0, 81.0];
pub const BAR: f64 = 32.0;

pub fn write(sheet: &mut Sheet, drawing: &Drawing<'_>, stage: &Staged, shot: &Shot) {
    let (unit, palette) = (shot.capital(), &stage.palette);
    let words = Words::of(drawing, stage, shot);
    let top = shot.height as f64 / unit - HEIGHT;
    let at = |x: f64, y: f64| Vector2::new(x * unit, y * unit);
    sheet.text(&words.title, at(2.2, 2.9), 1.35 * unit, palette.text);
    sheet.text(&words.line, at(2.2, 4.9), unit, palette.faint);
    if let Some([what, least, most]) = &words.colours {
        sheet.text(what, at(COLUMNS[0], top + 2.0), unit, palette.text);
        const STEPS: u32 = 128;
        for k in 0..STEPS {
            let x = |k: u32| COLUMNS[0] + BAR * f64::from(k) / f64::from(STEPS);
            let colour = colour_of(f64::from(k) / f64::from(STEPS - 1));
            sheet.rectangle(at(x(k), top + 3.1), at(x(k + 1), top + 4.5), colour, 1.0);
        }
        sheet.text(least, at(COLUMNS[0], top + 6.4), unit, palette.text);
        let width = super::font::width(most, 1.0);
        sheet.text(most, at(COLUMNS[0] + BAR - width, top + 6.4), unit, palette.text);
    }
    if let Some((length, said)) = &words.arrows {
        sheet.text(said, at(COLUMNS[1], top + 2.0), unit, palette.text);
        let right = COLUMNS[1] + length * stage.camera.scale / unit;
        for line in [
            [(COLUMNS[1], 3.8), (right, 3.8)],
            [(COLUMNS[1], 3.2), (COLUMNS[1], 4.4)],
            [(right, 3.2), (right, 4.4)],
        ] {
            let points = line.map(|(x, y)| at(x, top + y));
            sheet.line(&points, 0.18 * unit, palette.text);
        }
    }
    let column = if words.colours.is_some() { COLUMNS[2] } else { COLUMNS[0] };
    for (k, sign) in words.signs.iter().enumerate() {
        let y = top + 1.5 + 1.75 * k as f64;
        draw_sign(sheet, *sign, at(column + 0.8, y), unit, palette);
        sheet.text(sign.word(), at(column + 3.0, y + 0.5), unit, palette.text);
    }
}

fn draw_sign(sheet: &mut Sheet, sign: Sign, at: Vector2<f64>, unit: f64, palette: &Palette) {
    let ring = |radius: f64, from: f64, to: f64| -> Vec<Vector2<f64>> {
        let angle = |k: usize| from + (to - from) * k as f64 / 24.0;
        (0..=24).map(|k| at + Vector2::new(angle(k).cos(), angle(k).sin()) * radius * unit).collect()
    };
    let thin = 0.14 * unit;
    match sign {
        Sign::OutOfReach => sheet.line(&ring(0.65, 0.0, TAU), thin, palette.ring),
        Sign::Limit => {
            for k in 0..6 {
                let from = TAU * f64::from(k) / 6.0;
                sheet.line(&ring(0.65, from, from + TAU / 12.0), thin, palette.ring);
            }
        }
        Sign::Collides => {
            let side = Vector2::new(0.5, 0.5) * unit;
            let other = Vector2::new(0.5, -0.5) * unit;
            sheet.line(&[at - side, at + side], thin, palette.cross);
            sheet.line(&[at - other, at + other], thin, palette.cross);
        }
        Sign::Spot => sheet.line(&ring(0.75, 0.0, TAU), 0.3 * unit, palette.spot),
        Sign::Envelope => {
            let half = Vector2::new(unit, 0.0);
            sheet.line(&[at - half, at + half], thin, palette.envelope);
        }
    }
}
