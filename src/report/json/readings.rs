//! `readings --json`.

use super::{length, lengths};
use crate::assess::{ReadingChoice, ReadingRow, Readings};
use crate::report::text::findings;
use crate::units::mm_from_m;
use serde_json::{Value, json};

/// The document of `readings --json`.
pub fn readings(r: &Readings<'_>) -> Value {
    let cell = r.cell;
    let operations = cell.operations.iter().zip(&r.operations).map(|(operation, rows)| {
        json!({
            "name": operation.name,
            "equipment": cell.equipment[operation.equipment].name,
            "sense": operation.sense.name,
            "limit": operation.limit.map(|l| length(operation.sense.unit.from_si(l))),
            "readings": rows.iter().map(row).collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": "sweetspot/readings/1",
        "cell": cell.name,
        "robot": cell.robot.name,
        "errors": cell.error_set().name(),
        "model": cell.model.name(),
        "operations": operations.collect::<Vec<_>>(),
        "largest_regret": largest_regret(r),
        "findings": findings(r),
    })
}

fn row(row: &ReadingRow) -> Value {
    let choice = row.choice.as_ref().ok();
    let of = |f: fn(&ReadingChoice) -> Value| choice.map(f);
    let value = |v: f64| length(row.unit.from_si(v));
    json!({
        "reading": row.reading.name(),
        "quantity": row.quantity_name(),
        "registration": row.registration.name(),
        "unit": row.unit.word(),
        "node": of(|c| json!([c.node.0, c.node.1])),
        "position_mm": of(|c| json!(lengths(&c.position))),
        "value": choice.map(|c| value(c.value)),
        "at_signed_choice": row.at_signed.map(value),
        "at_unregistered_choice": row.at_unregistered.map(value),
        "ratio": row.ratio().map(length),
        "moved_mm": choice.and_then(|c| c.moved).map(|m| length(mm_from_m(m))),
        "reason": row.choice.as_ref().err(),
    })
}

/// Null if nothing was chosen by a signed sample.
fn largest_regret(r: &Readings<'_>) -> Value {
    let Some((k, row, ratio)) = r.largest_regret() else { return Value::Null };
    json!({
        "operation": r.cell.operations[k].name,
        "reading": row.reading.name(),
        "quantity": row.quantity_name(),
        "registration": row.registration.name(),
        "ratio": length(ratio),
    })
}
