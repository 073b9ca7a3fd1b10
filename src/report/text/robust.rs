//! The effect of misplaced equipment on each operation.

use super::{amount, fixed, percent1};
use crate::assess::Assessment;
use crate::cell::{Cell, Slot};
use crate::files::shown;
use crate::layout::{Corner, Largest, Lost, MisplacementEnd, Robustness};
use crate::record::value_word;
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};
use std::fmt::Write;

/// Largest number of lost corners that are listed. A corner of the box of placement tolerances is lost if
/// the operation is not feasible there.
const MAX_LOST_SHOWN: usize = 3;

/// Returns the effect of misplacement on each operation of a layout; empty if misplacement was not computed.
pub fn robustness(a: &Assessment<'_>) -> String {
    let mut out = String::new();
    for (k, robustness) in a.robustness.iter().enumerate() {
        let operation = &a.cell.operations[k];
        let surface = shown(&a.cell.equipment[operation.equipment].name);
        let _ = write!(out, "{} on {surface} (spot and posture branch unchanged): ", shown(&operation.name));
        match robustness {
            None => out.push_str("no usable node\n"),
            Some(r) => {
                let word = value_word(a.cell);
                let _ = writeln!(out, "{word} {} without misplacement", amount(a.cell.unit(), r.value));
                for line in robust_lines(a.cell, k, r) {
                    let _ = writeln!(out, "  {line}");
                }
            }
        }
    }
    out
}

/// Returns the effect of misplacement on one operation, line by line.
pub fn robust_lines(cell: &Cell, k: usize, r: &Robustness) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(worst) = &r.worst {
        let change = if r.value > 0.0 { (worst.value - r.value) / r.value } else { 0.0 };
        let sign = if change < 0.0 { "" } else { "+" };
        lines.push(format!(
            "placement tolerance: worst {} ({sign}{}) at {}",
            amount(cell.unit(), worst.value),
            percent1(change),
            moves(cell, &worst.moves)
        ));
    }
    for lost in r.lost.iter().take(MAX_LOST_SHOWN) {
        lines.push(format!("NOT feasible at {}: {}", moves(cell, &lost.moves), lost.status.reason(cell)));
    }
    if r.lost.len() > MAX_LOST_SHOWN {
        lines.push(format!(
            "in total: NOT feasible at {} of {} corners of the placement tolerances",
            r.lost.len(),
            r.corners
        ));
    }
    lines.push(format!("gradient: {}", slopes(cell, r)));
    let has_limit = cell.operations[k].limit.is_some() && cell.unit().is_error();
    let keeps = if has_limit { "feasible and within its limit" } else { "feasible" };
    if let Some(scale) = &r.scale {
        let at_most = most(scale, |s| format!("{} times the placement tolerances", fixed(s, 2)));
        lines.push(format!("the operation stays {keeps} up to {at_most}{}", because(cell, scale)));
    }
    let mm = |v| format!("{} mm in plan", fixed(mm_from_m(v), 2));
    let deg = |v| format!("{} deg in yaw", fixed(deg_from_rad(v), 3));
    let on = shown(&cell.equipment[cell.operations[k].equipment].name);
    for (at_most, largest) in [(most(&r.shift, mm), &r.shift), (most(&r.turn, deg), &r.turn)] {
        lines.push(format!("{on} may be misplaced by at most {at_most}{}", because(cell, largest)));
    }
    lines
}

fn most(largest: &Largest, said: impl Fn(f64) -> String) -> String {
    let more = if largest.ended.is_none() { " (the largest value tried)" } else { "" };
    said(largest.most) + more
}

/// Returns the reason why a misplacement larger than [`Largest::most`] is not allowed. The text is empty if
/// the largest misplacement tried is allowed.
fn because(cell: &Cell, largest: &Largest) -> String {
    match &largest.ended {
        None => String::new(),
        Some(MisplacementEnd::Limit(Corner { moves: at, .. })) => {
            format!(": beyond that, the operation exceeds its limit at {}", moves(cell, at))
        }
        Some(MisplacementEnd::Lost(Lost { moves: at, status })) => {
            format!(": beyond that, {} at {}", status.reason(cell), moves(cell, at))
        }
    }
}

/// Returns a misplacement such as "worktable x+2 y-2 yaw+0.2", mm and degrees.
fn moves(cell: &Cell, moves: &[(Slot, f64)]) -> String {
    let (mut said, mut of) = (String::new(), String::new());
    for (slot, by) in moves {
        let body = body(cell, *slot);
        if body != of {
            let _ = write!(said, "{}{body}", if of.is_empty() { "" } else { ", " });
            of = body;
        }
        let value = if slot.is_angle() { deg_from_rad(*by) } else { mm_from_m(*by) };
        let value = rounded(value, 3);
        let _ = write!(said, " {}{}{value}", axis(*slot), if value < 0.0 { "" } else { "+" });
    }
    said
}

fn body(cell: &Cell, slot: Slot) -> String {
    match slot {
        Slot::Equipment(k, _) => shown(&cell.equipment[k].name),
        _ => "robot base".into(),
    }
}

fn axis(slot: Slot) -> &'static str {
    match slot {
        Slot::Base(axis) | Slot::Equipment(_, axis) => ["x", "y", "z", "yaw"][axis],
        Slot::Attitude(..) => "attitude",
    }
}

/// Returns the gradient of the value of an operation: change in the unit of the objective per mm or degree.
fn slopes(cell: &Cell, r: &Robustness) -> String {
    let unit = cell.unit();
    let one = |(slot, slope): &(Slot, Option<f64>)| {
        let (per, word) = if slot.is_angle() { (rad_from_deg(1.0), "deg") } else { (m_from_mm(1.0), "mm") };
        let value = slope.map_or("-".into(), |slope| fixed(unit.from_si(slope * per), 5));
        let alone = r.gradient.iter().all(|(other, _)| body(cell, *other) == body(cell, *slot));
        let whose = if alone { String::new() } else { body(cell, *slot) + " " };
        format!("{whose}{} {value} {}/{word}", axis(*slot), unit.word())
    };
    r.gradient.iter().map(one).collect::<Vec<_>>().join(", ")
}
