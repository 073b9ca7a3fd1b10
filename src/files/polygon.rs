//! Checks of polygons: whether their edges cross or touch.

use nalgebra::Vector2;

/// Edge of a polygon: start and end.
type Edge = (Vector2<f64>, Vector2<f64>);

/// Returns the indices of two edges that share a point other than a common corner; None if the polygon is
/// simple.
///
/// Edge k runs from corner k to the next corner.
pub fn crossing_edges(corners: &[Vector2<f64>]) -> Option<(usize, usize)> {
    let n = corners.len();
    let edge = |k: usize| (corners[k], corners[(k + 1) % n]);
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    pairs.into_iter().find(|&(i, j)| cross(edge(i), edge(j), j == i + 1, j + 1 == n && i == 0))
}

/// Returns whether the edges of two polygons share a point.
pub fn rings_meet(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> bool {
    let edge = |ring: &[Vector2<f64>], k: usize| (ring[k], ring[(k + 1) % ring.len()]);
    (0..a.len()).any(|i| (0..b.len()).any(|j| cross(edge(a, i), edge(b, j), false, false)))
}

/// Returns whether two edges share a point other than a common corner.
///
/// `follows` means that `b` begins at the end of `a`; `leads` means that `b` ends at the start of `a`.
fn cross(a: Edge, b: Edge, follows: bool, leads: bool) -> bool {
    let (u, v) = (a.1 - a.0, b.1 - b.0);
    if follows || leads {
        // Neighbouring edges meet again only if one edge runs back over the other edge.
        let back = if follows { u.dot(&v) } else { v.dot(&u) };
        let flat = u.perp(&v).abs() <= 1e-12 * u.norm() * v.norm();
        return flat && back < 0.0;
    }
    let side = |e: Edge, p: Vector2<f64>| (e.1 - e.0).perp(&(p - e.0));
    let between = |e: Edge, p: Vector2<f64>| side(e, p) == 0.0 && (p - e.0).dot(&(p - e.1)) <= 0.0;
    let apart = |e: Edge, f: Edge| side(e, f.0) * side(e, f.1) >= 0.0;
    let proper = !apart(a, b) && !apart(b, a);
    proper || between(a, b.0) || between(a, b.1) || between(b, a.0) || between(b, a.1)
}
