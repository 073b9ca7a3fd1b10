//! The nearest layout without overlaps: a convex program, solved again while its axes turn.
//!
//! Two rectangles are apart if they are apart along one axis. With that axis held, "apart" is linear
//! in the shifts of the equipment, and the least shift is a quadratic program,
//!
//! ```text
//! minimize |d|^2   such that   n_ab . (d_a - d_b) >= depth_ab,   min <= x + d <= max,
//! ```
//!
//! which clarabel solves in some tens of microseconds. The new layout has new best axes, so it is
//! repeated a few times. Heights and yaws are left alone.

use super::Workcell;
use crate::cell::{Coordinate, Layout};
use crate::clearance::Separation;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// Programs solved at most.
const ROUNDS: usize = 8;
/// Distance kept beyond what is asked, m: more than placements are rounded by.
const SPARE: f64 = 2e-6;

/// Shifts below this are the solver's rounding, m.
const STILL: f64 = 1e-7;

/// One coordinate that may move: equipment, 0 for x or 1 for y, range.
struct Free {
    equipment: usize,
    axis: usize,
    min: f64,
    max: f64,
}

/// The layout without overlaps that is nearest to `layout`, as far as a few convex programs find it;
/// None if they do not. A layout without overlaps is its own answer.
pub fn separated(workcell: &Workcell, layout: &Layout) -> Option<Layout> {
    let free = free_coordinates(workcell);
    let mut moved = layout.clone();
    let mut overlaps = Vec::new();
    for _ in 0..ROUNDS {
        workcell.plan.overlaps(&moved, &mut overlaps);
        if overlaps.is_empty() {
            return Some(moved);
        }
        let shift = least_shift(&free, &moved, &workcell.plan.separations(&moved))?;
        for (coordinate, d) in free.iter().zip(shift).filter(|(_, d)| d.abs() > STILL) {
            let placement = &mut moved.placements[coordinate.equipment];
            let value = if coordinate.axis == 0 { &mut placement.x } else { &mut placement.y };
            *value = (*value + d).clamp(coordinate.min, coordinate.max);
        }
    }
    None
}

fn free_coordinates(workcell: &Workcell) -> Vec<Free> {
    let mut free = Vec::new();
    for (equipment, e) in workcell.cell.equipment.iter().enumerate() {
        for (axis, coordinate) in e.placement[..2].iter().enumerate() {
            if let Coordinate::Range { min, max, .. } = *coordinate {
                free.push(Free { equipment, axis, min, max });
            }
        }
    }
    free
}

/// The quadratic program of one round: shifts of the free coordinates, m.
fn least_shift(free: &[Free], layout: &Layout, pairs: &[Separation]) -> Option<Vec<f64>> {
    let n = free.len();
    let column = |equipment, axis| free.iter().position(|f| (f.equipment, f.axis) == (equipment, axis));
    // Rows of A d <= b.
    let (mut rows, mut columns, mut values, mut bounds) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut put = |row: usize, k: usize, value: f64| {
        rows.push(row);
        columns.push(k);
        values.push(value);
    };
    for pair in pairs {
        let row = bounds.len();
        for (axis, n) in [(0, pair.direction.0), (1, pair.direction.1)] {
            column(pair.a, axis).into_iter().for_each(|k| put(row, k, -n));
            pair.b.and_then(|b| column(b, axis)).into_iter().for_each(|k| put(row, k, n));
        }
        bounds.push(-pair.depth - SPARE);
    }
    for (k, f) in free.iter().enumerate() {
        let at = &layout.placements[f.equipment];
        let value = if f.axis == 0 { at.x } else { at.y };
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
