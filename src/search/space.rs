//! The search space: every free coordinate of every placement, scaled to [0, 1].

use crate::cell::{Cell, Coordinate, Layout};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};

/// The last of x, y, z, yaw.
const YAW: usize = 3;

/// One free coordinate: equipment, which of x, y, z, yaw, and its range.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Variable {
    equipment: usize,
    axis: usize,
    min: f64,
    max: f64,
}

/// Maps the unit cube to layouts.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    variables: Vec<Variable>,
    start: Layout,
}

impl Space {
    pub fn new(cell: &Cell) -> Self {
        let mut variables = Vec::new();
        for (equipment, e) in cell.equipment.iter().enumerate() {
            for (axis, coordinate) in e.placement.iter().enumerate() {
                if let Coordinate::Range { min, max, .. } = *coordinate {
                    variables.push(Variable { equipment, axis, min, max });
                }
            }
        }
        Self { variables, start: cell.start() }
    }

    pub fn dimensions(&self) -> usize {
        self.variables.len()
    }

    /// The start layout as a point.
    pub fn start(&self) -> Vec<f64> {
        self.point(&self.start)
    }

    /// The point of a layout whose free coordinates lie in their ranges.
    pub fn point(&self, layout: &Layout) -> Vec<f64> {
        let value = |v: &Variable| {
            let p = &layout.placements[v.equipment];
            [p.x, p.y, p.z, p.yaw][v.axis]
        };
        self.variables.iter().map(|v| (value(v) - v.min) / (v.max - v.min)).collect()
    }

    /// The layout of a point. Points outside the cube are folded back like in a mirror, so that
    /// every point has a layout. Coordinates are rounded to 1 um and 0.0001 degree: what is
    /// evaluated is exactly what a file can say.
    pub fn layout(&self, point: &[f64]) -> Layout {
        let mut layout = self.start.clone();
        for (variable, u) in self.variables.iter().zip(point) {
            let value = variable.min + mirrored(*u) * (variable.max - variable.min);
            let rounded = if variable.axis == YAW { to_ten_thousandth_degree(value) } else { to_um(value) };
            // A range need not end at a round number.
            let value = rounded.clamp(variable.min, variable.max);
            let placement = &mut layout.placements[variable.equipment];
            match variable.axis {
                0 => placement.x = value,
                1 => placement.y = value,
                2 => placement.z = value,
                _ => placement.yaw = value,
            }
        }
        layout
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
