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
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

/// The document of `map --json`. Nodes are made one by one while it is written: a map can have a
/// million of them.
#[derive(Serialize)]
pub struct MapDocument<'a> {
    schema: &'static str,
    cell: &'a str,
    robot: &'a str,
    feasible: bool,
    objective_mm: Option<f64>,
    overlaps: Value,
    layout: Value,
    operations: Vec<OperationDocument<'a>>,
}

#[derive(Serialize)]
struct OperationDocument<'a> {
    name: &'a str,
    equipment: &'a str,
    sense: &'static str,
    model: &'static str,
    errors: &'a str,
    counts: Value,
    nodes: Nodes<'a>,
    best: Option<NodeDocument>,
}

struct Nodes<'a>(&'a Cell, &'a OperationMap);

impl Serialize for Nodes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.1.nodes.iter().map(|n| NodeDocument::new(self.0, n)))
    }
}

#[derive(Serialize)]
struct NodeDocument {
    i: usize,
    j: usize,
    position_mm: [f64; 3],
    status: &'static str,
    reason: String,
    joints_deg: Option<Vec<f64>>,
    error_mm: Option<[f64; 3]>,
    error_sense_mm: Option<f64>,
    rotation_deg: Option<[f64; 3]>,
    linear_error_mm: Option<[f64; 3]>,
    nonlinear_error_mm: Option<[f64; 3]>,
    discrepancy_percent: Option<DiscrepancyDocument>,
}

/// Eq. (9) per component and for the resultant r.
#[derive(Serialize)]
struct DiscrepancyDocument {
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    r: Option<f64>,
}

/// The document of `map --json`.
pub fn map<'a>(assessment: &'a Assessment<'_>) -> MapDocument<'a> {
    let cell = assessment.cell;
    MapDocument {
        schema: "sweetspot/map/1",
        cell: &cell.name,
        robot: &cell.robot.name,
        feasible: assessment.evaluation.objective.is_some(),
        objective_mm: assessment.objective_mm().map(length),
        overlaps: overlaps(assessment),
        layout: layout(cell, &assessment.layout),
        operations: assessment.maps.iter().map(|m| operation_map(cell, m)).collect(),
    }
}

fn operation_map<'a>(cell: &'a Cell, map: &'a OperationMap) -> OperationDocument<'a> {
    let operation = &cell.operations[map.operation];
    OperationDocument {
        name: &operation.name,
        equipment: &cell.equipment[operation.equipment].name,
        sense: operation.sense.name(),
        model: cell.model.name(),
        errors: &cell.signed_errors().name,
        counts: counts(map),
        nodes: Nodes(cell, map),
        best: map.best_node().map(|n| NodeDocument::new(cell, n)),
    }
}

impl NodeDocument {
    fn new(cell: &Cell, n: &NodeRecord) -> Self {
        let p = n.posture.as_ref();
        Self {
            i: n.i,
            j: n.j,
            position_mm: lengths(&n.position),
            status: n.status.name(),
            reason: n.status.reason(cell),
            joints_deg: p.map(|p| joints(cell, p)),
            error_mm: p.map(|p| lengths(&p.error)),
            error_sense_mm: p.map(|p| length(mm_from_m(p.in_sense))),
            rotation_deg: p.map(|p| p.rotation.map(|r| length(deg_from_rad(r))).into()),
            linear_error_mm: p.map(|p| lengths(&p.linear)),
            nonlinear_error_mm: p.map(|p| lengths(&p.nonlinear)),
            discrepancy_percent: p.map(DiscrepancyDocument::new),
        }
    }
}

impl DiscrepancyDocument {
    fn new(p: &PostureRecord) -> Self {
        let d = discrepancy(&p.nonlinear, &p.linear);
        let [x, y, z, r] = [d.x, d.y, d.z, d.resultant].map(|v| v.map(length));
        Self { x, y, z, r }
    }
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

fn joints(cell: &Cell, p: &PostureRecord) -> Vec<f64> {
    let in_file_units = cell.robot.joints.iter().zip(p.joints).map(|(joint, q)| match joint.kind {
        crate::cell::JointKind::Revolute => length(deg_from_rad(q)),
        crate::cell::JointKind::Prismatic => length(mm_from_m(q)),
    });
    in_file_units.collect()
}

fn lengths(v: &Vector3<f64>) -> [f64; 3] {
    v.map(|m| length(mm_from_m(m))).into()
}

fn length(mm: f64) -> f64 {
    rounded(mm, 9)
}
