//! Goals of a layout, and the Pareto front or shortlist of layouts.

use super::fixed;
use super::table::TextTable;
use crate::assess::Assessment;
use crate::cell::{Cell, Goal};
use crate::record::goals;
use crate::search::SearchRecord;

/// Largest number of rows in the terminal; front.csv has all rows.
const MAX_ROWS_SHOWN: usize = 40;

/// Returns the values of the goals that the search of the cell measures. `values` are in the order of
/// [`Goal::ALL`].
fn cells<'a>(cell: &'a Cell, values: &'a [f64]) -> impl Iterator<Item = String> + 'a {
    let of = |goal: Goal| Goal::ALL.iter().position(|g| *g == goal).and_then(|k| values.get(k));
    cell.measured_goals().filter_map(move |goal| Some(fixed(goals::value(cell, goal, *of(goal)?), 4)))
}

/// Returns the goals of a layout, without the error, in one line. The text is empty if the layout is not
/// feasible.
pub fn goals_line(a: &Assessment<'_>) -> String {
    let Some(values) = a.goals() else { return String::new() };
    let others = a.cell.measured_goals().zip(cells(a.cell, &values)).skip(1);
    let said = others.map(|(goal, value)| format!("{} {value} {}", goal.name(), goals::word(a.cell, goal)));
    let said: Vec<_> = said.map(|s| s.trim_end().to_string()).collect();
    format!("{} layout: {}\n", a.label, said.join(", "))
}

/// Returns the Pareto front or the shortlist as a table; empty if the search kept no layouts.
pub fn front(cell: &Cell, record: &SearchRecord) -> String {
    let count = record.alternatives.len();
    if count == 0 {
        return String::new();
    }
    let mut table = TextTable::new(1);
    table.row(
        ["layout".to_string()].into_iter().chain(cell.measured_goals().map(|goal| goals::head(cell, goal))),
    );
    for (k, alternative) in record.alternatives.iter().take(MAX_ROWS_SHOWN).enumerate() {
        table.row([(k + 1).to_string()].into_iter().chain(cells(cell, &alternative.goals)));
    }
    let more = if count > MAX_ROWS_SHOWN {
        format!("and {} more: see front.csv\n", count - MAX_ROWS_SHOWN)
    } else {
        String::new()
    };
    format!("{}:\n{}{more}", goals::in_words(&cell.search.pareto, record), table.render())
}
