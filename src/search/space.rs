//! The search space: every free coordinate of a cell, scaled to [0, 1].

use crate::cell::{Cell, Coordinate, Layout, Slot};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};

/// Maps the unit cube to layouts.
#[derive(Debug, Clone)]
pub struct Space<'c> {
    cell: &'c Cell,
    variables: Vec<(Slot, &'c Coordinate)>,
}

impl<'c> Space<'c> {
    pub fn new(cell: &'c Cell) -> Self {
        Self { cell, variables: cell.free() }
    }

    pub fn dimensions(&self) -> usize {
        self.variables.len()
    }

    /// The start layout as a point.
    pub fn start(&self) -> Vec<f64> {
        self.point(&self.cell.start())
    }

    /// The point of a layout whose free coordinates lie in their ranges.
    pub fn point(&self, layout: &Layout) -> Vec<f64> {
        self.variables.iter().map(|(slot, c)| share(c, layout.value(self.cell, *slot))).collect()
    }

    /// The layout of a point. Points outside the cube are folded back like in a mirror, so that
    /// every point has a layout. Coordinates are rounded to 1 um and 0.0001 degree: what is
    /// evaluated is exactly what a file can say.
    pub fn layout(&self, point: &[f64]) -> Layout {
        self.cell.layout(|slot, coordinate| {
            let place = self.variables.iter().position(|(s, _)| *s == slot);
            place.map_or_else(|| coordinate.start(), |k| value(slot, coordinate, mirrored(point[k])))
        })
    }
}

/// Where in [0, 1] a value of a coordinate is; one of a list in the middle of its share.
fn share(coordinate: &Coordinate, value: f64) -> f64 {
    match coordinate {
        Coordinate::Fixed(_) => 0.0,
        Coordinate::Range { min, max, .. } => (value - min) / (max - min),
        Coordinate::List(values) => {
            let off = |k: &usize| (values[*k] - value).abs();
            let nearest = (0..values.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            (nearest.unwrap_or(0) as f64 + 0.5) / values.len() as f64
        }
    }
}

fn value(slot: Slot, coordinate: &Coordinate, share: f64) -> f64 {
    match coordinate {
        Coordinate::Fixed(value) => *value,
        Coordinate::Range { min, max, .. } => {
            let value = min + share * (max - min);
            let rounded = if slot.is_angle() { to_ten_thousandth_degree(value) } else { to_um(value) };
            // A range need not end at a round number.
            rounded.clamp(*min, *max)
        }
        Coordinate::List(values) => {
            let k = (share * values.len() as f64) as usize;
            values[k.min(values.len() - 1)]
        }
    }
}

fn to_ten_thousandth_degree(rad: f64) -> f64 {
    rad_from_deg(rounded(deg_from_rad(rad), 4))
}

fn to_um(m: f64) -> f64 {
    m_from_mm(rounded(mm_from_m(m), 3))
}

/// Folds a number into [0, 1].
fn mirrored(u: f64) -> f64 {
    let phase = u.rem_euclid(2.0);
    if phase > 1.0 { 2.0 - phase } else { phase }
}
