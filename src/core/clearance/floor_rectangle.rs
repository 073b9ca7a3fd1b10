//! Rectangles on the floor, and the depth of their overlap (separating axis theorem).

use crate::cell::{KeepOut, Placement, Rectangle};
use crate::geometry::PlanePoint;

/// Rectangle in plan, world frame; lengths in m.
#[derive(Clone, Copy)]
pub(super) struct PlacedRectangle {
    pub(super) centre: PlanePoint,
    /// Half lengths of the sides.
    pub(super) half: PlanePoint,
    /// Cosine of the yaw of the first side; `sin` is the sine.
    pub(super) cos: f64,
    pub(super) sin: f64,
}

/// Unit direction in plan, and the depth (m) by which two shapes overlap along this direction.
#[derive(Clone, Copy)]
pub(super) struct AxisDepth {
    pub(super) direction: PlanePoint,
    pub(super) depth: f64,
}

impl PlacedRectangle {
    pub(super) fn new(rectangle: &Rectangle, at: &Placement) -> Self {
        let (sin, cos) = at.yaw.sin_cos();
        let (x, y) = rectangle.centre;
        Self {
            centre: (at.x + cos * x - sin * y, at.y + sin * x + cos * y),
            half: (rectangle.size.0 / 2.0, rectangle.size.1 / 2.0),
            cos,
            sin,
        }
    }

    /// Returns the rectangle that a keep-out box covers in plan.
    pub(super) fn of_keep_out(keep_out: &KeepOut) -> Self {
        let (lo, hi) = (keep_out.min, keep_out.max);
        Self {
            centre: ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0),
            half: ((hi.x - lo.x) / 2.0, (hi.y - lo.y) / 2.0),
            cos: 1.0,
            sin: 0.0,
        }
    }

    /// Returns the corners of the rectangle, anticlockwise.
    pub(super) fn corners(&self) -> [PlanePoint; 4] {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(i, j)| {
            let (x, y) = (i * self.half.0, j * self.half.1);
            (self.centre.0 + self.cos * x - self.sin * y, self.centre.1 + self.sin * x + self.cos * y)
        })
    }

    /// Returns half the length (m) of the projection of the rectangle on a unit direction.
    pub(super) fn half_width(&self, (ux, uy): PlanePoint) -> f64 {
        self.half.0 * (self.cos * ux + self.sin * uy).abs()
            + self.half.1 * (self.cos * uy - self.sin * ux).abs()
    }
}

/// Returns the candidate separating axes of two rectangles: the directions of their sides.
fn axes(a: &PlacedRectangle, b: &PlacedRectangle) -> [PlanePoint; 4] {
    [(a.cos, a.sin), (-a.sin, a.cos), (b.cos, b.sin), (-b.sin, b.cos)]
}

/// Returns the overlap along the unit direction `u`, increased by the required `clearance`.
///
/// The returned direction is `u` or `-u`, whichever points from `b` to `a`.
fn overlap_along(u: PlanePoint, a: &PlacedRectangle, b: &PlacedRectangle, clearance: f64) -> AxisDepth {
    let apart = (a.centre.0 - b.centre.0) * u.0 + (a.centre.1 - b.centre.1) * u.1;
    let direction = if apart < 0.0 { (-u.0, -u.1) } else { u };
    AxisDepth { direction, depth: a.half_width(u) + b.half_width(u) + clearance - apart.abs() }
}

/// Returns the least overlap over the separating axes, directed from `b` to `a`.
///
/// A negative depth means that the rectangles keep the clearance. If `a` moves by `depth` along `direction`,
/// at least the clearance is left between them. The distance then exceeds the clearance slightly if the
/// nearest points are two corners.
pub(super) fn least_overlap(a: &PlacedRectangle, b: &PlacedRectangle, clearance: f64) -> AxisDepth {
    let shallower = |best: AxisDepth, next: AxisDepth| if next.depth < best.depth { next } else { best };
    let all = axes(a, b).into_iter().map(|u| overlap_along(u, a, b, clearance));
    all.fold(AxisDepth { direction: (1.0, 0.0), depth: f64::INFINITY }, shallower)
}

/// Returns how far two rectangles must move apart (m) to keep `clearance`; 0 if they already keep it.
pub(super) fn overlap_depth(a: &PlacedRectangle, b: &PlacedRectangle, clearance: f64) -> f64 {
    let mut least = f64::INFINITY;
    for u in axes(a, b) {
        least = least.min(overlap_along(u, a, b, clearance).depth);
        if least <= 0.0 {
            return 0.0;
        }
    }
    least
}
