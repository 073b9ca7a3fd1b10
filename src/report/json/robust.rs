//! `robust --json`, and `robustness` of each operation in `search --json`.

use super::{base, layout, length, refined};
use crate::assess::Assessment;
use crate::cell::{Cell, Slot};
use crate::layout::{Corner, Largest, Lost, MisplacementEnd, Robustness};
use crate::report::text::value_word;
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg};
use serde_json::{Map, Value, json};

/// The document of `robust --json`.
pub fn robust(a: &Assessment<'_>) -> Value {
    let operations = a.cell.operations.iter().enumerate().map(|(k, operation)| {
        json!({
            "name": operation.name,
            "equipment": a.cell.equipment[operation.equipment].name,
            "sense": operation.sense.name,
            "limit": operation.limit.map(|limit| length(operation.sense.unit.from_si(limit))),
            "refined": refined(a, k),
            "robustness": robustness(a, k),
        })
    });
    json!({
        "schema": "sweetspot/robust/1",
        "cell": a.cell.name,
        "robot": a.cell.robot.name,
        "errors": a.cell.error_set().name(),
        "quantity": value_word(a.cell),
        "unit": a.cell.unit().word(),
        "feasible": a.evaluation.objective.is_some(),
        "holds": a.is_robust(),
        "reasons": a.reasons(),
        "layout": layout(a.cell, &a.layout),
        "base": base(&a.layout),
        "operations": operations.collect::<Vec<_>>(),
    })
}

/// Null of an operation without a spot, or if it was not asked.
pub(super) fn robustness(a: &Assessment<'_>, k: usize) -> Value {
    let (cell, unit) = (a.cell, a.cell.unit());
    let Some(Some(r)) = a.robustness.get(k) else { return Value::Null };
    let Robustness { value, tolerance, corners, worst, lost, gradient, scale, shift, turn } = r;
    let value_of = |si: f64| length(unit.from_si(si));
    let slopes = gradient.iter().map(|(slot, slope)| {
        let per = if slot.is_angle() { rad_from_deg(1.0) } else { m_from_mm(1.0) };
        let word = if slot.is_angle() { "deg" } else { "mm" };
        let value = slope.map(|slope| length(unit.from_si(slope * per)));
        json!({ "of": body(cell, *slot), "number": number(*slot), "value": value, "per": word })
    });
    json!({
        "value": value_of(*value),
        "tolerance": moves(cell, tolerance),
        "corners": corners,
        "worst": worst.as_ref().map(|corner| self::corner(cell, corner)),
        "lost": lost.iter().map(|lost| self::lost(cell, lost)).collect::<Vec<_>>(),
        "gradient": slopes.collect::<Vec<_>>(),
        "largest_times_tolerance": scale.as_ref().map(|scale| largest(cell, scale, |s| s)),
        "largest_in_plan_mm": largest(cell, shift, mm_from_m),
        "largest_yaw_deg": largest(cell, turn, deg_from_rad),
        "holds": r.holds(),
    })
}

fn corner(cell: &Cell, corner: &Corner) -> Value {
    json!({ "moves": moves(cell, &corner.moves), "value": length(cell.unit().from_si(corner.value)) })
}

fn lost(cell: &Cell, lost: &Lost) -> Value {
    json!({ "moves": moves(cell, &lost.moves), "status": lost.status.name(), "reason": lost.status.reason(cell) })
}

/// `ended` is null if nothing ended it as far as it was looked.
fn largest(cell: &Cell, largest: &Largest, shown: impl Fn(f64) -> f64) -> Value {
    let ended = largest.ended.as_ref().map(|ended| match ended {
        MisplacementEnd::Lost(at) => lost(cell, at),
        MisplacementEnd::Limit(at) => corner(cell, at),
    });
    json!({ "most": length(shown(largest.most)), "ended": ended })
}

/// `{ "worktable": { "x_mm": 2, "yaw_deg": -0.2 } }`.
fn moves(cell: &Cell, moves: &[(Slot, f64)]) -> Value {
    let mut all = Map::new();
    for (slot, by) in moves {
        let entry = all.entry(body(cell, *slot)).or_insert_with(|| json!({}));
        entry[number(*slot)] =
            json!(length(if slot.is_angle() { deg_from_rad(*by) } else { mm_from_m(*by) }));
    }
    Value::Object(all)
}

/// An equipment by its name, or the robot base.
fn body(cell: &Cell, slot: Slot) -> String {
    match slot {
        Slot::Equipment(k, _) => cell.equipment[k].name.clone(),
        _ => "robot base".into(),
    }
}

fn number(slot: Slot) -> &'static str {
    match slot {
        Slot::Base(axis) | Slot::Equipment(_, axis) => ["x_mm", "y_mm", "z_mm", "yaw_deg"][axis],
        Slot::Attitude(_, angle) => ["bend_deg", "azimuth_deg", "spin_deg"][angle],
    }
}
