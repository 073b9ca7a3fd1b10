//! map.csv: one row per node.

use crate::cell::{Cell, JointKind};
use crate::compare::Assessment;
use crate::error_map::{NodeRecord, PostureRecord};
use crate::kinematic_error::discrepancy;
use crate::units::{deg_from_rad, mm_from_m, rounded};

/// The maps of all operations, with a header. World frame, mm and degrees.
///
/// # Errors
/// Those of the csv writer, which writes to memory here.
pub fn map(a: &Assessment<'_>) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let put = |writer: &mut ::csv::Writer<Vec<u8>>, row: &[String]| {
        writer.write_record(row).map_err(|e| e.to_string())
    };
    put(&mut writer, &header(a.cell))?;
    for map in &a.maps {
        let operation = &a.cell.operations[map.operation];
        let equipment = &a.cell.equipment[operation.equipment].name;
        for (k, node) in map.nodes.iter().enumerate() {
            let mut row = vec![inert(&operation.name), inert(equipment)];
            row.extend(node_columns(a.cell, node));
            row.push(if map.best == Some(k) { "1".into() } else { "0".into() });
            put(&mut writer, &row)?;
        }
    }
    writer.into_inner().map_err(|e| e.to_string())
}

fn header(cell: &Cell) -> Vec<String> {
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
        "best",
    ];
    start.into_iter().map(String::from).chain(joints).chain(end.into_iter().map(String::from)).collect()
}

fn node_columns(cell: &Cell, node: &NodeRecord) -> Vec<String> {
    let mut row = vec![node.i.to_string(), node.j.to_string()];
    row.extend(node.position.iter().map(|&v| number(mm_from_m(v))));
    row.push(node.status.name().to_string());
    row.push(inert(&node.status.reason(cell)));
    match &node.posture {
        Some(posture) => row.extend(posture_columns(cell, posture)),
        None => row.extend(std::iter::repeat_n(String::new(), cell.robot.axes() + 14)),
    }
    row
}

fn posture_columns(cell: &Cell, p: &PostureRecord) -> Vec<String> {
    let mm = |v: &f64| number(mm_from_m(*v));
    let mut row: Vec<String> = Vec::new();
    for (joint, &q) in cell.robot.joints.iter().zip(&p.joints) {
        row.push(if joint.kind == JointKind::Revolute { number(deg_from_rad(q)) } else { mm(&q) });
    }
    row.extend(p.error.iter().map(mm));
    row.push(mm(&p.in_sense));
    row.extend(p.rotation.iter().map(|&r| number(deg_from_rad(r))));
    row.extend(p.linear.iter().map(mm));
    let d = discrepancy(&p.nonlinear, &p.linear);
    row.extend([d.x, d.y, d.z, d.resultant].map(|v| v.map_or(String::new(), number)));
    row
}

fn number(v: f64) -> String {
    rounded(v, 9).to_string()
}

/// Text that a spreadsheet would take for a formula gets a leading apostrophe.
fn inert(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text.to_string() }
}
