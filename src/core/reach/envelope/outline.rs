//! Outline of a region in a plane by marching squares.
//!
//! The method is the two-dimensional form of marching cubes (W. E. Lorensen, H. E. Cline, 1987). A function
//! decides whether a point lies in the region. A crossing is a point where an edge of the lattice meets the
//! outline; bisection locates each crossing.

use rayon::prelude::*;

/// Section of an envelope by a plane; coordinates in m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnvelopeSection {
    pub outlines: Vec<Outline>,
}

/// Closed polygon, whose last point is joined to the first.
///
/// The region lies to the left of the polygon: an outer boundary runs anticlockwise, and the boundary of a
/// hole runs clockwise.
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

/// Mark of a lattice edge that does not cross the outline.
const NO_CROSSING: u32 = u32::MAX;

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

    fn point(&self, node: usize) -> [f64; 2] {
        [self.coordinate(0, node % self.size[0]), self.coordinate(1, node / self.size[0])]
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
        let [columns, rows] = self.size;
        let row = |j: usize| {
            let frame = |i: usize| i == 0 || j == 0 || i + 1 == columns || j + 1 == rows;
            let held: Vec<bool> =
                (0..columns).map(|i| !frame(i) && inside(self.point(i + j * columns))).collect();
            row_done(columns as u64);
            held
        };
        let held: Vec<bool> = (0..rows).into_par_iter().flat_map_iter(row).collect();
        // From point k, edge 2 k runs to the right, and edge 2 k + 1 runs upwards.
        let level = |edge: usize| edge.is_multiple_of(2);
        let end = |edge: usize| edge / 2 + if level(edge) { 1 } else { columns };
        let closes = |k: usize| (k + 1).is_multiple_of(columns);
        let has_end = |edge: usize| if level(edge) { !closes(edge / 2) } else { end(edge) < held.len() };
        let cut = |&edge: &usize| has_end(edge) && held[edge / 2] != held[end(edge)];
        let edges: Vec<usize> = (0..2 * held.len()).filter(cut).collect();
        let crossing = |&edge: &usize| {
            let (from, to) = (self.point(edge / 2), self.point(end(edge)));
            let (yes, no) = if held[edge / 2] { (from, to) } else { (to, from) };
            bisected(yes, no, tolerance, &inside)
        };
        let crossings: Vec<[f64; 2]> = edges.par_iter().map(crossing).collect();
        let mut number = vec![NO_CROSSING; 2 * held.len()];
        edges.iter().enumerate().for_each(|(k, &edge)| number[edge] = k as u32);
        let next = self.linked(&held, &number, edges.len(), &inside);
        EnvelopeSection { outlines: walked(&crossings, next) }
    }

    /// Returns, for every crossing of the outline with an edge, the next crossing along the outline.
    fn linked(
        &self,
        held: &[bool],
        number: &[u32],
        count: usize,
        inside: &impl Fn([f64; 2]) -> bool,
    ) -> Vec<u32> {
        let columns = self.size[0];
        let mut next = vec![NO_CROSSING; count];
        for low in (0..held.len() - columns).filter(|k| !(k + 1).is_multiple_of(columns)) {
            // Corners run anticlockwise from the lower left; side k runs from corner k to the next.
            let corners = [low, low + 1, low + columns + 1, low + columns];
            let sides = [2 * low, 2 * (low + 1) + 1, 2 * (low + columns), 2 * low + 1];
            let leaves = |k: usize| held[corners[k]] && !held[corners[(k + 1) % 4]];
            let enters = |k: usize| !held[corners[k]] && held[corners[(k + 1) % 4]];
            let saddle = (0..4).filter(|&k| leaves(k)).count() == 2;
            let middle = || {
                let [a, b] = [self.point(corners[0]), self.point(corners[2])];
                inside([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0])
            };
            // A saddle has two opposite corners inside the region. If the middle of the saddle is outside,
            // the outline separates the two corners.
            let turn = if saddle && !middle() { 3 } else { 1 };
            for k in (0..4).filter(|&k| leaves(k)) {
                if let Some(to) = (1..4).map(|n| (k + n * turn) % 4).find(|&k| enters(k)) {
                    next[number[sides[k]] as usize] = number[sides[to]];
                }
            }
        }
        next
    }
}

/// Returns the point between `yes` and `no` where `inside` changes, found by bisection.
fn bisected(
    mut yes: [f64; 2],
    mut no: [f64; 2],
    tolerance: f64,
    inside: &impl Fn([f64; 2]) -> bool,
) -> [f64; 2] {
    let middle = |a: [f64; 2], b: [f64; 2]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
    while (yes[0] - no[0]).abs() + (yes[1] - no[1]).abs() > 2.0 * tolerance {
        let between = middle(yes, no);
        if inside(between) { yes = between } else { no = between }
    }
    middle(yes, no)
}

/// Returns the closed polygons that result from following `next` from crossing to crossing.
fn walked(crossings: &[[f64; 2]], mut next: Vec<u32>) -> Vec<Outline> {
    let mut outlines = Vec::new();
    for start in 0..next.len() {
        let (mut at, mut points) = (start, Vec::new());
        while next[at] != NO_CROSSING {
            points.push(crossings[at]);
            at = std::mem::replace(&mut next[at], NO_CROSSING) as usize;
        }
        if !points.is_empty() {
            outlines.push(Outline { points });
        }
    }
    outlines
}
