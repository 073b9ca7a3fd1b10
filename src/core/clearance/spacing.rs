//! Distances between floor spaces, and the area of their convex hull.

use super::fence;
use super::floor_plan::FloorPlan;
use super::floor_rectangle::{PlacedRectangle, overlap_depth};
use crate::cell::{Cell, Coordinate, Layout, Role};
use crate::geometry::{PlanePoint, convex_hull, polygon_area};

impl FloorPlan {
    /// Returns the least distance between floor spaces that must not overlap. If this distance exceeds `max`
    /// (m), the result is `max`.
    ///
    /// Each distance is the root sum square of the distance in plan and the vertical distance. The result is
    /// 0 if any two of these floor spaces overlap. Pairs in which the search can move neither object are left
    /// out, because their distance is the same in every layout.
    pub fn spacing(&self, cell: &Cell, layout: &Layout, max: f64) -> f64 {
        if !self.enabled {
            return max;
        }
        let moves: Vec<bool> = (0..cell.equipment.len()).map(|k| is_moved(cell, k)).collect();
        let base_moves = cell.base.iter().any(Coordinate::is_free);
        let base = PlacedRectangle::new(&cell.robot.footprint, &layout.base);
        let at = |k: usize| (k, &layout.placements[k]);
        let all = |k: usize| PlacedRectangle::new(&cell.equipment[k].footprint, &layout.placements[k]);
        let mut least = max;
        let mut note = |in_plan: f64, rise: f64| least = least.min(in_plan.hypot(rise.max(0.0)));
        for i in 0..moves.len() {
            let here = all(i);
            for j in i + 1..moves.len() {
                let tied = cell.rides_on(i, j) || cell.rides_on(j, i);
                if (moves[i] || moves[j]) && !tied {
                    note(apart(&here, &all(j)), self.rise(at(i), at(j)));
                }
            }
            if moves[i] || base_moves {
                note(apart(&here, &base), self.rise_from_base(i, at(i).1, &layout.base));
            }
            if moves[i] {
                for (there, heights) in &self.keep_out {
                    note(apart(&here, there), self.rise_from(i, at(i).1, *heights));
                }
                note(within(cell, &here, max), 0.0);
            }
        }
        if base_moves {
            note(within(cell, &base, max), 0.0);
        }
        least
    }
}

/// Returns whether the search may move a piece of equipment, directly or with equipment that carries it.
fn is_moved(cell: &Cell, k: usize) -> bool {
    let below = cell.equipment.iter().enumerate().filter(|(under, _)| cell.rides_on(k, *under));
    below.flat_map(|(_, e)| &e.placement).any(Coordinate::is_free)
}

/// Returns the distance between two rectangles in plan, m.
fn apart(a: &PlacedRectangle, b: &PlacedRectangle) -> f64 {
    if overlap_depth(a, b, 0.0) > 0.0 {
        return 0.0;
    }
    let (a, b) = (a.corners(), b.corners());
    boundaries_apart(&a, &b)
}

/// Returns the distance of a floor space from the fence around it, m; `max` without a fence.
///
/// The distance is 0 if a part of the floor space is outside.
fn within(cell: &Cell, stand: &PlacedRectangle, max: f64) -> f64 {
    let Some(fence) = &cell.fence else { return max };
    let corners = stand.corners();
    let is_in = |polygon: &[PlanePoint], point: &PlanePoint| fence::locate(polygon, *point).0;
    let inside = corners.iter().all(|corner| is_in(&fence.corners, corner));
    // A corner of a fence that is not convex may cut into the floor space.
    let cut = fence.corners.iter().any(|corner| is_in(&corners, corner));
    if inside && !cut { boundaries_apart(&corners, &fence.corners) } else { 0.0 }
}

/// Returns the distance between the boundaries of two polygons, m; the boundaries must not cross.
///
/// One of the two nearest points is a corner of a polygon.
fn boundaries_apart(a: &[PlanePoint], b: &[PlanePoint]) -> f64 {
    let from = |points: &[PlanePoint], polygon: &[PlanePoint]| {
        points.iter().map(|p| fence::locate(polygon, *p).1).fold(f64::INFINITY, f64::min)
    };
    from(a, b).min(from(b, a))
}

/// Returns the area in plan, m^2, of the convex hull of robot base and equipment. Obstacles are left out.
pub fn footprint(cell: &Cell, layout: &Layout) -> f64 {
    let placed = cell.equipment.iter().zip(&layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    let equipment = placed.map(|(e, at)| PlacedRectangle::new(&e.footprint, at));
    let base = PlacedRectangle::new(&cell.robot.footprint, &layout.base);
    let corners: Vec<PlanePoint> = equipment.chain([base]).flat_map(|p| p.corners()).collect();
    polygon_area(&convex_hull(corners))
}
