//! The worst case: the corner of the tolerance box with the largest error in a sense.

use super::MAX_SOURCES;
use super::zonotope::{Farthest, Scratch, farthest_1, farthest_2, farthest_3, farthest_6};
use nalgebra::{Vector2, Vector3, Vector6};

/// Rounds of the polish at most; it ends when no flip is better.
const ROUNDS: usize = 4;

/// The largest error in a sense over the tolerance box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstCase {
    /// By the linear model: the exact maximum (a proven upper bound if `exact` is false, which
    /// takes a sense of more than three rows and very many sources).
    pub linear: f64,
    pub exact: bool,
    /// By the chosen model: its error at the best corner found from the linear one.
    pub by_model: f64,
    /// The corner of `by_model`, one sign per source.
    pub corner: [f64; MAX_SOURCES],
}

/// The farthest vertex of the zonotope of `columns` (sources at their tolerance) in `rows` rows;
/// its signs go to `corner`.
pub fn farthest(
    columns: &[Vector6<f64>],
    rows: usize,
    scratch: &mut Scratch,
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

/// The same by a model whose error at a corner is `error`: from the linear corner and its opposite
/// (even orders tell them apart), flipping those signs that matter less than the models differ.
pub fn by_model(
    columns: &[Vector6<f64>],
    linear: &Farthest,
    corner: [f64; MAX_SOURCES],
    mut error: impl FnMut(&[f64; MAX_SOURCES]) -> f64,
) -> WorstCase {
    let opposite = corner.map(|s| -s);
    let (mut best, mut corner) = (error(&corner), corner);
    let other = error(&opposite);
    if other > best {
        (best, corner) = (other, opposite);
    }
    let gap = 2.0 * (best - linear.value).abs();
    let sum: Vector6<f64> = columns.iter().zip(&corner).map(|(c, s)| c * *s).sum();
    for _ in 0..ROUNDS {
        let mut improved = false;
        for (k, column) in columns.iter().enumerate() {
            let loss = sum.norm() - (sum - column * (2.0 * corner[k])).norm();
            if loss.abs() <= gap {
                corner[k] = -corner[k];
                let flipped = error(&corner);
                if flipped > best {
                    (best, improved) = (flipped, true);
                } else {
                    corner[k] = -corner[k];
                }
            }
        }
        if !improved {
            break;
        }
    }
    let exact = linear.upper <= linear.value;
    WorstCase { linear: linear.upper.max(linear.value), exact, by_model: best, corner }
}
