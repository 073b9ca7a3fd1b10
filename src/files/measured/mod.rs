//! Reader of measured positions: text tables of trackers and controllers, with one row per posture.
//!
//! A table may have comments, a preamble, names of columns, and a line of units. Separator and decimal sign
//! are detected. The name of a column states what the column holds. In a table without names, the columns of
//! the joints come first.

mod columns;
mod decode;
mod grid;
mod name;
mod number;
mod pairing;
mod positions;
mod rows;

pub use columns::ColumnNames;
pub use decode::decode;
pub use name::StatedUnit;

use super::fault::Fault;
use crate::calibration::RawMeasurement;
use columns::{FoundColumns, TableNames};
use grid::FieldGrid;

/// Table of measured positions. All lengths have the unit of the position columns, but centimetres and
/// micrometres become millimetres. Angles are in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTable {
    /// Joint coordinates and positions. Lengths are in [`Self::length_unit`], and angles in
    /// [`Self::angle_unit`].
    pub rows: Vec<RawMeasurement>,
    /// Names of the columns of the joints.
    pub joints: Vec<String>,
    /// Names of the columns of the position of the first reflector.
    pub position: [String; 3],
    /// Names of the columns of the orientation.
    pub rotation: Vec<String>,
    /// Names of the columns of the uncertainty, and the coverage factor (number of standard deviations) of
    /// its values.
    pub uncertainty: Option<(Vec<String>, f64)>,
    /// Names of the reflectors. If the table names no reflector, the list holds one empty name.
    pub reflectors: Vec<String>,
    /// Unit of the joint angles, if the column names or a line of units state it.
    pub angle_unit: Option<StatedUnit>,
    /// Unit of lengths, if the column names or a line of units state it.
    pub length_unit: Option<StatedUnit>,
    /// Unit of the angles of orientations, if the column names or a line of units state it.
    pub rotation_unit: Option<StatedUnit>,
    /// Notes for the user on how the table was read.
    pub notes: Vec<String>,
}

impl MeasuredTable {
    /// Returns the table for an arm with `axes` joints. Joint k of this table becomes joint `places[k]`. All
    /// other joints get the coordinate 0 and an empty column name.
    pub fn with_joints_at(mut self, places: &[usize], axes: usize) -> Self {
        for row in &mut self.rows {
            let joints = std::mem::take(&mut row.numbers.joints);
            places.iter().enumerate().for_each(|(k, &place)| row.numbers.joints[place] = joints[k]);
        }
        let mut names = vec![String::new(); axes];
        let own = self.joints.into_iter();
        places.iter().zip(own).for_each(|(&place, name)| names[place] = name);
        self.joints = names;
        self
    }
}

/// Largest number of columns of a table.
const MAX_COLUMNS: usize = 100_000;

/// Table of the joint coordinates of the postures, separate from the table of positions.
#[derive(Debug, Clone, Copy)]
pub struct JointTable<'t> {
    pub file: &'t str,
    pub text: &'t str,
}

/// Reads a table of measured positions of an arm whose joints have the given names.
///
/// `columns` states the columns of some quantities; the reader finds the other columns itself. `joint_table`
/// holds the joints if the table of positions has none.
///
/// # Errors
///
/// Returns the faults of the files, at most 20.
pub fn read(
    file: &str,
    text: &str,
    joints: &[&str],
    columns: &ColumnNames,
    joint_table: Option<JointTable<'_>>,
) -> Result<MeasuredTable, Vec<Fault>> {
    let grid = FieldGrid::new(text);
    let fault = |line: Option<usize>, (message, help): (String, String)| {
        vec![Fault { line: line.unwrap_or(1), ..Fault::of_file(file, message, help) }]
    };
    if grid.header.len() > MAX_COLUMNS {
        let message = format!("the table has {} columns, more than {MAX_COLUMNS}", grid.header.len());
        return Err(fault(grid.header_line, (message, "export only joints and positions".into())));
    }
    let names = TableNames::new(&grid.header, &grid.units, columns, joints);
    let mut notes = Vec::new();
    let (found, joint_lines, joint_names) = match joint_table {
        None => {
            let is_numbered = grid.header_line.is_none() && !grid.lines.is_empty();
            let found = names.find(is_numbered).map_err(|why| fault(grid.header_line, why))?;
            if is_numbered {
                notes.push(format!(
                    "the table has no names of columns: columns 1 to {} are read as the joints and {} to \
                    {} as the position; state other columns with --column q1=NUMBER",
                    joints.len(),
                    joints.len() + 1,
                    joints.len() + 3
                ));
            }
            let names = found.joints.iter().map(|&k| grid.header[k].clone()).collect();
            (found, None, names)
        }
        Some(table) => {
            let other = FieldGrid::new(table.text);
            let paired = pairing::pair(&grid, &other, table.file, columns, joints)?;
            notes.push(paired.note);
            let is_numbered = grid.header_line.is_none() && !grid.lines.is_empty();
            let found = names.find_besides(Vec::new(), is_numbered);
            let found = found.map_err(|why| fault(grid.header_line, why))?;
            let found = FoundColumns { angle_unit: paired.angle_unit, ..found };
            (found, Some(paired.joints), paired.names)
        }
    };
    let read = rows::read(file, &grid, &found, joint_lines.as_deref())?;
    notes.extend(read.notes);
    let name = |k: &usize| grid.header[*k].clone();
    let place = found.reflectors.first().map_or([0; 3], |first| first.position);
    Ok(MeasuredTable {
        rows: read.rows,
        joints: joint_names,
        position: place.map(|k| name(&k)),
        rotation: found.rotation.iter().flat_map(|(_, places)| places.iter().map(name)).collect(),
        uncertainty: found.uncertainty.map(|(places, k)| (places.iter().map(name).collect(), k)),
        reflectors: read.reflectors,
        angle_unit: found.angle_unit,
        length_unit: found.length_unit,
        rotation_unit: found.rotation_unit,
        notes,
    })
}
