//! Placements of a piece that a user moves by hand: every placement at which the layout is usable.
//!
//! Unlike in a region, spots and branches are chosen anew at each placement, and the objective does not
//! count.

use super::RegionEffort;
use super::outline::{Domain, Inside, TwoLattices};
use crate::cell::{Cell, Coordinate, Layout, Slot};
use crate::geometry::PlanePoint;
use crate::layout::{Workcell, Workspace, evaluate_in};
use crate::units::m_from_mm;

/// Largest displacement that is examined along x or y if this coordinate has no range in the cell file, mm.
const WINDOW_MM: f64 = 1000.0;
/// Number of spacings of the lattice along the longer side of the domain. [`REFINED`] multiplies this number
/// for a refined outline.
const DIVISIONS: f64 = 40.0;
/// Number of spacings of the lattice if the check of a placement takes milliseconds.
const DIVISIONS_OF_DEAR: f64 = 12.0;
/// Factor by which a refined outline divides the spacing of the lattice.
const REFINED: i32 = 4;

/// One piece of a layout that is moved in plan.
struct MovedPiece<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    equipment: usize,
    /// Position in plan, m, in the frame in which the cell file states the placement.
    own: PlanePoint,
}

/// Returns the region in which the frame origin of a piece of equipment may be placed, world frame, m.
///
/// The region is given by closed rings; a point is inside if it lies in an odd number of rings. Height and
/// yaw do not change. If `is_refined` is true, the outline is finer, but its computation takes longer.
pub fn standing(
    workcell: &Workcell,
    layout: &Layout,
    equipment: usize,
    is_refined: bool,
) -> Vec<Vec<PlanePoint>> {
    let cell = &workcell.cell;
    let at = cell.own_placement(layout, equipment);
    let piece = MovedPiece { workcell, layout, equipment, own: (at.x, at.y) };
    let domain = Domain { x: domain(cell, equipment, 0, at.x), y: domain(cell, equipment, 1, at.y) };
    let longer = (domain.x.1 - domain.x.0).max(domain.y.1 - domain.y.0);
    let is_dear = RegionEffort::of(workcell).is_dear();
    let step = longer / if is_dear { DIVISIONS_OF_DEAR } else { DIVISIONS };
    let (step, coarse) = if is_refined { (step / f64::from(REFINED), REFINED) } else { (step, 1) };
    let rings = TwoLattices { domain, origin: piece.own, step, coarse }.trace(&piece);
    let under = cell.equipment[equipment].on.map(|under| layout.placements[under]);
    let in_world = |p: &PlanePoint| {
        let own = crate::cell::Placement { x: p.0, y: p.1, ..at };
        let placed = under.map_or(own, |under| under.carrying(&own));
        (placed.x, placed.y)
    };
    rings.iter().map(|ring| ring.iter().map(in_world).collect()).collect()
}

fn domain(cell: &Cell, equipment: usize, axis: usize, at: f64) -> (f64, f64) {
    match cell.equipment[equipment].placement[axis] {
        Coordinate::Range { min, max, .. } => (min, max),
        _ => (at - m_from_mm(WINDOW_MM), at + m_from_mm(WINDOW_MM)),
    }
}

impl Inside for MovedPiece<'_> {
    type Memory = Workspace;

    fn inside(&self, (x, y): PlanePoint, memory: &mut Workspace) -> bool {
        let slot = |axis| Slot::Equipment(self.equipment, axis);
        let moves = [(slot(0), x - self.own.0), (slot(1), y - self.own.1)];
        let layout = self.workcell.cell.misplaced(self.layout, &moves);
        evaluate_in(self.workcell, &layout, memory).is_accepted()
    }
}
