//! A row of a sweep.

use super::{layout, length, lengths, rounded_down};
use crate::assess::Assessment;
use crate::files::Choices;
use crate::report::sweep::{Row, Spot};
use crate::search::SearchRecord;
use crate::units::rounded;
use serde_json::{Map, Value};

/// The value of each set in the combination of an index: the last set changes fastest.
pub fn values(sets: &[Choices], index: usize) -> Vec<&str> {
    let mut rest = index;
    let mut values: Vec<&str> = sets
        .iter()
        .rev()
        .map(|set| {
            let value = &set.values[rest % set.values.len()];
            rest /= set.values.len();
            value.as_str()
        })
        .collect();
    values.reverse();
    values
}

/// The row of a combination, from the layout that it came to; `record`: of its search, none of a map.
pub fn row(sets: &[Choices], index: usize, a: &Assessment<'_>, record: Option<&SearchRecord>) -> Row {
    let paths = sets.iter().map(|s| s.path.clone());
    let typed = values(sets, index).into_iter();
    let read = typed.map(|v| serde_json::from_str(v).unwrap_or_else(|_| Value::String(v.into())));
    let Value::Object(layout) = layout(a.cell, &a.layout) else { return Row::default() };
    let feasible = a.evaluation.objective.is_some();
    Row {
        index,
        set: paths.zip(read).collect::<Map<_, _>>(),
        feasible,
        objective: a.objective().map(length),
        unit: a.cell.unit().word().to_string(),
        bound: record.and_then(|r| r.bound).map(|b| rounded_down(a.cell.unit().from_si(b))),
        gap_percent: record.and_then(SearchRecord::gap).map(|g| rounded(g * 100.0, 6)),
        evaluations: record.map_or(1, |r| r.evaluations),
        feasible_evaluations: record.map_or(u64::from(feasible), |r| r.feasible),
        operations: (0..a.maps.len()).map(|k| spot(a, k)).collect(),
        layout,
        reasons: a.reasons(),
    }
}

fn spot(a: &Assessment<'_>, k: usize) -> Spot {
    let operation = &a.cell.operations[a.maps[k].operation];
    let (unit, at) = (operation.sense.unit, a.spot(k));
    let error = a.error_at(k, &operation.sense.name);
    let limit = operation.limit.map(|limit| unit.from_si(limit));
    Spot {
        name: operation.name.clone(),
        value: at.map(|(_, p)| length(a.cell.unit().from_si(p.value))),
        position_mm: at.map(|(n, _)| lengths(&n.position)),
        error: error.map(length),
        limit: limit.map(length),
        error_unit: unit.word().to_string(),
        limit_met: error.zip(limit).map(|(error, limit)| error <= limit),
    }
}
