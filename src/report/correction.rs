//! Corrections as CSV: one row for each target.

use super::csv::{inert, or_empty, put};
use crate::cell::Unit;
use crate::record::{CorrectionDocument, CorrectionEntry};

/// Writes the corrections as CSV with a header. Commands are in the base frame of the robot, mm and degrees.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn csv(document: &CorrectionDocument) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let joints = document.driven().enumerate().map(|(k, (_, joint))| match joint.unit {
        Unit::Length => format!("q{}_mm", k + 1),
        _ => format!("q{}_deg", k + 1),
    });
    let first = ["operation", "target", "state"].into_iter();
    let middle = ["x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg"].into_iter();
    let last =
        ["before_mm", "before_deg", "rest_mm", "rest_deg", "random_mm", "random_deg", "reason"].into_iter();
    let header = first.map(String::from).chain(joints).chain(middle.chain(last).map(String::from));
    put(&mut writer, &header.collect::<Vec<_>>())?;
    for entry in &document.targets {
        put(&mut writer, &row(entry, document))?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

fn row(entry: &CorrectionEntry, document: &CorrectionDocument) -> Vec<String> {
    let mut cells = vec![inert(&entry.operation), inert(&target(entry)), entry.state.name().into()];
    cells.extend(document.driven().map(|(i, _)| or_empty(entry.joints.as_ref().map(|q| q[i]))));
    let command = entry.command.as_ref();
    cells.extend((0..3).map(|k| or_empty(command.map(|c| c.position_mm[k]))));
    cells.extend((0..3).map(|k| or_empty(command.map(|c| c.rpy_deg[k]))));
    let errors = [entry.before_mm, entry.before_deg, entry.rest_mm, entry.rest_deg];
    cells.extend(errors.into_iter().chain([entry.random_mm, entry.random_deg]).map(or_empty));
    cells.push(entry.reason.as_deref().map_or(String::new(), inert));
    cells
}

/// Returns the name of a target as it appears in the table of targets. A node without such a name is called
/// `node I J`, where I and J are the indices of the node. Any other target without a name is called `spot`.
pub fn target(entry: &CorrectionEntry) -> String {
    match (&entry.name, entry.node) {
        (Some(name), _) => name.clone(),
        (None, Some([i, j])) => format!("node {i} {j}"),
        (None, None) => "spot".into(),
    }
}
