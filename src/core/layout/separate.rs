//! Separation: the nearest layout without overlaps, found by a sequence of convex programs.
//!
//! Two rectangles do not overlap if their projections on one axis (separating axis) do not overlap. With that
//! axis fixed, this condition is linear in the shifts of the equipment. The least shift then solves a
//! quadratic program:
//!
//! ```text
//! minimize |d|^2   such that   n_ab . (d_a - d_b) >= depth_ab,   min <= x + d <= max,
//! ```
//!
//! Here x holds the free coordinates, d holds their shifts, and min and max are the ends of their ranges.
//! The shift of body a in plan is d_a. The separating axis of bodies a and b is n_ab, and their overlap
//! along it is depth_ab. The crate `clarabel` solves the program in a few tens of microseconds. In the new
//! layout, other axes may separate the bodies better, so the program is solved a few times. Heights and
//! yaws do not change. Bodies that are apart in height need no separation in plan.

use super::workcell::Workcell;
use crate::cell::{Cell, Coordinate, Layout, Slot};
use crate::clearance::Separation;
use crate::units::m_from_mm;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// Greatest number of quadratic programs solved for one layout.
const MAX_PROGRAMS: usize = 8;
/// Distance added to the clearance, as a multiple of the resolution of placements.
///
/// Rounding of x and y moves each of two bodies by at most half the diagonal of a square. The side of this
/// square is the resolution. A carried body also moves with its carrier.
const SPARE_DISTANCE: f64 = 2.0;

/// Least shift that is applied, m. Smaller shifts are rounding errors of the solver.
const LEAST_SHIFT: f64 = 1e-7;

/// Coordinate x or y of equipment that a search may change.
///
/// The coordinate is given in the frame of the carrier of the equipment, or in the world frame if there is
/// no carrier.
struct FreeCoordinate {
    /// Index of the equipment.
    equipment: usize,
    /// Axis of the coordinate: 0 for x, 1 for y.
    axis: usize,
    min: f64,
    max: f64,
}

impl FreeCoordinate {
    /// Returns the unit vector in plan along which the coordinate moves its equipment, in the world frame.
    fn direction(&self, cell: &Cell, layout: &Layout) -> (f64, f64) {
        let under = cell.equipment[self.equipment].on;
        let (sin, cos) = under.map_or(0.0, |under| layout.placements[under].yaw).sin_cos();
        if self.axis == 0 { (cos, sin) } else { (-sin, cos) }
    }
}

/// Returns a layout that has no overlaps and differs little from `layout`. The new layout is found by solving
/// a few convex optimization problems.
///
/// Returns None if their solutions give no such layout, or if `layout` does not belong to the cell. A layout
/// without overlaps is returned unchanged.
pub fn separated(workcell: &Workcell, layout: &Layout) -> Option<Layout> {
    if workcell.cell.misfit(layout).is_some() {
        return None;
    }
    let free = free_coordinates(workcell);
    let mut moved = layout.clone();
    let mut overlaps = Vec::new();
    let plan = workcell.floor_plan();
    for _ in 0..MAX_PROGRAMS {
        plan.overlaps(&moved, &mut overlaps);
        if overlaps.is_empty() {
            return Some(moved);
        }
        let shift = least_shift(&workcell.cell, &free, &moved, &plan.separations(&moved))?;
        moved = workcell.cell.layout(|slot, _| {
            let value = moved.value(&workcell.cell, slot);
            let shifted = free
                .iter()
                .zip(&shift)
                .find(|(f, d)| slot == Slot::Equipment(f.equipment, f.axis) && d.abs() > LEAST_SHIFT);
            shifted.map_or(value, |(f, d)| (value + d).clamp(f.min, f.max))
        });
    }
    None
}

/// Lists the coordinates x and y of equipment that a search may change.
fn free_coordinates(workcell: &Workcell) -> Vec<FreeCoordinate> {
    let mut free = Vec::new();
    for (equipment, e) in workcell.cell.equipment.iter().enumerate() {
        for (axis, coordinate) in e.placement[..2].iter().enumerate() {
            if let Coordinate::Range { min, max, .. } = *coordinate {
                free.push(FreeCoordinate { equipment, axis, min, max });
            }
        }
    }
    free
}

/// Solves one quadratic program and returns the shifts of the free coordinates, m. Returns None if the solver
/// finds no solution.
fn least_shift(
    cell: &Cell,
    free: &[FreeCoordinate],
    layout: &Layout,
    pairs: &[Separation],
) -> Option<Vec<f64>> {
    let n = free.len();
    let directions: Vec<_> = free.iter().map(|f| f.direction(cell, layout)).collect();
    let spare = SPARE_DISTANCE * m_from_mm(cell.search.resolution.mm);
    // The constraints are rows of A d <= b.
    let (mut rows, mut columns, mut values, mut bounds) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut put = |row: usize, k: usize, value: f64| {
        rows.push(row);
        columns.push(k);
        values.push(value);
    };
    for pair in pairs {
        let row = bounds.len();
        for (k, (f, direction)) in free.iter().zip(&directions).enumerate() {
            let along = pair.direction.0 * direction.0 + pair.direction.1 * direction.1;
            let moves = |equipment| f64::from(u8::from(cell.rides_on(equipment, f.equipment)));
            let apart = moves(pair.a) - pair.b.map_or(0.0, moves);
            if apart != 0.0 && along != 0.0 {
                put(row, k, -along * apart);
            }
        }
        bounds.push(-pair.depth - spare);
    }
    for (k, f) in free.iter().enumerate() {
        let value = cell.own_placement(layout, f.equipment).values()[f.axis];
        put(bounds.len(), k, 1.0);
        bounds.push(f.max - value);
        put(bounds.len(), k, -1.0);
        bounds.push(value - f.min);
    }
    let a = CscMatrix::new_from_triplets(bounds.len(), n, rows, columns, values);
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(bounds.len())];
    let mut solver =
        DefaultSolver::new(&CscMatrix::identity(n), &vec![0.0; n], &a, &bounds, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| solver.solution.x.clone())
}
