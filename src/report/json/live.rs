//! State of the live page of `view`: the form and the evaluation of a layout. The form is the part of a cell
//! that does not depend on the layout.

use super::live_records::{
    AnswerNodes, AnswerOperation, AnswerRecord, FormEquipment, FormGroup, FormNumber, FormRecord, LensChoice,
    NumbersRecord,
};
use crate::assess::Assessment;
use crate::cell::{Cell, Coordinate, Layout, PLAIN, Placement, Rectangle, Role, Slot};
use crate::drawing::{ErrorView, lenses};
use crate::error_map::OperationMap;
use crate::record::{
    ByName, StatusCounts, coordinate_name, near_limits, nine_digits as length, objective_word,
};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;
use serde::Serialize;
use serde_json::Value;

/// Largest number of nodes of a map that are sent. A larger map is thinned to every second, third, ... node.
const MAX_NODES: usize = 4000;
/// Number of decimals of lengths (mm) and angles (degrees) that are sent; more would not be visible.
const VISIBLE_DECIMALS: i32 = 4;

/// Converts a record to a JSON value. The conversion cannot fail, because a record holds only plain numbers
/// and texts.
pub fn value(record: &impl Serialize) -> Value {
    serde_json::to_value(record).unwrap_or_default()
}

fn in_file(slot: Slot, si: f64) -> f64 {
    length(if slot.is_angle() { deg_from_rad(si) } else { mm_from_m(si) })
}

/// Returns the data of a cell that do not depend on the layout. The data are names, search settings,
/// outlines, and the coordinates that the page can change.
pub fn form(cell: &Cell) -> FormRecord<'_> {
    let defined = cell.senses.iter().map(|s| s.name.as_str());
    let equipment = cell.equipment.iter().map(|e| FormEquipment {
        name: &e.name,
        obstacle: e.role == Role::Obstacle,
        on: e.on,
        footprint: rectangle(&e.footprint),
        surface: e.surface.as_ref().map(rectangle),
    });
    let keep_out = cell.keep_out.iter().map(|k| [mm(k.min.x), mm(k.min.y), mm(k.max.x), mm(k.max.y)]);
    let fence = cell.fence.as_ref().map(|f| f.corners.iter().map(|(x, y)| [mm(*x), mm(*y)]).collect());
    FormRecord {
        schema: "sweetspot/live/1",
        cell: &cell.name,
        robot: &cell.robot.name,
        errors: cell.error_set().name(),
        form: groups(cell),
        senses: PLAIN.into_iter().chain(defined).collect(),
        budget: cell.search.budget,
        seed: cell.search.seed,
        can_search: !cell.free().is_empty(),
        equipment: equipment.collect(),
        base_footprint: rectangle(&cell.robot.footprint),
        keep_out: keep_out.collect(),
        fence,
    }
}

/// Returns the coordinates that the page can change, grouped by their owners: equipment, operations and robot
/// base. The page can change all coordinates of equipment and the robot base, even those that the file fixes.
fn groups(cell: &Cell) -> Vec<FormGroup<'_>> {
    let four = |slot: &dyn Fn(usize) -> Slot, c: &[Coordinate; 4]| {
        c.iter().enumerate().map(|(axis, c)| form_number(slot(axis), c)).collect::<Vec<_>>()
    };
    let movable = cell.equipment.iter().enumerate().filter(|(_, e)| e.role == Role::Equipment);
    let mut groups: Vec<FormGroup<'_>> = movable
        .map(|(k, e)| {
            let numbers = four(&|axis| Slot::Equipment(k, axis), &e.placement);
            FormGroup { group: "equipment", name: &e.name, index: Some(k), numbers }
        })
        .collect();
    for (k, operation) in cell.operations.iter().enumerate() {
        let angles = operation.angles.iter().enumerate();
        let angles = angles.filter_map(|(angle, c)| Some((angle, c.as_ref().filter(|c| c.is_free())?)));
        let numbers: Vec<_> = angles.map(|(angle, c)| form_number(Slot::Attitude(k, angle), c)).collect();
        if !numbers.is_empty() {
            groups.push(FormGroup { group: "attitude", name: &operation.name, index: None, numbers });
        }
    }
    let numbers = four(&Slot::Base, &cell.base);
    groups.push(FormGroup { group: "robot_base", name: "robot base", index: None, numbers });
    groups
}

fn form_number(slot: Slot, c: &Coordinate) -> FormNumber {
    let (min, max) = c.range();
    let list = if let Coordinate::List(values) = c { Some(values) } else { None };
    FormNumber {
        key: coordinate_name(slot),
        free: c.is_free(),
        min: c.is_free().then(|| in_file(slot, min)),
        max: c.is_free().then(|| in_file(slot, max)),
        list: list.map(|values| values.iter().map(|v| in_file(slot, *v)).collect()),
    }
}

/// Returns the values of all coordinates of a layout by owner and key. The owner of a coordinate is the robot
/// base, a piece of equipment or an operation. [`form`] returns the owners and keys.
pub fn numbers(cell: &Cell, layout: &Layout) -> NumbersRecord {
    let mut all = NumbersRecord::default();
    // `Cell::layout` calls the closure for every coordinate. Only these calls are needed here, not the
    // returned layout.
    cell.layout(|slot, coordinate| {
        let owner = match slot {
            Slot::Base(_) => &mut all.robot_base,
            Slot::Equipment(k, _) => all.equipment.entry(cell.equipment[k].name.clone()).or_default(),
            Slot::Attitude(k, _) => all.attitude.entry(cell.operations[k].name.clone()).or_default(),
        };
        owner.insert(coordinate_name(slot).into(), in_file(slot, layout.value(cell, slot)));
        coordinate.start()
    });
    all
}

/// Returns the evaluation of a layout as the page reads it: its objective and its error maps.
pub fn answer<'a>(a: &Assessment<'a>) -> AnswerRecord<'a> {
    let cell = a.cell;
    AnswerRecord {
        feasible: a.evaluation.objective.is_some(),
        met: a.meets_requirements(),
        certified: a.certificate.as_ref().map(|certificate| certificate.holds()),
        objective: a.objective().map(length),
        unit: cell.unit(),
        word: objective_word(cell),
        reasons: a.reasons(),
        placements: a.layout.placements.iter().map(placed).collect(),
        base: placed(&a.layout.base),
        operations: a.maps.iter().map(|m| operation(a, m)).collect(),
    }
}

/// Returns the combinations of model and reading under which a cell can be evaluated.
pub fn lens_list(cell: &Cell) -> Vec<LensChoice> {
    let choice = |l: &ErrorView| LensChoice { model: l.model, reading: l.reading, word: l.reading_word() };
    lenses(cell).iter().map(choice).collect()
}

fn operation<'a>(a: &Assessment<'a>, map: &OperationMap) -> AnswerOperation<'a> {
    let cell = a.cell;
    let operation = &cell.operations[map.operation];
    let requirement = a.requirement(map.operation);
    let value = |v: f64| length(cell.unit().from_si(v));
    let near = a.spot(map.operation).map_or(Vec::new(), |(_, p)| near_limits(cell, &p.joints));
    let near = cell.robot.joints.iter().zip(near).filter(|(_, near)| *near);
    let near = near.map(|(joint, _)| joint.name.as_str()).collect();
    AnswerOperation {
        name: &operation.name,
        equipment: operation.equipment,
        sense: &operation.sense.name,
        value: map.value.map(value),
        limit: requirement.map(|r| value(r.limit)),
        margin: requirement.map(|r| value(r.margin)),
        worst: a.worst(map.operation).map(value),
        near_limits: near,
        counts: StatusCounts::new(map),
        best: map.best_node().map(|n| [n.i, n.j]),
        nodes: nodes(cell, map),
    }
}

fn nodes(cell: &Cell, map: &OperationMap) -> AnswerNodes {
    let (m, n) = cell.operations[map.operation].place.divisions();
    let mut every = 1;
    while (m / every + 1) * (n / every + 1) > MAX_NODES {
        every += 1;
    }
    let best = map.best_node().map(|n| (n.i, n.j));
    let kept = map.nodes.iter().filter(|n| (n.i % every, n.j % every) == (0, 0) || Some((n.i, n.j)) == best);
    let (mut all, mut reasons) = (AnswerNodes { every, ..AnswerNodes::default() }, ByName::new());
    let list =
        |v: &Vector3<f64>, decimals: i32| -> [f64; 3] { v.map(|v| rounded(mm_from_m(v), decimals)).into() };
    for node in kept {
        let posture = node.usable_posture();
        all.ij.push([node.i, node.j]);
        all.at.push(list(&node.position, 1));
        all.status.push(node.status.sign());
        all.value.push(posture.map(|p| rounded(cell.unit().from_si(p.value), 6)));
        all.error.push(posture.map(|p| list(&p.error, VISIBLE_DECIMALS)));
        let next = reasons.len();
        all.why.push(*reasons.entry(node.status.reason(cell)).or_insert(next));
    }
    AnswerNodes { reasons: reasons.into_keys().collect(), ..all }
}

/// Returns x, y, z (mm) and yaw (degrees).
fn placed(at: &Placement) -> [f64; 4] {
    [mm(at.x), mm(at.y), mm(at.z), rounded(deg_from_rad(at.yaw), VISIBLE_DECIMALS)]
}

/// Returns centre and size of a rectangle, mm.
fn rectangle(r: &Rectangle) -> [f64; 4] {
    [mm(r.centre.0), mm(r.centre.1), mm(r.size.0), mm(r.size.1)]
}

fn mm(m: f64) -> f64 {
    rounded(mm_from_m(m), VISIBLE_DECIMALS)
}
