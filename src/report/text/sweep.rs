//! The table of a sweep.

use super::table::TextTable;
use crate::files::shown;
use crate::record::{RequirementState, SweepGroup, SweepRow, SweepSpot, SweepTable};
use crate::report::sweep::word;
use std::fmt::Write;

/// Returns the table of all rows, in which a star marks the best row. A second table states the best row for
/// each value of each `--set` option.
pub fn sweep(document: &SweepTable) -> String {
    let Some(first) = document.rows.first() else { return String::new() };
    let mut table = TextTable::new(2 + first.set.len());
    let mut head = vec![String::new(), "#".into()];
    head.extend(first.set.keys().map(|path| shown(path)));
    head.push("objective".into());
    head.extend(first.operations.iter().map(|o| shown(&o.name)));
    head.push("evaluations".into());
    table.row(head);
    for row in &document.rows {
        let mark = if document.best == Some(row.index) { "*" } else { "" };
        let mut line = vec![mark.to_string(), format!("{:04}", row.index)];
        line.extend(row.set.values().map(|v| shown(&word(v))));
        line.push(objective(row));
        line.extend(row.operations.iter().map(operation));
        line.push(row.evaluations.to_string());
        table.row(line);
    }
    let mut out = table.render();
    // Writing to a String cannot fail.
    let _ = write!(out, "\n{}", summary(document));
    out
}

fn objective(row: &SweepRow) -> String {
    match row.objective {
        Some(objective) => format!("{objective:.4} {}", row.unit.word()),
        None => "not feasible".into(),
    }
}

fn operation(spot: &SweepSpot) -> String {
    let Some(value) = spot.value else { return "no spot".into() };
    match spot.requirement {
        RequirementState::Met => format!("{value:.4} met"),
        RequirementState::Missed => format!("{value:.4} missed"),
        RequirementState::NotGuaranteed => format!("{value:.4} not guaranteed"),
        RequirementState::None => format!("{value:.4}"),
    }
}

/// Returns one line for every value of every `--set` option.
fn summary(document: &SweepTable) -> String {
    let mut table = TextTable::new(2);
    table.row(["set", "value", "best", "#", "feasible"]);
    for group in &document.best_of {
        let SweepGroup { path, value, combinations, feasible, best, .. } = group;
        let row = best.and_then(|index| document.row(index));
        let index = best.map_or(String::new(), |index| format!("{index:04}"));
        let count = format!("{feasible} of {combinations}");
        table.row([shown(path), shown(&word(value)), row.map_or("-".into(), objective), index, count]);
    }
    table.render()
}
