//! Worst-case tolerance analysis: the corner of the tolerance box where the size of the error in a sense is
//! largest.

use super::MAX_SOURCES;
use super::zonotope::{Farthest, ZonotopeScratch, farthest_1, farthest_2, farthest_3, farthest_6};
use nalgebra::{Vector2, Vector3, Vector6};

/// Largest number of rounds of the local search, which ends earlier if no flip of a sign increases the error.
const MAX_ROUNDS: usize = 12;

/// Largest size of the error in a sense over the tolerance box, m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstCase {
    /// Maximum by the linear model, or a proven upper bound if `exact` is false.
    pub linear: f64,
    /// Whether `linear` is the exact maximum. If the error has more than three components in the sense and
    /// there are very many sources, `linear` may be an upper bound.
    pub exact: bool,
    /// Largest error by the chosen model that the local search finds; equal to `linear` for the linear model.
    pub by_model: f64,
    /// Corner of the tolerance box with the error `by_model`, one sign per source.
    pub corner: [f64; MAX_SOURCES],
}

/// Returns the maximum of `|sum_k s_k g_k|` over all signs `s`, and writes the maximizing signs to `corner`.
///
/// The `g_k` are the first `rows` components of `columns`: the effects of the sources at their tolerances.
/// The maximum is the farthest vertex of a zonotope.
pub fn farthest(
    columns: &[Vector6<f64>],
    rows: usize,
    scratch: &mut ZonotopeScratch,
    corner: &mut [f64],
) -> Farthest {
    let n = columns.len();
    match rows {
        0 | 1 => {
            let mut flat = [0.0; MAX_SOURCES];
            flat.iter_mut().zip(columns).for_each(|(f, c)| *f = c[0]);
            farthest_1(&flat[..n], corner)
        }
        2 => {
            let mut flat = [Vector2::zeros(); MAX_SOURCES];
            flat.iter_mut().zip(columns).for_each(|(f, c)| *f = Vector2::new(c[0], c[1]));
            farthest_2(&flat[..n], scratch, corner)
        }
        3 => {
            let mut flat = [Vector3::zeros(); MAX_SOURCES];
            flat.iter_mut().zip(columns).for_each(|(f, c)| *f = Vector3::new(c[0], c[1], c[2]));
            farthest_3(&flat[..n], scratch, corner)
        }
        _ => farthest_6(columns, scratch, corner),
    }
}

/// Share of the linear worst case. A flip is always tried if it changes the linear error by no more than this
/// share.
const NEAR_SHARE: f64 = 0.02;

/// Largest number of sources whose signs are tried in every combination.
const MAX_EXHAUSTIVE: usize = 8;

/// Sine of the angle below which columns count as parallel and are flipped as one group in the local search.
const PARALLEL_SINE: f64 = 1e-6;

/// Returns the worst case by a model; `error` returns the error by this model at a corner of the tolerance
/// box.
///
/// A local search starts from two corners: `corner`, the worst by the linear model, and the opposite corner.
/// The sizes of the errors at these two corners differ only by terms of even order. The search flips signs:
/// one alone, or those of all parallel columns together. A flip is tried only if it changes the linear error
/// by no more than a threshold. The threshold is the largest of three values:
///
/// - `quadratic`, the size of the second-order terms;
/// - the share `NEAR_SHARE` of the linear worst case;
/// - twice the largest difference between the linear worst case and the error by the model at the two
///   corners.
///
/// Flips of all parallel columns together are needed, for example, on a planar arm, whose lateral effects are
/// perpendicular to all other effects. So the worst linear corners come in pairs, and no single flip leads
/// from one corner of a pair to the other.
///
/// `largest` holds two corners: those with the largest displacement and the largest rotation of the TCP. A
/// source is weak if a flip of its sign can change the linear error by at most the threshold. If more than
/// `MAX_EXHAUSTIVE` sources are weak, the search also starts from mixed corners. A mixed corner takes the
/// signs of the weak sources from a corner in `largest`, and all other signs from `corner`. All signs of the
/// weak sources, or all signs of the other sources, or both may be reversed.
pub fn by_model(
    columns: &[Vector6<f64>],
    linear: &Farthest,
    quadratic: f64,
    largest: &[[f64; MAX_SOURCES]],
    corner: [f64; MAX_SOURCES],
    mut error: impl FnMut(&[f64; MAX_SOURCES]) -> f64,
) -> WorstCase {
    let both = |corner: [f64; MAX_SOURCES]| [corner, corner.map(|s| -s)];
    let starts = both(corner).map(|corner| (error(&corner), corner));
    let apart = starts.iter().map(|(e, _)| (e - linear.value).abs()).fold(0.0, f64::max);
    let gap = (2.0 * apart).max(NEAR_SHARE * linear.value).max(quadratic);
    let groups = groups(columns);
    let (mut best, mut at) = (f64::NEG_INFINITY, corner);
    let mut polish = |start: (f64, [f64; MAX_SOURCES]), error: &mut dyn FnMut(&[f64; MAX_SOURCES]) -> f64| {
        let (value, corner) = polished(columns, &groups[..columns.len()], gap, start, error);
        if value > best {
            (best, at) = (value, corner);
        }
    };
    // Sources with hardly any linear effect act through products of errors. A few such sources are tried in
    // every combination of signs. Many take their signs from the corners in `largest`.
    let unseen = |k: usize| 2.0 * columns[k].norm() <= gap;
    let count = (0..columns.len()).filter(|&k| unseen(k)).count();
    if (1..=MAX_EXHAUSTIVE).contains(&count) {
        for mut tried in both(corner) {
            let mut start = (error(&tried), tried);
            for step in 1u32..1 << count {
                let flip = (0..columns.len()).filter(|&k| unseen(k)).nth(step.trailing_zeros() as usize);
                flip.into_iter().for_each(|k| tried[k] = -tried[k]);
                let value = error(&tried);
                if value > start.0 {
                    start = (value, tried);
                }
            }
            polish(start, &mut error);
        }
    } else {
        starts.into_iter().for_each(|start| polish(start, &mut error));
    }
    if count > MAX_EXHAUSTIVE {
        for mut start in largest.iter().flat_map(|l| both(*l)) {
            (0..columns.len()).filter(|&k| !unseen(k)).for_each(|k| start[k] = corner[k]);
            for start in both(start) {
                polish((error(&start), start), &mut error);
            }
        }
    }
    let exact = linear.upper <= linear.value;
    WorstCase { linear: linear.upper.max(linear.value), exact, by_model: best, corner: at }
}

/// Returns, for every column, a bit set of the later columns that are parallel to it.
///
/// The set of a column is empty if an earlier column is parallel to this column.
fn groups(columns: &[Vector6<f64>]) -> [u128; MAX_SOURCES] {
    let mut groups = [0; MAX_SOURCES];
    let mut taken = 0u128;
    for (k, column) in columns.iter().enumerate().filter(|(_, c)| **c != Vector6::zeros()) {
        if taken >> k & 1 == 0 {
            let after = columns.iter().enumerate().skip(k + 1);
            groups[k] = after.filter(|(_, c)| parallel(c, column)).fold(0, |bits, (j, _)| bits | 1 << j);
            taken |= groups[k];
        }
    }
    groups
}

/// Corner of the tolerance box that the local search has reached.
struct SearchCorner {
    /// Size of the error by the model at this corner.
    value: f64,
    signs: [f64; MAX_SOURCES],
    /// Linear error at this corner: the sum of the columns multiplied by `signs`.
    sum: Vector6<f64>,
}

/// Returns the largest error that the local search reaches from `start`, and the corner with this error.
///
/// The search flips single signs and groups of parallel columns. If no such flip increases the error, it
/// flips pairs of signs.
fn polished(
    columns: &[Vector6<f64>],
    groups: &[u128],
    gap: f64,
    start: (f64, [f64; MAX_SOURCES]),
    error: &mut dyn FnMut(&[f64; MAX_SOURCES]) -> f64,
) -> (f64, [f64; MAX_SOURCES]) {
    let (value, signs) = start;
    let sum: Vector6<f64> = columns.iter().zip(&signs).map(|(c, s)| c * *s).sum();
    let mut best = SearchCorner { value, signs, sum };
    for _ in 0..MAX_ROUNDS {
        let before = best.value;
        for (k, group) in groups.iter().enumerate() {
            // A column without parallel ones has no group to flip.
            for others in [Some(0), Some(*group).filter(|g| *g != 0)].into_iter().flatten() {
                let members = |bits: u128| (0..columns.len()).filter(move |&j| j == k || bits >> j & 1 == 1);
                let change: Vector6<f64> = members(others).map(|j| columns[j] * (-2.0 * best.signs[j])).sum();
                if ((best.sum + change).norm() - best.sum.norm()).abs() > gap {
                    continue;
                }
                members(others).for_each(|j| best.signs[j] = -best.signs[j]);
                let value = error(&best.signs);
                if value > best.value {
                    (best.value, best.sum) = (value, best.sum + change);
                } else {
                    members(others).for_each(|j| best.signs[j] = -best.signs[j]);
                }
            }
        }
        if best.value <= before && !flip_pair(columns, gap, &mut best, error) {
            break;
        }
    }
    (best.value, best.signs)
}

/// Flips the first pair of signs that increases the error and changes the linear error by at most `gap`.
///
/// Pairs matter because products of errors may dominate if the linear effects are small. Returns false if
/// there is no such pair.
fn flip_pair(
    columns: &[Vector6<f64>],
    gap: f64,
    best: &mut SearchCorner,
    error: &mut dyn FnMut(&[f64; MAX_SOURCES]) -> f64,
) -> bool {
    let SearchCorner { value, signs, sum } = best;
    let size = sum.norm();
    for j in 0..columns.len() {
        let first = *sum + columns[j] * (-2.0 * signs[j]);
        for k in j + 1..columns.len() {
            let both = first + columns[k] * (-2.0 * signs[k]);
            if (both.norm() - size).abs() > gap {
                continue;
            }
            (signs[j], signs[k]) = (-signs[j], -signs[k]);
            let tried = error(signs);
            if tried > *value {
                (*value, *sum) = (tried, both);
                return true;
            }
            (signs[j], signs[k]) = (-signs[j], -signs[k]);
        }
    }
    false
}

fn parallel(a: &Vector6<f64>, b: &Vector6<f64>) -> bool {
    let product = a.dot(b);
    a.norm_squared() * b.norm_squared() - product * product
        <= PARALLEL_SINE * PARALLEL_SINE * product * product
}
