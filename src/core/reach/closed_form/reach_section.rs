//! Table of lower bounds of the distance from targets to the points that three revolute joints reach.
//!
//! Joint 1 rotates the reachable points about its axis. So a target is described by its radius and its
//! height. The reachable points are described by their cross-section in the half-plane of radius and height.
//! A square lattice of cells covers the cross-section. An exact distance transform gives, for each cell, the
//! nearest cell that contains a sampled point (Felzenszwalb and Huttenlocher 2012).

use super::three_joint_point::{ThreeJointPoint, ThreeJointState};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Number of sampled angles for each of joints 2 and 3.
const ANGLES: usize = 256;

/// Number of cells along the longer side of the cross-section.
const CELLS: usize = 96;

/// Mark of a cell that contains no sampled point.
const EMPTY: u32 = u32::MAX;

/// Lattice over the cross-section; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ReachSection {
    /// Least radius and height of the lattice.
    corner: (f64, f64),
    /// Side of a cell.
    side: f64,
    /// Number of cells along the radius and along the height.
    count: (usize, usize),
    cells: Vec<SectionCell>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct SectionCell {
    /// Index of a sampled posture whose point is in the nearest cell that is not empty.
    sample: u32,
    /// Lower bound of the distance from the centre of this cell to the reachable points, m.
    bound: f64,
}

impl ReachSection {
    /// Samples the points that three revolute joints reach.
    pub fn new(point: &ThreeJointPoint) -> Self {
        let places: Vec<_> = (0..ANGLES * ANGLES).map(|k| point.section(&at(point, k as u32))).collect();
        let (mut low, mut high) = ((f64::INFINITY, f64::INFINITY), (0.0, f64::NEG_INFINITY));
        for &(radius, height) in &places {
            low = (f64::min(low.0, radius), f64::min(low.1, height));
            high = (f64::max(high.0, radius), f64::max(high.1, height));
        }
        let side = ((high.0 - low.0).max(high.1 - low.1) / CELLS as f64).max(f64::MIN_POSITIVE);
        let count = [high.0 - low.0, high.1 - low.1].map(|length| (length / side) as usize + 1);
        let mut section = Self {
            corner: low,
            side,
            count: (count[0], count[1]),
            cells: Vec::with_capacity(count[0] * count[1]),
        };
        let mut samples = vec![EMPTY; count[0] * count[1]];
        for (k, place) in (0..).zip(places) {
            samples[section.cell_at(place)] = k;
        }
        let nearest = nearest_filled(&samples, section.count);
        // A point of the cell may be half a diagonal away from the centre. The distance of a reachable point
        // from the nearest sample is at most the motion that half a step of both angles causes.
        let slack = side / 2f64.sqrt() + point.travel() * TAU / ANGLES as f64 / 2.0;
        for (k, &from) in nearest.iter().enumerate() {
            let apart = section.centre(k).0 - section.centre(from).0;
            let distance = apart.hypot(section.centre(k).1 - section.centre(from).1);
            section.cells.push(SectionCell { sample: samples[from], bound: distance - slack });
        }
        section
    }

    /// Returns a lower bound of the distance from `p` to the reachable points, m; `p` is in frame 0.
    pub fn bound(&self, p: &Vector3<f64>) -> f64 {
        let norm = |x: f64, y: f64| (x * x + y * y).sqrt();
        let place = (norm(p.x, p.y), p.z);
        let k = self.cell_at(place);
        let centre = self.centre(k);
        (self.cells[k].bound - norm(place.0 - centre.0, place.1 - centre.1)).max(0.0)
    }

    /// Returns the postures from which a search for the reachable point nearest to `p` starts.
    ///
    /// The postures are the samples of the cell that contains `p` and of its four diagonal neighbours.
    pub fn starts<'a>(
        &'a self,
        point: &'a ThreeJointPoint,
        p: &Vector3<f64>,
    ) -> impl Iterator<Item = ThreeJointState> + 'a {
        let place = (p.x.hypot(p.y), p.z);
        let offsets = [(0.0, 0.0), (1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let samples = offsets.map(|(x, y)| {
            self.cells[self.cell_at((place.0 + x * self.side, place.1 + y * self.side))].sample
        });
        let is_new = move |k: &usize| !samples[..*k].contains(&samples[*k]);
        (0..samples.len()).filter(is_new).map(move |k| at(point, samples[k]))
    }

    /// Returns the index of the cell that contains a place (radius, height), or else of the nearest cell.
    fn cell_at(&self, place: (f64, f64)) -> usize {
        let along = |at: f64, from: f64, count: usize| (((at - from) / self.side) as usize).min(count - 1);
        along(place.0, self.corner.0, self.count.0)
            + self.count.0 * along(place.1, self.corner.1, self.count.1)
    }

    /// Returns radius and height of the centre of a cell, m.
    fn centre(&self, cell: usize) -> (f64, f64) {
        let along = |k: usize, from: f64| from + (k as f64 + 0.5) * self.side;
        (along(cell % self.count.0, self.corner.0), along(cell / self.count.0, self.corner.1))
    }
}

/// Returns the sampled posture with the index `sample`.
fn at(point: &ThreeJointPoint, sample: u32) -> ThreeJointState {
    point.on_grid([sample as usize % ANGLES, sample as usize / ANGLES], ANGLES)
}

/// Returns, for each cell, the index of the nearest cell that is not empty.
fn nearest_filled(samples: &[u32], (width, height): (usize, usize)) -> Vec<usize> {
    let far = (width + height).pow(2) as f64;
    let mut nearest: Vec<usize> = (0..samples.len()).collect();
    let mut square: Vec<f64> = samples.iter().map(|s| if *s == EMPTY { far } else { 0.0 }).collect();
    for y in 0..height {
        transform(&mut square, &mut nearest, |x| x + width * y, width);
    }
    for x in 0..width {
        transform(&mut square, &mut nearest, |y| x + width * y, height);
    }
    nearest
}

/// Computes the distance transform along one line of cells.
///
/// Let k and x be positions on the line. The parabola `square[k] + (x - k)^2` is the squared distance from
/// position x to the filled cell `nearest[k]`. The lower envelope of these parabolas is the transform.
///
/// For each cell, `nearest` holds the index of the nearest filled cell. `square` holds the squared distance
/// to that cell, in squared cell sides. `cell` returns the index of the cell at a position on the line.
fn transform(square: &mut [f64], nearest: &mut [usize], cell: impl Fn(usize) -> usize, count: usize) {
    let known: Vec<(f64, usize)> = (0..count).map(|k| (square[cell(k)], nearest[cell(k)])).collect();
    // Parabolas of the envelope: the apex, and the position from which this parabola is the lowest.
    let mut envelope: Vec<(usize, f64)> = Vec::with_capacity(count);
    for k in 0..count {
        let mut from = f64::NEG_INFINITY;
        while let Some(&(apex, begin)) = envelope.last() {
            let (a, b) = (apex as f64, k as f64);
            from = (known[k].0 + b * b - known[apex].0 - a * a) / (2.0 * (b - a));
            if from > begin {
                break;
            }
            envelope.pop();
            from = f64::NEG_INFINITY;
        }
        envelope.push((k, from));
    }
    let mut lowest = 0;
    for k in 0..count {
        while lowest + 1 < envelope.len() && envelope[lowest + 1].1 <= k as f64 {
            lowest += 1;
        }
        let apex = envelope[lowest].0;
        square[cell(k)] = known[apex].0 + (k.abs_diff(apex) as f64).powi(2);
        nearest[cell(k)] = known[apex].1;
    }
}
