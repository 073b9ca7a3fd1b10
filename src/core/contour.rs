//! Contours of a region in a plane. A function tests whether a point is inside the region. The contours
//! are traced on a square lattice.
//!
//! An edge of the lattice is crossed if one of its vertices is inside the region and the other is outside.
//! Square tracing follows the contour from one crossed edge to the next. Bisection locates the contour on a
//! crossed edge. If only two opposite corners of a square are inside, the contour separates them.

use crate::geometry::PlanePoint;
use std::collections::HashSet;

/// Column and row of a vertex of the lattice.
pub type LatticeVertex = (i32, i32);

/// Edge of the lattice that the contour crosses; the first vertex is inside, and the second is outside.
pub type CrossedEdge = (LatticeVertex, LatticeVertex);

/// Returns every closed contour that crosses at least one of the edges in `starts`. Each contour is the list
/// of its crossed edges, with the inside on the left.
pub fn contours(
    starts: impl IntoIterator<Item = CrossedEdge>,
    mut is_inside: impl FnMut(LatticeVertex) -> bool,
) -> Vec<Vec<CrossedEdge>> {
    let (mut visited, mut found) = (HashSet::new(), Vec::new());
    for start in starts {
        if !visited.contains(&start) {
            let contour = follow(start, &mut is_inside);
            visited.extend(contour.iter().copied());
            found.push(contour);
        }
    }
    found
}

/// Follows the contour from a crossed edge back to the same edge.
fn follow(start: CrossedEdge, is_inside: &mut impl FnMut(LatticeVertex) -> bool) -> Vec<CrossedEdge> {
    let mut contour = vec![start];
    let (mut a, mut b) = start;
    loop {
        // The next square contains the edge from `a` to `b` and the parallel edge from `c` to `e`.
        let aside = (a.1 - b.1, b.0 - a.0);
        let (c, e) = ((a.0 + aside.0, a.1 + aside.1), (b.0 + aside.0, b.1 + aside.1));
        (a, b) = match (is_inside(c), is_inside(e)) {
            (false, _) => (a, c),
            (true, false) => (c, e),
            (true, true) => (e, b),
        };
        if (a, b) == start {
            return contour;
        }
        contour.push((a, b));
    }
}

/// Brackets the contour between a point inside and a point outside, using `steps` bisections. Returns the
/// final pair of points: inside and outside.
pub fn bisected(
    (mut inside, mut outside): (PlanePoint, PlanePoint),
    steps: usize,
    mut is_inside: impl FnMut(PlanePoint) -> bool,
) -> (PlanePoint, PlanePoint) {
    for _ in 0..steps {
        let middle = middle(inside, outside);
        if is_inside(middle) { inside = middle } else { outside = middle }
    }
    (inside, outside)
}

/// Returns the midpoint of two points.
pub fn middle(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0)
}
