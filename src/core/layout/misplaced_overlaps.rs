//! Overlaps of floor spaces that occur if equipment is misplaced.

use super::misplacement::{Moves, overlapping_moves};
use super::workcell::Workcell;
use crate::cell::Layout;
use crate::clearance::{Overlap, Party};

/// Returns the greatest sum of overlap depths, m, that any checked misplacement of a layout causes.
///
/// Overlaps with the floor do not count: if equipment stands lower than drawn, the floor under it is lower,
/// too.
///
/// `found` is memory that the function overwrites.
pub fn overlap_depth(workcell: &Workcell, layout: &Layout, found: &mut Vec<Overlap>) -> f64 {
    if let Some(wide) = &workcell.wide {
        wide.overlaps(layout, found);
        if !found.iter().any(is_between_solids) {
            return 0.0;
        }
    }
    let depth = |moves: &Moves| {
        workcell.plan.overlaps(&workcell.cell.misplaced(layout, moves), found);
        found.iter().filter(|o| is_between_solids(o)).map(|o| o.depth).sum::<f64>()
    };
    overlapping_moves(&workcell.cell).iter().map(depth).fold(0.0, f64::max)
}

/// Returns whether neither party of an overlap is the floor.
pub fn is_between_solids(overlap: &Overlap) -> bool {
    ![overlap.a, overlap.b].contains(&Party::Floor)
}
