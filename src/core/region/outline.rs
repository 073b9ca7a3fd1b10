//! Outline of a region in the plane, computed by a test of single points.
//!
//! A coarse lattice finds the parts of the region. An edge of a lattice is crossed if one of its vertices is
//! inside the region and the other is outside. On a fine lattice, the boundary of each part is followed from
//! one crossed edge to the next. Bisection locates every crossing. The region may have several parts and
//! holes.

use crate::contour::{CrossedEdge, LatticeVertex, bisected, contours};
use crate::geometry::{PlanePoint, simplified_line};
use nalgebra::Vector2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Number of bisection steps between the two vertices of a crossed edge.
const BISECTIONS: usize = 6;

/// Largest distance, m, of a removed point of the outline from the simplified outline.
const STRAIGHT: f64 = 1e-4;

/// Rectangle in which a region lies, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    pub x: (f64, f64),
    pub y: (f64, f64),
}

impl Domain {
    /// Returns whether a point lies in the rectangle.
    pub fn contains(&self, (x, y): PlanePoint) -> bool {
        (self.x.0..=self.x.1).contains(&x) && (self.y.0..=self.y.1).contains(&y)
    }
}

/// Lattices on which a region is traced.
pub struct TwoLattices {
    pub domain: Domain,
    /// Known point inside the region.
    pub origin: PlanePoint,
    /// Spacing of the fine lattice, m.
    pub step: f64,
    /// Spacing of the coarse lattice, in steps of the fine lattice.
    pub coarse: i32,
}

/// Test of whether a point is inside the region. The test needs working memory, which threads must not share.
pub trait Inside: Sync {
    type Memory: Default;

    fn inside(&self, at: PlanePoint, memory: &mut Self::Memory) -> bool;
}

/// State of a trace: the tested vertices, and which of them are inside the region.
struct Trace<'a, I: Inside> {
    lattice: &'a TwoLattices,
    region: &'a I,
    known: HashMap<LatticeVertex, bool>,
    memory: I::Memory,
}

impl TwoLattices {
    /// Traces the region. Returns closed rings; a point is inside if it lies in an odd number of rings.
    ///
    /// Every point of a ring is inside the region. Between the points, and at parts or holes that the coarse
    /// lattice misses, the outline may be wrong.
    pub fn trace<I: Inside>(&self, region: &I) -> Vec<Vec<PlanePoint>> {
        let mut trace = Trace { lattice: self, region, known: HashMap::new(), memory: I::Memory::default() };
        trace.test_all(self.coarse_vertices());
        let mut starts = trace.coarse_crossings();
        starts.extend(trace.crossings_on_axes());
        let rings = contours(starts, |vertex| trace.is_inside(vertex));
        rings.iter().map(|ring| simplified(self.located(region, ring))).collect()
    }

    fn at(&self, (i, j): LatticeVertex) -> PlanePoint {
        (self.origin.0 + f64::from(i) * self.step, self.origin.1 + f64::from(j) * self.step)
    }

    /// Returns the vertices with the least and with the greatest indices. Both vertices lie outside the
    /// domain.
    fn ends(&self) -> (LatticeVertex, LatticeVertex) {
        let end = |limit: f64, origin: f64| (limit - origin) / self.step;
        let Domain { x, y } = self.domain;
        let low = |limit, origin| end(limit, origin).floor() as i32 - 1;
        let high = |limit, origin| end(limit, origin).ceil() as i32 + 1;
        (
            (low(x.0, self.origin.0), low(y.0, self.origin.1)),
            (high(x.1, self.origin.0), high(y.1, self.origin.1)),
        )
    }

    /// Returns the indices of the coarse lattice along x and y, from end to end.
    fn coarse_indices(&self) -> (Vec<i32>, Vec<i32>) {
        let (low, high) = self.ends();
        let all = |low: i32, high: i32| -> Vec<i32> {
            let inner = low.div_euclid(self.coarse) + 1..=(high - 1).div_euclid(self.coarse);
            [low].into_iter().chain(inner.map(|k| k * self.coarse)).chain([high]).collect()
        };
        (all(low.0, high.0), all(low.1, high.1))
    }

    fn coarse_vertices(&self) -> Vec<LatticeVertex> {
        let (along_x, along_y) = self.coarse_indices();
        along_x.iter().flat_map(|i| along_y.iter().map(move |j| (*i, *j))).collect()
    }

    /// Locates the crossings of a ring by bisection; each result is the last tested point that is inside.
    fn located<I: Inside>(&self, region: &I, ring: &[CrossedEdge]) -> Vec<PlanePoint> {
        let locate = |memory: &mut I::Memory, (inside, outside): &CrossedEdge| {
            let is_inside = |at| self.domain.contains(at) && region.inside(at, memory);
            bisected((self.at(*inside), self.at(*outside)), BISECTIONS, is_inside).0
        };
        ring.par_iter().map_init(I::Memory::default, locate).collect()
    }
}

impl<I: Inside> Trace<'_, I> {
    fn test_all(&mut self, vertices: Vec<LatticeVertex>) {
        let Self { lattice, region, .. } = self;
        let test = |memory: &mut I::Memory, vertex: &LatticeVertex| {
            let at = lattice.at(*vertex);
            lattice.domain.contains(at) && region.inside(at, memory)
        };
        let found: Vec<bool> = vertices.par_iter().map_init(I::Memory::default, test).collect();
        self.known.extend(vertices.into_iter().zip(found));
    }

    fn is_inside(&mut self, vertex: LatticeVertex) -> bool {
        let Self { lattice, region, known, memory } = self;
        *known.entry(vertex).or_insert_with(|| {
            let at = lattice.at(vertex);
            lattice.domain.contains(at) && region.inside(at, memory)
        })
    }

    /// Returns one crossed edge of the fine lattice for each crossed edge of the coarse lattice.
    fn coarse_crossings(&mut self) -> Vec<CrossedEdge> {
        let (along_x, along_y) = self.lattice.coarse_indices();
        let mut edges = Vec::new();
        for (k, i) in along_x.iter().enumerate() {
            for (l, j) in along_y.iter().enumerate() {
                edges.extend(along_x.get(k + 1).map(|next| ((*i, *j), (*next, *j))));
                edges.extend(along_y.get(l + 1).map(|next| ((*i, *j), (*i, *next))));
            }
        }
        edges.into_iter().filter_map(|(a, b)| self.crossing(a, b)).collect()
    }

    /// Returns a crossed edge on the line between two vertices, with the inner vertex first; None unless
    /// exactly one of the two vertices is inside.
    fn crossing(&mut self, a: LatticeVertex, b: LatticeVertex) -> Option<CrossedEdge> {
        let (mut inside, mut outside) = match (self.is_inside(a), self.is_inside(b)) {
            (true, false) => (a, b),
            (false, true) => (b, a),
            _ => return None,
        };
        while (inside.0 - outside.0).abs() + (inside.1 - outside.1).abs() > 1 {
            let middle = ((inside.0 + outside.0).div_euclid(2), (inside.1 + outside.1).div_euclid(2));
            match self.is_inside(middle) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        Some((inside, outside))
    }

    /// Returns every crossed edge on the two lines through the known point.
    fn crossings_on_axes(&mut self) -> Vec<CrossedEdge> {
        let (low, high) = self.lattice.ends();
        let along_x = (low.0..high.0).map(|i| ((i, 0), (i + 1, 0)));
        let along_y = (low.1..high.1).map(|j| ((0, j), (0, j + 1)));
        self.test_all((low.0..=high.0).map(|i| (i, 0)).chain((low.1..=high.1).map(|j| (0, j))).collect());
        along_x.chain(along_y).filter_map(|(a, b)| self.crossing(a, b)).collect()
    }
}

/// Removes the points of a ring that nearly lie on straight lines between other points.
fn simplified(ring: Vec<PlanePoint>) -> Vec<PlanePoint> {
    let mut points: Vec<Vector2<f64>> = ring.iter().map(|p| Vector2::new(p.0, p.1)).collect();
    // The line is closed, and its two ends are kept.
    points.extend(points.first().copied());
    let mut kept = simplified_line(&points, STRAIGHT);
    kept.pop();
    kept.into_iter().map(|k| ring[k]).collect()
}
