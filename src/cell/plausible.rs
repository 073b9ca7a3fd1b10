//! Warnings about sizes that are probably a wrong unit: 20 times the reach, or a twentieth of it.

use super::document::{At, Library};
use super::fault::Severity;
use super::model::{Cell, Equipment};
use super::solid;
use crate::units::mm_from_m;

const FACTOR: f64 = 20.0;

/// Compares every equipment with the robot's reach. `at` gives the place of an equipment by name.
pub fn warn(cell: &Cell, at: impl Fn(&str) -> At, lib: &mut Library<'_>) {
    let reach = cell.robot.reach();
    for equipment in &cell.equipment {
        let size = largest_size(equipment);
        let side = if size > FACTOR * reach {
            "20 times"
        } else if size < reach / FACTOR {
            "less than a twentieth of"
        } else {
            continue;
        };
        let message = format!(
            "`{}` measures {} mm, {side} the reach of the robot ({:.0} mm)",
            equipment.name,
            (mm_from_m(size) * 10.0).round() / 10.0,
            mm_from_m(reach)
        );
        lib.fault(
            at(&equipment.name),
            Severity::Warning,
            message,
            "are its lengths, or the robot's, really in mm?",
        );
    }
}

fn largest_size(e: &Equipment) -> f64 {
    let drawn = solid::extent_of(e.solids.iter().map(|s| &s.shape)).map_or(0.0, |(lo, hi)| (hi - lo).max());
    let surface = e.surface.map_or(0.0, |s| s.size.0.max(s.size.1));
    let footprint = e.footprint.size.0.max(e.footprint.size.1);
    drawn.max(surface).max(footprint)
}
