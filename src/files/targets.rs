//! Reader of a table of targets: positions of the TCP, with or without orientations.

use super::fault::{Fault, listed, shown};

/// Target in a table, mm and degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetRow {
    /// Name of the target; the number of its row if the table has no names.
    pub name: String,
    pub position_mm: [f64; 3],
    /// Rotations rx, ry, rz about the fixed axes x, y and z.
    pub rotation_deg: Option<[f64; 3]>,
}

/// Columns of the position, then of the rotation. Each column may have one of two names.
const COLUMNS: [[&str; 2]; 6] =
    [["x", "x_mm"], ["y", "y_mm"], ["z", "z_mm"], ["rx", "rx_deg"], ["ry", "ry_deg"], ["rz", "rz_deg"]];

/// Largest number of faults listed for one file.
const MAX_FAULTS: usize = 20;

/// Largest number of targets.
const MAX_TARGETS: usize = 100_000;

/// Largest absolute value of a number, mm or degrees.
const MAX_NUMBER: f64 = 1e6;

/// Reads a table of targets. The first line names the columns; the separator is a comma or a semicolon.
///
/// # Errors
/// Returns the faults of the file, at most 20.
pub fn read(file: &str, text: &str) -> Result<Vec<TargetRow>, Vec<Fault>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let first = text.lines().next().unwrap_or("");
    let separator = if first.contains(';') { b';' } else { b',' };
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.delimiter(separator).trim(csv::Trim::All).from_reader(text.as_bytes());
    let fault =
        |line: usize, message: String, help: &str| Fault { line, ..Fault::of_file(file, message, help) };
    let header: Vec<String> = match reader.headers() {
        Ok(header) => header.iter().map(str::to_lowercase).collect(),
        Err(e) => return Err(vec![fault(1, e.to_string(), "save the table as CSV in UTF-8")]),
    };
    let places = places(&header).map_err(|message| {
        vec![fault(1, message, "name the columns x, y, z, and for orientations rx, ry, rz (mm and degrees)")]
    })?;
    let name = header.iter().position(|column| column == "name");
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for (k, record) in reader.records().enumerate() {
        if faults.len() >= MAX_FAULTS {
            break;
        }
        let record = match record {
            Ok(record) => record,
            Err(e) => {
                let line = e.position().map_or(k + 2, |at| at.line() as usize);
                faults.push(fault(line, e.to_string(), "give every row as many fields as the first line"));
                continue;
            }
        };
        let line = record.position().map_or(k + 2, |at| at.line() as usize);
        let mut numbers = [0.0; COLUMNS.len()];
        for (place, number) in places.iter().zip(&mut numbers) {
            let field = record.get(*place).unwrap_or("");
            let point = if separator == b',' { field.to_string() } else { field.replace(',', ".") };
            match point.parse::<f64>() {
                Ok(value) if value.abs() <= MAX_NUMBER => *number = value,
                _ => {
                    let message =
                        format!("`{}` in column `{}` is not a number", shown(field), header[*place]);
                    faults.push(fault(
                        line,
                        message,
                        "write a number in mm or degrees, from -1000000 to 1000000",
                    ));
                }
            }
        }
        let [x, y, z, rx, ry, rz] = numbers;
        let given = name.and_then(|place| record.get(place)).filter(|name| !name.is_empty());
        rows.push(TargetRow {
            name: given.map_or_else(|| (k + 1).to_string(), str::to_string),
            position_mm: [x, y, z],
            rotation_deg: (places.len() == COLUMNS.len()).then_some([rx, ry, rz]),
        });
    }
    if faults.is_empty() && rows.is_empty() {
        faults.push(fault(1, "the table has no target".into(), "give one row for each target"));
    }
    if rows.len() > MAX_TARGETS {
        let message = format!("the table has more than {MAX_TARGETS} targets");
        faults.push(fault(1, message, "split the table"));
    }
    if faults.is_empty() { Ok(rows) } else { Err(faults) }
}

/// Returns the indices of the position columns, then of the rotation columns if the table has any.
fn places(header: &[String]) -> Result<Vec<usize>, String> {
    let place = |names: &[&str; 2]| header.iter().position(|column| names.contains(&column.as_str()));
    let found: Vec<_> = COLUMNS.iter().map(place).collect();
    let rotates = found[3..].iter().any(Option::is_some);
    let wanted = if rotates { COLUMNS.len() } else { 3 };
    let missing = COLUMNS.iter().zip(&found).take(wanted).filter(|(_, place)| place.is_none());
    let missing: Vec<_> = missing.map(|(names, _)| format!("`{}`", names[0])).collect();
    if missing.is_empty() {
        return Ok(found.into_iter().take(wanted).flatten().collect());
    }
    let known = listed(header.iter().map(String::as_str));
    Err(format!("there is no column {}; the columns are {known}", missing.join(", ")))
}
