//! The farthest vertex of a zonotope: how far a sum of effects reaches when each may take either
//! end of its tolerance, `max |sum s_k g_k|` over all signs `s`. Exact, with the signs.
//!
//! A vertex is farthest only if its own direction is inside its normal cone, so it is enough to
//! visit every cell that the planes perpendicular to the generators cut out of the directions:
//!
//! - 2-D: turn a direction by half a turn; one sign after another flips, in the order of angle;
//! - 3-D: every cell lies beside some great circle, so walk along each as in 2-D and take both
//!   sides. Arms whose axes are parallel split into a plane and its normal, a 2-D problem;
//! - more: branch and bound, see `branch.rs`.
//!
//! Few generators are tried in all corners at once, `table.rs`. Every candidate is a true corner, so
//! ties and rounding never invent a maximum, and its value is summed anew from the signs returned.
//! Squares must not overflow or vanish: sizes between 1e-150 and 1e150.

mod branch_and_bound;
mod circle_walk;
mod sign_table;

use branch_and_bound::BranchAndBound;
use circle_walk::{CircleWalk, split, walk_circles};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use sign_table::{SignTable, try_all};

/// Most generators, a power of two: at least as many as there can be sources.
pub const MAX_GENERATORS: usize = 128;

/// Up to this many in 3-D, trying all corners beats looking for structure and walking.
const FEW: usize = 7;
/// And beats walking once structure was looked for.
const SOME: usize = 11;
/// Sine of the angle below which generators count as parallel. They then take signs that add up,
/// unless they are smaller than this part of the sum.
const PARALLEL: f64 = 1e-13;
/// Cosine below which directions count as perpendicular.
const PERPENDICULAR: f64 = 1e-14;

/// Working memory, about 20 kB; what is left in it never matters.
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
    /// The norm at the corner returned.
    pub value: f64,
    /// No corner is farther; equal to `value` when that is exact.
    pub upper: f64,
}

/// 1-D: everything adds up.
pub fn farthest_1(generators: &[f64], signs: &mut [f64]) -> Farthest {
    let first = generators.iter().find(|g| **g != 0.0).map_or(1.0, |g| g.signum());
    let mut value = 0.0;
    for (s, g) in signs.iter_mut().zip(generators) {
        *s = if *g * first < 0.0 { -1.0 } else { 1.0 };
        value += g.abs();
    }
    Farthest { value, upper: value }
}

/// 2-D: one walk round the zonogon.
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

/// 3-D: a walk along each of n circles.
pub fn farthest_3(generators: &[Vector3<f64>], scratch: &mut ZonotopeScratch, signs: &mut [f64]) -> Farthest {
    let n = generators.len().min(MAX_GENERATORS);
    let (generators, signs) = (&generators[..n], &mut signs[..n]);
    if n <= FEW {
        try_all(generators, &mut scratch.table, signs);
    } else if !split(generators, &mut scratch.walk, signs) {
        let mut corner = [1.0; MAX_GENERATORS];
        scratch.merged.merge(generators);
        let merged = scratch.merged.sums();
        if merged.len() <= SOME {
            try_all(merged, &mut scratch.table, &mut corner);
        } else {
            walk_circles(merged, &mut scratch.walk, &mut corner);
        }
        scratch.merged.spread(&corner, signs);
    }
    exact(generators, signs)
}

/// 4 to 6 dimensions, padded with zeros: branch and bound. Exact but for the hardest cases, which
/// say so by `upper` above `value`.
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

/// Mends what rounding may have left, makes the signs unique and sums anew.
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

/// Flips single signs as long as that gains more than rounding.
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

/// Generators with the parallel ones added up, and the way back.
struct MergedGenerators<const M: usize> {
    count: usize,
    sum: [SVector<f64, M>; MAX_GENERATORS],
    unit: [SVector<f64, M>; MAX_GENERATORS],
    /// Of each generator: where it went, and whether turned round.
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

    /// From signs of the sums to signs of the generators.
    fn spread(&self, corner: &[f64], signs: &mut [f64]) {
        for (s, (at, turn)) in signs.iter_mut().zip(self.place) {
            *s = corner[at] * turn;
        }
    }
}

fn parallel<const M: usize>(a: &SVector<f64, M>, b: &SVector<f64, M>) -> bool {
    let cos = a.dot(b);
    cos * cos > 0.999 && (a - b * cos).norm_squared() < PARALLEL * PARALLEL
}
