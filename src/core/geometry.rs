//! Geometry of the plane: convex hull, area, joined edges, simplified polylines.

use nalgebra::SVector;
use std::collections::BTreeMap;

/// Point of a plane, in a unit that the caller chooses.
pub type PlanePoint = (f64, f64);

/// Returns twice the signed area of a triangle: positive if `a`, `b`, `c` turn to the left.
pub fn turn(a: PlanePoint, b: PlanePoint, c: PlanePoint) -> f64 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

/// Returns the corners of the convex hull, anticlockwise.
///
/// The method is the monotone chain (A. M. Andrew, Information Processing Letters 9 (1979) 216-219). If the
/// points are collinear, the result is their two end points; if the points coincide, the result is one point.
pub fn convex_hull(mut points: Vec<PlanePoint>) -> Vec<PlanePoint> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = &PlanePoint>| {
        let mut chain: Vec<PlanePoint> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && turn(a, b, *p) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        // The last point is also the first point of the other half.
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter());
    hull.extend(half(&mut points.iter().rev()));
    if hull.is_empty() { points } else { hull }
}

/// Returns the signed area of a polygon: positive if its corners run anticlockwise.
pub fn polygon_area(corners: &[PlanePoint]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>() / 2.0
}

/// Open or closed polyline that consists of joined edges.
#[derive(Debug, Clone, PartialEq)]
pub struct JoinedLine<K> {
    /// Corners in the order of the edges; a closed polyline does not repeat the first corner.
    pub corners: Vec<K>,
    pub is_closed: bool,
}

/// Joins directed edges into polylines, and returns open polylines first, then closed polylines.
///
/// Every edge is in exactly one polyline. If several edges leave a corner, `choose` selects the edge with
/// which the polyline continues. The function `choose` receives the index of the arriving edge and the
/// indices of the leaving edges. It returns the index of a leaving edge.
pub fn join_edges<K: Copy + Ord>(
    edges: &[(K, K)],
    mut choose: impl FnMut(usize, &[usize]) -> usize,
) -> Vec<JoinedLine<K>> {
    let mut leaving: BTreeMap<K, Vec<usize>> = BTreeMap::new();
    let mut surplus: BTreeMap<K, i64> = BTreeMap::new();
    for (k, (from, to)) in edges.iter().enumerate() {
        leaving.entry(*from).or_default().push(k);
        *surplus.entry(*from).or_default() += 1;
        *surplus.entry(*to).or_default() -= 1;
    }
    // An open polyline begins at a corner where more edges leave than arrive.
    let ends = surplus.into_iter().filter(|(_, n)| *n > 0);
    let ends: Vec<K> = ends.flat_map(|(corner, n)| std::iter::repeat_n(corner, n as usize)).collect();
    let mut lines = Vec::new();
    for start in ends.into_iter().chain(edges.iter().map(|(from, _)| *from)) {
        let (mut corners, mut at, mut last) = (vec![start], start, None);
        while let Some(free) = leaving.get_mut(&at).filter(|free| !free.is_empty()) {
            let edge = match last {
                Some(last) if free.len() > 1 => choose(last, free),
                _ => free[0],
            };
            free.retain(|k| *k != edge);
            (at, last) = (edges[edge].1, Some(edge));
            corners.push(at);
        }
        if corners.len() > 1 {
            let is_closed = at == start;
            if is_closed {
                corners.pop();
            }
            lines.push(JoinedLine { corners, is_closed });
        }
    }
    lines
}

/// Returns the indices of the points that a simplified polyline keeps (Ramer 1972; Douglas and Peucker 1973).
///
/// No removed point is farther than `tolerance` from the simplified polyline, which keeps the first and the
/// last point.
pub fn simplified_line<const N: usize>(points: &[SVector<f64, N>], tolerance: f64) -> Vec<usize> {
    let mut keep = vec![false; points.len()];
    let mut parts = vec![(0, points.len().saturating_sub(1))];
    while let Some((first, last)) = parts.pop() {
        let (Some(a), Some(b)) = (points.get(first), points.get(last)) else { continue };
        (keep[first], keep[last]) = (true, true);
        let along = b - a;
        let distance = |p: &SVector<f64, N>| {
            let share = along.dot(&(p - a)) / along.norm_squared().max(f64::MIN_POSITIVE);
            (p - a - along * share.clamp(0.0, 1.0)).norm()
        };
        let inner = (first + 1..last).map(|k| (k, distance(&points[k])));
        let farthest = inner.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = farthest.filter(|(_, distance)| *distance > tolerance) {
            parts.extend([(first, k), (k, last)]);
        }
    }
    (0..points.len()).filter(|k| keep[*k]).collect()
}

/// Returns the low and the high corner of the bounding box; None if there are no points.
pub fn bounding_box(points: impl Iterator<Item = PlanePoint>) -> Option<(PlanePoint, PlanePoint)> {
    let corners = points.map(|p| (p, p));
    corners.reduce(|(lo, hi), (a, b)| ((lo.0.min(a.0), lo.1.min(a.1)), (hi.0.max(b.0), hi.1.max(b.1))))
}
