//! Comparison of layouts.

use super::table::TextTable;
use super::{ALWAYS_COUNTED, fixed, mm, mm1, percent1};
use crate::assess::{Assessment, Comparison, Requirement};
use crate::cell::{Cell, Coordinate, JointKind, Objective, Slot, Unit};
use crate::error_map::NodeSign;
use crate::layout::Refined;
use crate::record::{joints as joint_coordinates, near_limits, reading_word};
use crate::units::{deg_from_rad, rounded};
use std::fmt::Write;

/// Returns the certificates of the layouts, the comparison table, and the reasons why layouts are not
/// feasible.
pub fn comparison(comparison: &Comparison<'_>) -> String {
    let mut out: String = comparison.columns.iter().map(super::certificate).collect();
    if !out.is_empty() {
        out.push('\n');
    }
    out + &side_by_side(comparison)
}

/// Returns the table of [`comparison`] without the certificates, then the reasons why layouts are not
/// feasible.
pub fn side_by_side(comparison: &Comparison<'_>) -> String {
    let mut out = comparison_table(comparison).render();
    for column in comparison.columns.iter().filter(|c| c.evaluation.objective.is_none()) {
        let _ = write!(out, "\n{}", feasibility(column));
    }
    out
}

/// Returns the table of [`comparison`]: group, label, and one table cell for each layout. The first row names
/// the layouts.
pub fn comparison_table(comparison: &Comparison<'_>) -> TextTable {
    let mut table = TextTable::new(2);
    let columns = &comparison.columns;
    table.labelled("", "", columns.iter().map(|c| c.label.clone()));
    for name in comparison.equipment() {
        placement_rows(&mut table, name, columns);
    }
    if let Some(first) = columns.first() {
        base_rows(&mut table, columns);
        for k in 0..first.cell.operations.len() {
            operation_rows(&mut table, k, comparison);
        }
    }
    let objective = |a: &Assessment<'_>| a.objective();
    let cells = (0..columns.len()).map(|c| with_change(comparison, c, &objective));
    if columns.iter().any(|c| c.cell_yield.is_some()) && columns.iter().all(|c| c.maps.len() > 1) {
        let share = |a: &Assessment<'_>| a.cell_yield.map(|estimate| estimate.value);
        let cells = (0..columns.len()).map(|c| with_change(comparison, c, &share));
        table.labelled("all operations", "yield of the samples", cells);
    }
    let time = |a: &Assessment<'_>| a.cycle_time().map(|cycle| cycle.total());
    if columns.iter().any(|c| time(c).is_some()) {
        let cells = (0..columns.len()).map(|c| with_change(comparison, c, &time));
        table.labelled("cycle", "time s", cells);
    }
    let label = columns.first().map_or(String::new(), |c| objective_label(c.cell));
    table.labelled("optimizer", &label, cells);
    table
}

/// Returns the label of the objective, with the unit.
fn objective_label(cell: &Cell) -> String {
    let how = match (cell.operations.len(), cell.search.objective) {
        (1, _) => "",
        (_, Objective::WeightedSum) => ", weighted sum",
        (_, Objective::WeightedMaximum) => ", weighted maximum",
        (_, Objective::Lexicographic) => ", in order of priority",
        (_, Objective::ToleranceCost) => ", tolerances for all operations:",
    };
    let misplaced = if cell.search.robust { " if misplaced" } else { "" };
    format!("objective{misplaced}{how} {}", cell.unit().word()).trim_end().to_string()
}

/// Returns the objective of a layout, or the reasons why it is not feasible, one per line.
pub fn feasibility(a: &Assessment<'_>) -> String {
    verdict(&a.label, a.cell.unit(), a.evaluation.objective, &a.reasons())
}

/// Returns the objective of a layout as text, or the reasons why the layout is not feasible, one per line.
/// `label` names the layout, and `objective` is in SI units.
pub fn verdict(label: &str, unit: Unit, objective: Option<f64>, reasons: &[String]) -> String {
    match objective.map(|objective| unit.from_si(objective)) {
        Some(objective) => format!("{label} layout: objective {objective:.4} {}\n", unit.word()),
        None => format!("{label} layout is not feasible:\n  {}\n", reasons.join("\n  ")),
    }
}

fn placement_rows(table: &mut TextTable, name: &str, columns: &[Assessment<'_>]) {
    let of = |a: &Assessment<'_>| {
        let k = a.cell.equipment.iter().position(|e| e.name == name)?;
        Some(a.layout.placements[k])
    };
    let cells = |f: fn(&crate::cell::Placement) -> String| {
        columns.iter().map(move |c| of(c).map_or("-".into(), |p| f(&p))).collect::<Vec<_>>()
    };
    let tied = columns.iter().any(|c| c.cell.equipment.iter().any(|e| e.name == name && e.on.is_some()));
    let word = if tied { "x, y mm (world)" } else { "x, y mm" };
    table.labelled(name, word, cells(|p| format!("{}, {}", mm(p.x), mm(p.y))).into_iter());
    table.labelled("", "z mm", cells(|p| mm(p.z)).into_iter());
    table.labelled("", "yaw deg", cells(|p| rounded(deg_from_rad(p.yaw), 4).to_string()).into_iter());
}

/// Adds the placement of the robot base if a search may move the base in at least one compared cell.
fn base_rows(table: &mut TextTable, columns: &[Assessment<'_>]) {
    if !columns.iter().any(|c| c.cell.base.iter().any(Coordinate::is_free)) {
        return;
    }
    let cells = |f: fn(&crate::cell::Placement) -> String| columns.iter().map(move |c| f(&c.layout.base));
    table.labelled("robot base", "x, y mm", cells(|p| format!("{}, {}", mm(p.x), mm(p.y))));
    table.labelled("", "z mm", cells(|p| mm(p.z)));
    table.labelled("", "yaw deg", cells(|p| rounded(deg_from_rad(p.yaw), 4).to_string()));
}

/// Adds a row for each attitude angle that a search may change in at least one compared cell.
fn attitude_rows(table: &mut TextTable, k: usize, columns: &[Assessment<'_>]) {
    for (angle, word) in ["bend deg", "azimuth deg", "spin deg"].into_iter().enumerate() {
        let is_free =
            |c: &Assessment<'_>| c.cell.operations[k].angles[angle].as_ref().is_some_and(Coordinate::is_free);
        if columns.iter().any(is_free) {
            let value = |c: &Assessment<'_>| deg_from_rad(c.layout.value(c.cell, Slot::Attitude(k, angle)));
            table.labelled("", word, columns.iter().map(|c| rounded(value(c), 4).to_string()));
        }
    }
}

/// Adds a row with the value over all nodes (max, mean or p95) if the operation happens at every node. If the
/// operation has a limit and the objective is an error, adds a row with the margin to this limit.
fn worth_rows(table: &mut TextTable, k: usize, columns: &[Assessment<'_>]) {
    let (operation, unit) = (&columns[0].cell.operations[k], columns[0].cell.unit());
    if operation.over.needs_every_node() {
        let word = format!("{} of {} {}", operation.over.name(), operation.place.in_words(), unit.word());
        let value = |a: &Assessment<'_>| a.maps[k].value.map_or("-".into(), |v| fixed(unit.from_si(v), 4));
        table.labelled("", &word, columns.iter().map(value));
    }
    if let Some(limit) = operation.limit.filter(|_| unit.is_error()) {
        let word = format!("limit {} {}", fixed(unit.from_si(limit), 4), unit.word());
        let told = |a: &Assessment<'_>| a.requirement(k).map_or("-".into(), |r| margin(a.cell.unit(), r));
        table.labelled("", &word, columns.iter().map(told));
    }
}

/// Describes whether a limit is met, and by which margin. No margin is given if the objective is a cost of
/// tolerances.
pub fn margin(unit: Unit, r: Requirement) -> String {
    if !r.known {
        "not guaranteed: no bound over the misplacements is known".into()
    } else if unit == Unit::Cost {
        if r.is_met() { "met".into() } else { "MISSED with the tightest tolerances".into() }
    } else if r.is_met() {
        format!("met, {} to spare", fixed(unit.from_si(r.margin), 4))
    } else if r.is_unproven() {
        let most = fixed(unit.from_si(r.limit - r.margin), 4);
        format!("not guaranteed: the proven bound over the misplacements is {most}")
    } else {
        format!("MISSED by {}", fixed(unit.from_si(-r.margin), 4))
    }
}

/// Adds the refined spot between the nodes, if any layout has one.
fn refined_rows(table: &mut TextTable, k: usize, columns: &[Assessment<'_>]) {
    if columns.iter().all(|c| c.refined[k].is_none()) {
        return;
    }
    let cells = |f: &dyn Fn(&Refined) -> String| {
        let of = |c: &Assessment<'_>| c.refined[k].as_ref().map_or("-".into(), f);
        columns.iter().map(of).collect::<Vec<_>>()
    };
    let position = |r: &Refined| r.position.iter().map(|v| mm1(*v)).collect::<Vec<_>>().join(", ");
    table.labelled("", "refined x, y, z mm", cells(&position).into_iter());
    let unit = columns[0].cell.unit();
    let value = |r: &Refined| format!("{} (-{})", fixed(unit.from_si(r.value), 4), percent1(r.gain()));
    table.labelled(
        "",
        &format!("refined {} (change from the best node)", unit.word()),
        cells(&value).into_iter(),
    );
}

fn operation_rows(table: &mut TextTable, k: usize, comparison: &Comparison<'_>) {
    let columns = &comparison.columns;
    let operation = &columns[0].cell.operations[k];
    let spot = |a: &Assessment<'_>| match a.spot(k) {
        Some((n, _)) => format!("{}, {}, {}", mm1(n.position.x), mm1(n.position.y), mm1(n.position.z)),
        None => "none".into(),
    };
    table.labelled(&operation.name, "spot x, y, z mm", columns.iter().map(spot));
    refined_rows(table, k, columns);
    let joints = |a: &Assessment<'_>| match a.spot(k) {
        Some((_, p)) => {
            let q = joint_coordinates(a.cell, &p.joints);
            let near = near_limits(a.cell, &p.joints);
            let mark =
                |(q, near): (&f64, bool)| format!("{:.2}{}", rounded(*q, 2), if near { "!" } else { "" });
            q.iter().zip(near).map(mark).collect::<Vec<_>>().join(", ")
        }
        None => "-".into(),
    };
    let slides = columns.iter().any(|a| a.cell.robot.joints.iter().any(|j| j.kind == JointKind::Prismatic));
    let units = if slides { "joints deg, slides mm" } else { "joints deg" };
    let near =
        |a: &Assessment<'_>| a.spot(k).is_some_and(|(_, p)| near_limits(a.cell, &p.joints).contains(&true));
    let note = if columns.iter().any(near) { " (! near its limit)" } else { "" };
    table.labelled("", &format!("{units}{note}"), columns.iter().map(joints));
    attitude_rows(table, k, columns);
    let cell = columns[0].cell;
    let word = if cell.is_yield() { "p95" } else { reading_word(cell) };
    for sense in &columns[0].maps[k].senses {
        let asked = if *sense == operation.sense { " <- own sense" } else { "" };
        let error = |a: &Assessment<'_>| a.error_at(k, &sense.name);
        let cells = (0..columns.len()).map(|c| with_change(comparison, c, &error));
        table.labelled("", &format!("{word} {} {}{asked}", sense.name, sense.unit.word()), cells);
    }
    worth_rows(table, k, columns);
    if operation.limit.is_some() {
        let success = |a: &Assessment<'_>| a.spot(k).and_then(|(_, p)| p.success);
        table.labelled("", "yield", (0..columns.len()).map(|c| with_change(comparison, c, &success)));
    }
    for sign in NodeSign::ALL {
        if !ALWAYS_COUNTED.contains(&sign) && columns.iter().all(|c| c.maps[k].count(sign) == 0) {
            continue;
        }
        table.labelled(
            "",
            &format!("nodes {}", sign.label()),
            columns.iter().map(|c| c.maps[k].count(sign).to_string()),
        );
    }
}

/// Returns the value of a column, and its change from the value of the first column.
fn with_change(
    comparison: &Comparison<'_>,
    column: usize,
    value: &dyn Fn(&Assessment<'_>) -> Option<f64>,
) -> String {
    let Some(v) = value(&comparison.columns[column]) else { return "-".into() };
    match comparison.change_percent(column, value) {
        Some(change) => format!("{v:.4} ({change:+.1} %)"),
        None => format!("{v:.4}"),
    }
}
