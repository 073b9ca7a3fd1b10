//! Reader of the tool attitude of an operation.

use super::coordinate;
use crate::cell::{Attitude, Azimuth, Coordinate, Spin};
use crate::files::fault::shown;
use crate::files::keys::key::NumberRange;
use crate::files::keys::operation::{MAX_BEND, MAX_SPINS, operation};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Value;
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;

/// Attitude with the start values of its angles, and the search variables for elevation, azimuth and spin.
/// The entry of an angle that is not a search variable is None.
type SearchedAttitude = (Attitude, [Option<Coordinate>; 3]);

/// Reads `bend_deg`, `azimuth_deg`, `spin_deg` and `tolerance_deg` of an operation.
pub fn read(t: &mut Table) -> Option<SearchedAttitude> {
    let elevation = read_bend(t);
    let (azimuth, spin) = (read_azimuth(t), read_spin(t));
    let tolerance = t.number(&operation::TOLERANCE)?;
    let (elevation, (azimuth, searched_azimuth), (spin, searched_spin)) = (elevation?, azimuth?, spin?);
    let attitude = Attitude { elevation: elevation.start(), azimuth, spin, tolerance };
    // A fixed angle is part of the attitude, but not a search variable.
    let angles = [Some(elevation), searched_azimuth, searched_spin];
    Some((attitude, angles.map(|c| c.filter(Coordinate::is_free))))
}

/// Reads the elevation of the tool axis, rad.
fn read_bend(t: &mut Table) -> Option<Coordinate> {
    let node = t.get(&operation::BEND)?;
    let bend = coordinate::read(node, &operation::BEND, t)?;
    let (low, high) = bend.range();
    let beyond = [low, high].map(units::deg_from_rad).into_iter().find(|deg| deg.abs() > MAX_BEND + 1e-9);
    if let Some(deg) = beyond {
        let given = plain(units::rounded(deg, 6));
        let message = format!("`bend_deg` must be from -{MAX_BEND} to {MAX_BEND}, not {given}");
        let help = "-90 points the tool down, 0 holds it horizontal, and 90 points it up; -100 is 10 degrees past straight down";
        t.error(node.at, message, help);
    }
    Some(bend)
}

/// Reads the azimuth: an angle in the surface, a range or list of angles, "radial" or "free".
fn read_azimuth(t: &mut Table) -> Option<(Azimuth, Option<Coordinate>)> {
    let key = operation::AZIMUTH;
    let Some(node) = t.get(&key) else { return Some((Azimuth::Free, None)) };
    match &node.value {
        Value::Text(word) if word == "radial" => Some((Azimuth::Radial, None)),
        Value::Text(word) if word == "free" => Some((Azimuth::Free, None)),
        Value::Text(word) => {
            let message = format!("`azimuth_deg` cannot be \"{}\"", shown(word));
            t.error(
                node.at,
                message,
                "write an angle from the x axis of the surface, or \"radial\", or \"free\"",
            );
            None
        }
        _ => {
            let angle = coordinate::read(node, &key, t)?;
            Some((Azimuth::Surface(angle.start()), Some(angle)))
        }
    }
}

/// Reads the spin: one angle, a list of allowed angles, a range to search, or "free".
fn read_spin(t: &mut Table) -> Option<(Spin, Option<Coordinate>)> {
    let key = operation::SPIN;
    let Some(node) = t.get(&key) else { return Some((Spin::Free, None)) };
    match &node.value {
        Value::Text(word) if word == "free" => Some((Spin::Free, None)),
        Value::Text(word) => {
            let message = format!("`spin_deg` cannot be \"{}\"", shown(word));
            t.error(node.at, message, "write an angle, a list of angles, or \"free\"");
            None
        }
        Value::Array(items) if items.is_empty() || items.len() > MAX_SPINS => {
            let message =
                format!("a list in `spin_deg` must have 1 to {MAX_SPINS} angles, not {}", items.len());
            t.error(node.at, message, "write for example spin_deg = [0, 90, 180, 270], or \"free\"");
            None
        }
        Value::Array(items) => {
            let angles = value::numbers(node, "`spin_deg`", items.len(), NumberRange::Finite, t.lib)?;
            Some((Spin::At(angles.into_iter().map(units::rad_from_deg).collect()), None))
        }
        _ => {
            let angle = coordinate::read(node, &key, t)?;
            Some((Spin::At(vec![angle.start()]), Some(angle)))
        }
    }
}
