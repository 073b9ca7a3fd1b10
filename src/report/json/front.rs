//! `goals`, `pareto`, `keep` and `front` of `search --json`.

use super::{attitudes, base, layout, length};
use crate::cell::{Cell, Goal};
use crate::report::goals;
use crate::search::SearchRecord;
use serde_json::{Map, Value, json};

/// By their keys; null of a layout that is not feasible.
pub(super) fn of_goals(cell: &Cell, values: Option<&[f64]>) -> Value {
    let Some(values) = values else { return Value::Null };
    let entry = |(goal, si): (Goal, &f64)| {
        (goals::key(goal).to_string(), json!(length(goals::value(cell, goal, *si))))
    };
    Value::Object(Goal::ALL.into_iter().zip(values).map(entry).collect::<Map<String, Value>>())
}

/// The names of the goals of a front; null without one.
pub(super) fn pareto(cell: &Cell) -> Value {
    let goals = &cell.search.pareto;
    if goals.is_empty() { Value::Null } else { json!(goals.iter().map(Goal::name).collect::<Vec<_>>()) }
}

/// The layouts beside the best; null if none were asked for.
pub(super) fn front(cell: &Cell, record: &SearchRecord) -> Value {
    if cell.search.keep == 0 && cell.search.pareto.is_empty() {
        return Value::Null;
    }
    let count = record.alternatives.len();
    let one = record.alternatives.iter().enumerate().map(|(k, alternative)| {
        let candidate = &alternative.candidate;
        json!({
            "file": goals::file_name(k, count),
            "objective_value": candidate.evaluation.objective.map(|o| length(cell.unit().from_si(o))),
            "goals": of_goals(cell, Some(&alternative.goals)),
            "layout": layout(cell, &candidate.layout),
            "base": base(&candidate.layout),
            "attitudes": attitudes(cell, &candidate.layout),
        })
    });
    Value::Array(one.collect())
}
