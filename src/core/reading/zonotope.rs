//! Farthest vertex of a zonotope: `max |sum s_k g_k|` over all signs `s`, exact and with the signs.
//!
//! It is the largest sum of effects if each source may take either end of its tolerance. A vertex is
//! farthest only if its own direction is inside its normal cone. So it suffices to visit every cell that
//! the planes perpendicular to the generators cut out of the sphere of directions:
//!
//! - 2-D: rotate a direction by half a turn; one sign after another flips, in the order of angle;
//! - 3-D: every cell lies beside some great circle, so walk along each circle as in 2-D and take both
//!   sides (`circle_walk`); with parallel axes all generators lie in one plane or along its normal, a
//!   2-D problem;
//! - 4-D to 6-D: branch and bound (`branch_and_bound`).
//!
//! For a few generators all corners are tried at once (`sign_table`). Every candidate is a true corner, so
//! that ties and rounding never invent a maximum. The returned value is summed anew from the returned signs.
//! Squares must neither overflow nor underflow: sizes are between 1e-150 and 1e150.

mod branch_and_bound;
mod circle_walk;
mod sign_table;

use branch_and_bound::BranchAndBound;
use circle_walk::{CircleWalk, split, walk_circles};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use sign_table::{SignTable, try_all};

/// Largest number of generators: a power of two, at least as many as there can be sources.
pub const MAX_GENERATORS: usize = 128;

/// Number of 3-D generators up to which trying all corners beats looking for structure.
const MAX_EXHAUSTIVE: usize = 7;
/// Number of merged 3-D generators up to which trying all corners beats walking along circles.
const MAX_EXHAUSTIVE_MERGED: usize = 11;
/// Sine of the angle below which generators count as parallel.
///
/// Parallel generators take signs that add up, except those that are smaller than this share of the sum.
const PARALLEL_SINE: f64 = 1e-13;
/// Cosine below which directions count as perpendicular.
const PERPENDICULAR: f64 = 1e-14;

/// Working memory, about 20 kB; its content never matters.
#[derive(Default)]
pub struct ZonotopeScratch {
    walk: CircleWalk,
    table: SignTable<3>,
    merged: MergedGenerators<3>,
    branch: BranchAndBound,
    merged_6: MergedGenerators<6>,
}

/// The farthest corner found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// Norm at the corner returned.
    pub value: f64,
    /// Upper bound of the norm at any corner; equal to `value` if that is exact.
    pub upper: f64,
}

/// Returns the farthest corner in 1-D, where all sizes add up, and writes its signs.
pub fn farthest_1(generators: &[f64], signs: &mut [f64]) -> Farthest {
    let first = generators.iter().find(|g| **g != 0.0).map_or(1.0, |g| g.signum());
    let mut value = 0.0;
    for (s, g) in signs.iter_mut().zip(generators) {
        *s = if *g * first < 0.0 { -1.0 } else { 1.0 };
        value += g.abs();
    }
    Farthest { value, upper: value }
}

/// Returns the farthest corner in 2-D by one walk round the zonogon, and writes its signs.
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

/// Returns the farthest corner in 3-D by a walk along each of n great circles, and writes its signs.
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

/// Returns the farthest corner in 4-D to 6-D, padded with zeros, by branch and bound, and writes its signs.
///
/// It is exact except for the hardest cases, which have `upper` above `value`.
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

/// Removes effects of rounding, makes the signs unique and sums anew.
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

/// Flips single signs as long as the sum grows by more than rounding.
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

/// Generators with parallel ones added up, and the map back to the single ones.
struct MergedGenerators<const M: usize> {
    count: usize,
    sum: [SVector<f64, M>; MAX_GENERATORS],
    unit: [SVector<f64, M>; MAX_GENERATORS],
    /// Sum that contains each generator, and the sign of its direction in the sum.
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

    /// Converts signs of the sums to signs of the generators.
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
