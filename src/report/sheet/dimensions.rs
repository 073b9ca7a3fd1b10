//! Dimensions: distances along the world x and y from the robot base to the nearest corner of every piece of
//! equipment.

use super::SheetView;
use crate::cell::Role;
use crate::drawing::Drawing;
use crate::drawing::floor_corners;
use crate::units::{mm_from_m, rounded};
use nalgebra::Vector2;
use std::fmt::Write;

/// Distance between the view and the first dimension line, mm on paper. The next lines are [`LINE_SPACING`]
/// apart.
const FIRST_LINE: f64 = 7.0;
const LINE_SPACING: f64 = 6.0;
/// Length of the head of an arrow, mm on paper.
const HEAD: f64 = 2.2;

/// Returns one entry per piece of equipment: letter, index, and the corner nearest to the robot base (world
/// frame, m).
pub fn marks(drawing: &Drawing<'_>) -> Vec<(String, usize, Vector2<f64>)> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let base = Vector2::new(layout.base.x, layout.base.y);
    let placed = cell.equipment.iter().zip(&layout.placements).enumerate();
    let nearest = placed.filter(|(_, (e, _))| e.role == Role::Equipment).filter_map(|(k, (e, at))| {
        let corners = floor_corners(&e.footprint, at).map(|(x, y)| Vector2::new(x, y));
        let away = |p: &Vector2<f64>| (p - base).norm();
        Some((k, corners.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)))?))
    });
    nearest.enumerate().map(|(n, (k, corner))| (letter(n), k, corner)).collect()
}

/// Returns the letter with number `n`: A to Z, then A1, B1, ...
fn letter(n: usize) -> String {
    let first = char::from(b'A' + (n % 26) as u8);
    if n < 26 { first.to_string() } else { format!("{first}{}", n / 26) }
}

/// Returns the space that the dimension lines need beside and below the plan, mm on paper.
pub fn room(drawing: &Drawing<'_>) -> f64 {
    let count = drawing.cell.equipment.iter().filter(|e| e.role == Role::Equipment).count();
    FIRST_LINE + LINE_SPACING * count as f64
}

pub fn draw(out: &mut String, drawing: &Drawing<'_>, view: &SheetView) {
    let base = Vector2::new(drawing.layout.base.x, drawing.layout.base.y);
    let (x0, y0) = view.at(&base);
    let _ = writeln!(
        out,
        "<path d=\"M{:.2} {y0:.2}h8M{x0:.2} {:.2}v8\" stroke=\"#000000\" stroke-width=\"0.25\"/>",
        x0 - 4.0,
        y0 - 4.0
    );
    for (n, (letter, _, corner)) in marks(drawing).iter().enumerate() {
        let (x, y) = view.at(corner);
        let away = FIRST_LINE + LINE_SPACING * n as f64;
        let distance = (corner - base).map(|m| rounded(mm_from_m(m), 1));
        let (line, post) = (view.bottom + away, view.left - away);
        let _ = writeln!(
            out,
            "<g fill=\"none\" stroke=\"#000000\" stroke-width=\"0.13\">\
             <path d=\"M{x:.2} {:.2}V{:.2}M{x0:.2} {:.2}V{2:.2}M{:.2} {y:.2}H{:.2}M{:.2} {y0:.2}H{5:.2}\" \
             stroke-dasharray=\"none\" stroke=\"#57606a\"/></g>",
            y + 1.0,
            line + 1.5,
            y0 + 5.0,
            x - 1.0,
            post - 1.5,
            x0 - 5.0
        );
        ruled(out, (x0, x), line, false, &format!("{letter} {}", distance.x.abs()));
        ruled(out, (y0, y), post, true, &format!("{letter} {}", distance.y.abs()));
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2.1\" fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"0.25\"/>\
             <text x=\"{x:.2}\" y=\"{:.2}\" text-anchor=\"middle\" font-weight=\"600\">{letter}</text>",
            y + 0.95
        );
    }
}

/// Draws a dimension line with arrow heads. The number is above the line, or left of a vertical line. A short
/// line has its arrow heads outside and its number beyond one end.
fn ruled(out: &mut String, (from, to): (f64, f64), across: f64, upright: bool, number: &str) {
    let (low, high) = (from.min(to), from.max(to));
    let wide = 1.6 * number.len() as f64;
    let is_short = high - low < wide + 2.0 * HEAD;
    let inwards = if is_short { -HEAD } else { HEAD };
    let head = |at: f64, by: f64| {
        let point = |along: f64, aside: f64| match upright {
            true => format!("{:.2} {:.2}", across + aside, at + along),
            false => format!("{:.2} {:.2}", at + along, across + aside),
        };
        format!("M{}L{}L{}Z", point(0.0, 0.0), point(by, 0.4), point(by, -0.4))
    };
    let (start, end) = if is_short { (low - 2.0 * HEAD, high + 2.0 * HEAD) } else { (low, high) };
    let line = match upright {
        true => format!("M{across:.2} {start:.2}V{end:.2}"),
        false => format!("M{start:.2} {across:.2}H{end:.2}"),
    };
    let middle = if is_short { end + wide / 2.0 + 1.0 } else { (low + high) / 2.0 };
    let (x, y, turn) = match upright {
        true => (across - 0.8, middle, format!(" transform=\"rotate(-90 {:.2} {middle:.2})\"", across - 0.8)),
        false => (middle, across - 0.8, String::new()),
    };
    let _ = writeln!(
        out,
        "<path d=\"{line}{}{}\" fill=\"#000000\" stroke=\"#000000\" stroke-width=\"0.18\"/>\
         <text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"middle\"{turn} stroke=\"#ffffff\" stroke-width=\"0.7\" \
         paint-order=\"stroke\">{number}</text>",
        head(low, inwards),
        head(high, -inwards)
    );
}
