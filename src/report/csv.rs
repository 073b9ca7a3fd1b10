//! map.csv: one row per node. readings.csv: one row per operation and reading.
//! front.csv: one row per layout.

use super::goals;
use crate::assess::{Assessment, ReadingRow, Readings};
use crate::cell::{Cell, Goal, JointKind, Sense, Slot, Unit};
use crate::error_map::{NodeRecord, OperationMap, PostureRecord};
use crate::kinematic_error::discrepancy;
use crate::reading::Figures;
use crate::search::SearchRecord;
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};

/// The maps of all operations, with a header. World frame, mm and degrees.
///
/// # Errors
/// Those of the csv writer, which writes to memory here.
pub fn map(a: &Assessment<'_>) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &columns(a))?;
    rows(a, |mut row| {
        TEXTS.iter().for_each(|&k| row[k] = inert(&row[k]));
        put(&mut writer, &row)
    })?;
    writer.into_inner().map_err(|e| e.to_string())
}

/// The columns of the map whose texts come from files: operation, equipment, reason.
const TEXTS: [usize; 3] = [0, 1, 8];

/// The header of the map.
pub(super) fn columns(a: &Assessment<'_>) -> Vec<String> {
    header(a.cell, &senses(a))
}

/// The rows of the map, one by one, their texts as they are.
pub(super) fn rows(
    a: &Assessment<'_>,
    mut take: impl FnMut(Vec<String>) -> Result<(), String>,
) -> Result<(), String> {
    let senses = senses(a);
    for map in &a.maps {
        let operation = &a.cell.operations[map.operation];
        let equipment = &a.cell.equipment[operation.equipment].name;
        for (k, node) in map.nodes.iter().enumerate() {
            let mut row = vec![operation.name.clone(), equipment.clone()];
            row.extend(node_columns(a.cell, node, map, &senses));
            row.push(if map.best == Some(k) { "1".into() } else { "0".into() });
            row.extend(refined_columns(a, map.operation, map.best == Some(k)));
            take(row)?;
        }
    }
    Ok(())
}

pub fn put(writer: &mut ::csv::Writer<Vec<u8>>, row: &[String]) -> Result<(), String> {
    writer.write_record(row).map_err(|e| e.to_string())
}

/// The layouts beside the best of a search, with a header: goals, then free coordinates (mm, degrees).
///
/// # Errors
/// Those of the csv writer, which writes to memory here.
pub fn front(cell: &Cell, record: &SearchRecord) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let free = cell.free();
    let mut header = vec!["layout".to_string()];
    header.extend(Goal::ALL.map(|goal| goals::key(goal).to_string()));
    header.extend(free.iter().map(|(slot, _)| inert(&variable(cell, *slot))));
    put(&mut writer, &header)?;
    for (k, alternative) in record.alternatives.iter().enumerate() {
        let mut row = vec![(k + 1).to_string()];
        let values = Goal::ALL.into_iter().zip(&alternative.goals);
        row.extend(values.map(|(goal, si)| number(goals::value(cell, goal, *si))));
        row.extend(free.iter().map(|(slot, _)| {
            let value = alternative.candidate.layout.value(cell, *slot);
            number(if slot.is_angle() { deg_from_rad(value) } else { mm_from_m(value) })
        }));
        put(&mut writer, &row)?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

/// "table x_mm", as the cell file says it.
fn variable(cell: &Cell, slot: Slot) -> String {
    let placement = ["x_mm", "y_mm", "z_mm", "yaw_deg"];
    match slot {
        Slot::Base(axis) => format!("base {}", placement[axis]),
        Slot::Equipment(k, axis) => format!("{} {}", cell.equipment[k].name, placement[axis]),
        Slot::Attitude(k, angle) => {
            format!("{} {}", cell.operations[k].name, ["bend_deg", "azimuth_deg", "spin_deg"][angle])
        }
    }
}

const REFINED: [&str; 4] = ["refined_x_mm", "refined_y_mm", "refined_z_mm", "refined_value"];

/// The spot between the nodes, in the row of the best node.
fn refined_columns(a: &Assessment<'_>, k: usize, is_best: bool) -> [String; 4] {
    let Some(refined) = a.refined[k].as_ref().filter(|_| is_best) else { return Default::default() };
    let [x, y, z] = [0, 1, 2].map(|axis| number(mm_from_m(refined.position[axis])));
    [x, y, z, number(a.cell.unit().from_si(refined.value))]
}

/// The readings of all operations, with a header. World frame, mm and degrees.
///
/// # Errors
/// Those of the csv writer, which writes to memory here.
pub fn readings(r: &Readings<'_>) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &READINGS.map(str::to_string))?;
    for (operation, rows) in r.cell.operations.iter().zip(&r.operations) {
        for row in rows {
            put(&mut writer, &reading_columns(&operation.name, row))?;
        }
    }
    writer.into_inner().map_err(|e| e.to_string())
}

const READINGS: [&str; 16] = [
    "operation",
    "reading",
    "quantity",
    "registration",
    "i",
    "j",
    "x_mm",
    "y_mm",
    "z_mm",
    "value",
    "unit",
    "at_signed_choice",
    "at_unregistered_choice",
    "ratio",
    "moved_mm",
    "reason",
];

fn reading_columns(operation: &str, row: &ReadingRow) -> Vec<String> {
    let choice = row.choice.as_ref().ok();
    let mm = |v: f64| number(mm_from_m(v));
    let value = |v: f64| number(row.unit.from_si(v));
    let or_empty = |v: Option<String>| v.unwrap_or_default();
    let words = [row.reading.name(), row.quantity_name(), row.registration.name()];
    let mut columns = vec![inert(operation)];
    columns.extend(words.map(str::to_string));
    columns
        .extend([choice.map(|c| c.node.0.to_string()), choice.map(|c| c.node.1.to_string())].map(or_empty));
    columns.extend([0, 1, 2].map(|k| or_empty(choice.map(|c| mm(c.position[k])))));
    columns.extend([or_empty(row.value().map(value)), row.unit.word().to_string()]);
    columns.extend(
        [row.at_signed.map(value), row.at_unregistered.map(value), row.ratio().map(number)].map(or_empty),
    );
    columns.push(or_empty(choice.and_then(|c| c.moved).map(mm)));
    columns.push(or_empty(row.choice.as_ref().err().map(|why| inert(why))));
    columns
}

/// Every sense that any map reports.
fn senses<'a>(a: &'a Assessment<'_>) -> Vec<&'a Sense> {
    let mut all: Vec<&Sense> = Vec::new();
    for sense in a.maps.iter().flat_map(|m| &m.senses) {
        if !all.iter().any(|s| s.name == sense.name) {
            all.push(sense);
        }
    }
    all
}

type Column = (&'static str, fn(&Figures) -> f64);

/// Figures of a sense, as columns.
const FIGURES: [Column; 5] = [
    ("worst", |f| f.worst),
    ("rms", |f| f.rms),
    ("mean", |f| f.mean),
    ("p95", |f| f.p95),
    ("p99", |f| f.p99),
];

fn header(cell: &Cell, senses: &[&Sense]) -> Vec<String> {
    let start = ["operation", "equipment", "i", "j", "x_mm", "y_mm", "z_mm", "status", "reason"];
    let joints = cell.robot.joints.iter().enumerate().map(|(k, joint)| match joint.kind {
        JointKind::Revolute => format!("q{}_deg", k + 1),
        JointKind::Prismatic => format!("q{}_mm", k + 1),
    });
    let end = [
        "error_x_mm",
        "error_y_mm",
        "error_z_mm",
        "error_sense_mm",
        "error_sense_deg",
        "rotation_x_deg",
        "rotation_y_deg",
        "rotation_z_deg",
        "linear_x_mm",
        "linear_y_mm",
        "linear_z_mm",
        "discrepancy_x_percent",
        "discrepancy_y_percent",
        "discrepancy_z_percent",
        "discrepancy_r_percent",
        "linear_off_percent",
        "second_order_off_percent",
        "value",
        "yield",
    ];
    let figures = FIGURES
        .iter()
        .flat_map(|(figure, _)| senses.iter().map(move |s| format!("{figure}_{}_{}", s.name, s.unit.word())));
    let text = |words: &[&str]| words.iter().map(|w| w.to_string()).collect::<Vec<_>>();
    let row = text(&start).into_iter().chain(joints).chain(text(&end));
    row.chain(figures).chain(text(&["best"])).chain(text(&REFINED)).collect()
}

fn node_columns(cell: &Cell, node: &NodeRecord, map: &OperationMap, senses: &[&Sense]) -> Vec<String> {
    let mut row = vec![node.i.to_string(), node.j.to_string()];
    row.extend(node.position.iter().map(|&v| number(mm_from_m(v))));
    row.push(node.status.name().to_string());
    row.push(node.status.reason(cell));
    match &node.posture {
        Some(posture) => row.extend(posture_columns(cell, posture, map, senses)),
        None => {
            let empty = cell.robot.axes() + 19 + FIGURES.len() * senses.len();
            row.extend(std::iter::repeat_n(String::new(), empty));
        }
    }
    row
}

fn posture_columns(cell: &Cell, p: &PostureRecord, map: &OperationMap, senses: &[&Sense]) -> Vec<String> {
    let mm = |v: &f64| number(mm_from_m(*v));
    let mut row: Vec<String> = Vec::new();
    for (joint, &q) in cell.robot.joints.iter().zip(&p.joints) {
        row.push(if joint.kind == JointKind::Revolute { number(deg_from_rad(q)) } else { mm(&q) });
    }
    row.extend(p.error.iter().map(mm));
    let own = &cell.operations[map.operation].sense;
    let in_sense = map.sense(&own.name).map(|k| own.unit.from_si(p.figures[k].error));
    let of = |unit| in_sense.filter(|_| own.unit == unit).map_or(String::new(), number);
    row.extend([of(Unit::Length), of(Unit::Angle)]);
    row.extend(p.rotation.iter().map(|&r| number(deg_from_rad(r))));
    row.extend(p.linear.iter().map(mm));
    let d = discrepancy(&p.nonlinear, &p.linear);
    row.extend([d.x, d.y, d.z, d.resultant].map(|v| v.map_or(String::new(), number)));
    row.extend([p.linear_off, p.second_order_off].map(|off| number(percent_from_share(off))));
    row.push(number(cell.unit().from_si(p.value)));
    row.push(p.success.map_or(String::new(), number));
    for (_, figure) in FIGURES {
        row.extend(senses.iter().map(|sense| {
            let figures = map.sense(&sense.name).map(|k| &p.figures[k]);
            figures.map_or(String::new(), |f| number(sense.unit.from_si(figure(f))))
        }));
    }
    row
}

pub fn number(v: f64) -> String {
    rounded(v, 9).to_string()
}

/// Text that a spreadsheet would take for a formula gets a leading apostrophe.
pub fn inert(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text.to_string() }
}
