//! `map --json`.

use super::{joints, layout, length, lengths, refined};
use crate::assess::Assessment;
use crate::cell::{Cell, Model, Unit};
use crate::error_map::{NodeRecord, NodeSign, OperationMap, PostureRecord};
use crate::kinematic_error::discrepancy;
use crate::motion::Transfer;
use crate::reading::{Estimate, Figures, MonteCarlo};
use crate::report::text::value_word;
use crate::units::{deg_from_rad, percent_from_share};
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
    objective: Option<f64>,
    unit: &'static str,
    /// What must be said about how the errors are read.
    notes: Vec<String>,
    overlaps: Value,
    /// Why the layout is not feasible.
    reasons: Vec<String>,
    /// Of a cell that asks for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    transfers: Option<Value>,
    layout: Value,
    operations: Vec<OperationDocument<'a>>,
}

#[derive(Serialize)]
struct OperationDocument<'a> {
    name: &'a str,
    equipment: &'a str,
    sense: &'a str,
    model: &'static str,
    errors: &'a str,
    reading: &'static str,
    quantity: &'static str,
    registration: &'static str,
    limit: Option<f64>,
    /// What is left to the limit; negative: it is missed.
    margin: Option<f64>,
    over: &'static str,
    /// What the operation is worth: at its best node, or over all nodes.
    value: Option<f64>,
    counts: Value,
    guard: Value,
    monte_carlo: Value,
    nodes: Nodes<'a>,
    best: Option<NodeDocument>,
    /// The spot between the nodes.
    refined: Value,
}

struct Nodes<'a>(&'a Cell, &'a OperationMap);

impl Serialize for Nodes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.1.nodes.iter().map(|n| NodeDocument::new(self.0, self.1, n)))
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
    error_sense_deg: Option<f64>,
    value: Option<f64>,
    touched: Option<bool>,
    rotation_deg: Option<[f64; 3]>,
    linear_error_mm: Option<[f64; 3]>,
    nonlinear_error_mm: Option<[f64; 3]>,
    discrepancy_percent: Option<DiscrepancyDocument>,
    linear_off_percent: Option<f64>,
    second_order_off_percent: Option<f64>,
    worst_mm: Option<BySense>,
    worst_linear_mm: Option<BySense>,
    rms_mm: Option<BySense>,
    mean_mm: Option<BySense>,
    p95_mm: Option<BySense>,
    p99_mm: Option<BySense>,
    worst_deg: Option<BySense>,
    rms_deg: Option<BySense>,
    p95_deg: Option<BySense>,
    r#yield: Option<f64>,
}

/// Values by the name of their sense.
type BySense = Map<String, Value>;

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
        objective: assessment.objective().map(length),
        unit: cell.unit().word(),
        notes: crate::report::text::caveats(cell),
        overlaps: overlaps(assessment),
        reasons: assessment.reasons(),
        transfers: cell.transfer.is_some().then(|| transfers(assessment)),
        layout: layout(cell, &assessment.layout),
        operations: assessment.maps.iter().map(|m| operation_map(assessment, m)).collect(),
    }
}

fn operation_map<'a>(a: &'a Assessment<'_>, map: &'a OperationMap) -> OperationDocument<'a> {
    let cell = a.cell;
    let operation = &cell.operations[map.operation];
    OperationDocument {
        name: &operation.name,
        equipment: &cell.equipment[operation.equipment].name,
        sense: &operation.sense.name,
        model: cell.model.name(),
        errors: cell.error_set().name(),
        reading: cell.reading.name(),
        quantity: value_word(cell),
        registration: cell.registration.name(),
        limit: operation.limit.map(|l| length(operation.sense.unit.from_si(l))),
        margin: a.requirement(map.operation).map(|r| length(cell.unit().from_si(r.margin))),
        over: operation.over.name(),
        value: map.value.map(|v| length(cell.unit().from_si(v))),
        counts: counts(map),
        guard: guard(cell, map),
        monte_carlo: monte_carlo(a, map.operation),
        nodes: Nodes(cell, map),
        best: map.best_node().map(|n| NodeDocument::new(cell, map, n)),
        refined: refined(a, map.operation),
    }
}

impl NodeDocument {
    fn new(cell: &Cell, map: &OperationMap, n: &NodeRecord) -> Self {
        let p = n.posture.as_ref();
        let own = &cell.operations[map.operation].sense;
        let in_sense = |unit| {
            let p = p.filter(|_| own.unit == unit)?;
            Some(length(unit.from_si(p.figures[map.sense(&own.name)?].error)))
        };
        let lengths_of = |figure: fn(&Figures) -> f64| p.and_then(|p| by_sense(map, p, Unit::Length, figure));
        let angles_of = |figure: fn(&Figures) -> f64| p.and_then(|p| by_sense(map, p, Unit::Angle, figure));
        Self {
            i: n.i,
            j: n.j,
            position_mm: lengths(&n.position),
            status: n.status.name(),
            reason: n.status.reason(cell),
            joints_deg: p.map(|p| joints(cell, &p.joints)),
            error_mm: p.map(|p| lengths(&p.error)),
            error_sense_mm: in_sense(Unit::Length),
            error_sense_deg: in_sense(Unit::Angle),
            value: p.map(|p| length(cell.unit().from_si(p.value))),
            touched: p.map(|p| p.touched),
            rotation_deg: p.map(|p| p.rotation.map(|r| length(deg_from_rad(r))).into()),
            linear_error_mm: p.map(|p| lengths(&p.linear)),
            nonlinear_error_mm: p.map(|p| lengths(&p.nonlinear)),
            discrepancy_percent: p.map(DiscrepancyDocument::new),
            linear_off_percent: p.map(|p| length(percent_from_share(p.linear_off))),
            second_order_off_percent: p.map(|p| length(percent_from_share(p.second_order_off))),
            worst_mm: lengths_of(|f| f.worst),
            worst_linear_mm: lengths_of(|f| f.worst_linear),
            rms_mm: lengths_of(|f| f.rms),
            mean_mm: lengths_of(|f| f.mean),
            p95_mm: lengths_of(|f| f.p95),
            p99_mm: lengths_of(|f| f.p99),
            worst_deg: angles_of(|f| f.worst),
            rms_deg: angles_of(|f| f.rms),
            p95_deg: angles_of(|f| f.p95),
            r#yield: p.and_then(|p| p.success).map(length),
        }
    }
}

/// A figure in every reported sense of one unit; None if there is none.
fn by_sense(
    map: &OperationMap,
    p: &PostureRecord,
    unit: Unit,
    figure: fn(&Figures) -> f64,
) -> Option<BySense> {
    let pairs = map.senses.iter().zip(&p.figures).filter(|(s, _)| s.unit == unit);
    let values: BySense =
        pairs.map(|(s, f)| (s.name.clone(), json!(length(unit.from_si(figure(f)))))).collect();
    (!values.is_empty()).then_some(values)
}

/// Where the models are not to be trusted, over the usable nodes.
pub(super) fn guard(cell: &Cell, map: &OperationMap) -> Value {
    let of = |model: Model| {
        let (most, above, _) = map.off(model, cell.guard);
        json!({ "most_percent": length(percent_from_share(most)), "nodes_above": above })
    };
    json!({
        "threshold_percent": length(percent_from_share(cell.guard)),
        "linear": of(Model::Linear),
        "second_order": of(Model::SecondOrder),
        "trusted": map.off(cell.model, cell.guard).1 == 0,
    })
}

/// What the samples say of a spot; null unless the reading is statistical.
pub(super) fn monte_carlo(a: &Assessment<'_>, operation: usize) -> Value {
    let Some(samples) = &a.samples[operation] else { return Value::Null };
    let unit = a.cell.operations[operation].sense.unit;
    let estimate = |e: &Estimate, unit: Unit| {
        let [value, low, high] = [e.value, e.low, e.high].map(|v| length(unit.from_si(v)));
        json!({ "value": value, "low": low, "high": high })
    };
    let MonteCarlo { rms, mean, p95, p99, above, success, .. } = samples;
    json!({
        "samples": samples.samples,
        "unit": unit.word(),
        "rms": estimate(rms, unit),
        "mean": estimate(mean, unit),
        "p95": estimate(p95, unit),
        "p99": estimate(p99, unit),
        "yield": success.as_ref().map(|s| estimate(s, Unit::Share)),
        "share_above_first_order_p95": estimate(above, Unit::Share),
        "first_order_holds": a.first_order_holds(operation),
    })
}

impl DiscrepancyDocument {
    fn new(p: &PostureRecord) -> Self {
        let d = discrepancy(&p.nonlinear, &p.linear);
        let [x, y, z, r] = [d.x, d.y, d.z, d.resultant].map(|v| v.map(length));
        Self { x, y, z, r }
    }
}

/// Returns the number of nodes with each sign; those that few cells know only where they occur.
pub(super) fn counts(map: &OperationMap) -> Value {
    let always = [
        NodeSign::Usable,
        NodeSign::OutOfReach,
        NodeSign::JointLimit,
        NodeSign::Collision,
        NodeSign::Attitude,
        NodeSign::NotConverged,
        NodeSign::Unjudged,
    ];
    let rare = NodeSign::ALL.into_iter().filter(|sign| !always.contains(sign) && map.count(*sign) > 0);
    let entry = |sign: NodeSign| (sign.name().to_string(), json!(map.count(sign)));
    Value::Object(always.into_iter().chain(rare).map(entry).collect())
}

/// The ways between consecutive operations; none if one of them is blocked.
pub(super) fn transfers(a: &Assessment<'_>) -> Value {
    let way = |t: &Transfer| {
        let name = |k: usize| &a.cell.operations[k].name;
        json!({
            "from": name(t.from),
            "to": name(t.to),
            "way": t.way.in_words(),
            "travel_deg": length(deg_from_rad(t.travel)),
            "joints_deg": t.path.iter().map(|q| joints(a.cell, q)).collect::<Vec<_>>(),
        })
    };
    Value::Array(a.evaluation.transfers.iter().map(way).collect())
}

fn overlaps(a: &Assessment<'_>) -> Value {
    json!(a.evaluation.overlaps.iter().map(|o| o.in_words(a.cell)).collect::<Vec<_>>())
}
