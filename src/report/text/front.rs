//! What else a layout is good at, and the layouts beside the best one.

use super::fixed;
use super::table::Table;
use crate::assess::Assessment;
use crate::cell::{Cell, Goal};
use crate::record::goals;
use crate::search::SearchRecord;

/// Rows told in the terminal; front.csv has all.
const TOLD: usize = 40;

fn cells<'a>(cell: &'a Cell, values: &'a [f64]) -> impl Iterator<Item = String> + 'a {
    Goal::ALL.into_iter().zip(values).map(|(goal, si)| fixed(goals::value(cell, goal, *si), 4))
}

/// The goals of a layout in one line; empty if it is not feasible.
pub fn goals_line(a: &Assessment<'_>) -> String {
    let Some(values) = a.goals() else { return String::new() };
    let others = Goal::ALL.into_iter().zip(cells(a.cell, &values)).skip(1);
    let said = others.map(|(goal, value)| format!("{} {value} {}", goal.name(), goals::word(a.cell, goal)));
    let said: Vec<_> = said.map(|s| s.trim_end().to_string()).collect();
    format!("{} layout: {}\n", a.label, said.join(", "))
}

/// The front or the shortlist as a table; empty if there is none.
pub fn front(cell: &Cell, record: &SearchRecord) -> String {
    let count = record.alternatives.len();
    if count == 0 {
        return String::new();
    }
    let mut table = Table::new(1);
    table.row(["layout".to_string()].into_iter().chain(Goal::ALL.map(|goal| goals::head(cell, goal))));
    for (k, alternative) in record.alternatives.iter().take(TOLD).enumerate() {
        table.row([(k + 1).to_string()].into_iter().chain(cells(cell, &alternative.goals)));
    }
    let more =
        if count > TOLD { format!("and {} more: see front.csv\n", count - TOLD) } else { String::new() };
    format!("{}:\n{}{more}", goals::in_words(&cell.search.pareto, record), table.render())
}
