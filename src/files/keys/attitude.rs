//! The attitude of the tool at an operation.

use super::coordinate;
use crate::cell::Coordinate;
use crate::cell::{Attitude, Azimuth, Spin};
use crate::files::fault::shown;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;

/// Most spins of one operation.
pub const MAX_SPINS: usize = 72;

/// Widest tolerance, degrees.
pub const MAX_TOLERANCE: f64 = 45.0;

/// Steepest elevation, degrees: past the vertical the tool leans back.
pub const MAX_BEND: f64 = 135.0;

/// The attitude as drawn, and its angles that may be searched: elevation, azimuth, spin.
type Aim = (Attitude, [Option<Coordinate>; 3]);

/// Reads `bend_deg`, `azimuth_deg`, `spin_deg` and `tolerance_deg` of an operation.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Aim> {
    let elevation = read_bend(t, lib);
    let azimuth = match t.get("azimuth_deg") {
        Some(node) => read_azimuth(node, lib),
        None => Some((Azimuth::Free, None)),
    };
    let spin = match t.get("spin_deg") {
        Some(node) => read_spin(node, lib),
        None => Some((Spin::Free, None)),
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
    let (elevation, (azimuth, of_azimuth), (spin, of_spin)) = (elevation?, azimuth?, spin?);
    let attitude = Attitude { elevation: elevation.start(), azimuth, spin, tolerance };
    // What is fixed stands in the attitude.
    Some((attitude, [Some(elevation), of_azimuth, of_spin].map(|c| c.filter(Coordinate::is_free))))
}

/// Elevation of the tool axis, rad.
fn read_bend(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Coordinate> {
    let node = t.need("bend_deg", format!("add bend_deg = {}", Must::BeFinite.example()))?;
    let bend = coordinate::read(node, "bend_deg", units::rad_from_deg, lib)?;
    let (low, high) = bend.range();
    let beyond = [low, high].map(units::deg_from_rad).into_iter().find(|deg| deg.abs() > MAX_BEND + 1e-9);
    if let Some(deg) = beyond {
        let message = format!(
            "`bend_deg` must be from -{MAX_BEND} to {MAX_BEND}, not {}",
            plain(units::rounded(deg, 6))
        );
        let help = "-90 is the tool pointing down, 0 horizontal, 90 up, -100 down and back by 10";
        lib.error(node.at, message, help);
    }
    Some(bend)
}

/// An angle in the surface or a range of them, "radial" or "free".
fn read_azimuth(node: &Node, lib: &mut Library<'_>) -> Option<(Azimuth, Option<Coordinate>)> {
    let what = "`azimuth_deg`";
    match &node.value {
        Value::Text(word) if word == "radial" => Some((Azimuth::Radial, None)),
        Value::Text(word) if word == "free" => Some((Azimuth::Free, None)),
        Value::Text(word) => {
            let message = format!("{what} cannot be \"{}\"", shown(word));
            lib.error(node.at, message, "write an angle in the surface, \"radial\" or \"free\"");
            None
        }
        _ => {
            let angle = coordinate::read(node, "azimuth_deg", units::rad_from_deg, lib)?;
            Some((Azimuth::Surface(angle.start()), Some(angle)))
        }
    }
}

/// One angle, a list of them, a range to choose one from, or "free".
fn read_spin(node: &Node, lib: &mut Library<'_>) -> Option<(Spin, Option<Coordinate>)> {
    let what = "`spin_deg`";
    match &node.value {
        Value::Text(word) if word == "free" => Some((Spin::Free, None)),
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
            Some((Spin::At(angles.into_iter().map(units::rad_from_deg).collect()), None))
        }
        _ => {
            let angle = coordinate::read(node, "spin_deg", units::rad_from_deg, lib)?;
            Some((Spin::At(vec![angle.start()]), Some(angle)))
        }
    }
}
