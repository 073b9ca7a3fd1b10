//! Cell files with fixed placements, such as best.toml. Each file begins with `from`, the path of the
//! original cell file relative to the folder of the new file.

use crate::cell::{Cell, Layout, Reading, Slot, Unit};
use crate::safe_text::shown;
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};
use std::fmt::Write;

/// Returns the text of a cell file that includes the file `from`. The text fixes the free coordinates, error
/// set, model, reading, quantity, registration, senses and limits, and states the assumed values. In the
/// statistical reading, the text also fixes the seed. `comment` is one line.
pub fn fixed(from: &str, comment: &str, cell: &Cell, layout: &Layout) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "# {comment}\nfrom = {}\n", quoted(from));
    let _ = writeln!(
        out,
        "errors = {}\nmodel = \"{}\"\nreading = \"{}\"\nquantity = \"{}\"\nregistration = \"{}\"",
        quoted(cell.error_set().name()),
        cell.model.name(),
        cell.reading.name(),
        cell.quantity.name(),
        cell.registration.name()
    );
    let assumed = |key: &str| cell.assumed.iter().find(|a| a.key == key);
    let line_of = |key: &str, name: &str| assumed(key).map(|a| format!("{name} = {}\n", a.value));
    out.extend(line_of("clearance_mm", "clearance_mm"));
    let margins = ["joint_deg", "joint_mm", "singularity"];
    let margins = margins.iter().filter_map(|name| line_of(&format!("margins.{name}"), name));
    let margins: String = margins.collect();
    if !margins.is_empty() {
        let _ = write!(out, "\n[margins]\n{margins}");
    }
    let free = cell.free();
    let of = |is: &dyn Fn(Slot) -> bool| {
        let lines = free.iter().filter(|(slot, _)| is(*slot));
        lines.map(|(slot, _)| line(*slot, layout.value(cell, *slot))).collect::<String>()
    };
    let base = of(&|slot| matches!(slot, Slot::Base(_)));
    if let Some(tolerance) = line_of("robot.base_tolerance", "base_tolerance") {
        let _ = write!(out, "\n[robot]\n{tolerance}");
    }
    if !base.is_empty() {
        let _ = write!(out, "\n[robot.base]\n{base}");
    }
    for (k, equipment) in cell.equipment.iter().enumerate() {
        let placement = of(&|slot| matches!(slot, Slot::Equipment(of, _) if of == k));
        let key = format!("equipment.{}.placement_tolerance", shown(&equipment.name));
        if let Some(tolerance) = line_of(&key, "placement_tolerance") {
            let _ = write!(out, "\n[equipment.{}]\n{tolerance}", quoted(&equipment.name));
        }
        if !placement.is_empty() {
            let _ = write!(out, "\n[equipment.{}.placement]\n{placement}", quoted(&equipment.name));
        }
    }
    let switches = [("ideal", cell.search.ideal), ("robust", cell.search.robust)];
    let switches = switches.iter().filter(|(_, is_on)| *is_on).map(|(name, _)| format!("{name} = true\n"));
    // The seed of the search is also the seed of the Monte Carlo samples that check the statistical figures.
    let seed = (cell.reading == Reading::Statistical).then(|| format!("seed = {}\n", cell.search.seed));
    let search: String = switches.chain(seed).collect();
    if !search.is_empty() {
        let _ = write!(out, "\n[search]\n{search}");
    }
    for (k, operation) in cell.operations.iter().enumerate() {
        let _ = writeln!(
            out,
            "\n[operation.{}]\nsense = {}",
            quoted(&operation.name),
            quoted(&operation.sense.name)
        );
        out.push_str(&of(&|slot| matches!(slot, Slot::Attitude(of, _) if of == k)));
        if let Some(limit) = operation.limit {
            let _ = match operation.sense.unit {
                Unit::Angle => {
                    writeln!(out, "limit_deg = {}", shortest(limit, deg_from_rad, rad_from_deg, 6))
                }
                _ => writeln!(out, "limit_mm = {}", shortest(limit, mm_from_m, m_from_mm, 6)),
            };
        }
    }
    out
}

/// Returns the TOML line of a free coordinate.
fn line(slot: Slot, value: f64) -> String {
    let key = match slot {
        Slot::Base(axis) | Slot::Equipment(_, axis) => ["x_mm", "y_mm", "z_mm", "yaw_deg"][axis],
        Slot::Attitude(_, angle) => ["bend_deg", "azimuth_deg", "spin_deg"][angle],
    };
    let value = match slot.is_angle() {
        true => shortest(value, deg_from_rad, rad_from_deg, 4),
        false => shortest(value, mm_from_m, m_from_mm, 3),
    };
    format!("{key} = {value}\n")
}

/// Returns a TOML basic string. Names contain no control characters; quotes and backslashes are escaped.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Largest rounding error of a coordinate after conversion to another frame and back, m or rad.
const ROUNDING: f64 = 1e-13;

/// Largest number of decimals of a value in mm or degrees.
const MAX_DIGITS: i32 = 12;

/// Returns an SI value in the unit of the file, with the fewest digits that preserve it. The text contains a
/// decimal point, so TOML reads a float.
fn shortest(si: f64, to_file: fn(f64) -> f64, from_file: fn(f64) -> f64, digits: i32) -> String {
    let few = rounded(to_file(si), digits);
    let is_near = (from_file(few) - si).abs() <= ROUNDING;
    let exact = || (digits + 1..=MAX_DIGITS).map(|d| rounded(to_file(si), d)).find(|v| from_file(*v) == si);
    let value = if is_near { few } else { exact().unwrap_or(to_file(si)) };
    let text = value.to_string();
    if text.contains('.') { text } else { text + ".0" }
}
