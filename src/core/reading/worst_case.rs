//! Worst-case tolerance analysis: the corner of the tolerance box where the size of the error in a sense is
//! largest.

use super::MAX_SOURCES;
use super::corner::ToleranceCorner;
use super::zonotope::{Farthest, ZonotopeScratch, farthest_1, farthest_2, farthest_3, farthest_6};
use nalgebra::{Vector2, Vector3, Vector6};

/// Largest size of the error in a [sense](crate::cell::Sense) over the tolerance box, m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstCase {
    /// Maximum by the linear model, or a proven upper bound if `exact` is false.
    pub linear: f64,
    /// Whether `linear` is the exact maximum. If the sense of the operation measures more than three
    /// components of the error and there are very many sources, `linear` may be an upper bound.
    pub exact: bool,
    /// Largest error by the chosen model, found by a local search over the corners of the tolerance box. For
    /// the linear model, this value equals `linear`.
    pub by_model: f64,
    /// Corner of the tolerance box where the largest error was found.
    pub corner: ToleranceCorner,
}

/// Returns the maximum of `|sum_k s_k g_k|` over all signs `s`, and writes the maximizing signs to `corner`.
///
/// Column k of `columns` is the effect of source k at its tolerance. The vector `g_k` holds the first `rows`
/// components of this column.
///
/// The maximum is the distance from the origin to the farthest vertex of a zonotope.
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
