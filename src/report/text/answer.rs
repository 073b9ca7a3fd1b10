//! Answer of a search or map: placements, errors of the operations, and room (allowed displacement) of every
//! piece.

use super::compare::margin;
use super::table::TextTable;
use super::{buildability, fixed};
use crate::assess::Assessment;
use crate::cell::{Coordinate, Placement, Role, Unit};
use crate::files::shown;
use crate::record::{PlacementEntry, RegionEntry, TurnEntry, value_word};
use crate::region::MovableBody;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::fmt::Write;

/// Returns the answer for one feasible layout: placements, errors and limits, yield, cycle time, and room.
///
/// The text is empty if the layout is not feasible.
pub fn answer(a: &Assessment<'_>) -> String {
    if a.evaluation.objective.is_none() {
        return String::new();
    }
    let mut out = format!("\n{}\n{}\n", placements(a), operations(a));
    out.push_str(&super::yield_lines(a));
    out.push_str(&super::cycle_time(a));
    out.push_str(&room(a));
    out
}

/// Returns the table with the placements of the equipment in the frame of the robot base.
fn placements(a: &Assessment<'_>) -> String {
    let mut table = TextTable::new(1);
    table.row(["placement from the robot base", "x mm", "y mm", "z mm", "yaw deg"]);
    let base_moves = a.cell.base.iter().any(Coordinate::is_free);
    if base_moves {
        table.row(row("robot base (world)", &a.layout.base));
    }
    let placed = a.cell.equipment.iter().zip(&a.layout.placements);
    for (equipment, at) in placed.filter(|(e, _)| e.role == Role::Equipment) {
        table.row(row(&shown(&equipment.name), &at.from_base(&a.layout.base)));
    }
    table.render()
}

fn row(name: &str, at: &Placement) -> Vec<String> {
    let mm = |m: f64| rounded(mm_from_m(m), 2).to_string();
    let yaw = rounded(deg_from_rad(at.yaw), 3).to_string();
    vec![name.to_string(), mm(at.x), mm(at.y), mm(at.z), yaw]
}

/// Returns the table of errors and limits.
fn operations(a: &Assessment<'_>) -> String {
    let unit = a.cell.unit();
    let figure = |value: Option<f64>| value.map_or("-".into(), |v| fixed(unit.from_si(v), 4));
    let certified = a.certificate.as_ref().is_some_and(|certificate| certificate.holds());
    let mut table = TextTable::new(1);
    let value = match unit {
        Unit::Cost => value_word(a.cell).to_string(),
        _ => format!("{} {}", value_word(a.cell), unit.word()),
    };
    let mut head = vec!["operation".to_string(), value];
    if certified {
        head.push("misplaced at most".into());
    }
    // If the objective is a cost, this column shows the cost of the tightest tolerances.
    let limit = if unit == Unit::Cost { "tightest" } else { "limit" };
    head.extend([limit.to_string(), "requirement".into()]);
    table.row(head);
    for (k, operation) in a.cell.operations.iter().enumerate() {
        let mut row = vec![shown(&operation.name), figure(a.maps[k].value)];
        if certified {
            row.push(a.worst(k).map_or("no bound known".into(), |worst| figure(Some(worst))));
        }
        let requirement = a.requirement(k);
        row.push(figure(requirement.map(|r| r.limit)));
        row.push(requirement.map_or("-".into(), |r| margin(unit, r)));
        table.row(row);
    }
    table.render() + &buildability::verdict(a)
}

/// Returns the room (allowed displacement) of every piece, and what limits each room. The text also states
/// how far the whole cell may be rotated about the base axis. The text is empty if there are no regions.
fn room(a: &Assessment<'_>) -> String {
    let regions = RegionEntry::all(a);
    if regions.is_empty() {
        return String::new();
    }
    let mut table = TextTable::new(1);
    table.row([
        "room to place (spots unchanged)",
        "mm",
        "deg",
        "z mm from the base",
        "yaw deg from the base",
    ]);
    let from_to = |[least, most]: [f64; 2]| match least == most {
        true => least.to_string(),
        false => format!("{least} to {most}"),
    };
    let figure = |value: Option<f64>| value.map_or("-".into(), |value| value.to_string());
    // The regions are in the world frame.
    let base = PlacementEntry::new(&a.layout.base);
    let less = |range: [f64; 2], by: f64| range.map(|value| rounded(value - by, 2) + 0.0);
    // The yaw of a piece is within half a turn; its range is shifted by the same whole turns.
    let turns = |range: [f64; 2]| (((range[0] + range[1]) / 2.0 - base.yaw_deg) / 360.0).round() * 360.0;
    for region in &regions {
        let RegionEntry { equipment, room_mm, room_deg, z_mm, yaw_deg, .. } = region;
        let from_base = match equipment == MovableBody::Base.name(a.cell) {
            true => [*z_mm, *yaw_deg],
            false => [less(*z_mm, base.z_mm), less(*yaw_deg, base.yaw_deg + turns(*yaw_deg))],
        };
        let [z, yaw] = from_base.map(from_to);
        table.row([shown(equipment), figure(*room_mm), figure(*room_deg), z, yaw]);
    }
    let mut out = table.render();
    for RegionEntry { equipment, ends_with, .. } in &regions {
        let _ = writeln!(out, "  what limits the room of {}: {}", shown(equipment), ends_with);
    }
    if let Some(turn) = TurnEntry::new(a) {
        out.push_str(&whole_cell(&turn));
    }
    out
}

/// Returns how far the whole cell may be rotated about the base axis, as a line of text.
fn whole_cell(turn: &TurnEntry) -> String {
    let [least, most] = turn.turn_deg;
    format!(
        "the whole cell may be rotated about the base axis by {least} to {most} deg while the objective \
        grows by at most the indifference (limited by: {})\n",
        turn.ends_with
    )
}
