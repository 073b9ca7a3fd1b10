//! Outline of a region in a plane, traced on a dense lattice ([`crate::contour`]).

use crate::contour::{CrossedEdge, LatticeVertex, bisected, contours, middle};
use crate::geometry::PlanePoint;
use rayon::prelude::*;

/// Section of an envelope by a plane; coordinates in m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnvelopeSection {
    pub outlines: Vec<Outline>,
}

/// Closed polygon, whose last point is joined to the first.
///
/// A walk from point to point has the section of the envelope on its left. An outer boundary therefore
/// runs anticlockwise, and the boundary of a hole runs clockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    pub points: Vec<[f64; 2]>,
}

/// Square lattice of points in a plane.
///
/// Every coordinate is a whole number of steps plus half a step, so no point lies on the base axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lattice {
    /// Index of the first column and of the first row, counted in steps from the origin.
    first: [i64; 2],
    size: [usize; 2],
    step: f64,
}

impl EnvelopeSection {
    /// Returns the area of the section, m^2, without the area of its holes.
    pub fn area(&self) -> f64 {
        self.outlines.iter().map(Outline::area).sum()
    }

    /// Returns whether the section contains no point.
    pub fn is_empty(&self) -> bool {
        self.outlines.is_empty()
    }

    /// Returns the vertices of all outlines.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.outlines.iter().flat_map(|o| o.points.iter().copied())
    }
}

impl Outline {
    /// Returns the signed area, m^2, which is negative for a hole.
    pub fn area(&self) -> f64 {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().zip(next).map(|(a, b)| (a[0] * b[1] - a[1] * b[0]) / 2.0).sum()
    }

    /// Returns whether the polygon bounds a hole.
    pub fn is_hole(&self) -> bool {
        self.area() < 0.0
    }
}

impl Lattice {
    /// Returns a lattice that covers a disc of `radius` (m) about `centre` and has a border outside the disc.
    pub fn round(centre: [f64; 2], radius: f64, step: f64) -> Self {
        let first = centre.map(|c| ((c - radius) / step).floor() as i64 - 1);
        let last = centre.map(|c| ((c + radius) / step).ceil() as i64 + 1);
        Self { first, size: [0, 1].map(|k| (last[k] - first[k]).max(2) as usize), step }
    }

    /// Returns the number of points of the lattice.
    pub fn count(&self) -> u64 {
        (self.size[0] * self.size[1]) as u64
    }

    /// Returns x of column `k` (axis 0) or y of row `k` (axis 1), m.
    fn coordinate(&self, axis: usize, k: usize) -> f64 {
        (self.first[axis] as f64 + k as f64 + 0.5) * self.step
    }

    /// Returns x of all columns (axis 0) or y of all rows (axis 1), m.
    pub fn line(&self, axis: usize) -> Vec<f64> {
        (0..self.size[axis]).map(|k| self.coordinate(axis, k)).collect()
    }

    fn point(&self, (i, j): LatticeVertex) -> PlanePoint {
        (self.coordinate(0, i as usize), self.coordinate(1, j as usize))
    }

    /// Returns the region in which `inside` returns true; parts narrower than a step may be missed.
    ///
    /// The error of a vertex of the outline is at most `tolerance` (m). `row_done` is called after every row
    /// of the lattice with the number of points in the row.
    pub fn region(
        &self,
        tolerance: f64,
        row_done: &(dyn Fn(u64) + Sync),
        inside: impl Fn([f64; 2]) -> bool + Sync,
    ) -> EnvelopeSection {
        let [columns, rows] = self.size.map(|size| size as i32);
        let is_inside = |(x, y): PlanePoint| inside([x, y]);
        let row = |j: i32| {
            let frame = |i: i32| i == 0 || j == 0 || i + 1 == columns || j + 1 == rows;
            let held: Vec<bool> = (0..columns).map(|i| !frame(i) && is_inside(self.point((i, j)))).collect();
            row_done(columns as u64);
            held
        };
        let held: Vec<bool> = (0..rows).into_par_iter().flat_map_iter(row).collect();
        let holds = |(i, j): LatticeVertex| held[i as usize + j as usize * self.size[0]];
        // No vertex of the border is inside, so every contour has an edge that leaves the region to the left.
        let leaves = |&(a, b): &CrossedEdge| holds(a) && !holds(b);
        let starts = (0..rows).flat_map(|j| (1..columns).map(move |i| ((i, j), (i - 1, j)))).filter(leaves);
        let steps = (self.step / (2.0 * tolerance)).log2().ceil().max(0.0) as usize;
        let crossing = |&(a, b): &CrossedEdge| {
            let (a, b) = bisected((self.point(a), self.point(b)), steps, is_inside);
            let at = middle(a, b);
            [at.0, at.1]
        };
        let outline =
            |contour: &Vec<CrossedEdge>| Outline { points: contour.par_iter().map(crossing).collect() };
        EnvelopeSection { outlines: contours(starts, holds).iter().map(outline).collect() }
    }
}
