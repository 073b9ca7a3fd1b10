//! Floor space in plan: which equipment stands in another, in the robot's base or where it may not.

use crate::cell::{Cell, Layout, Placement, Rectangle, Role, extent};

/// Who takes part in an overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Party {
    /// Index into [`Cell::equipment`].
    Equipment(usize),
    RobotBase,
    /// Index into [`Cell::keep_out`].
    KeepOut(usize),
    Floor,
}

/// Two parties share floor space; pulling them apart takes `depth` (m), clearance included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    pub a: Party,
    pub b: Party,
    pub depth: f64,
}

/// A rectangle placed in plan: centre, half size, directions of its sides.
#[derive(Clone, Copy)]
struct Placed {
    centre: (f64, f64),
    half: (f64, f64),
    cos: f64,
    sin: f64,
}

impl Placed {
    fn new(rectangle: &Rectangle, at: &Placement) -> Self {
        let (sin, cos) = at.yaw.sin_cos();
        let (x, y) = rectangle.centre;
        Self {
            centre: (at.x + cos * x - sin * y, at.y + sin * x + cos * y),
            half: (rectangle.size.0 / 2.0, rectangle.size.1 / 2.0),
            cos,
            sin,
        }
    }

    /// Half the width of the shadow on the unit direction (ux, uy).
    fn shadow(&self, (ux, uy): (f64, f64)) -> f64 {
        self.half.0 * (self.cos * ux + self.sin * uy).abs()
            + self.half.1 * (self.cos * uy - self.sin * ux).abs()
    }
}

/// Separating axes of two rectangles: how deep they overlap when each keeps `clearance`, or 0.
/// At corners this asks for a little more than the clearance, never for less.
fn depth(a: &Placed, b: &Placed, clearance: f64) -> f64 {
    let (dx, dy) = (b.centre.0 - a.centre.0, b.centre.1 - a.centre.1);
    let axes = [(a.cos, a.sin), (-a.sin, a.cos), (b.cos, b.sin), (-b.sin, b.cos)];
    let along = |u: (f64, f64)| a.shadow(u) + b.shadow(u) + clearance - (dx * u.0 + dy * u.1).abs();
    axes.into_iter().map(along).fold(f64::INFINITY, f64::min).max(0.0)
}

/// All overlaps of a layout, in the order equipment, robot base, keep-out boxes, floor.
pub fn overlaps(cell: &Cell, layout: &Layout, found: &mut Vec<Overlap>) {
    found.clear();
    if !cell.collision {
        return;
    }
    let base = Placed::new(&cell.robot.footprint, &cell.base);
    let mut note = |a, b, depth: f64| {
        if depth > 0.0 {
            found.push(Overlap { a, b, depth });
        }
    };
    for (i, (equipment, at)) in cell.equipment.iter().zip(&layout.placements).enumerate() {
        let party = Party::Equipment(i);
        let here = Placed::new(&equipment.footprint, at);
        for (j, (other, there)) in cell.equipment.iter().zip(&layout.placements).enumerate().skip(i + 1) {
            if equipment.role == Role::Obstacle && other.role == Role::Obstacle {
                continue;
            }
            note(
                party,
                Party::Equipment(j),
                depth(&here, &Placed::new(&other.footprint, there), cell.clearance),
            );
        }
        note(party, Party::RobotBase, depth(&here, &base, cell.clearance));
        let shapes = || equipment.solids.iter().map(|s| extent(&s.shape));
        let low = shapes().map(|(lo, _)| lo.z).fold(0.0, f64::min) + at.z;
        let high = shapes().map(|(_, hi)| hi.z).fold(0.0, f64::max) + at.z;
        for (k, keep_out) in cell.keep_out.iter().enumerate() {
            let stands = equipment.solids.iter().any(|s| matches!(s.shape, crate::cell::Shape::Leg { .. }));
            let low = if stands { low.min(cell.floor) } else { low };
            let height = (high + cell.clearance - keep_out.min.z).min(keep_out.max.z - low + cell.clearance);
            if height > 0.0 {
                note(party, Party::KeepOut(k), depth(&here, &plan_of(keep_out), cell.clearance));
            }
        }
        note(party, Party::Floor, cell.floor - low - 1e-9);
    }
}

fn plan_of(keep_out: &crate::cell::KeepOut) -> Placed {
    let (lo, hi) = (keep_out.min, keep_out.max);
    Placed {
        centre: ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0),
        half: ((hi.x - lo.x) / 2.0, (hi.y - lo.y) / 2.0),
        cos: 1.0,
        sin: 0.0,
    }
}
