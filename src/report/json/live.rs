//! What the page of `view` is told: the form of a cell once, and what a layout is worth, as compact as
//! can be.

use crate::assess::Assessment;
use crate::cell::{Cell, Coordinate, Layout, PLAIN, Placement, Rectangle, Role, Slot};
use crate::drawing::lenses;
use crate::error_map::OperationMap;
use crate::record::{StatusCounts, coordinate_name, nine_digits as length, value_word};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use serde_json::{Map, Value, json};

/// Nodes of a map that are told at most; of more every second, third, ... is.
const MOST_NODES: usize = 4000;
/// Digits of mm that are seen.
const SEEN: i32 = 4;

fn in_file(slot: Slot, si: f64) -> f64 {
    length(if slot.is_angle() { deg_from_rad(si) } else { mm_from_m(si) })
}

/// Everything of a cell that no layout changes.
pub fn form(cell: &Cell) -> Value {
    let defined = cell.senses.iter().map(|s| s.name.as_str());
    json!({
        "schema": "sweetspot/live/1",
        "cell": cell.name,
        "robot": cell.robot.name,
        "errors": cell.error_set().name(),
        "form": groups(cell),
        "senses": PLAIN.into_iter().chain(defined).collect::<Vec<_>>(),
        "budget": cell.search.budget,
        "seed": cell.search.seed,
        "can_search": !cell.free().is_empty(),
        "equipment": cell.equipment.iter().map(|e| json!({
            "name": e.name,
            "obstacle": e.role == Role::Obstacle,
            "on": e.on,
            "footprint": rectangle(&e.footprint),
            "surface": e.surface.as_ref().map(rectangle),
        })).collect::<Vec<_>>(),
        "base_footprint": rectangle(&cell.robot.footprint),
        "keep_out": cell.keep_out.iter().map(|k| {
            json!([mm(k.min.x), mm(k.min.y), mm(k.max.x), mm(k.max.y)])
        }).collect::<Vec<_>>(),
        "fence": cell.fence.as_ref().map(|f| f.corners.iter().map(|(x, y)| [mm(*x), mm(*y)]).collect::<Vec<_>>()),
    })
}

/// The numbers that the page can change, owner by owner; every one of an equipment, also what is fixed.
fn groups(cell: &Cell) -> Value {
    let number = |slot: Slot, c: &Coordinate| {
        let (min, max) = c.range();
        let list = if let Coordinate::List(values) = c { Some(values) } else { None };
        json!({
            "key": coordinate_name(slot),
            "free": c.is_free(),
            "min": c.is_free().then(|| in_file(slot, min)),
            "max": c.is_free().then(|| in_file(slot, max)),
            "list": list.map(|values| values.iter().map(|v| in_file(slot, *v)).collect::<Vec<_>>()),
        })
    };
    let four = |slot: &dyn Fn(usize) -> Slot, c: &[Coordinate; 4]| {
        c.iter().enumerate().map(|(axis, c)| number(slot(axis), c)).collect::<Vec<_>>()
    };
    let movable = cell.equipment.iter().enumerate().filter(|(_, e)| e.role == Role::Equipment);
    let mut groups: Vec<Value> = movable
        .map(|(k, e)| {
            let numbers = four(&|axis| Slot::Equipment(k, axis), &e.placement);
            json!({ "group": "equipment", "name": e.name, "index": k, "numbers": numbers })
        })
        .collect();
    for (k, operation) in cell.operations.iter().enumerate() {
        let angles = operation.angles.iter().enumerate();
        let angles = angles.filter_map(|(angle, c)| Some((angle, c.as_ref().filter(|c| c.is_free())?)));
        let numbers: Vec<Value> = angles.map(|(angle, c)| number(Slot::Attitude(k, angle), c)).collect();
        if !numbers.is_empty() {
            groups.push(json!({ "group": "attitude", "name": operation.name, "numbers": numbers }));
        }
    }
    groups.push(
        json!({ "group": "robot_base", "name": "robot base", "numbers": four(&Slot::Base, &cell.base) }),
    );
    Value::Array(groups)
}

/// The numbers of a layout under the names of [`form`].
pub fn numbers(cell: &Cell, layout: &Layout) -> Value {
    let mut all = json!({ "robot_base": {}, "equipment": {}, "attitude": {} });
    // Asking for a layout visits every number that there is.
    cell.layout(|slot, coordinate| {
        let (group, name) = match slot {
            Slot::Base(_) => ("robot_base", None),
            Slot::Equipment(k, _) => ("equipment", Some(&cell.equipment[k].name)),
            Slot::Attitude(k, _) => ("attitude", Some(&cell.operations[k].name)),
        };
        let value = json!(in_file(slot, layout.value(cell, slot)));
        let owner = match name {
            Some(name) => &mut all[group][name],
            None => &mut all[group],
        };
        owner[coordinate_name(slot)] = value;
        coordinate.start()
    });
    all
}

/// What a layout is worth, with its maps.
pub fn answer(a: &Assessment<'_>) -> Value {
    let cell = a.cell;
    json!({
        "feasible": a.evaluation.objective.is_some(),
        "met": a.meets_requirements(),
        "objective": a.objective().map(length),
        "unit": cell.unit().word(),
        "word": value_word(cell),
        "reasons": a.reasons(),
        "placements": a.layout.placements.iter().map(placed).collect::<Vec<_>>(),
        "base": placed(&a.layout.base),
        "operations": a.maps.iter().map(|m| operation(a, m)).collect::<Vec<_>>(),
    })
}

/// The models and readings in which a cell has an answer.
pub fn lens_list(cell: &Cell) -> Value {
    let word = |l: &crate::drawing::Lens| json!({ "model": l.model.name(), "reading": l.reading.name(), "word": l.reading_word() });
    lenses(cell).iter().map(word).collect()
}

fn operation(a: &Assessment<'_>, map: &OperationMap) -> Value {
    let cell = a.cell;
    let operation = &cell.operations[map.operation];
    let requirement = a.requirement(map.operation);
    let value = |v: f64| length(cell.unit().from_si(v));
    json!({
        "name": operation.name,
        "equipment": operation.equipment,
        "sense": operation.sense.name,
        "value": map.value.map(value),
        "limit": requirement.map(|r| value(r.limit)),
        "margin": requirement.map(|r| value(r.margin)),
        "counts": StatusCounts::new(map),
        "best": map.best_node().map(|n| [n.i, n.j]),
        "nodes": nodes(cell, map),
    })
}

/// One list per column: positions and errors in mm, values as read, the reason as a number of the list of
/// reasons.
fn nodes(cell: &Cell, map: &OperationMap) -> Value {
    let (m, n) = cell.operations[map.operation].place.divisions();
    let mut every = 1;
    while (m / every + 1) * (n / every + 1) > MOST_NODES {
        every += 1;
    }
    let best = map.best_node().map(|n| (n.i, n.j));
    let kept = map.nodes.iter().filter(|n| (n.i % every, n.j % every) == (0, 0) || Some((n.i, n.j)) == best);
    let (mut reasons, mut why, mut at, mut values, mut errors, mut status, mut ij) =
        (Map::new(), vec![], vec![], vec![], vec![], vec![], vec![]);
    for node in kept {
        at.push(node.position.map(|v| rounded(mm_from_m(v), 1)));
        status.push(node.status.name());
        ij.push([node.i, node.j]);
        let posture = node.usable_posture();
        values.push(posture.map(|p| rounded(cell.unit().from_si(p.value), 6)));
        errors.push(posture.map(|p| p.error.map(|v| rounded(mm_from_m(v), SEEN))));
        let count = reasons.len();
        let reason = reasons.entry(node.status.reason(cell)).or_insert_with(|| json!(count));
        why.push(reason.clone());
    }
    let list = |v: &nalgebra::Vector3<f64>| [v.x, v.y, v.z];
    json!({
        "ij": ij,
        "at": at.iter().map(list).collect::<Vec<_>>(),
        "status": status,
        "value": values,
        "error": errors.iter().map(|e| e.as_ref().map(list)).collect::<Vec<_>>(),
        "why": why,
        "reasons": reasons.keys().collect::<Vec<_>>(),
        "every": every,
    })
}

/// x, y, z, yaw.
fn placed(at: &Placement) -> [f64; 4] {
    [mm(at.x), mm(at.y), mm(at.z), rounded(deg_from_rad(at.yaw), SEEN)]
}

/// Centre and size.
fn rectangle(r: &Rectangle) -> [f64; 4] {
    [mm(r.centre.0), mm(r.centre.1), mm(r.size.0), mm(r.size.1)]
}

fn mm(m: f64) -> f64 {
    rounded(mm_from_m(m), SEEN)
}
