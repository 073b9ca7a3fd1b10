//! Floor spaces of the equipment in plan.

use crate::cell::{Placement, Rectangle};
use crate::geometry::PlanePoint;

/// Returns the corners (x, y) of a floor space in the world frame, m. The corners run anticlockwise, and `at`
/// is the placement of the frame of the floor space.
pub fn floor_corners(rectangle: &Rectangle, at: &Placement) -> [PlanePoint; 4] {
    let (sin, cos) = at.yaw.sin_cos();
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(u, v)| {
        let (x, y) = (rectangle.centre.0 + u * rectangle.size.0, rectangle.centre.1 + v * rectangle.size.1);
        (at.x + cos * x - sin * y, at.y + sin * x + cos * y)
    })
}
