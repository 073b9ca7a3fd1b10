//! Joint coordinates from a second table. Its rows are matched with the rows of the first table by a shared
//! column, or by their order.

use super::columns::{ColumnNames, TableNames};
use super::grid::FieldGrid;
use super::name::StatedUnit;
use super::rows::joint_fields;
use crate::cell::JointVector;
use crate::files::fault::{Fault, shown};
use std::collections::HashMap;

/// Joint coordinates of every line of a table of positions.
pub struct PairedJoints {
    /// Joint coordinates of every line; None for a line whose posture the second table does not contain.
    pub joints: Vec<Option<JointVector>>,
    pub names: Vec<String>,
    pub angle_unit: Option<StatedUnit>,
    /// Note for the user on how the rows were matched.
    pub note: String,
}

/// Names of columns that identify a posture, in order of preference.
const KEYS: [&str; 14] = [
    "id",
    "pose",
    "posture",
    "no",
    "no.",
    "nr",
    "nr.",
    "number",
    "index",
    "name",
    "point",
    "point name",
    "timestamp",
    "time",
];

/// Finds the joint coordinates of every line of `positions` in the table `joints`, read from `file`.
///
/// # Errors
///
/// Returns the faults of the second table.
pub fn pair(
    positions: &FieldGrid<'_>,
    joints: &FieldGrid<'_>,
    file: &str,
    columns: &ColumnNames,
    robot_joints: &[&str],
) -> Result<PairedJoints, Vec<Fault>> {
    let names = TableNames::new(&joints.header, &joints.units, columns, robot_joints);
    let fault =
        |line: usize, message: String, help: &str| Fault { line, ..Fault::of_file(file, message, help) };
    let is_numbered = joints.header_line.is_none() && !joints.lines.is_empty();
    let (places, angle_unit) = names
        .find_joints(is_numbered)
        .map_err(|(message, help)| vec![fault(joints.header_line.unwrap_or(1), message, &help)])?;
    let (mut all, mut faults) = (Vec::new(), Vec::new());
    for line in &joints.lines {
        match joint_fields(&joints.fields(line), &places, &joints.header) {
            Ok(q) => all.push(q),
            Err((message, help)) => faults.push(fault(line.number, message, &help)),
        }
    }
    if !faults.is_empty() {
        faults.truncate(super::rows::MAX_FAULTS);
        return Err(faults);
    }
    let names = places.iter().map(|&k| joints.header[k].clone()).collect();
    if let Some((name, of_lines)) = shared_key(positions, joints) {
        let joints: Vec<_> = of_lines.into_iter().map(|k| k.map(|k| all[k])).collect();
        let lost = joints.iter().filter(|q| q.is_none()).count();
        let mut note = format!("rows of the two tables are matched by the column `{}`", shown(&name));
        if lost > 0 {
            note += &format!("; {lost} rows of positions have no matching row of joints and are left out");
        }
        return Ok(PairedJoints { joints, names, angle_unit, note });
    }
    if all.len() != positions.lines.len() {
        let message = format!(
            "the table of joints has {} postures, but the table of positions has {} rows, and no common column identifies the postures",
            all.len(),
            positions.lines.len()
        );
        let help = "give both tables a column of the same name, such as id, with one value for each posture";
        return Err(vec![fault(1, message, help)]);
    }
    let note = "rows of the two tables are matched by their order".into();
    Ok(PairedJoints { joints: all.into_iter().map(Some).collect(), names, angle_unit, note })
}

/// Returns the column that identifies postures in both tables. For every line of the table of positions, also
/// returns the matching line of the table of joint coordinates. Returns None if no such column exists.
fn shared_key(positions: &FieldGrid<'_>, joints: &FieldGrid<'_>) -> Option<(String, Vec<Option<usize>>)> {
    let place =
        |grid: &FieldGrid<'_>, key: &str| grid.header.iter().position(|name| name.eq_ignore_ascii_case(key));
    let both = KEYS.iter().filter_map(|key| Some((place(positions, key)?, place(joints, key)?)));
    for (of_position, of_joints) in both {
        let mut lines = HashMap::new();
        for (k, line) in joints.lines.iter().enumerate() {
            let key = joints.fields(line).get(of_joints).copied().unwrap_or("");
            lines.insert(key, k);
        }
        let is_unique = lines.len() == joints.lines.len() && !lines.contains_key("");
        let found = positions
            .lines
            .iter()
            .map(|line| positions.fields(line).get(of_position).and_then(|key| lines.get(key)).copied());
        let found: Vec<_> = found.collect();
        // A column that identifies few rows means something else in one of the tables.
        if is_unique && 2 * found.iter().flatten().count() >= found.len() {
            return Some((positions.header[of_position].clone(), found));
        }
    }
    None
}
