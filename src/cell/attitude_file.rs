//! The attitude of the tool at an operation.

use super::attitude::{Attitude, Azimuth, Spin};
use super::document::Library;
use super::fault::shown;
use super::reader::Table;
use super::tree::{Node, Value};
use super::value::{self, Must, plain};
use crate::units;

/// Most spins of one operation.
const MAX_SPINS: usize = 72;

/// Widest tolerance, degrees.
const MAX_TOLERANCE: f64 = 45.0;

/// Reads `bend_deg`, `azimuth_deg`, `spin_deg` and `tolerance_deg` of an operation.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Attitude> {
    let elevation = read_bend(t, lib);
    let azimuth = match t.get("azimuth_deg") {
        Some(node) => read_azimuth(node, lib),
        None => Some(Azimuth::Free),
    };
    let spin = match t.get("spin_deg") {
        Some(node) => read_spin(node, lib),
        None => Some(Spin::Free),
    };
    let tolerance = t.number_or("tolerance_deg", 0.0, Must::NotBeNegative, lib);
    if let Some(wide) = tolerance.filter(|deg| *deg > MAX_TOLERANCE) {
        let message = format!("`tolerance_deg` must be at most {MAX_TOLERANCE}, not {}", plain(wide));
        let at = t.get("tolerance_deg").map_or(t.at, |node| node.at);
        lib.error(
            at,
            message,
            "a tool that may point anywhere has azimuth_deg = \"free\" and spin_deg = \"free\"",
        );
    }
    let tolerance = units::rad_from_deg(tolerance?);
    Some(Attitude { elevation: elevation?, azimuth: azimuth?, spin: spin?, tolerance })
}

/// Elevation of the tool axis, rad.
fn read_bend(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<f64> {
    let bend = t.number("bend_deg", Must::BeFinite, lib)?;
    if bend.abs() > 90.0 {
        let message = format!("`bend_deg` must be from -90 to 90, not {}", plain(bend));
        let help = "-90 is the tool pointing down, 0 horizontal, 90 up";
        lib.error(t.get("bend_deg")?.at, message, help);
    }
    Some(units::rad_from_deg(bend))
}

/// An angle in the surface, "radial" or "free".
fn read_azimuth(node: &Node, lib: &mut Library<'_>) -> Option<Azimuth> {
    let what = "`azimuth_deg`";
    match &node.value {
        Value::Text(word) if word == "radial" => Some(Azimuth::Radial),
        Value::Text(word) if word == "free" => Some(Azimuth::Free),
        Value::Text(word) => {
            let message = format!("{what} cannot be \"{}\"", shown(word));
            lib.error(node.at, message, "write an angle in the surface, \"radial\" or \"free\"");
            None
        }
        _ => {
            let angle = value::number(node, what, Must::BeFinite, lib)?;
            Some(Azimuth::Surface(units::rad_from_deg(angle)))
        }
    }
}

/// One angle, a list of them, or "free".
fn read_spin(node: &Node, lib: &mut Library<'_>) -> Option<Spin> {
    let what = "`spin_deg`";
    match &node.value {
        Value::Text(word) if word == "free" => Some(Spin::Free),
        Value::Text(word) => {
            let message = format!("{what} cannot be \"{}\"", shown(word));
            lib.error(node.at, message, "write an angle, a list of angles, or \"free\"");
            None
        }
        Value::Array(items) if items.is_empty() || items.len() > MAX_SPINS => {
            let message = format!("{what} must be 1 to {MAX_SPINS} angles, not {}", items.len());
            lib.error(node.at, message, "write for example spin_deg = [0, 90, 180, 270], or \"free\"");
            None
        }
        Value::Array(items) => {
            let angles = value::numbers(node, what, items.len(), Must::BeFinite, lib)?;
            Some(Spin::At(angles.into_iter().map(units::rad_from_deg).collect()))
        }
        _ => {
            let angle = value::number(node, what, Must::BeFinite, lib)?;
            Some(Spin::At(vec![units::rad_from_deg(angle)]))
        }
    }
}
