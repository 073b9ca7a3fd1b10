//! Rows of a table of measured positions.

use super::columns::{ColumnFault, FoundColumns, RotationForm};
use super::grid::{FieldGrid, GridLine};
use super::number::FieldValue;
use crate::calibration::{MeasuredPosition, RawMeasurement, RawRotation};
use crate::cell::{JointVector, MAX_JOINTS};
use crate::files::fault::{Fault, shown};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;

/// Largest number of faults listed for one file.
pub const MAX_FAULTS: usize = 20;

/// Largest number of reflectors of one table.
const MAX_REFLECTORS: usize = 20;

/// Magnitude at and above which a number cannot be a joint coordinate or a position, in any unit.
const TOO_FAR: f64 = 1e9;

/// Rows and reflectors of a table, with notes on the lines that were left out.
pub struct ReadRows {
    pub rows: Vec<RawMeasurement>,
    pub reflectors: Vec<String>,
    pub notes: Vec<String>,
}

/// Reads the rows of a table; `joints` holds the joint coordinates of every line if a second table
/// states them.
///
/// # Errors
///
/// Returns the faults of the rows, at most [`MAX_FAULTS`].
pub fn read(
    file: &str,
    grid: &FieldGrid<'_>,
    found: &FoundColumns,
    joints: Option<&[Option<JointVector>]>,
) -> Result<ReadRows, Vec<Fault>> {
    let fault =
        |line: usize, (message, help): ColumnFault| Fault { line, ..Fault::of_file(file, message, help) };
    let names_rows = found.reflector.is_some_and(|column| identifies_rows(grid, column));
    let found = &FoundColumns { reflector: found.reflector.filter(|_| !names_rows), ..found.clone() };
    let mut reader =
        RowReader { grid, found, joints, rows: Vec::new(), reflectors: Vec::new(), unseen: 0, texts: 0 };
    let mut faults = Vec::new();
    for (k, line) in grid.lines.iter().enumerate() {
        reader.read(k, line).into_iter().for_each(|why| faults.push(fault(line.number, why)));
        if faults.len() >= MAX_FAULTS {
            break;
        }
    }
    faults.truncate(MAX_FAULTS);
    let first = grid.header_line.unwrap_or(1);
    if faults.is_empty() && reader.rows.is_empty() {
        let help = "give one row per measured posture, with its joint coordinates and its position";
        faults.push(fault(first, ("the file has no row of numbers".into(), help.into())));
    }
    if reader.reflectors.len() > MAX_REFLECTORS {
        let message = match found.reflector {
            Some(k) => {
                format!("column `{}` names more than {MAX_REFLECTORS} reflectors", shown(&grid.header[k]))
            }
            None => format!("the table has positions of more than {MAX_REFLECTORS} reflectors"),
        };
        let help = "rename the columns that do not belong to reflectors, or state x, y and z with --column";
        faults.push(fault(first, (message, help.into())));
    }
    if faults.is_empty() { Ok(reader.finished()) } else { Err(faults) }
}

/// Returns whether the number of different names in a column exceeds half the number of rows. Such a column
/// names postures, not reflectors. The function returns false for a table of at most four rows.
fn identifies_rows(grid: &FieldGrid<'_>, column: usize) -> bool {
    let names: HashSet<_> =
        grid.lines.iter().filter_map(|line| grid.fields(line).get(column).copied()).collect();
    grid.lines.len() > 4 && 2 * names.len() > grid.lines.len()
}

struct RowReader<'a, 't> {
    grid: &'a FieldGrid<'t>,
    found: &'a FoundColumns,
    joints: Option<&'a [Option<JointVector>]>,
    rows: Vec<RawMeasurement>,
    reflectors: Vec<String>,
    /// Number of rows in which no reflector was seen.
    unseen: usize,
    /// Number of lines without a number, such as repeated names of columns.
    texts: usize,
}

impl RowReader<'_, '_> {
    /// Reads line `k`, counted from 0, and returns its faults.
    fn read(&mut self, k: usize, line: &GridLine<'_>) -> Vec<ColumnFault> {
        let fields = self.grid.fields(line);
        let numbers: Vec<FieldValue> = fields.iter().map(|field| FieldValue::read(field)).collect();
        if numbers.iter().all(|field| field.number().is_none()) {
            self.texts += 1;
            return Vec::new();
        }
        let mut faults = Vec::new();
        let joints = match self.joints {
            Some(all) => all[k],
            None => joint_fields(&fields, &self.found.joints, &self.grid.header)
                .map(|mut q| {
                    q.iter_mut().zip(&self.found.joint_factors).for_each(|(q, factor)| *q *= factor);
                    q
                })
                .map_err(|why| faults.push(why))
                .ok(),
        };
        let mut positions = Vec::new();
        for (reflector, columns) in self.found.reflectors.iter().enumerate() {
            match position(&columns.position, &numbers) {
                Ok(Some(position)) => positions.push((reflector, position * self.found.position_factor)),
                Ok(None) => {}
                Err(place) => {
                    faults.push(not_a_number(fields.get(place).unwrap_or(&""), &self.grid.header[place]));
                }
            }
        }
        let Some(joints) = joints.filter(|_| faults.is_empty()) else { return faults };
        self.unseen += usize::from(positions.is_empty());
        let (rotation, sigma) = (self.rotation(&numbers), self.sigma(&numbers));
        for (reflector, position) in positions {
            let reflector = self.reflector(reflector, &fields);
            let row = line.number;
            let numbers = MeasuredPosition { row, joints, reflector, position, rotation: None, sigma };
            self.rows.push(RawMeasurement { numbers, rotation });
        }
        faults
    }

    /// Returns the index of a reflector. A name in the row identifies the reflector if the table has a column
    /// of reflector names and one position per row. Otherwise, the position columns identify the reflector.
    fn reflector(&mut self, of_columns: usize, fields: &[&str]) -> usize {
        let columns = &self.found.reflectors;
        let name = match (self.found.reflector, columns.len()) {
            (Some(k), 1) => fields.get(k).copied().unwrap_or(""),
            _ => &columns[of_columns].name,
        };
        self.reflectors.iter().position(|known| known == name).unwrap_or_else(|| {
            self.reflectors.push(name.to_string());
            self.reflectors.len() - 1
        })
    }

    /// Returns the orientation of a row; None if one of its numbers is missing.
    fn rotation(&self, numbers: &[FieldValue]) -> Option<RawRotation> {
        let (form, places) = self.found.rotation.as_ref()?;
        let all = places.iter().map(|&k| numbers.get(k)?.number()).collect::<Option<Vec<_>>>()?;
        Some(match form {
            RotationForm::Angles => RawRotation::Angles(all.try_into().ok()?),
            RotationForm::ScalarFirst => RawRotation::ScalarFirst(all.try_into().ok()?),
            RotationForm::Quaternion => RawRotation::Quaternion(all.try_into().ok()?),
            RotationForm::Matrix => RawRotation::Matrix(Matrix3::from_row_slice(&all)),
        })
    }

    /// Returns the stated standard deviation per axis, in the unit of the position; None if it is missing.
    fn sigma(&self, numbers: &[FieldValue]) -> Option<f64> {
        let (places, deviations) = self.found.uncertainty.as_ref()?;
        let all = places.iter().map(|&k| numbers.get(k)?.number()).collect::<Option<Vec<_>>>()?;
        let square = all.iter().map(|u| u * u).sum::<f64>() / all.len() as f64;
        let sigma = square.sqrt() * self.found.uncertainty_factor / deviations;
        Some(sigma).filter(|sigma| *sigma > 0.0 && *sigma < TOO_FAR)
    }

    fn finished(self) -> ReadRows {
        let mut notes = Vec::new();
        if self.unseen > 0 {
            notes.push(format!("{} rows without a measured position are left out", self.unseen));
        }
        if self.texts > 0 {
            notes.push(format!("{} lines without numbers are left out", self.texts));
        }
        ReadRows { rows: self.rows, reflectors: self.reflectors, notes }
    }
}

/// Returns the position in three columns; None if it was not measured. The error is the index of the column
/// that does not hold a number.
fn position(places: &[usize; 3], numbers: &[FieldValue]) -> Result<Option<Vector3<f64>>, usize> {
    let mut position = [None; 3];
    for (coordinate, &place) in position.iter_mut().zip(places) {
        *coordinate = match numbers.get(place).copied().unwrap_or(FieldValue::Missing) {
            FieldValue::Number(number) if number.abs() < TOO_FAR => Some(number),
            FieldValue::Missing => None,
            _ => return Err(place),
        };
    }
    Ok(match position {
        [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
        _ => None,
    })
}

/// Returns the joint coordinates in the fields of a line, in the unit of the file.
pub fn joint_fields(
    fields: &[&str],
    places: &[usize],
    header: &[String],
) -> Result<JointVector, ColumnFault> {
    let mut joints = [0.0; MAX_JOINTS];
    for (q, &place) in joints.iter_mut().zip(places) {
        let Some(field) = fields.get(place) else {
            let message =
                format!("the row has {} fields, but the table has {} columns", fields.len(), header.len());
            return Err((message, "give every row as many fields as the table has columns".into()));
        };
        match FieldValue::read(field) {
            FieldValue::Number(number) if number.abs() < TOO_FAR => *q = number,
            _ => return Err(not_a_number(field, &header[place])),
        }
    }
    Ok(joints)
}

fn not_a_number(field: &str, column: &str) -> ColumnFault {
    let message = format!("`{}` in column `{}` is not a finite number", shown(field), shown(column));
    (message, "delete the row, or correct the number".into())
}
