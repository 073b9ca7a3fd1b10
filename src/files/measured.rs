//! Reader of measured positions: a text table with one row per posture.

use super::fault::{Fault, listed, shown};
use crate::calibration::MeasuredPosition;
use crate::cell::MAX_JOINTS;
use nalgebra::Vector3;

/// Names that state which column holds a quantity: `q1`, `q2` ..., `x`, `y`, `z`.
pub type ColumnNames = [(String, String)];

/// Table of measured positions as the file states them, without conversion of units.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTable {
    /// Numbers of the file: joint coordinates and positions in the units of the file.
    pub rows: Vec<MeasuredPosition>,
    /// Names of the columns of the joints.
    pub joints: Vec<String>,
    /// Names of the columns of the position.
    pub position: [String; 3],
    /// Names of the reflectors; one without a name if the table has no column of reflectors.
    pub reflectors: Vec<String>,
}

/// Largest number of faults listed for one file.
const MAX_FAULTS: usize = 20;

/// Beginnings of the names of position columns, the most telling first.
const POSITION_NAMES: [&str; 5] = ["measurement_", "measured_", "meas_", "tracker_", ""];

/// Names of a column that states the reflector of a row.
const REFLECTOR_NAMES: [&str; 4] = ["reflector", "target", "smr", "point"];

/// Largest number of reflectors of one table.
const MAX_REFLECTORS: usize = 20;

/// Reads a table of measured positions of an arm whose joints have the given names.
///
/// The first line names the columns. The separator is a semicolon, a tab or a comma. If the separator is not
/// a comma, numbers may have a decimal comma. `columns` names the columns that the reader must not guess.
///
/// # Errors
///
/// Returns the faults of the file, at most 20.
pub fn read(
    file: &str,
    text: &str,
    joints: &[&str],
    columns: &ColumnNames,
) -> Result<MeasuredTable, Vec<Fault>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let first = text.lines().next().unwrap_or("");
    let separators = [b';', b'\t', b','].into_iter();
    let separator = separators.max_by_key(|s| first.bytes().filter(|b| b == s).count()).unwrap_or(b';');
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.delimiter(separator).trim(csv::Trim::All).from_reader(text.as_bytes());
    let fault = |line: u64, message: String, help: &str| Fault {
        line: line as usize,
        ..Fault::of_file(file, message, help)
    };
    let header: Vec<String> = match reader.headers() {
        Ok(header) => header.iter().map(str::to_string).collect(),
        Err(error) => return Err(vec![fault(1, error.to_string(), "save the table as CSV in UTF-8")]),
    };
    let (places, names) =
        find_columns(&header, joints, columns).map_err(|(message, help)| vec![fault(1, message, &help)])?;
    let reflector_column = header.iter().position(|name| REFLECTOR_NAMES.contains(&&*name.to_lowercase()));
    let mut reflectors: Vec<String> = Vec::new();
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for (k, record) in reader.records().enumerate() {
        let row = k + 1;
        if faults.len() == MAX_FAULTS {
            break;
        }
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                let line = error.position().map_or(row as u64 + 1, csv::Position::line);
                faults.push(fault(
                    line,
                    error.to_string(),
                    "give every row as many fields as the first line",
                ));
                continue;
            }
        };
        let line = record.position().map_or(row as u64 + 1, csv::Position::line);
        let mut numbers = Vec::new();
        for (place, name) in places.iter().zip(&names) {
            let field = record.get(*place).unwrap_or("");
            let point = if separator == b',' { field.to_string() } else { field.replace(',', ".") };
            match point.parse::<f64>() {
                Ok(number) if number.is_finite() && number.abs() < 1e9 => numbers.push(number),
                _ => faults.push(fault(
                    line,
                    format!("`{}` in column `{}` is not a finite number", shown(field), shown(name)),
                    "delete the row, or correct the number",
                )),
            }
        }
        if let ([q @ .., x, y, z], true) = (&numbers[..], numbers.len() == places.len()) {
            let mut all = [0.0; MAX_JOINTS];
            all[..q.len()].copy_from_slice(q);
            let name = reflector_column.and_then(|k| record.get(k)).unwrap_or("");
            let known = reflectors.iter().position(|known| known == name);
            let reflector = known.unwrap_or(reflectors.len());
            if known.is_none() {
                reflectors.push(name.to_string());
            }
            let position = Vector3::new(*x, *y, *z);
            rows.push(MeasuredPosition {
                row,
                joints: all,
                reflector,
                position,
                rotation: None,
                sigma: None,
            });
        }
    }
    if faults.is_empty() && rows.is_empty() {
        faults.push(fault(1, "the file has no row of numbers".into(), "give one row per measured posture"));
    }
    if let Some(column) = reflector_column.filter(|_| reflectors.len() > MAX_REFLECTORS) {
        let message =
            format!("column `{}` names more than {MAX_REFLECTORS} reflectors", shown(&header[column]));
        faults.push(fault(1, message, "rename the column if it does not name the reflector of a row"));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let position = [0, 1, 2].map(|k| names[joints.len() + k].clone());
    Ok(MeasuredTable { rows, joints: names[..joints.len()].to_vec(), position, reflectors })
}

/// Places and names of the columns of the joints and of the position.
type FoundColumns = (Vec<usize>, Vec<String>);

/// Finds the columns of the joints and of the position; the error holds a message and a help.
fn find_columns(
    header: &[String],
    joints: &[&str],
    columns: &ColumnNames,
) -> Result<FoundColumns, (String, String)> {
    let lower: Vec<String> = header.iter().map(|name| name.to_lowercase()).collect();
    let quantities: Vec<String> = (1..=joints.len()).map(|k| format!("q{k}")).collect();
    let known = quantities.iter().map(String::as_str).chain(["x", "y", "z"]);
    if let Some((unknown, _)) = columns.iter().find(|(name, _)| !known.clone().any(|k| k == name)) {
        let known: Vec<_> = known.collect();
        return Err((format!("`{}` is not a quantity of this arm", shown(unknown)), known.join(", ")));
    }
    let stated = |quantity: &str| columns.iter().find(|(name, _)| name == quantity).map(|(_, column)| column);
    let joint_columns: Vec<usize> = (0..lower.len()).filter(|&i| lower[i].contains("joint")).collect();
    let mut places = Vec::new();
    for (k, joint) in joints.iter().enumerate() {
        let n = k + 1;
        let guesses = [
            format!("q{n}"),
            format!("q{n}_deg"),
            format!("q{n}_rad"),
            format!("q{n}_mm"),
            format!("joint_{n}"),
            format!("joint{n}"),
            format!("j{n}"),
            format!("a{n}"),
            format!("axis{n}"),
            joint.to_lowercase(),
        ];
        let guess = || {
            let named = lower.iter().position(|name| guesses.contains(name));
            named.or_else(|| joint_columns.get(k).copied().filter(|_| joint_columns.len() == joints.len()))
        };
        places.push(column(header, &quantities[k], stated(&quantities[k]), guess)?);
    }
    for axis in ["x", "y", "z"] {
        let guess = || {
            let ends = ["", "_mm", "_m", " [mm]", " (mm)"];
            let names = POSITION_NAMES.iter().flat_map(|begin| ends.map(|end| format!("{begin}{axis}{end}")));
            names.into_iter().find_map(|name| lower.iter().position(|column| *column == name))
        };
        places.push(column(header, axis, stated(axis), guess)?);
    }
    let names = places.iter().map(|&i| header[i].clone()).collect();
    Ok((places, names))
}

/// Returns the column that is stated for a quantity, or else the guessed one.
fn column(
    header: &[String],
    quantity: &str,
    stated: Option<&String>,
    guess: impl Fn() -> Option<usize>,
) -> Result<usize, (String, String)> {
    let place = match stated {
        Some(name) => header.iter().position(|column| column == name),
        None => guess(),
    };
    place.ok_or_else(|| {
        let what = match stated {
            Some(name) => format!("no column `{}`", shown(name)),
            None => format!("no column is named as `{quantity}`"),
        };
        let columns = listed(header.iter().map(String::as_str));
        (what, format!("name the column with --column {quantity}=NAME; the columns are {columns}"))
    })
}
