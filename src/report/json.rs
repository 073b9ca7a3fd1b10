//! The machine-readable contract: field names of `map`, `search` and `compare --json`.
//!
//! Lengths in mm, angles in degrees, rounded to 1e-9; world frame; joints in the robot's own
//! coordinates. What has no value is null, never left out.

use crate::cell::{Cell, Layout, Role, Sense};
use crate::compare::{Assessment, Comparison};
use crate::error_map::{NodeRecord, OperationMap, PostureRecord};
use crate::kinematic_error::discrepancy;
use crate::search::{Ended, SearchRecord};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// The document of `map --json`.
pub fn map(assessment: &Assessment<'_>) -> Value {
    let cell = assessment.cell;
    let operations: Vec<_> = assessment.maps.iter().map(|m| operation_map(cell, m)).collect();
    json!({
        "schema": "sweetspot/map/1",
        "cell": cell.name,
        "robot": cell.robot.name,
        "feasible": assessment.evaluation.objective.is_some(),
        "objective_mm": assessment.objective_mm().map(length),
        "overlaps": overlaps(assessment),
        "layout": layout(cell, &assessment.layout),
        "operations": operations,
    })
}

fn operation_map(cell: &Cell, map: &OperationMap) -> Value {
    let operation = &cell.operations[map.operation];
    let nodes: Vec<_> = map.nodes.iter().map(|n| node(cell, n)).collect();
    json!({
        "name": operation.name,
        "equipment": cell.equipment[operation.equipment].name,
        "sense": operation.sense.name(),
        "model": cell.model.name(),
        "errors": cell.signed_errors().name,
        "counts": counts(map),
        "nodes": nodes,
        "best": map.best.map(|k| node(cell, &map.nodes[k])),
    })
}

fn node(cell: &Cell, n: &NodeRecord) -> Value {
    let of = |f: &dyn Fn(&PostureRecord) -> Value| n.posture.as_ref().map(f);
    json!({
        "i": n.i,
        "j": n.j,
        "position_mm": lengths(&n.position),
        "status": n.status.name(),
        "reason": n.status.reason(cell),
        "joints_deg": of(&|p| joints(cell, p)),
        "error_mm": of(&|p| lengths(&p.error)),
        "error_sense_mm": of(&|p| json!(length(mm_from_m(p.in_sense)))),
        "rotation_deg": of(&|p| json!(p.rotation.map(|r| length(deg_from_rad(r))).as_slice())),
        "linear_error_mm": of(&|p| lengths(&p.linear)),
        "nonlinear_error_mm": of(&|p| lengths(&p.nonlinear)),
        "discrepancy_percent": of(&discrepancies),
    })
}

fn discrepancies(p: &PostureRecord) -> Value {
    let d = discrepancy(&p.nonlinear, &p.linear);
    let percent = |v: Option<f64>| v.map(length);
    json!({ "x": percent(d.x), "y": percent(d.y), "z": percent(d.z), "r": percent(d.resultant) })
}

/// The document of `search --json`. Without `seconds` it is the file search.json, which is the same
/// for any number of threads.
pub fn search(cell: &Cell, record: &SearchRecord, assessed: &Comparison<'_>, seconds: Option<f64>) -> Value {
    let [start, best] = &assessed.columns[..] else { return Value::Null };
    let ended = match record.ended {
        Ended::Done => "done",
        Ended::Interrupted => "interrupted",
        Ended::NothingToSearch => "nothing-to-search",
    };
    let mut document = json!({
        "schema": "sweetspot/search/1",
        "status": if record.found() { "found" } else { "none" },
        "objective_mm": best.objective_mm().map(length),
        "gain_percent": assessed.change_percent(1, Assessment::objective_mm).map(|c| rounded(-c, 6)),
        "evaluations": record.evaluations,
        "feasible": record.feasible,
        "ended": ended,
        "cell": cell.name,
        "robot": cell.robot.name,
        "errors": cell.signed_errors().name,
        "model": cell.model.name(),
        "objective": cell.search.objective.name(),
        "solver": cell.search.solver.name(),
        "seed": cell.search.seed,
        "budget": cell.search.budget,
        "reasons": best.reasons(),
        "layout": layout(cell, &best.layout),
        "operations": spots(best),
        "start": {
            "objective_mm": start.objective_mm().map(length),
            "reasons": start.reasons(),
            "layout": layout(cell, &start.layout),
            "operations": spots(start),
        },
        "trace": record.trace.iter().map(|(n, e)| json!([n, length(mm_from_m(*e))])).collect::<Vec<_>>(),
    });
    if let (Some(seconds), Some(object)) = (seconds, document.as_object_mut()) {
        object.insert("seconds".into(), json!(rounded(seconds, 3)));
    }
    document
}

/// The document of `compare --json`.
pub fn compare(comparison: &Comparison<'_>) -> Value {
    let layouts = comparison.columns.iter().enumerate().map(|(k, a)| {
        json!({
            "name": a.label,
            "feasible": a.evaluation.objective.is_some(),
            "objective_mm": a.objective_mm().map(length),
            "change_percent": comparison.change_percent(k, Assessment::objective_mm).map(length),
            "reasons": a.reasons(),
            "layout": layout(a.cell, &a.layout),
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
        let by_sense: Map<String, Value> =
            Sense::ALL.iter().map(|&s| (s.name().to_string(), json!(a.error_mm(k, s).map(length)))).collect();
        json!({
            "name": operation.name,
            "equipment": a.cell.equipment[operation.equipment].name,
            "sense": operation.sense.name(),
            "node": spot.map(|(n, _)| json!([n.i, n.j])),
            "position_mm": spot.map(|(n, _)| lengths(&n.position)),
            "joints_deg": spot.map(|(_, p)| joints(a.cell, p)),
            "error_mm": spot.map(|(_, p)| lengths(&p.error)),
            "error_sense_mm": spot.map(|(_, p)| length(mm_from_m(p.in_sense))),
            "error_by_sense_mm": by_sense,
            "counts": counts(map),
        })
    };
    Value::Array(a.maps.iter().enumerate().map(one).collect())
}

fn counts(map: &OperationMap) -> Value {
    let count = |status| map.count(status);
    json!({
        "ok": count("ok"),
        "out-of-reach": count("out-of-reach"),
        "joint-limit": count("joint-limit"),
        "collision": count("collision"),
    })
}

fn overlaps(a: &Assessment<'_>) -> Value {
    json!(a.evaluation.overlaps.iter().map(|o| o.in_words(a.cell)).collect::<Vec<_>>())
}

/// Placements by the name of the equipment; obstacles are not the layout's to place.
fn layout(cell: &Cell, layout: &Layout) -> Value {
    let placed = cell.equipment.iter().zip(&layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    let one = placed.map(|(e, p)| {
        let mm = |v| length(mm_from_m(v));
        let at = json!({
            "x_mm": mm(p.x), "y_mm": mm(p.y), "z_mm": mm(p.z), "yaw_deg": length(deg_from_rad(p.yaw)),
        });
        (e.name.clone(), at)
    });
    Value::Object(one.collect())
}

fn joints(cell: &Cell, p: &PostureRecord) -> Value {
    let in_file_units = cell.robot.joints.iter().zip(p.joints).map(|(joint, q)| match joint.kind {
        crate::cell::JointKind::Revolute => length(deg_from_rad(q)),
        crate::cell::JointKind::Prismatic => length(mm_from_m(q)),
    });
    json!(in_file_units.collect::<Vec<_>>())
}

fn lengths(v: &Vector3<f64>) -> Value {
    json!(v.map(|m| length(mm_from_m(m))).as_slice())
}

fn length(mm: f64) -> f64 {
    rounded(mm, 9)
}
