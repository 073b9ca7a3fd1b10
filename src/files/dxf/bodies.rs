//! Bodies of a plan: upright boxes, cylinders and prisms over the outlines of the plan. Each body states the
//! rectangle of least area around itself.

use super::DxfFault;
use super::convex::convex_parts;
use super::outlines::{FloorOutline, OutlineShape};
use crate::cell::{Placement, Shape};
use crate::files::fault::shown;
use crate::geometry::{PlanePoint, convex_hull, polygon_area};
use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Largest number of bodies of a plan. Every posture is checked against each body, so the number is limited.
const MAX_BODIES: usize = 500;

/// Largest distance, m, of a corner from the box that replaces a rectangular outline.
const BOX_ROUNDING: f64 = 1e-6;

/// Convex body over an outline, or over a part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanBody {
    /// Layer, number of the outline on its layer and, if the outline has several parts, number of the
    /// part.
    pub name: String,
    /// Placement of the body frame in the frame of the drawing, m. The origin of the body frame is the centre
    /// of the rectangle around the body.
    pub placement: Placement,
    /// Sides of the rectangle around the body, along the axes of its frame, m.
    pub size: (f64, f64),
    /// Shape in the body frame, from z = 0 up to the height of the plan.
    pub shape: Shape,
}

/// Returns the bodies of the outlines. An outline that is not convex is divided into convex parts.
///
/// # Errors
/// Fails if there are too many bodies, or if an outline cannot be divided into convex parts.
pub fn bodies(outlines: &[FloorOutline], height: f64) -> Result<Vec<PlanBody>, DxfFault> {
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let mut all = Vec::new();
    for outline in outlines {
        let number = numbers.entry(&outline.layer).or_default();
        *number += 1;
        let name = format!("{} {number}", shown(&outline.layer));
        match &outline.shape {
            OutlineShape::Circle { centre, radius } => all.push(cylinder(name, *centre, *radius, height)),
            OutlineShape::Polygon(corners) => {
                let parts = convex_parts(corners).ok_or_else(|| {
                    let message = format!(
                        "layer `{}`: an outline cannot be divided into convex parts",
                        shown(&outline.layer)
                    );
                    DxfFault::new(
                        outline.line,
                        message,
                        "simplify the outline: some of its corners almost coincide",
                    )
                })?;
                let count = parts.len();
                let named =
                    |k: usize| if count == 1 { name.clone() } else { format!("{name} part {}", k + 1) };
                all.extend(parts.iter().enumerate().map(|(k, part)| upright(named(k), part, height)));
            }
        }
        if all.len() > MAX_BODIES {
            let message = format!("the outlines have more than {MAX_BODIES} convex parts");
            return Err(DxfFault::new(outline.line, message, "raise `tolerance_mm`, or name fewer layers"));
        }
    }
    Ok(all)
}

fn cylinder(name: String, (x, y): PlanePoint, radius: f64, height: f64) -> PlanBody {
    let shape = Shape::Cylinder { a: Vector3::zeros(), b: Vector3::new(0.0, 0.0, height), radius };
    let placement = Placement { x, y, z: 0.0, yaw: 0.0 };
    PlanBody { name, placement, size: (2.0 * radius, 2.0 * radius), shape }
}

/// Returns the prism over a convex polygon; a box if the polygon is a rectangle.
fn upright(name: String, corners: &[PlanePoint], height: f64) -> PlanBody {
    let (placement, size) = least_rectangle(corners);
    let spare = size.0 * size.1 - polygon_area(corners);
    let shape = if corners.len() == 4 && spare <= BOX_ROUNDING * (size.0 + size.1) {
        let pose = Pose { translation: Vector3::new(0.0, 0.0, height / 2.0), ..Pose::IDENTITY };
        Shape::Box { pose, size: Vector3::new(size.0, size.1, height) }
    } else {
        let (s, c) = placement.yaw.sin_cos();
        let own = |&(x, y): &PlanePoint| {
            let (dx, dy) = (x - placement.x, y - placement.y);
            (c * dx + s * dy, c * dy - s * dx)
        };
        prism(&corners.iter().map(own).collect::<Vec<_>>(), height)
    };
    PlanBody { name, placement, size, shape }
}

/// Returns the closed mesh of a prism over a convex polygon, whose corners run anticlockwise.
fn prism(corners: &[PlanePoint], height: f64) -> Shape {
    let n = corners.len() as u32;
    let at = |z: f64| corners.iter().map(move |(x, y)| Vector3::new(*x, *y, z));
    let ends = (1..n - 1).flat_map(|k| [[0, k + 1, k], [n, n + k, n + k + 1]]);
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, n + next], [k, n + next, n + k]]
    });
    Shape::Mesh {
        pose: Pose::IDENTITY,
        vertices: at(0.0).chain(at(height)).collect(),
        triangles: ends.chain(sides).collect(),
        closed: true,
    }
}

/// Returns the rectangle of least area around points: its centre and yaw, and its sides, m.
///
/// One side of the rectangle lies on an edge of the convex hull (H. Freeman and R. Shapira, CACM 18 (1975)
/// 409-413).
fn least_rectangle(points: &[PlanePoint]) -> (Placement, (f64, f64)) {
    let hull = convex_hull(points.to_vec());
    let along = |k: usize| {
        let (a, b) = (hull[k], hull[(k + 1) % hull.len()]);
        let yaw = (b.1 - a.1).atan2(b.0 - a.0);
        let (s, c) = yaw.sin_cos();
        let range = |f: &dyn Fn(&PlanePoint) -> f64| {
            let values = hull.iter().map(f);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
        };
        let u = range(&|p| c * p.0 + s * p.1);
        let v = range(&|p| c * p.1 - s * p.0);
        let (x, y) = ((u.0 + u.1) / 2.0, (v.0 + v.1) / 2.0);
        let placement = Placement { x: c * x - s * y, y: s * x + c * y, z: 0.0, yaw };
        (placement, (u.1 - u.0, v.1 - v.0))
    };
    let area = |size: (f64, f64)| size.0 * size.1;
    let all = (0..hull.len()).map(along);
    let start = (Placement { x: 0.0, y: 0.0, z: 0.0, yaw: 0.0 }, (f64::INFINITY, f64::INFINITY));
    all.fold(start, |best, next| if area(next.1) < area(best.1) { next } else { best })
}
