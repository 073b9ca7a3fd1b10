//! The search space: every free coordinate of a cell, scaled to [0, 1].

use crate::cell::{Cell, Coordinate, Layout, Resolution, Slot};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};

/// Largest standard deviation of a converged variable with a range, as a number of resolution steps.
const TOLERANCE_STEPS: f64 = 4.0;
/// Largest standard deviation of a converged variable with listed values, as a share of the interval that
/// represents one value.
const TOLERANCE_SHARE: f64 = 0.2;

/// Change that leads from a point to its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NeighbourChange {
    /// Change of one coordinate to another value of its list.
    List,
    /// Change of two coordinates, each to another value of its own list.
    Lists,
    /// Step of one coordinate that has a range, as a share of that range.
    Range(f64),
}

/// Map from the unit cube to layouts.
#[derive(Debug, Clone)]
pub struct SearchSpace<'c> {
    cell: &'c Cell,
    variables: Vec<(Slot, &'c Coordinate)>,
}

impl<'c> SearchSpace<'c> {
    /// Returns the search space of a cell.
    pub fn new(cell: &'c Cell) -> Self {
        Self { cell, variables: cell.free() }
    }

    /// Returns the number of variables.
    pub fn dimensions(&self) -> usize {
        self.variables.len()
    }

    /// Returns the point of the unit cube that represents the layout in the cell file.
    pub fn start(&self) -> Vec<f64> {
        self.point(&self.cell.start())
    }

    /// Returns the point of the unit cube that represents a layout. The free coordinates of the layout must
    /// lie in their ranges.
    pub fn point(&self, layout: &Layout) -> Vec<f64> {
        self.variables.iter().map(|(slot, c)| share(c, layout.value(self.cell, *slot))).collect()
    }

    /// Moves `point` to the standard point of its layout in the unit cube. All points with the same layout
    /// give the same result.
    ///
    /// A variable with a range takes the position of its rounded value. A variable with listed values takes
    /// the middle of the interval that represents its value.
    pub fn settled(&self, point: &[f64]) -> Vec<f64> {
        let shares = self.variables.iter().zip(point);
        shares.map(|((slot, c), u)| share(c, self.value(*slot, c, mirrored(*u)))).collect()
    }

    /// Returns the convergence tolerance of each variable: the standard deviation below which a global solver
    /// has converged, as a share of the search range. The polish then refines the result.
    ///
    /// A variable with a range has converged to a few steps of the resolution. A variable with listed values
    /// has converged to one value.
    pub fn tolerances(&self) -> Vec<f64> {
        let Resolution { mm, deg } = self.cell.search.resolution;
        let of = |(slot, coordinate): &(Slot, &Coordinate)| match coordinate {
            Coordinate::Fixed(_) => f64::INFINITY,
            Coordinate::Range { min, max, .. } => {
                let step = if slot.is_angle() { rad_from_deg(deg) } else { m_from_mm(mm) };
                TOLERANCE_STEPS * step / (max - min)
            }
            Coordinate::List(values) => TOLERANCE_SHARE / values.len() as f64,
        };
        self.variables.iter().map(of).collect()
    }

    /// Returns the neighbours of `point` in the unit cube: one point for each possible change of the kind
    /// `change`.
    pub fn neighbours(&self, point: &[f64], change: NeighbourChange) -> Vec<Vec<f64>> {
        match change {
            NeighbourChange::List => self.other_values(point, 0),
            NeighbourChange::Lists => {
                let first = self.other_values(point, 0);
                let place = |p: &[f64]| p.iter().zip(point).position(|(a, b)| a != b).unwrap_or(0);
                first.iter().flat_map(|p| self.other_values(p, place(p) + 1)).collect()
            }
            NeighbourChange::Range(step) => {
                let ranges = self.variables.iter().enumerate();
                let ranges = ranges.filter(|(_, (_, c))| matches!(c, Coordinate::Range { .. }));
                let both = ranges.flat_map(|(k, _)| [(k, point[k] - step), (k, point[k] + step)]);
                both.filter(|(_, u)| (0.0..=1.0).contains(u)).map(|(k, u)| with(point, k, u)).collect()
            }
        }
    }

    /// Returns the points that differ from `point` in one variable with listed values.
    ///
    /// Only the variables with index `from` or higher are changed.
    fn other_values(&self, point: &[f64], from: usize) -> Vec<Vec<f64>> {
        let beside = |k: usize| {
            let others = middles(self.variables[k].1).into_iter().filter(move |u| *u != point[k]);
            others.map(move |u| with(point, k, u))
        };
        (from..point.len()).flat_map(beside).collect()
    }

    /// Returns one point per layout if all variables have listed values and there are no more than `most`
    /// layouts.
    ///
    /// Otherwise returns None.
    pub fn every_point(&self, most: u64) -> Option<Vec<Vec<f64>>> {
        let lists: Vec<Vec<f64>> = self.variables.iter().map(|(_, c)| middles(c)).collect();
        let count = lists.iter().try_fold(1u64, |count, list| count.checked_mul(list.len() as u64))?;
        if count == 0 || count > most {
            return None;
        }
        let mut all = vec![Vec::new()];
        for list in &lists {
            all = all.iter().flat_map(|p| list.iter().map(|u| [&p[..], &[*u]].concat())).collect();
        }
        Some(all)
    }

    /// Returns the layout that a point of the unit cube represents.
    ///
    /// Points outside the unit cube are mirrored at its faces, so every point represents a layout.
    /// Coordinates are rounded to multiples of the resolution of the search.
    pub fn layout(&self, point: &[f64]) -> Layout {
        self.cell.layout(|slot, coordinate| {
            let place = self.variables.iter().position(|(s, _)| *s == slot);
            place.map_or_else(|| coordinate.start(), |k| self.value(slot, coordinate, mirrored(point[k])))
        })
    }

    /// Returns the value of a coordinate at a position in [0, 1].
    fn value(&self, slot: Slot, coordinate: &Coordinate, share: f64) -> f64 {
        match coordinate {
            Coordinate::Fixed(value) => *value,
            Coordinate::Range { min, max, .. } => {
                let Resolution { mm, deg } = self.cell.search.resolution;
                let value = min + share * (max - min);
                match slot.is_angle() {
                    true => multiple(value, (*min, *max), deg, deg_from_rad, rad_from_deg),
                    false => multiple(value, (*min, *max), mm, mm_from_m, m_from_mm),
                }
            }
            Coordinate::List(values) => {
                let k = (share * values.len() as f64) as usize;
                values[k.min(values.len() - 1)]
            }
        }
    }
}

fn with(point: &[f64], k: usize, u: f64) -> Vec<f64> {
    let mut moved = point.to_vec();
    moved[k] = u;
    moved
}

/// Returns the positions in [0, 1] that represent the listed values of a coordinate; empty for a range.
fn middles(coordinate: &Coordinate) -> Vec<f64> {
    let Coordinate::List(values) = coordinate else { return Vec::new() };
    (0..values.len()).map(|k| middle(k, values.len())).collect()
}

/// Returns the middle of the interval of [0, 1] that represents value `k` in a list of `count` values.
fn middle(k: usize, count: usize) -> f64 {
    (k as f64 + 0.5) / count as f64
}

/// Returns the position in [0, 1] that represents a value of a coordinate.
fn share(coordinate: &Coordinate, value: f64) -> f64 {
    match coordinate {
        Coordinate::Fixed(_) => 0.0,
        Coordinate::Range { min, max, .. } => (value - min) / (max - min),
        Coordinate::List(values) => {
            let off = |k: &usize| (values[*k] - value).abs();
            let nearest = (0..values.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            middle(nearest.unwrap_or(0), values.len())
        }
    }
}

/// Largest number of decimals of a resolution in mm or degrees.
const RESOLUTION_DIGITS: i32 = 9;

/// Returns the multiple of `step` that lies inside a range and is nearest to `value`.
///
/// If the range contains no multiple, returns the point of the range that is nearest to `value`.
///
/// `value` and `range` are in SI units, and `step` is in the unit of files.
fn multiple(
    value: f64,
    (min, max): (f64, f64),
    step: f64,
    to_file: fn(f64) -> f64,
    from_file: fn(f64) -> f64,
) -> f64 {
    let (low, high) = ((to_file(min) / step - ROUNDING).ceil(), (to_file(max) / step + ROUNDING).floor());
    if low > high {
        return value.clamp(min, max);
    }
    let count = (to_file(value) / step).round().clamp(low, high);
    from_file(rounded(count * step, RESOLUTION_DIGITS)).clamp(min, max)
}

/// Tolerance for the rounding error of the quotient of coordinate and resolution.
const ROUNDING: f64 = 1e-9;

/// Mirrors a number at 0 and 1 into [0, 1].
fn mirrored(u: f64) -> f64 {
    let phase = u.rem_euclid(2.0);
    if phase > 1.0 { 2.0 - phase } else { phase }
}
