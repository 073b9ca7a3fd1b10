//! Dimensions of the plan and of the front view.
//!
//! The plan states the distances from the robot base to the nearest corner of each piece of equipment, along
//! world x and y. The plan also states the yaw of each piece. The front view states the heights.

use super::SheetView;
use super::ink::{TextAnchor, TextStyle, put, stroke};
use super::title::BLACK;
use crate::cell::{Equipment, Placement, Role};
use crate::drawing::Drawing;
use crate::drawing::floor_corners;
use crate::report::chart::labels::OccupiedBoxes;
use crate::units::{deg_from_rad, mm_from_m, rounded, wrapped};
use nalgebra::Vector2;
use std::fmt::Write;

/// Distance between the view and the first dimension line, mm on paper. The next lines are [`LINE_SPACING`]
/// apart.
const FIRST_LINE: f64 = 7.0;
const LINE_SPACING: f64 = 6.0;
/// Length of the head of an arrow, mm on paper.
const HEAD: f64 = 2.2;
/// Radius of the arc of an angular dimension, mm on paper.
const ARC: f64 = 11.0;
/// Height of the numbers, mm.
const NUMBER: TextStyle = TextStyle::plain(2.6);
const GREY: &str = "#57606a";

/// Piece of equipment with its letter and the corner that its dimensions lead to.
pub struct Mark {
    pub letter: String,
    /// Index of the equipment.
    pub equipment: usize,
    /// Corner nearest to the robot base, in the world frame, m.
    pub corner: Vector2<f64>,
    /// Tolerances of the corner along x and y, m. None if no tolerance is stated, or if less than
    /// 0.1 mm remains after the allowance for an error of the yaw.
    pub tolerance: [Option<f64>; 2],
    /// Tolerance of the yaw, rad; 0 if none is stated.
    pub turn: f64,
}

/// Returns a mark for every piece of equipment.
pub fn marks(drawing: &Drawing<'_>) -> Vec<Mark> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let base = Vector2::new(layout.base.x, layout.base.y);
    let placed = cell.equipment.iter().zip(&layout.placements).enumerate();
    let nearest = placed.filter(|(_, (e, _))| e.role == Role::Equipment).filter_map(|(k, (e, at))| {
        let corners = floor_corners(&e.footprint, at).map(|(x, y)| Vector2::new(x, y));
        let away = |p: &Vector2<f64>| (p - base).norm();
        let corner = corners.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
        Some((k, e, at, corner))
    });
    let mark = |(n, (equipment, e, at, corner)): (usize, (usize, &Equipment, &Placement, _))| {
        // The tolerances of a piece that stands on another piece are along the axes of the lower piece. They
        // are not shown, because the dimensions are along the world axes.
        let given = if e.on.is_none() { e.tolerance.0 } else { [0.0; 4] };
        Mark {
            letter: letter(n),
            equipment,
            corner,
            tolerance: of_corner(&given, at, &corner),
            turn: given[3],
        }
    };
    nearest.enumerate().map(mark).collect()
}

/// Returns the tolerances of a corner of a piece along x and y, m. A corner within these tolerances keeps the
/// frame of the piece within its placement tolerances at every allowed yaw.
///
/// If the corner is in place, a yaw error rotates the frame about the corner. A yaw error d moves the frame
/// along x by d times the y distance between frame and corner. It moves the frame along y by d times the x
/// distance. The tolerance of the corner is the placement tolerance minus this displacement.
fn of_corner(given: &[f64; 4], at: &Placement, corner: &Vector2<f64>) -> [Option<f64>; 2] {
    let arm = Vector2::new(at.x, at.y) - corner;
    let left = [given[0] - given[3] * arm.y.abs(), given[1] - given[3] * arm.x.abs()];
    // A tolerance below 0.1 mm cannot be kept with a tape measure.
    left.map(|left| Some(left).filter(|left| mm_from_m(*left) >= 0.1))
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

/// Returns the space that the heights need beside the front view, mm on paper.
pub fn room_of_heights(drawing: &Drawing<'_>) -> f64 {
    FIRST_LINE + LINE_SPACING * heights(drawing).len() as f64
}

fn number(m: f64) -> String {
    (rounded(mm_from_m(m), 1).abs() + 0.0).to_string()
}

/// Returns a tolerance as text with a plus-minus sign, mm, rounded down to 0.1 mm. The text is empty if there
/// is no tolerance.
fn plus_minus(tolerance: Option<f64>) -> String {
    // Adding 1e-6 compensates for rounding errors of the conversion.
    let down = |m: f64| (mm_from_m(m) * 10.0 + 1e-6).floor() / 10.0;
    tolerance.map_or(String::new(), |m| format!(" \u{b1}{}", down(m)))
}

/// Draws the dimensions of the plan. Adds the boxes of letters and angles to `taken`, so that later texts
/// avoid these boxes.
pub fn draw(out: &mut String, drawing: &Drawing<'_>, view: &SheetView, taken: &mut OccupiedBoxes) {
    let base = Vector2::new(drawing.layout.base.x, drawing.layout.base.y);
    let (x0, y0) = view.at(&base);
    stroke(out, &format!("M{:.2} {y0:.2}h8M{x0:.2} {:.2}v8", x0 - 4.0, y0 - 4.0), BLACK, 0.25);
    let marks = marks(drawing);
    for (n, Mark { letter, corner, tolerance, .. }) in marks.iter().enumerate() {
        let (x, y) = view.at(corner);
        let away = FIRST_LINE + LINE_SPACING * n as f64;
        let distance = corner - base;
        let (line, post) = (view.bottom + away, view.left - away);
        let help = format!(
            "M{x:.2} {:.2}V{:.2}M{x0:.2} {:.2}V{1:.2}M{:.2} {y:.2}H{:.2}M{:.2} {y0:.2}H{4:.2}",
            y + 1.0,
            line + 1.5,
            y0 + 5.0,
            x - 1.0,
            post - 1.5,
            x0 - 5.0
        );
        stroke(out, &help, GREY, 0.13);
        let [along_x, along_y] =
            [0, 1].map(|k| format!("{letter} {}{}", number(distance[k]), plus_minus(tolerance[k])));
        ruled(out, (x0, x), line, false, &along_x);
        ruled(out, (y0, y), post, true, &along_y);
    }
    for mark in &marks {
        let (x, y) = view.at(&mark.corner);
        taken.keep([x - 2.2, y - 2.2, x + 2.2, y + 2.2]);
    }
    marks.iter().for_each(|mark| angle(out, drawing, view, (mark, taken)));
    for Mark { letter, corner, .. } in &marks {
        balloon(out, view.at(corner), letter);
    }
}

/// Draws a letter in a circle.
fn balloon(out: &mut String, (x, y): (f64, f64), letter: &str) {
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2.1\" fill=\"#ffffff\" stroke=\"{BLACK}\" stroke-width=\"0.25\"/>"
    );
    let style = NUMBER.anchored(TextAnchor::Middle).bold().fitted(letter, 3.6);
    put(out, (x, y + 0.95), style, "", letter);
}

/// Draws the yaw of a piece as an angular dimension at its corner. The angle goes from the world x to the x
/// axis of the piece.
fn angle(
    out: &mut String,
    drawing: &Drawing<'_>,
    view: &SheetView,
    (mark, taken): (&Mark, &mut OccupiedBoxes),
) {
    let yaw = wrapped(drawing.layout.placements[mark.equipment].yaw);
    let (x, y) = view.at(&mark.corner);
    let end = |angle: f64, radius: f64| (x + radius * angle.cos(), y - radius * angle.sin());
    let turn = match mark.turn {
        0.0 => String::new(),
        turn => format!(" \u{b1}{}\u{b0}", rounded(deg_from_rad(turn), 3)),
    };
    let said = format!("{}\u{b0}{turn}", rounded(deg_from_rad(yaw), 2) + 0.0);
    let mut legs = String::new();
    for (to, radius) in [(0.0, ARC + 2.0), (yaw, ARC + 2.0)] {
        let (far, near) = (end(to, radius), end(to, 2.1));
        let _ = write!(legs, "M{:.2} {:.2}L{:.2} {:.2}", near.0, near.1, far.0, far.1);
    }
    stroke(out, &legs, GREY, 0.13);
    // Arrow heads on a short arc would cover the arc.
    if (yaw * ARC).abs() > 2.0 * HEAD {
        let (a, b) = (end(0.0, ARC), end(yaw, ARC));
        let sweep = u8::from(yaw < 0.0);
        let arc = format!("M{:.2} {:.2}A{ARC} {ARC} 0 0 {sweep} {:.2} {:.2}", a.0, a.1, b.0, b.1);
        stroke(out, &arc, BLACK, 0.18);
        let sign = yaw.signum();
        // Both heads extend along the arc, away from their tips.
        let (sin, cos) = yaw.sin_cos();
        let (at_start, at_end) = ((0.0, sign), (sin * sign, -cos * sign));
        let heads = head(a, at_start) + &head(b, at_end);
        let _ = writeln!(out, "<path d=\"{heads}\" fill=\"{BLACK}\"/>");
    }
    // The number is beside the arc, at a free place.
    let wide = NUMBER.width(&said);
    // Beside a small angle, the edge of the piece would cross the number.
    let lifts =
        if (yaw * ARC).abs() > 4.0 { [0.0, 3.0, -3.0, 6.0, -6.0] } else { [2.4, -3.4, 5.0, -6.0, 8.0] };
    let places = lifts.map(|lift| {
        let (x, y) = end(yaw / 2.0, ARC + 3.4);
        (x, y + 0.9 - lift)
    });
    let is_free = |(x, y): &&(f64, f64)| taken.take([*x, y - 2.4, x + wide, y + 0.8]);
    let at = places.iter().find(is_free).copied().unwrap_or(places[0]);
    put(out, at, NUMBER.rimmed(), "", &said);
}

/// Returns the SVG path of an arrow head with its tip at the point `(x, y)`. The head extends from the tip
/// along the unit vector `(right, up)`.
fn head((x, y): (f64, f64), (right, up): (f64, f64)) -> String {
    let (bx, by) = (x + HEAD * right, y - HEAD * up);
    let (sx, sy) = (0.4 * up, 0.4 * right);
    format!("M{x:.2} {y:.2}L{:.2} {:.2}L{:.2} {:.2}Z", bx + sx, by + sy, bx - sx, by - sy)
}

/// Height above the floor in the front view, with its text.
struct HeightMark {
    name: String,
    /// Horizontal coordinate and height in the world, m.
    at: Vector2<f64>,
    tolerance: Option<f64>,
}

/// Returns the heights of the robot base and of every piece of equipment; heights of 0 are left out.
fn heights(drawing: &Drawing<'_>) -> Vec<HeightMark> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let tolerance = |half: f64| Some(half).filter(|half| *half > 0.0);
    let base = HeightMark {
        name: if cell.pedestal(layout.base.z).is_some() { "pedestal ".into() } else { "base ".into() },
        at: Vector2::new(layout.base.x, layout.base.z),
        tolerance: tolerance(cell.base_tolerance.0[2]),
    };
    let piece = |mark: &Mark| {
        let at = &layout.placements[mark.equipment];
        let given = cell.equipment[mark.equipment].tolerance.0[2];
        HeightMark {
            name: format!("{} ", mark.letter),
            at: Vector2::new(at.x, at.z),
            // The tolerance of a piece on another piece is relative to that piece, not to the floor.
            tolerance: tolerance(given).filter(|_| cell.equipment[mark.equipment].on.is_none()),
        }
    };
    let marks = marks(drawing);
    let all = std::iter::once(base).chain(marks.iter().map(piece));
    all.filter(|mark| (mark.at.y - drawing.floor).abs() > 1e-6).collect()
}

/// Draws the heights left of the front view.
pub fn draw_heights(out: &mut String, drawing: &Drawing<'_>, view: &SheetView) {
    for (n, mark) in heights(drawing).iter().enumerate() {
        let post = view.left - FIRST_LINE - LINE_SPACING * n as f64;
        let (x, y) = view.at(&mark.at);
        let (left, floor) = view.at(&Vector2::new(view.low.x, drawing.floor));
        let end = post - 1.5;
        stroke(out, &format!("M{x:.2} {y:.2}H{end:.2}M{left:.2} {floor:.2}H{end:.2}"), GREY, 0.13);
        let said =
            format!("{}{}{}", mark.name, number(mark.at.y - drawing.floor), plus_minus(mark.tolerance));
        ruled(out, (floor, y), post, true, &said);
    }
}

/// Draws a dimension line with arrow heads. The number is above the line, or left of a vertical line. A short
/// line has its arrow heads outside and its number beyond one end.
fn ruled(out: &mut String, (from, to): (f64, f64), across: f64, upright: bool, said: &str) {
    let (low, high) = (from.min(to), from.max(to));
    let wide = NUMBER.width(said);
    let is_short = high - low < wide + 2.0 * HEAD;
    let inwards = if is_short { -1.0 } else { 1.0 };
    let point = |along: f64| if upright { (across, along) } else { (along, across) };
    let axis = |sign: f64| if upright { (0.0, -sign) } else { (sign, 0.0) };
    let (start, end) = if is_short { (low - 2.0 * HEAD, high + 2.0 * HEAD) } else { (low, high) };
    let (a, b) = (point(start), point(end));
    let heads = head(point(low), axis(inwards)) + &head(point(high), axis(-inwards));
    let _ = writeln!(
        out,
        "<path d=\"M{:.2} {:.2}L{:.2} {:.2}\" stroke=\"{BLACK}\" stroke-width=\"0.18\"/>\
         <path d=\"{heads}\" fill=\"{BLACK}\"/>",
        a.0, a.1, b.0, b.1
    );
    let middle = if !is_short {
        (low + high) / 2.0
    } else if upright {
        start - wide / 2.0 - 0.5
    } else {
        end + wide / 2.0 + 0.5
    };
    let (at, turned) = match upright {
        true => ((across - 0.8, middle), -90.0),
        false => ((middle, across - 0.8), 0.0),
    };
    let style = TextStyle { turned, ..NUMBER.anchored(TextAnchor::Middle).rimmed() };
    put(out, at, style, "", said);
}
