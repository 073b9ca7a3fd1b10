//! Farthest vertex of a zonotope: the exact `max |sum s_k g_k|` over all signs `s`, and the maximizing signs.
//!
//! The vectors `g_k` are the generators, and a choice of signs is a corner.
//!
//! The maximum is the largest norm that the sum of all effects can have if each source is at one end of its
//! tolerance. If a vertex is farthest, the direction from the origin to this vertex lies in the normal cone
//! of the vertex. The planes perpendicular to the generators cut the sphere of directions into cells, one per
//! vertex. So it suffices to visit every cell:
//!
//! - 2-D: a direction is rotated through half a turn. Whenever it is perpendicular to a generator, the sign
//!   of this generator flips.
//! - 3-D: the planes cut the sphere in great circles, and every cell borders on a circle. A walk along each
//!   circle, as in 2-D, visits the cells on both sides (`circle_walk`). If all joint axes are parallel, every
//!   generator lies in one plane or along its normal. Then a 2-D walk in this plane suffices.
//! - 4-D to 6-D: branch and bound (`branch_and_bound`).
//!
//! If there are only a few generators, all corners are tried (`sign_table`). Every candidate is a true
//! corner, so ties and rounding never produce a false maximum. The returned value is computed from the
//! returned signs. Squares must neither overflow nor underflow: the norms of the generators must be
//! between 1e-150 and 1e150.

mod branch_and_bound;
mod circle_walk;
mod far_vertex;
mod sign_table;

use branch_and_bound::BranchAndBound;
use circle_walk::{CircleWalk, split, walk_circles};
pub use far_vertex::far_vertex;
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use sign_table::{SignTable, try_all};

/// Largest number of generators: a power of two, not less than the largest number of error sources.
pub const MAX_GENERATORS: usize = 128;

/// Largest number of 3-D generators for which it is faster to try all signs than to look for parallel
/// generators.
const MAX_EXHAUSTIVE: usize = 7;
/// Largest number of 3-D generators for which it is faster to try all signs than to walk along circles. A
/// group of parallel generators counts as one generator.
const MAX_EXHAUSTIVE_MERGED: usize = 11;
/// Generators count as parallel if the sine of their angle is below this value.
///
/// The signs of parallel generators are chosen so that their sizes add up. A generator smaller than
/// `PARALLEL_SINE` times the sum may get the opposite sign.
const PARALLEL_SINE: f64 = 1e-13;
/// Cosine below which directions count as perpendicular.
const PERPENDICULAR: f64 = 1e-14;

/// Working memory of the functions `farthest_2` to `farthest_6`; its content does not affect results.
///
/// Each part is a [`Box`] with tens of kilobytes on the heap, so a move of this value copies only pointers.
#[derive(Default)]
pub struct ZonotopeScratch {
    walk: Box<CircleWalk>,
    table: Box<SignTable<3>>,
    merged: Box<MergedGenerators<3>>,
    branch: Box<BranchAndBound>,
    merged_6: Box<MergedGenerators<6>>,
}

/// Result of the maximization of `|sum s_k g_k|` over all signs `s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// Norm of `sum s_k g_k` with the returned signs.
    pub value: f64,
    /// Upper bound of the norm of `sum s_k g_k` over all signs `s`; equal to `value` if `value` is the exact
    /// maximum.
    pub upper: f64,
}

/// Maximizes `|sum s_k g_k|` over the signs `s` in 1-D, and writes the signs. The maximum is the sum of all
/// `|g_k|`.
pub fn farthest_1(generators: &[f64], signs: &mut [f64]) -> Farthest {
    let first = generators.iter().find(|g| **g != 0.0).map_or(1.0, |g| g.signum());
    let mut value = 0.0;
    for (s, g) in signs.iter_mut().zip(generators) {
        *s = if *g * first < 0.0 { -1.0 } else { 1.0 };
        value += g.abs();
    }
    Farthest { value, upper: value }
}

/// Maximizes `|sum s_k g_k|` over the signs `s` in 2-D by one walk around the zonotope, and writes the signs.
pub fn farthest_2(generators: &[Vector2<f64>], scratch: &mut ZonotopeScratch, signs: &mut [f64]) -> Farthest {
    let n = generators.len().min(MAX_GENERATORS);
    let (generators, signs) = (&generators[..n], &mut signs[..n]);
    let walk = &mut scratch.walk;
    for (k, g) in generators.iter().enumerate() {
        walk.put(k, g.x, g.y, 0.0);
    }
    let stop = walk.farthest(n, 0.0);
    walk.signs_at(&stop, |k, s| signs[k] = s, n);
    exact(generators, signs)
}

/// Maximizes `|sum s_k g_k|` over the signs `s` in 3-D by walks along great circles, and writes the signs.
///
/// Each circle of directions is perpendicular to a generator. If there are only a few generators, all signs
/// are tried instead.
pub fn farthest_3(generators: &[Vector3<f64>], scratch: &mut ZonotopeScratch, signs: &mut [f64]) -> Farthest {
    let n = generators.len().min(MAX_GENERATORS);
    let (generators, signs) = (&generators[..n], &mut signs[..n]);
    if n <= MAX_EXHAUSTIVE {
        try_all(generators, &mut scratch.table, signs);
    } else if !split(generators, &mut scratch.walk, signs) {
        let mut corner = [1.0; MAX_GENERATORS];
        scratch.merged.merge(generators);
        let merged = scratch.merged.sums();
        if merged.len() <= MAX_EXHAUSTIVE_MERGED {
            try_all(merged, &mut scratch.table, &mut corner);
        } else {
            walk_circles(merged, &mut scratch.walk, &mut corner);
        }
        scratch.merged.spread(&corner, signs);
    }
    exact(generators, signs)
}

/// Maximizes `|sum s_k g_k|` over the signs `s` in 4-D to 6-D by branch and bound, and writes the signs.
///
/// Unused components of the generators `g_k` must be zero.
///
/// The result is exact except in the hardest cases, in which `upper` is greater than `value`.
pub fn farthest_6(generators: &[Vector6<f64>], scratch: &mut ZonotopeScratch, signs: &mut [f64]) -> Farthest {
    let n = generators.len().min(MAX_GENERATORS);
    let (generators, signs) = (&generators[..n], &mut signs[..n]);
    let mut corner = [1.0; MAX_GENERATORS];
    scratch.merged_6.merge(generators);
    let upper = scratch.branch.farthest(scratch.merged_6.sums(), &mut corner);
    scratch.merged_6.spread(&corner, signs);
    let found = exact(generators, signs);
    Farthest { upper: upper.map_or(found.value, |u| u.max(found.value)), ..found }
}

/// Improves the signs by single flips, normalizes the signs, and returns the norm of the sum with these
/// signs.
///
/// Reversing all signs does not change the norm of the sum. Normalized signs are +1 for the first generator
/// that is not zero, and for all zero generators.
fn exact<const M: usize>(generators: &[SVector<f64, M>], signs: &mut [f64]) -> Farthest {
    climb(generators, signs);
    let zero = SVector::zeros();
    let first = generators.iter().position(|g| *g != zero).map_or(1.0, |k| signs[k]);
    let mut sum = zero;
    for (g, s) in generators.iter().zip(signs) {
        *s = if *g == zero { 1.0 } else { *s * first };
        sum += g * *s;
    }
    let value = sum.norm();
    Farthest { value, upper: value }
}

/// Flips single signs as long as a flip increases the norm of the sum by more than a rounding error.
fn climb<const M: usize>(generators: &[SVector<f64, M>], signs: &mut [f64]) {
    let mut sum = SVector::<f64, M>::zeros();
    for (g, s) in generators.iter().zip(&*signs) {
        sum += g * *s;
    }
    let mut steady = 0;
    for (k, g) in generators.iter().enumerate().cycle().take(16 * generators.len()) {
        // |sum - 2 s g|^2 = |sum|^2 + 4 (|g|^2 - s g . sum)
        if g.norm_squared() - signs[k] * g.dot(&sum) > 1e-15 * sum.norm_squared() {
            sum -= g * (2.0 * signs[k]);
            signs[k] = -signs[k];
            steady = 0;
        } else {
            steady += 1;
        }
        if steady == generators.len() {
            return;
        }
    }
}

/// Sums of parallel generators, and the map from each generator to the sum that contains it.
struct MergedGenerators<const M: usize> {
    count: usize,
    sum: [SVector<f64, M>; MAX_GENERATORS],
    unit: [SVector<f64, M>; MAX_GENERATORS],
    /// Index of the sum that contains each generator, and the sign with which the generator enters this sum.
    place: [(usize, f64); MAX_GENERATORS],
}

impl<const M: usize> Default for MergedGenerators<M> {
    fn default() -> Self {
        let zeros = [SVector::zeros(); MAX_GENERATORS];
        MergedGenerators { count: 0, sum: zeros, unit: zeros, place: [(0, 1.0); MAX_GENERATORS] }
    }
}

impl<const M: usize> MergedGenerators<M> {
    fn sums(&self) -> &[SVector<f64, M>] {
        &self.sum[..self.count]
    }

    fn merge(&mut self, generators: &[SVector<f64, M>]) {
        self.count = 0;
        for (k, g) in generators.iter().enumerate() {
            let size = g.norm();
            self.place[k] = (0, 1.0);
            if size == 0.0 {
                continue;
            }
            let unit = g / size;
            let parallel = self.unit[..self.count].iter().position(|u| parallel(u, &unit));
            let at = parallel.unwrap_or(self.count);
            if parallel.is_none() {
                (self.unit[at], self.sum[at]) = (unit, *g);
                self.count += 1;
                self.place[k] = (at, 1.0);
            } else {
                let turn = if unit.dot(&self.unit[at]) < 0.0 { -1.0 } else { 1.0 };
                self.sum[at] += g * turn;
                self.place[k] = (at, turn);
            }
        }
    }

    /// Converts `corner`, one sign per sum of parallel generators, to one sign per generator.
    fn spread(&self, corner: &[f64], signs: &mut [f64]) {
        for (s, (at, turn)) in signs.iter_mut().zip(self.place) {
            *s = corner[at] * turn;
        }
    }
}

fn parallel<const M: usize>(a: &SVector<f64, M>, b: &SVector<f64, M>) -> bool {
    let cos = a.dot(b);
    cos * cos > 0.999 && (a - b * cos).norm_squared() < PARALLEL_SINE * PARALLEL_SINE
}
