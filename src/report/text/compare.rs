//! Layouts side by side.

use super::table::Table;
use super::{STATUSES, USUAL, mm, mm1, value_word};
use crate::cell::Unit;
use crate::compare::{Assessment, Comparison};
use crate::units::{deg_from_rad, rounded};
use std::fmt::Write;

/// Layouts side by side.
pub fn comparison(comparison: &Comparison<'_>) -> String {
    let mut table = Table::new(2);
    let columns = &comparison.columns;
    table.labelled("", "", columns.iter().map(|c| c.label.clone()));
    for name in comparison.equipment() {
        placement_rows(&mut table, name, columns);
    }
    if let Some(first) = columns.first() {
        for k in 0..first.cell.operations.len() {
            operation_rows(&mut table, k, comparison);
        }
    }
    let objective = |a: &Assessment<'_>| a.objective();
    let cells = (0..columns.len()).map(|c| with_change(comparison, c, &objective));
    table.labelled("objective", columns.first().map_or("", |c| c.cell.unit().word()), cells);
    let mut out = table.render();
    for column in columns.iter().filter(|c| c.evaluation.objective.is_none()) {
        let _ = write!(out, "\n{}", feasibility(column));
    }
    out
}

/// The objective of a layout, or line by line why it has none.
pub fn feasibility(a: &Assessment<'_>) -> String {
    match a.objective() {
        Some(objective) => {
            format!("{} layout: objective {objective:.4} {}\n", a.label, a.cell.unit().word())
        }
        None => format!("{} layout is not feasible:\n  {}\n", a.label, a.reasons().join("\n  ")),
    }
}

fn placement_rows(table: &mut Table, name: &str, columns: &[Assessment<'_>]) {
    let of = |a: &Assessment<'_>| {
        let k = a.cell.equipment.iter().position(|e| e.name == name)?;
        Some(a.layout.placements[k])
    };
    let cells = |f: fn(&crate::cell::Placement) -> String| {
        columns.iter().map(move |c| of(c).map_or("-".into(), |p| f(&p))).collect::<Vec<_>>()
    };
    table.labelled(name, "x, y mm", cells(|p| format!("{}, {}", mm(p.x), mm(p.y))).into_iter());
    table.labelled("", "z mm", cells(|p| mm(p.z)).into_iter());
    table.labelled("", "yaw deg", cells(|p| rounded(deg_from_rad(p.yaw), 4).to_string()).into_iter());
}

fn operation_rows(table: &mut Table, k: usize, comparison: &Comparison<'_>) {
    let columns = &comparison.columns;
    let operation = &columns[0].cell.operations[k];
    let spot = |a: &Assessment<'_>| match a.spot(k) {
        Some((n, _)) => format!("{}, {}, {}", mm1(n.position.x), mm1(n.position.y), mm1(n.position.z)),
        None => "none".into(),
    };
    table.labelled(&operation.name, "spot x, y, z mm", columns.iter().map(spot));
    let joints = |a: &Assessment<'_>| match a.spot(k) {
        Some((_, p)) => {
            let q = p.joints.iter().take(a.cell.robot.axes());
            q.map(|q| format!("{:.2}", rounded(deg_from_rad(*q), 2))).collect::<Vec<_>>().join(", ")
        }
        None => "-".into(),
    };
    table.labelled("", "joints deg", columns.iter().map(joints));
    let cell = columns[0].cell;
    let word = if cell.unit() == Unit::Share { "p95" } else { value_word(cell) };
    for sense in &columns[0].maps[k].senses {
        let asked = if *sense == operation.sense { " <- asked" } else { "" };
        let error = |a: &Assessment<'_>| a.error_at(k, &sense.name);
        let cells = (0..columns.len()).map(|c| with_change(comparison, c, &error));
        table.labelled("", &format!("{word} {} {}{asked}", sense.name, sense.unit.word()), cells);
    }
    if operation.limit.is_some() {
        let success = |a: &Assessment<'_>| a.spot(k).and_then(|(_, p)| p.success);
        table.labelled("", "yield", (0..columns.len()).map(|c| with_change(comparison, c, &success)));
    }
    for (status, words) in STATUSES {
        if !USUAL.contains(&status) && columns.iter().all(|c| c.maps[k].count(status) == 0) {
            continue;
        }
        table.labelled(
            "",
            &format!("nodes {words}"),
            columns.iter().map(|c| c.maps[k].count(status).to_string()),
        );
    }
}

/// A value and its change from the first column.
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
