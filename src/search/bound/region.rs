//! What is left of an operation when it chooses its spot alone: how high, how steep, how far out.

use crate::cell::{Attitude, Cell, Coordinate, Rectangle};
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// Far above what inverse kinematics may be off (m, rad), far below what matters.
const SLACK: f64 = 1e-6;

/// Where the TCP of one operation may be in any layout. Azimuth and spin are left free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    pub operation: usize,
    /// TCP above the robot base, m.
    pub height: (f64, f64),
    /// Elevation of the tool axis, rad; None if the arm keeps it by its build.
    pub elevation: Option<(f64, f64)>,
    /// Distance from the z axis of the robot base, m; None if the layout does not limit it.
    pub radius: Option<(f64, f64)>,
}

impl Region {
    /// The region of an operation in every layout of a cell. `kept`: the elevation that the arm keeps.
    pub fn new(cell: &Cell, operation: usize, kept: Option<f64>) -> Self {
        let asked = &cell.operations[operation];
        let equipment = &cell.equipment[asked.equipment];
        let [x, y, z, _] = equipment.placement.map(range);
        let above = asked.standoff - cell.base.z;
        let radius = equipment.surface.as_ref().map(|surface| {
            distances(surface, (x.0 - cell.base.x, x.1 - cell.base.x), (y.0 - cell.base.y, y.1 - cell.base.y))
        });
        Self {
            operation,
            height: (z.0 + above - SLACK, z.1 + above + SLACK),
            elevation: kept.is_none().then(|| elevations(&asked.attitude)),
            radius,
        }
    }

    /// What the height, the radius and the tool axis must keep.
    pub(super) fn constraints(&self) -> Vec<Constraint> {
        let mut all = vec![Constraint { of: Quantity::Height, low: self.height.0, high: self.height.1 }];
        if let Some((low, high)) = self.elevation {
            // Near the vertical the height of the axis says nothing to first order.
            let flat = low.cos().max(high.cos());
            if low <= -FRAC_PI_2 + SLACK || high >= FRAC_PI_2 - SLACK {
                let flat = if low <= 0.0 && high >= 0.0 { 1.0 } else { flat } + SLACK;
                all.extend([0, 1].map(|k| Constraint { of: Quantity::Axis(k), low: -flat, high: flat }));
            }
            let (low, high) = (low.sin() - SLACK, high.sin() + SLACK);
            all.push(Constraint { of: Quantity::Axis(2), low, high });
        }
        if let Some((low, high)) = self.radius {
            // On the axis the square is flat: what is no limit must not look like one.
            let low = if low > 0.0 { low * low } else { -high * high };
            all.push(Constraint { of: Quantity::RadiusSquared, low, high: high * high });
        }
        all
    }
}

/// What a constraint looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Quantity {
    /// Of the TCP above the base, m.
    Height,
    /// A component of the tool axis.
    Axis(usize),
    /// Of the TCP from the z axis of the base, m^2.
    RadiusSquared,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Constraint {
    pub of: Quantity,
    pub low: f64,
    pub high: f64,
}

impl Constraint {
    pub fn value(&self, tip: &Vector3<f64>, tool: &Vector3<f64>) -> f64 {
        match self.of {
            Quantity::Height => tip.z,
            Quantity::Axis(k) => tool[k],
            Quantity::RadiusSquared => tip.xy().norm_squared(),
        }
    }
}

fn range(coordinate: Coordinate) -> (f64, f64) {
    match coordinate {
        Coordinate::Fixed(value) => (value, value),
        Coordinate::Range { min, max, .. } => (min, max),
    }
}

/// Every tilt within the tolerance counts.
fn elevations(attitude: &Attitude) -> (f64, f64) {
    let by = attitude.tolerance + SLACK;
    let around = |e: f64| e.clamp(-FRAC_PI_2, FRAC_PI_2);
    (around(attitude.elevation - by), around(attitude.elevation + by))
}

/// Nearest and farthest that a point of a surface can be from the base axis, whatever its yaw; the
/// surface's frame lies in a rectangle.
fn distances(surface: &Rectangle, x: (f64, f64), y: (f64, f64)) -> (f64, f64) {
    let corner = |centre: f64, size: f64| centre.abs() + size / 2.0;
    let around = corner(surface.centre.0, surface.size.0).hypot(corner(surface.centre.1, surface.size.1));
    let near = x.0.max(-x.1).max(0.0).hypot(y.0.max(-y.1).max(0.0));
    let far = x.0.abs().max(x.1.abs()).hypot(y.0.abs().max(y.1.abs()));
    ((near - around - SLACK).max(0.0), far + around + SLACK)
}
