//! Rotation of equipment about the base axis. Only pieces with ranges of x, y and yaw, and the pieces that
//! stand on them, are rotated.
//!
//! The base axis is the vertical line through the origin of the robot base. The errors may change, for
//! example if the base frame has an error. A rotation is allowed if the objective grows by at most the
//! indifference, and the layout stays feasible and within every limit. A joint limit, an obstacle or the
//! range of a coordinate may limit the rotation.

use super::piece::Interval;
use super::{RegionEffort, RoomEnd};
use crate::cell::{Cell, Coordinate, Layout, Placement};
use crate::layout::HeldLayout;
use crate::units::rad_from_deg;
use std::f64::consts::PI;

/// Tolerance for the rounding error of a coordinate, m and rad.
const ROUNDING: f64 = 1e-9;

/// Least and greatest angle, rad, by which the pieces may be rotated together about the base axis.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeTurn {
    pub least: f64,
    pub most: f64,
    /// Reason why the pieces cannot be rotated farther in the direction that allows less rotation. If both
    /// directions allow equal rotations, the reason refers to the negative direction.
    pub ended: RoomEnd,
}

/// Returns how far all pieces with ranges of x, y and yaw may be rotated together about the base axis.
/// Returns None if the equipment under an operation lacks one of these ranges.
pub fn turn(held: &HeldLayout<'_>, most: f64) -> Option<WholeTurn> {
    let cell = &held.workcell().cell;
    let turns = |k: usize| {
        let is_range = |axis: usize| matches!(cell.equipment[k].placement[axis], Coordinate::Range { .. });
        [0, 1, 3].into_iter().all(is_range)
    };
    let carrier = |mut k: usize| {
        while let Some(under) = cell.equipment[k].on {
            k = under;
        }
        k
    };
    if !cell.operations.iter().all(|o| turns(carrier(o.equipment))) {
        return None;
    }
    let pieces: Vec<usize> = (0..cell.equipment.len()).filter(|k| turns(carrier(*k))).collect();
    let interval = Interval::scanned(
        0.0,
        ((-PI, PI), RoomEnd::Window),
        rad_from_deg(RegionEffort::of(held.workcell()).scan_deg),
        |angle, memory| {
            let turned = turned(cell, held.layout(), &pieces, angle).ok_or(RoomEnd::Range)?;
            held.judge(&turned, most, memory).map(|_| ()).map_err(RoomEnd::Held)
        },
    );
    let (_, ended) = interval.nearest(0.0);
    Some(WholeTurn { least: interval.low.0, most: interval.high.0, ended })
}

/// Returns a layout with some pieces rotated by `angle` (rad) about the base axis; None if a coordinate of a
/// piece leaves the range over which the search varies it.
fn turned(cell: &Cell, layout: &Layout, pieces: &[usize], angle: f64) -> Option<Layout> {
    let (sin, cos) = angle.sin_cos();
    let mut turned = layout.clone();
    for &k in pieces {
        let (at, base) = (&layout.placements[k], &layout.base);
        let (x, y) = (at.x - base.x, at.y - base.y);
        let at = Placement {
            x: base.x + cos * x - sin * y,
            y: base.y + sin * x + cos * y,
            z: at.z,
            yaw: at.yaw + angle,
        };
        turned.placements[k] = at;
        if cell.equipment[k].on.is_none() {
            let within = |(c, value): (&Coordinate, f64)| {
                let (min, max) = c.range();
                (min - ROUNDING..=max + ROUNDING).contains(&value)
            };
            if !cell.equipment[k].placement.iter().zip(at.values()).all(within) {
                return None;
            }
        }
    }
    Some(turned)
}
