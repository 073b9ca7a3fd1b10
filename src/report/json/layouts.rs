//! `search --json` and `compare --json`.

use super::front::{front, of_goals, pareto};
use super::map::{counts, guard, monte_carlo};
use super::robust::robustness;
use super::{attitudes, base, joints, layout, length, lengths, refined, rounded_down};
use crate::assess::{Assessment, Comparison};
use crate::cell::{Cell, Operation, Unit};
use crate::error_map::OperationMap;
use crate::proof::{OperationBound, Proof, WhyNot};
use crate::reading::Figures;
use crate::report::text::value_word;
use crate::search::SearchRecord;
use crate::units::rounded;
use serde_json::{Map, Value, json};

/// The document of `search --json`. Without `seconds` it is the file search.json, which is the same
/// for any number of threads.
pub fn search(
    cell: &Cell,
    (record, proof): (&SearchRecord, &Proof),
    assessed: &Comparison<'_>,
    seconds: Option<f64>,
) -> Value {
    let [start, best] = &assessed.columns[..] else { return Value::Null };
    let mut document = json!({
        "schema": "sweetspot/search/1",
        "status": if record.found() { "found" } else { "none" },
        "objective_mm": best.objective_mm().map(length),
        "objective_value": best.objective().map(length),
        "unit": cell.unit().word(),
        "gain_percent": assessed.change_percent(1, Assessment::objective).map(|c| rounded(-c, 6)),
        "bound": record.bound.map(|b| rounded_down(cell.unit().from_si(b))),
        "gap_percent": record.gap().map(|g| rounded(g * 100.0, 6)),
        "proof": proven(cell, proof),
        "evaluations": record.evaluations,
        "feasible": record.feasible,
        "ended": record.ended.name(),
        "cell": cell.name,
        "robot": cell.robot.name,
        "errors": cell.error_set().name(),
        "model": cell.model.name(),
        "reading": cell.reading.name(),
        "quantity": value_word(cell),
        "registration": cell.registration.name(),
        "notes": crate::report::text::caveats(cell),
        "objective": cell.search.objective.name(),
        "solver": cell.search.solver.name(),
        "seed": cell.search.seed,
        "budget": cell.search.budget,
        "robust": cell.search.robust,
        "pareto": pareto(cell),
        "keep": Some(cell.search.keep).filter(|keep| *keep > 0),
        "reasons": best.reasons(),
        "goals": of_goals(cell, best.goals().as_deref()),
        "layout": layout(cell, &best.layout),
        "base": base(&best.layout),
        "attitudes": attitudes(cell, &best.layout),
        "operations": spots(best),
        "start": {
            "objective_mm": start.objective_mm().map(length),
            "objective_value": start.objective().map(length),
            "reasons": start.reasons(),
            "layout": layout(cell, &start.layout),
            "base": base(&start.layout),
            "attitudes": attitudes(cell, &start.layout),
            "operations": spots(start),
        },
        "front": front(cell, record),
        "trace": record.trace.iter().map(|(n, e)| json!([n, length(cell.unit().from_si(*e))])).collect::<Vec<_>>(),
    });
    if let (Some(seconds), Some(object)) = (seconds, document.as_object_mut()) {
        object.insert("seconds".into(), json!(rounded(seconds, 3)));
    }
    document
}

/// What is proven of each operation, or why nothing is.
fn proven(cell: &Cell, proof: &Proof) -> Value {
    let operation = |(bound, operation): (&OperationBound, &Operation)| {
        let unit = operation.sense.unit;
        json!({
            "name": operation.name,
            "bound": bound.value.ok().map(|v| rounded_down(unit.from_si(v))),
            "unit": unit.word(),
            "why_not": bound.value.err().map(WhyNot::in_words),
            "boxes": bound.boxes,
        })
    };
    json!({
        "covers": proof.covers.name(),
        "operations": proof.operations.iter().zip(&cell.operations).map(operation).collect::<Vec<_>>(),
    })
}

/// The document of `compare --json`.
pub fn compare(comparison: &Comparison<'_>) -> Value {
    let layouts = comparison.columns.iter().enumerate().map(|(k, a)| {
        json!({
            "name": a.label,
            "feasible": a.evaluation.objective.is_some(),
            "objective_mm": a.objective_mm().map(length),
            "objective": a.objective().map(length),
            "unit": a.cell.unit().word(),
            "change_percent": comparison.change_percent(k, Assessment::objective).map(length),
            "reasons": a.reasons(),
            "layout": layout(a.cell, &a.layout),
            "base": base(&a.layout),
            "attitudes": attitudes(a.cell, &a.layout),
            "operations": spots(a),
        })
    });
    json!({ "schema": "sweetspot/compare/1", "layouts": layouts.collect::<Vec<_>>() })
}

/// The spot of every operation.
fn spots(a: &Assessment<'_>) -> Value {
    let one = |(k, map): (usize, &OperationMap)| {
        let operation = &a.cell.operations[map.operation];
        let spot = a.spot(k);
        let figures = |figure: fn(&Figures) -> f64| {
            let of = |s: &crate::cell::Sense| {
                let value = a.figures(k, &s.name).map(|f| length(s.unit.from_si(figure(f))));
                (s.name.clone(), json!(value))
            };
            map.senses.iter().filter(|s| s.unit == Unit::Length).map(of).collect::<Map<String, Value>>()
        };
        let own = a.figures(k, &operation.sense.name).map(|f| operation.sense.unit.from_si(f.error));
        let in_sense = |unit| own.filter(|_| operation.sense.unit == unit).map(length);
        json!({
            "name": operation.name,
            "equipment": a.cell.equipment[operation.equipment].name,
            "sense": operation.sense.name,
            "place": operation.place.in_words(),
            "over": operation.over.name(),
            "value": map.value.map(|value| length(a.cell.unit().from_si(value))),
            "requirement": a.requirement(k).map(|r| json!({
                "limit": length(a.cell.unit().from_si(r.limit)),
                "margin": length(a.cell.unit().from_si(r.margin)),
                "met": r.is_met(),
            })),
            "node": spot.map(|(n, _)| json!([n.i, n.j])),
            "position_mm": spot.map(|(n, _)| lengths(&n.position)),
            "joints_deg": spot.map(|(_, p)| joints(a.cell, &p.joints)),
            "refined": refined(a, k),
            "robustness": robustness(a, k),
            "error_mm": spot.map(|(_, p)| lengths(&p.error)),
            "error_sense_mm": in_sense(Unit::Length),
            "error_sense_deg": in_sense(Unit::Angle),
            "error_by_sense_mm": figures(|f| f.error),
            "worst_mm": figures(|f| f.worst),
            "rms_mm": figures(|f| f.rms),
            "p95_mm": figures(|f| f.p95),
            "yield": spot.and_then(|(_, p)| p.success).map(length),
            "guard": guard(a.cell, map),
            "monte_carlo": monte_carlo(a, k),
            "counts": counts(map),
        })
    };
    Value::Array(a.maps.iter().enumerate().map(one).collect())
}
