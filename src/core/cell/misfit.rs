//! Check that a layout belongs to a cell.

use super::attitude::{Attitude, Azimuth, Spin};
use super::layout::{Layout, Slot};
use super::model::{Cell, Operation};
use crate::safe_text::shown;

/// Greatest absolute value of a coordinate (m) or an angle (rad) of a layout.
///
/// Sums and products of such numbers stay finite.
pub const MAX_COORDINATE: f64 = 1e6;

/// Reason why a layout does not belong to a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Misfit {
    /// The number of placements in the layout (`given`) differs from the number of pieces of equipment in the
    /// cell (`needed`).
    Placements { given: usize, needed: usize },
    /// The number of attitudes in the layout (`given`) differs from the number of operations in the cell
    /// (`needed`).
    Attitudes { given: usize, needed: usize },
    /// A world coordinate of a placement or an angle of an attitude is NaN, or its absolute value exceeds
    /// [`MAX_COORDINATE`].
    Coordinate(Slot),
    /// The attitude of the operation with this index does not fit the cell, for one of two reasons:
    ///
    /// - a fixed angle or the tolerance differs from that of the operation in the cell;
    /// - an angle that a search may change does not have exactly one value.
    Attitude(usize),
}

impl Misfit {
    /// Describes the reason in words, with the names that the cell gives to equipment and operations.
    pub fn in_words(&self, cell: &Cell) -> String {
        let axis = |k: usize| ["x", "y", "z", "yaw"].get(k).copied().unwrap_or("coordinate");
        let angle = |k: usize| ["bend", "azimuth", "spin"].get(k).copied().unwrap_or("angle");
        match *self {
            Self::Placements { given, needed } => {
                format!("the layout has {given} placements, but the cell has {needed} pieces of equipment")
            }
            Self::Attitudes { given, needed } => {
                format!("the layout has {given} attitudes, but the cell has {needed} operations")
            }
            Self::Coordinate(slot) => {
                let whose = match slot {
                    Slot::Base(k) => format!("{} of the robot base", axis(k)),
                    Slot::Equipment(k, a) => format!("{} of {}", axis(a), shown(&cell.equipment[k].name)),
                    Slot::Attitude(k, a) => {
                        format!("{} of operation {}", angle(a), shown(&cell.operations[k].name))
                    }
                };
                format!("{whose} is not a number between -{MAX_COORDINATE} and {MAX_COORDINATE} (m or rad)")
            }
            Self::Attitude(k) => {
                let name = shown(&cell.operations[k].name);
                format!("the attitude of operation {name} in the layout does not fit the cell")
            }
        }
    }
}

impl Cell {
    /// Returns the reason why a layout does not belong to this cell; None if the layout belongs to it.
    pub fn misfit(&self, layout: &Layout) -> Option<Misfit> {
        let (given, needed) = (layout.placements.len(), self.equipment.len());
        if given != needed {
            return Some(Misfit::Placements { given, needed });
        }
        let (given, needed) = (layout.attitudes.len(), self.operations.len());
        if given != needed {
            return Some(Misfit::Attitudes { given, needed });
        }
        let base = (0..4).map(|axis| (Slot::Base(axis), layout.base.values()[axis]));
        let placed = layout.placements.iter().enumerate();
        let placed =
            placed.flat_map(|(k, at)| (0..4).map(move |axis| (Slot::Equipment(k, axis), at.values()[axis])));
        let angles = layout.attitudes.iter().enumerate();
        let angles =
            angles.flat_map(|(k, attitude)| angles_of(attitude).map(move |(a, v)| (Slot::Attitude(k, a), v)));
        let is_beyond = |value: f64| value.is_nan() || value.abs() > MAX_COORDINATE;
        if let Some((slot, _)) = base.chain(placed).chain(angles).find(|(_, value)| is_beyond(*value)) {
            return Some(Misfit::Coordinate(slot));
        }
        let mut asked = self.operations.iter().zip(&layout.attitudes);
        asked.position(|(operation, attitude)| !allows(operation, attitude)).map(Misfit::Attitude)
    }
}

/// Returns every angle that an attitude states, rad, each with its index: 0 elevation, 1 azimuth, 2 spin.
///
/// A list of allowed spins gives several angles with index 2.
fn angles_of(attitude: &Attitude) -> impl Iterator<Item = (usize, f64)> {
    let azimuth = if let Azimuth::Surface(angle) = attitude.azimuth { Some((1, angle)) } else { None };
    let spins = if let Spin::At(spins) = &attitude.spin { &spins[..] } else { &[] };
    [(0, attitude.elevation)].into_iter().chain(azimuth).chain(spins.iter().map(|spin| (2, *spin)))
}

/// Returns whether an attitude equals the attitude of an operation, except for the angles that a search may
/// change.
fn allows(operation: &Operation, given: &Attitude) -> bool {
    let (asked, [elevation, azimuth, spin]) =
        (&operation.attitude, operation.angles.each_ref().map(Option::is_some));
    let elevation = elevation || given.elevation == asked.elevation;
    let azimuth =
        if azimuth { matches!(given.azimuth, Azimuth::Surface(_)) } else { given.azimuth == asked.azimuth };
    let spin = match &given.spin {
        Spin::At(spins) if spin => spins.len() == 1,
        other => !spin && *other == asked.spin,
    };
    elevation && azimuth && spin && given.tolerance == asked.tolerance
}
