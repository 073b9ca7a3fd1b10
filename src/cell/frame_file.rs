//! Errors of a frame: of the robot's base and tool, and of an equipment's placement or fixture.

use super::document::Library;
use super::error_model::*;
use super::reader::Table;
use super::tolerance_file::{self, Kind};
use super::tree::Node;
use super::value::Must;
use crate::units;

/// The frame error under a key of an error set; missing: none.
pub fn read_part(
    t: &mut Table<'_>,
    key: &'static str,
    must: Must,
    lib: &mut Library<'_>,
) -> Option<[f64; PER_FRAME]> {
    let Some(node) = t.get(key) else { return Some([0.0; PER_FRAME]) };
    Table::read(node, &format!("`{key}`"), lib, |t, lib| read_values(t, must, lib))
}

/// `position_mm` and `rotation_deg`, each 0 if missing.
fn read_values(t: &mut Table<'_>, must: Must, lib: &mut Library<'_>) -> Option<[f64; PER_FRAME]> {
    let position = t.numbers_or_zero("position_mm", 3, must, lib);
    let rotation = t.numbers_or_zero("rotation_deg", 3, must, lib);
    let (position, rotation) = (position?, rotation?);
    let lengths = position.into_iter().map(units::m_from_mm);
    let mut all = lengths.chain(rotation.into_iter().map(units::rad_from_deg));
    Some([(); PER_FRAME].map(|()| all.next().unwrap_or(0.0)))
}

/// `errors` of an equipment.
pub fn read_errors(node: &Node, lib: &mut Library<'_>) -> Option<FrameErrors> {
    Table::read(node, "`errors`", lib, |t, lib| {
        let kind = Kind::read(t, lib);
        let values = read_values(t, Kind::must(kind), lib);
        if kind != Some(Kind::Tolerance) {
            tolerance_file::refuse(t, kind, lib);
            return values.map(FrameErrors::Signed);
        }
        let distributions =
            tolerance_file::read_words(t, "distribution", PER_FRAME, Distribution::Normal, lib);
        let sigmas = tolerance_file::read_sigmas(t, lib);
        let (values, distributions, sigmas) = (values?, distributions?, sigmas?);
        let mut spreads = values.map(Spread::of_magnitude);
        for (spread, distribution) in spreads.iter_mut().zip(distributions) {
            (spread.distribution, spread.sigmas) = (distribution, sigmas);
        }
        Some(FrameErrors::Tolerance(spreads))
    })
}
