//! Title block, list of placements, scale bar.

use super::dimensions::{marks, room};
use super::{MARGIN, TITLE};
use crate::drawing::Drawing;
use crate::drawing::round_numbers::{ONE_TWO_FIVE, round_down};
use crate::svg_text::escaped;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::fmt::Write;

/// Height of a line of the list of placements, mm on paper.
pub const LINE: f64 = 4.2;
pub const LIST: f64 = 122.0;
/// Largest number of characters of a name in the list of placements.
const NAME: usize = 24;

/// Returns the number of lines of the list of placements, and the space for the dimension lines, mm on paper.
pub fn rows(drawing: &Drawing<'_>) -> (usize, f64) {
    let of_regions = if drawing.regions.is_empty() { 0 } else { drawing.regions.len() + 1 };
    (marks(drawing).len() + drawing.fields.len() + of_regions + 3, room(drawing))
}

fn short(name: &str) -> String {
    let cut: String = name.chars().take(NAME).collect();
    escaped(&if cut.len() < name.len() { cut + "..." } else { cut })
}

/// Rounds a value down to a multiple of `1 / scale`.
fn down(value: f64, scale: f64) -> f64 {
    (value * scale).floor() / scale
}

fn mm(m: f64) -> f64 {
    rounded(mm_from_m(m), 1)
}

/// Draws the list of placements: corners and frames of the equipment, and spots. Spots are in the world
/// frame. Corners and frames are given along the world axes from the robot base, heights from the floor.
pub fn list(out: &mut String, drawing: &Drawing<'_>, (left, top): (f64, f64)) {
    let base = &drawing.layout.base;
    let mut y = top;
    let mut row = |cells: [String; 6], weight: &str| {
        let at = [0.0, 44.0, 60.0, 76.0, 92.0, 108.0];
        for (k, (cell, x)) in cells.iter().zip(at).enumerate() {
            let (x, anchor) = if k == 0 { (left, "start") } else { (left + x + 12.0, "end") };
            let _ = writeln!(
                out,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" font-weight=\"{weight}\">{cell}</text>"
            );
        }
        y += LINE;
    };
    let words = |words: [&str; 6]| words.map(str::to_string);
    row(words(["from the robot base, mm", "corner x", "corner y", "frame x", "frame y", "height"]), "600");
    for (letter, k, corner) in marks(drawing) {
        let at = &drawing.layout.placements[k];
        let numbers =
            [corner.x - base.x, corner.y - base.y, at.x - base.x, at.y - base.y, at.z - drawing.floor];
        let [a, b, c, d, e] = numbers.map(|m| mm(m).to_string());
        let yaw = rounded(deg_from_rad(at.yaw), 2);
        let name = format!("{letter} {}, yaw {yaw}\u{b0}", short(&drawing.cell.equipment[k].name));
        row([name, a, b, c, d, e], "400");
    }
    row(words(["spot, world, mm", "x", "y", "z", "", "error"]), "600");
    for field in &drawing.fields {
        let operation = &drawing.cell.operations[field.operation];
        let name = short(&operation.name);
        let value = field.best.and_then(|k| field.takes[0].values[field.sense][k]);
        let unit = operation.sense.unit;
        let value = value.map(|v| format!("{} {}", rounded(unit.from_si(v), 3), unit.word()));
        let cells = match field.spot {
            Some(p) => {
                let [x, y, z] = [p.x, p.y, p.z].map(|m| mm(m).to_string());
                [name, x, y, z, String::new(), value.unwrap_or_default()]
            }
            None => {
                [name, "no usable node".into(), String::new(), String::new(), String::new(), String::new()]
            }
        };
        row(cells, "400");
    }
    if drawing.regions.is_empty() {
        return;
    }
    row(words(["room to place (filled: where the frame may be)", "", "", "", "mm", "deg"]), "600");
    for region in &drawing.regions {
        // A room that is rounded up would not hold.
        let room = region.room.map_or("-".into(), |room| format!("{:.1}", down(mm_from_m(room), 10.0)));
        let turn = region.turn.map_or("-".into(), |turn| format!("{:.2}", down(deg_from_rad(turn), 100.0)));
        row([short(&region.name), String::new(), String::new(), String::new(), room, turn], "400");
    }
}

/// Draws the frame of the sheet and the title block with scale bar and axes.
pub fn block(
    out: &mut String,
    drawing: &Drawing<'_>,
    (paper, width, height): (&str, f64, f64),
    (ratio, operation): (f64, Option<usize>),
) {
    let (cell, top) = (drawing.cell, height - MARGIN - TITLE);
    let _ = writeln!(
        out,
        "<rect x=\"{MARGIN}\" y=\"{MARGIN}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#000000\" \
         stroke-width=\"0.5\"/><path d=\"M{MARGIN} {top}H{}\" stroke=\"#000000\" stroke-width=\"0.35\"/>",
        width - 2.0 * MARGIN,
        height - 2.0 * MARGIN,
        width - MARGIN
    );
    let stands = operation.map_or("home".into(), |k| short(&cell.operations[k].name));
    let arrows = format!(
        "arrows: {} error, {} times enlarged{}",
        drawing.lenses.first().map_or("", |l| l.reading_word()),
        rounded(drawing.exaggeration(0), 6),
        if drawing.lenses.first().is_some_and(|l| l.is_signed()) { "" } else { ", plus or minus" }
    );
    let mut senses: Vec<&str> = cell.operations.iter().map(|o| o.sense.name.as_str()).collect();
    senses.dedup();
    let left = [
        (4.2, format!("{} ({})", escaped(&cell.name), escaped(&drawing.name))),
        (2.6, escaped(&crate::report::text::headline(cell))),
        (2.6, format!("sense {}; {arrows}", escaped(&senses.join(", ")))),
        (2.6, format!("robot at {stands}; circles: nodes that cannot be used; dashed: reach at this height")),
    ];
    let right = [
        (4.2, format!("scale 1:{ratio}")),
        (2.6, format!("{paper}, dimensions in mm")),
        (2.6, "world axes as shown".into()),
        (2.6, format!("sweetspot {}", env!("CARGO_PKG_VERSION"))),
    ];
    let column = width - MARGIN - 62.0;
    let _ =
        writeln!(out, "<path d=\"M{column:.2} {top}v{TITLE}\" stroke=\"#000000\" stroke-width=\"0.35\"/>");
    for (x, lines) in [(MARGIN + 4.0, left), (column + 4.0, right)] {
        for (k, (size, line)) in lines.iter().enumerate() {
            let _ = writeln!(
                out,
                "<text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"{size}\" font-weight=\"{}\">{line}</text>",
                top + 6.6 + 6.0 * k as f64,
                if k == 0 { 600 } else { 400 }
            );
        }
    }
    bar(out, (column - 66.0, top + TITLE / 2.0), ratio);
}

/// Draws a scale bar of 20 to 40 mm on paper, with the axes of the plan.
fn bar(out: &mut String, (x, y): (f64, f64), ratio: f64) {
    let length = round_down(40.0 * ratio, ONE_TWO_FIVE);
    let wide = length / ratio;
    let _ = writeln!(
        out,
        "<g fill=\"none\" stroke=\"#000000\" stroke-width=\"0.35\"><path d=\"M{x:.2} {0:.2}v3m0 -1.5h{wide:.2}m0 -1.5v3\"/>\
         <path d=\"M{1:.2} {2:.2}h9l-2 -0.8m2 0.8l-2 0.8M{1:.2} {2:.2}v-9l-0.8 2m0.8 -2l0.8 2\"/></g>\
         <text x=\"{3:.2}\" y=\"{4:.2}\" text-anchor=\"middle\">{length} mm</text>\
         <text x=\"{5:.2}\" y=\"{6:.2}\">x</text><text x=\"{7:.2}\" y=\"{8:.2}\" text-anchor=\"middle\">y</text>",
        y - 1.5,
        x - 16.0,
        y + 5.0,
        x + wide / 2.0,
        y + 5.0,
        x - 6.0,
        y + 5.8,
        x - 16.0,
        y - 5.0
    );
}
