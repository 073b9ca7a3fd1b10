//! The table of a sweep as CSV.

use super::csv::{flag_word, inert, or_empty, put};
use crate::record::{PlacementEntry, SweepRow, SweepTable};
use serde_json::Value;

/// Returns a value of a `--set` option as text.
pub fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

const COORDINATES: [&str; 4] = ["x_mm", "y_mm", "z_mm", "yaw_deg"];

/// Writes table.csv: one line per row, with a header. Positions are in the world frame, mm; angles are in
/// degrees.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn csv(table: &SweepTable) -> Result<Vec<u8>, String> {
    let rows = &table.rows;
    let operations = distinct(rows.iter().flat_map(|r| r.operations.iter().map(|o| o.name.as_str())));
    let equipment = distinct(rows.iter().flat_map(|r| r.layout.keys().map(String::as_str)));
    let paths: Vec<&str> = rows.first().map_or(Vec::new(), |r| r.set.keys().map(String::as_str).collect());
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &header(&paths, &operations, &equipment))?;
    for row in rows {
        let mut line = vec![row.index.to_string()];
        line.extend(paths.iter().map(|p| row.set.get(*p).map_or(String::new(), cell)));
        line.extend([table.best == Some(row.index), row.feasible].map(|flag| flag_word(flag).to_string()));
        line.extend([or_empty(row.objective), row.unit.word().into()]);
        line.extend([or_empty(row.bound), or_empty(row.gap_percent), row.evaluations.to_string()]);
        line.extend(operations.iter().flat_map(|name| spot_columns(row, name)));
        line.extend(equipment.iter().flat_map(|name| placement_columns(row.layout.get(*name))));
        line.push(inert(&row.reasons.join("; ")));
        put(&mut writer, &line)?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

fn header(paths: &[&str], operations: &[&str], equipment: &[&str]) -> Vec<String> {
    let mut header: Vec<String> = vec!["index".into()];
    header.extend(paths.iter().map(|p| inert(p)));
    let plain = ["best", "feasible", "objective", "unit", "bound", "gap_percent", "evaluations"];
    header.extend(plain.map(str::to_string));
    let spot = ["value", "x_mm", "y_mm", "z_mm", "error", "limit", "error_unit", "limit_met"];
    for name in operations {
        header.extend(spot.map(|column| format!("operation.{name}.{column}")));
    }
    for name in equipment {
        header.extend(COORDINATES.map(|column| format!("equipment.{name}.{column}")));
    }
    header.push("reasons".into());
    header
}

/// Returns a value of a `--set` option for CSV. The function [`inert`] puts an apostrophe before a text that
/// looks like a formula. A number gets no apostrophe, even if it begins with a minus.
fn cell(value: &Value) -> String {
    if value.is_number() { word(value) } else { inert(&word(value)) }
}

fn spot_columns(row: &SweepRow, name: &str) -> [String; 8] {
    let Some(spot) = row.operations.iter().find(|o| o.name == name) else { return Default::default() };
    let [x, y, z] = [0, 1, 2].map(|k| or_empty(spot.position_mm.map(|p| p[k])));
    let met = spot.limit_met.map_or(String::new(), |met| flag_word(met).into());
    let unit = spot.error_unit.word().to_string();
    [or_empty(spot.value), x, y, z, or_empty(spot.error), or_empty(spot.limit), unit, met]
}

fn placement_columns(at: Option<&PlacementEntry>) -> [String; 4] {
    let Some(at) = at else { return Default::default() };
    [at.x_mm, at.y_mm, at.z_mm, at.yaw_deg].map(|v| or_empty(Some(v)))
}

fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    names.for_each(|name| {
        if !all.contains(&name) {
            all.push(name);
        }
    });
    all
}
