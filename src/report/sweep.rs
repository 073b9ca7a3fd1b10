//! A sweep: one row per combination of settings, and what is best among them.
//!
//! Rows are files of their own, read again for the table: a sweep that was killed and resumed makes it
//! from the same numbers. Lengths in mm, angles in degrees, world frame.

use super::csv::{inert, number, put};
use crate::units::rounded;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// What one combination came to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub index: usize,
    /// Value by path, as JSON where that reads it, else as typed.
    pub set: Map<String, Value>,
    pub feasible: bool,
    pub objective: Option<f64>,
    pub unit: String,
    /// What no layout can beat, where a search says so.
    pub bound: Option<f64>,
    pub gap_percent: Option<f64>,
    /// Layouts evaluated, and how many of them were feasible.
    pub evaluations: u64,
    pub feasible_evaluations: u64,
    pub operations: Vec<Spot>,
    /// `x_mm`, `y_mm`, `z_mm`, `yaw_deg` by equipment.
    pub layout: Map<String, Value>,
    /// Why it is not feasible.
    pub reasons: Vec<String>,
}

/// One operation of a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    pub name: String,
    /// What the objective adds up, in its unit; null without a spot.
    pub value: Option<f64>,
    pub position_mm: Option<[f64; 3]>,
    /// The error in the sense of the operation, and the largest with which it succeeds, in `error_unit`.
    pub error: Option<f64>,
    pub limit: Option<f64>,
    pub error_unit: String,
    /// Whether the limit is kept; None without a limit or a spot.
    pub limit_met: Option<bool>,
}

/// A value of a set, and the best row that has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Group<'a> {
    pub path: &'a str,
    pub value: &'a Value,
    pub rows: usize,
    pub feasible: usize,
    pub best: Option<&'a Row>,
}

/// The row with the least objective, the first of equals; None if objectives differ in unit.
pub fn best<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<&'a Row> {
    let feasible = rows.filter(|r| r.feasible);
    let unit = &feasible.clone().next()?.unit;
    let is_one_unit = feasible.clone().all(|r| r.unit == *unit);
    let objective = |r: &Row| r.objective.unwrap_or(f64::INFINITY);
    feasible.min_by(|a, b| objective(a).total_cmp(&objective(b))).filter(|_| is_one_unit)
}

/// Every value of every path, in the order of the rows.
pub fn groups(rows: &[Row]) -> Vec<Group<'_>> {
    let mut groups = Vec::new();
    let Some(first) = rows.first() else { return groups };
    for path in first.set.keys() {
        let mut values: Vec<&Value> = Vec::new();
        for value in rows.iter().filter_map(|r| r.set.get(path)) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        groups.extend(values.into_iter().map(|value| {
            let of = rows.iter().filter(|r| r.set.get(path) == Some(value));
            let feasible = of.clone().filter(|r| r.feasible).count();
            Group { path, value, rows: of.clone().count(), feasible, best: best(of) }
        }));
    }
    groups
}

/// A value of a set as text.
pub fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// table.json.
pub fn json(mode: &str, rows: &[Row]) -> Value {
    let best_of = groups(rows).into_iter().map(|g| {
        json!({
            "path": g.path, "value": g.value, "combinations": g.rows, "feasible": g.feasible,
            "best": g.best.map(|r| r.index), "objective": g.best.and_then(|r| r.objective),
        })
    });
    json!({
        "schema": "sweetspot/sweep/1",
        "mode": mode,
        "combinations": rows.len(),
        "feasible": rows.iter().filter(|r| r.feasible).count(),
        "best": best(rows.iter()).map(|r| r.index),
        "best_of": best_of.collect::<Vec<_>>(),
        "rows": rows,
    })
}

const COORDINATES: [&str; 4] = ["x_mm", "y_mm", "z_mm", "yaw_deg"];

/// table.csv: one line per row, with a header.
///
/// # Errors
/// Those of the csv writer, which writes to memory here.
pub fn csv(rows: &[Row]) -> Result<Vec<u8>, String> {
    let operations = distinct(rows.iter().flat_map(|r| r.operations.iter().map(|o| o.name.as_str())));
    let equipment = distinct(rows.iter().flat_map(|r| r.layout.keys().map(String::as_str)));
    let paths: Vec<&str> = rows.first().map_or(Vec::new(), |r| r.set.keys().map(String::as_str).collect());
    let mut header: Vec<String> = vec!["index".into()];
    header.extend(paths.iter().map(|p| inert(p)));
    let plain = ["best", "feasible", "objective", "unit", "bound", "gap_percent", "evaluations"];
    header.extend(plain.map(str::to_string));
    let of_operation = ["value", "x_mm", "y_mm", "z_mm", "error", "limit", "error_unit", "limit_met"];
    for name in &operations {
        header.extend(of_operation.map(|column| format!("operation.{name}.{column}")));
    }
    for name in &equipment {
        header.extend(COORDINATES.map(|column| format!("equipment.{name}.{column}")));
    }
    header.push("reasons".into());
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &header)?;
    let best = best(rows.iter()).map(|r| r.index);
    for row in rows {
        let mut line = vec![row.index.to_string()];
        line.extend(paths.iter().map(|p| row.set.get(*p).map_or(String::new(), cell)));
        line.extend([flag(best == Some(row.index)), flag(row.feasible), or_empty(row.objective)]);
        line.extend([row.unit.clone(), or_empty(row.bound), or_empty(row.gap_percent)]);
        line.push(row.evaluations.to_string());
        line.extend(operations.iter().flat_map(|name| spot_columns(row, name)));
        line.extend(equipment.iter().flat_map(|name| {
            let at = row.layout.get(*name);
            COORDINATES.map(|c| or_empty(at.and_then(|at| at.get(c)?.as_f64())))
        }));
        line.push(inert(&row.reasons.join("; ")));
        put(&mut writer, &line)?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

/// A minus before a number makes no formula.
fn cell(value: &Value) -> String {
    if value.is_number() { word(value) } else { inert(&word(value)) }
}

fn spot_columns(row: &Row, name: &str) -> [String; 8] {
    let Some(spot) = row.operations.iter().find(|o| o.name == name) else { return Default::default() };
    let [x, y, z] = [0, 1, 2].map(|k| or_empty(spot.position_mm.map(|p| p[k])));
    let met = spot.limit_met.map_or(String::new(), flag);
    [or_empty(spot.value), x, y, z, or_empty(spot.error), or_empty(spot.limit), spot.error_unit.clone(), met]
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

fn flag(yes: bool) -> String {
    if yes { "1".into() } else { "0".into() }
}

fn or_empty(value: Option<f64>) -> String {
    value.map_or(String::new(), |v| number(rounded(v, 9)))
}
