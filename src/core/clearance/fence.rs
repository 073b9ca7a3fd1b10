//! Fence: a simple polygon that encloses equipment and robot base, with walls on its edges.

use super::bodies::{EquipmentSolid, part};
use crate::cell::{Cell, Fence, Shape};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Thickness of a wall, m. The wall stands outside the line of the fence.
const WALL_THICKNESS: f64 = 0.01;

/// Returns the walls of the fence in the world frame; empty for a fence without a height.
pub(super) fn walls(cell: &Cell) -> Vec<EquipmentSolid> {
    let Some(Fence { corners, height: Some(height) }) = &cell.fence else { return Vec::new() };
    let n = corners.len();
    let wall = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        let (x, y) = (b.0 - a.0, b.1 - a.1);
        let (length, yaw) = (x.hypot(y), y.atan2(x));
        // The corners run anticlockwise, so the outside is on the right.
        let out = (y / length * WALL_THICKNESS / 2.0, -x / length * WALL_THICKNESS / 2.0);
        let middle = ((a.0 + b.0) / 2.0 + out.0, (a.1 + b.1) / 2.0 + out.1);
        let centre = Vector3::new(middle.0, middle.1, cell.floor + height / 2.0);
        part(&Shape::Box {
            pose: Pose::from_translation_yaw(centre, yaw),
            size: Vector3::new(length, WALL_THICKNESS, *height),
        })
    };
    (0..n).map(wall).collect()
}

/// Returns whether a point lies in the polygon, and its distance from the boundary (m).
pub(super) fn locate(corners: &[(f64, f64)], (x, y): (f64, f64)) -> (bool, f64) {
    let n = corners.len();
    let (mut inside, mut nearest) = (false, f64::INFINITY);
    for k in 0..n {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        // A ray along x from an inner point crosses the edges an odd number of times.
        if (a.1 > y) != (b.1 > y) && x < a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1) {
            inside = !inside;
        }
        let (u, v) = ((b.0 - a.0, b.1 - a.1), (x - a.0, y - a.1));
        let s = ((u.0 * v.0 + u.1 * v.1) / (u.0 * u.0 + u.1 * u.1)).clamp(0.0, 1.0);
        nearest = nearest.min((v.0 - s * u.0).hypot(v.1 - s * u.1));
    }
    (inside, nearest)
}

/// Returns whether the polygon is convex: the boundary turns left at every corner.
pub(super) fn is_convex(corners: &[(f64, f64)]) -> bool {
    let n = corners.len();
    (0..n).all(|k| {
        let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % n]);
        (b.0 - a.0) * (c.1 - b.1) - (b.1 - a.1) * (c.0 - b.0) >= 0.0
    })
}
