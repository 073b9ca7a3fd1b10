//! Measured positions with their predictions as CSV.

use super::csv::{flag_word, inert, put};
use crate::record::ComparedFile;

/// Columns of the table; vectors are in the base frame of the robot, mm.
const COLUMNS: [&str; 15] = [
    "file",
    "row",
    "reflector",
    "x_mm",
    "y_mm",
    "z_mm",
    "measured_x_mm",
    "measured_y_mm",
    "measured_z_mm",
    "predicted_x_mm",
    "predicted_y_mm",
    "predicted_z_mm",
    "predicted_size_mm",
    "residual_mm",
    "inside_95",
];

/// Writes one row for each measured position after a header.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn csv(files: &[ComparedFile]) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &COLUMNS.map(String::from))?;
    for file in files {
        for p in &file.positions {
            let mut row = vec![inert(&file.file), p.row.to_string(), p.reflector.to_string()];
            let vectors = [p.nominal_mm, p.measured_mm, p.predicted_mm];
            row.extend(vectors.as_flattened().iter().map(f64::to_string));
            row.extend([p.predicted_size_mm, p.residual_mm].map(|mm| mm.to_string()));
            row.push(p.inside_95.map_or("", flag_word).into());
            put(&mut writer, &row)?;
        }
    }
    writer.into_inner().map_err(|e| e.to_string())
}
