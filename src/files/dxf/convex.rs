//! Convex parts of a polygon: ear clipping, then removal of diagonals between parts whose union is convex.
//!
//! Every corner of a part is a corner of the polygon. The parts do not overlap, and their union is the
//! polygon. The removal of diagonals leaves at most four times the least possible number of parts (S. Hertel
//! and K. Mehlhorn, Fast triangulation of simple polygons, FCT 1983).

use crate::geometry::{PlanePoint, turn};

/// Returns the convex parts, all anticlockwise, of an anticlockwise polygon that does not cross itself.
/// Returns None if rounding errors prevent the division.
pub fn convex_parts(corners: &[PlanePoint]) -> Option<Vec<Vec<PlanePoint>>> {
    let mut parts = triangles(corners)?;
    let mut k = 0;
    while k < parts.len() {
        let joined = (k + 1..parts.len()).find_map(|j| Some((j, joined(corners, &parts[k], &parts[j])?)));
        match joined {
            Some((j, part)) => {
                parts[k] = part;
                parts.swap_remove(j);
            }
            None => k += 1,
        }
    }
    let point = |part: Vec<usize>| part.into_iter().map(|i| corners[i]).collect();
    Some(parts.into_iter().map(point).collect())
}

/// Returns the triangles of an ear clipping, as indices of corners; None if rounding errors leave no ear.
fn triangles(corners: &[PlanePoint]) -> Option<Vec<Vec<usize>>> {
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut parts = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        let ear = (0..n).find(|&k| {
            let [a, b, c] = [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
            let is_empty =
                || left.iter().all(|i| [a, b, c].contains(i) || !is_within(corners, [a, b, c], *i));
            turn(corners[a], corners[b], corners[c]) > 0.0 && is_empty()
        })?;
        parts.push(vec![left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
        left.remove(ear);
    }
    parts.push(left);
    Some(parts)
}

/// Returns whether a corner lies within a triangle or on its edge.
fn is_within(corners: &[PlanePoint], [a, b, c]: [usize; 3], p: usize) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|(i, j)| turn(corners[*i], corners[*j], corners[p]) >= 0.0)
}

/// Returns the union of two parts that share an edge; None if the parts share no edge, or if the union is not
/// convex.
fn joined(corners: &[PlanePoint], first: &[usize], second: &[usize]) -> Option<Vec<usize>> {
    let next = |part: &[usize], k: usize| part[(k + 1) % part.len()];
    let shared = |k: &usize| {
        let at = second.iter().position(|i| *i == next(first, *k))?;
        (next(second, at) == first[*k]).then_some(at)
    };
    let (k, at) = (0..first.len()).find_map(|k| Some((k, shared(&k)?)))?;
    // The union runs from the end of the shared edge around the first part. Then the union runs around the
    // second part without the ends of the edge.
    let round = (0..first.len()).map(|i| first[(k + 1 + i) % first.len()]);
    let rest = (2..second.len()).map(|i| second[(at + i) % second.len()]);
    let whole: Vec<usize> = round.chain(rest).collect();
    let n = whole.len();
    let is_left = |k: usize| {
        let [a, b, c] = [whole[k], whole[(k + 1) % n], whole[(k + 2) % n]].map(|i| corners[i]);
        turn(a, b, c) >= 0.0
    };
    (0..n).all(is_left).then_some(whole)
}
