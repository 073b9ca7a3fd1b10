//! The table of a sweep.

use super::table::TextTable;
use crate::files::shown;
use crate::report::sweep::{Row, Spot, best, groups, word};
use std::fmt::Write;

/// Returns the table of all rows with the best marked, then the best of every value.
pub fn sweep(rows: &[Row]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let best = best(rows.iter()).map(|r| r.index);
    let mut table = TextTable::new(2 + first.set.len());
    let mut head = vec![String::new(), "#".into()];
    head.extend(first.set.keys().map(|path| shown(path)));
    head.push("objective".into());
    head.extend(first.operations.iter().map(|o| shown(&o.name)));
    head.push("evaluations".into());
    table.row(head);
    for row in rows {
        let mark = if best == Some(row.index) { "*" } else { "" };
        let mut line = vec![mark.to_string(), format!("{:04}", row.index)];
        line.extend(row.set.values().map(|v| shown(&word(v))));
        line.push(objective(row));
        line.extend(row.operations.iter().map(operation));
        line.push(row.evaluations.to_string());
        table.row(line);
    }
    let mut out = table.render();
    // Writing to a String cannot fail.
    let _ = write!(out, "\n{}", summary(rows));
    out
}

fn objective(row: &Row) -> String {
    match row.objective {
        Some(objective) => format!("{objective:.4} {}", row.unit),
        None => "not feasible".into(),
    }
}

fn operation(spot: &Spot) -> String {
    let Some(value) = spot.value else { return "no spot".into() };
    match spot.limit_met {
        Some(true) => format!("{value:.4} met"),
        Some(false) => format!("{value:.4} missed"),
        None => format!("{value:.4}"),
    }
}

/// Returns one line for every value of every set.
fn summary(rows: &[Row]) -> String {
    let mut table = TextTable::new(2);
    table.row(["set", "value", "best", "#", "feasible"]);
    for group in groups(rows) {
        let best = group.best.map_or("-".into(), objective);
        let index = group.best.map_or(String::new(), |r| format!("{:04}", r.index));
        let count = format!("{} of {}", group.feasible, group.rows);
        table.row([shown(group.path), shown(&word(group.value)), best, index, count]);
    }
    table.render()
}
