//! List of placements next to the views of a sheet: corners, frames, tolerances, spots and room (allowed
//! displacement of each piece).

use super::arrangement::{Arrangement, BLOCK};
use super::dimensions::{Mark, marks};
use super::ink::{TextStyle, put, stroke};
use super::title::{BLACK, at_end};
use crate::cell::{Equipment, Placement, Role};
use crate::drawing::Drawing;
use crate::files::shown;
use crate::units::{deg_from_rad, mm_from_m, rounded, wrapped};

/// Height of a line of the list, mm.
const LINE: f64 = 4.2;
/// Height of the font of the list, mm.
const FONT: f64 = 2.5;
/// Width of the first column, mm.
const FIRST: f64 = 52.0;
/// Right ends of the columns of numbers, from the left edge of the list, mm.
const ENDS: [f64; 6] = [68.0, 84.0, 100.0, 116.0, 132.0, 148.0];
/// Left and right end of the last column, which contains text, mm.
const LAST: (f64, f64) = (151.0, BLOCK.0);

/// Line of the list.
struct ListLine {
    first: String,
    numbers: [String; 6],
    last: String,
    is_head: bool,
}

impl ListLine {
    fn head(first: &str, columns: [&str; 6], last: &str) -> Self {
        Self { first: first.into(), numbers: columns.map(str::to_string), last: last.into(), is_head: true }
    }
}

/// Returns the height of the list, mm.
pub fn height(drawing: &Drawing<'_>) -> f64 {
    LINE * lines(drawing).len() as f64 + 3.0
}

/// Draws the list. A list that is taller than its space is drawn with a smaller line height.
pub fn draw(out: &mut String, drawing: &Drawing<'_>, arrangement: &Arrangement) {
    let lines = lines(drawing);
    let (left, top, high) = arrangement.list;
    let pitch = LINE.min(high / lines.len().max(1) as f64);
    let size = FONT.min(FONT * pitch / LINE);
    for (k, line) in lines.iter().enumerate() {
        let y = top + pitch * (k as f64 + 0.8);
        let weighted = |style: TextStyle| if line.is_head { style.bold() } else { style };
        if line.is_head {
            stroke(out, &format!("M{left:.2} {:.2}h{}", y + 1.1, LAST.1), BLACK, 0.18);
        }
        // The first text may be as wide as the empty columns beside it.
        let empty = line.numbers.iter().take_while(|said| said.is_empty()).count();
        let room = if empty == 0 { FIRST } else { ENDS[empty - 1] } - 1.0;
        let style = weighted(TextStyle::plain(size)).fitted(&line.first, room);
        put(out, (left + 1.0, y), style, "", &line.first);
        for (said, end) in line.numbers.iter().zip(ENDS).filter(|(said, _)| !said.is_empty()) {
            let style = weighted(at_end(size)).fitted(said, 15.5);
            put(out, (left + end, y), style, "", said);
        }
        let style = weighted(TextStyle::plain(size)).fitted(&line.last, LAST.1 - LAST.0 - 3.0);
        put(out, (left + LAST.0, y), style, "", &line.last);
    }
}

fn mm(m: f64) -> String {
    // Adding 0 turns -0 into 0.
    (rounded(mm_from_m(m), 1) + 0.0).to_string()
}

fn deg(rad: f64) -> String {
    format!("{}\u{b0}", rounded(deg_from_rad(wrapped(rad)), 2) + 0.0)
}

fn lines(drawing: &Drawing<'_>) -> Vec<ListLine> {
    let mut all = placements(drawing);
    all.extend(spots(drawing));
    all.extend(room(drawing));
    all
}

/// Returns the lines of robot, equipment and obstacles. Positions of corners and frames are relative to the
/// robot base, along the world axes. Heights are measured from the floor.
fn placements(drawing: &Drawing<'_>) -> Vec<ListLine> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let columns = ["corner x", "corner y", "frame x", "frame y", "height", "yaw"];
    let mut all = vec![ListLine::head("from the robot base, world axes, mm", columns, "tolerance")];
    let base = &layout.base;
    let own = |at: &Placement| [mm(at.x - base.x), mm(at.y - base.y), mm(at.z - drawing.floor), deg(at.yaw)];
    let stand = match cell.pedestal(base.z) {
        Some((section, high)) => {
            let (x, y) = section.centre;
            let aside = match (x, y) == (0.0, 0.0) {
                true => String::new(),
                false => format!(", centre at x {}, y {} in the frame of the base", mm(x), mm(y)),
            };
            let size = format!("{} \u{d7} {}", mm(section.size.0), mm(section.size.1));
            format!("pedestal {size}, {} high{aside}", mm(high))
        }
        None => String::new(),
    };
    let [.., height, yaw] = own(base);
    let none = String::new;
    all.push(ListLine {
        first: format!("robot {}", shown(&cell.robot.name)),
        numbers: [none(), none(), "0".into(), "0".into(), height, yaw],
        last: tolerance_in_words(&cell.base_tolerance.0),
        is_head: false,
    });
    if (base.x, base.y) != (0.0, 0.0) {
        let first = format!("base in the world: x {}, y {}", mm(base.x), mm(base.y));
        all.push(ListLine { first, numbers: [(); 6].map(|()| none()), last: none(), is_head: false });
    }
    if !stand.is_empty() {
        all.push(ListLine { first: stand, numbers: [(); 6].map(|()| none()), last: none(), is_head: false });
    }
    let marks = marks(drawing);
    let marked = |k: usize| marks.iter().find(|mark| mark.equipment == k);
    let line = |(k, (e, at)): (usize, (&Equipment, &Placement))| {
        let [x, y, z, yaw] = own(at);
        let (letter, corner) = match marked(k) {
            Some(Mark { letter, corner, .. }) => {
                (format!("{letter} "), [mm(corner.x - base.x), mm(corner.y - base.y)])
            }
            None => (none(), [none(), none()]),
        };
        let [cx, cy] = corner;
        let last = match (e.role, e.on) {
            (Role::Obstacle, _) => "obstacle".into(),
            (_, Some(carrier)) => format!("on {}", shown(&cell.equipment[carrier].name)),
            _ => tolerance_in_words(&e.tolerance.0),
        };
        ListLine {
            first: format!("{letter}{}", shown(&e.name)),
            numbers: [cx, cy, x, y, z, yaw],
            last,
            is_head: false,
        }
    };
    all.extend(cell.equipment.iter().zip(&layout.placements).enumerate().map(line));
    all
}

/// Returns a placement tolerance (m, rad) as text with plus-minus signs; empty if the placement has none.
fn tolerance_in_words(tolerance: &[f64; 4]) -> String {
    if tolerance.iter().all(|half| *half == 0.0) {
        return String::new();
    }
    let [x, y, z] = [0, 1, 2].map(|k| mm(tolerance[k]));
    let lengths = if x == y && y == z { x } else { format!("{x}/{y}/{z}") };
    format!("\u{b1}{lengths}, \u{b1}{}", deg(tolerance[3]))
}

fn spots(drawing: &Drawing<'_>) -> Vec<ListLine> {
    let mut all = vec![ListLine::head("spot in the world, mm", ["x", "y", "z", "", "error", "limit"], "")];
    for field in &drawing.fields {
        let operation = &drawing.cell.operations[field.operation];
        let unit = operation.sense.unit;
        let told = |si: f64| format!("{} {}", rounded(unit.from_si(si), 3), unit.word());
        let of_node = || field.best.and_then(|k| field.takes[0].values[field.sense][k]);
        let is_of_all = operation.over.needs_every_node() && drawing.cell.unit().is_error();
        let value = if is_of_all { field.value } else { of_node() }.map(told);
        let limit = operation.limit.map(told).unwrap_or_default();
        let [x, y, z] = match field.spot {
            Some(p) => [p.x, p.y, p.z].map(mm),
            None => [(); 3].map(|()| "none".to_string()),
        };
        all.push(ListLine {
            first: shown(&operation.name),
            numbers: [x, y, z, String::new(), value.unwrap_or_default(), limit],
            last: format!("in {}", shown(&operation.sense.name)),
            is_head: false,
        });
    }
    all
}

fn room(drawing: &Drawing<'_>) -> Vec<ListLine> {
    if drawing.regions.is_empty() {
        return Vec::new();
    }
    let what = ["", "", "", "", "in plan", "in yaw"];
    let mut all = vec![ListLine::head("room to place (filled: where the frame origin may be)", what, "")];
    // The room is rounded down, because a larger displacement may not be feasible.
    let down = |value: f64, scale: f64| (value * scale).floor() / scale;
    for region in &drawing.regions {
        let room = region.room.map_or("-".into(), |room| format!("{:.1} mm", down(mm_from_m(room), 10.0)));
        let turn =
            region.turn.map_or("-".into(), |turn| format!("{:.2}\u{b0}", down(deg_from_rad(turn), 100.0)));
        let [a, b, c, d] = [(); 4].map(|()| String::new());
        all.push(ListLine {
            first: shown(&region.name),
            numbers: [a, b, c, d, room, turn],
            last: String::new(),
            is_head: false,
        });
    }
    all
}
