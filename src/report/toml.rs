//! best.toml: the cell again with its placements fixed, runnable where it lies.

use crate::cell::{Cell, Coordinate, Layout, Unit};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};
use std::fmt::Write;

/// A cell file that takes everything `from` another and fixes the free coordinates of the
/// placements, the error set, the model, how they are read, and senses and limits as asked for.
/// `comment` is one line.
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
    for (equipment, at) in cell.equipment.iter().zip(&layout.placements) {
        let values = [at.x, at.y, at.z, at.yaw];
        let free: Vec<_> =
            (0..4).filter(|&k| matches!(equipment.placement[k], Coordinate::Range { .. })).collect();
        if free.is_empty() {
            continue;
        }
        let _ = writeln!(out, "\n[equipment.{}.placement]", quoted(&equipment.name));
        for k in free {
            let _ = match k {
                3 => writeln!(out, "yaw_deg = {}", shortest(values[k], deg_from_rad, rad_from_deg, 4)),
                _ => writeln!(
                    out,
                    "{} = {}",
                    ["x_mm", "y_mm", "z_mm"][k],
                    shortest(values[k], mm_from_m, m_from_mm, 3)
                ),
            };
        }
    }
    for operation in &cell.operations {
        let _ = writeln!(
            out,
            "\n[operation.{}]\nsense = {}",
            quoted(&operation.name),
            quoted(&operation.sense.name)
        );
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

/// A TOML basic string. Names hold no control characters; quotes and backslashes are escaped.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// An SI value in the unit of the file: with few digits if they say the same, else with all. TOML
/// reads it as a float.
fn shortest(si: f64, to_file: fn(f64) -> f64, from_file: fn(f64) -> f64, digits: i32) -> String {
    let few = rounded(to_file(si), digits);
    let value = if from_file(few) == si { few } else { to_file(si) };
    let text = value.to_string();
    if text.contains('.') { text } else { text + ".0" }
}
