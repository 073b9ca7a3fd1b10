//! Search for the signs with which the sum of the generators is longest: a walk around a zonogon in 2-D, and
//! walks along great circles in 3-D.

use super::{MAX_GENERATORS, PERPENDICULAR, climb};
use nalgebra::Vector3;

/// Mask of the low bits of a sort key. These bits hold the index of the generator, so all keys differ.
const PLACES: u64 = MAX_GENERATORS as u64 - 1;

/// Generators in the frame of a circle: x and y in its plane, z along its axis; generators with y < 0 are
/// negated.
pub(super) struct CircleWalk {
    at: [Vector3<f64>; MAX_GENERATORS],
    fold: [f64; MAX_GENERATORS],
    key: [f64; MAX_GENERATORS],
    order: [u8; MAX_GENERATORS],
}

/// Longest sum on a walk.
///
/// `flips` is the number of signs that the walk has flipped when it reaches this sum. `side` is the sign of
/// the component of the sum along the axis of the circle.
pub(super) struct WalkMaximum {
    square: f64,
    flips: usize,
    side: f64,
}

impl Default for CircleWalk {
    fn default() -> Self {
        CircleWalk {
            at: [Vector3::zeros(); MAX_GENERATORS],
            fold: [1.0; MAX_GENERATORS],
            key: [0.0; MAX_GENERATORS],
            order: [0; MAX_GENERATORS],
        }
    }
}

impl CircleWalk {
    #[inline]
    pub(super) fn put(&mut self, k: usize, x: f64, y: f64, z: f64) {
        let fold = if y < 0.0 { -1.0 } else { 1.0 };
        let (x, y, z) = (x * fold, y * fold, z * fold);
        self.at[k] = Vector3::new(x, y, z);
        self.fold[k] = fold;
        // The key is minus the cotangent of the angle at which the sign flips. The key is always finite.
        let key = if (x / y).abs() < f64::MAX { x / y } else { f64::MAX.copysign(x) };
        self.key[k] = f64::from_bits(key.to_bits() & !PLACES | k as u64);
    }

    /// Returns the longest sum of the first `n` generators and an additional generator, over all signs that
    /// the walk visits.
    ///
    /// The additional generator lies along the axis of the circle and has the length `size`. The sign of this
    /// generator is the sign of the axial component of the other generators' sum.
    pub(super) fn farthest(&mut self, n: usize, size: f64) -> WalkMaximum {
        self.sort(n);
        let mut sum: Vector3<f64> = self.at[..n].iter().sum();
        let mut stop = WalkMaximum { square: -1.0, flips: 0, side: 1.0 };
        for (flips, k) in self.order[..n].iter().enumerate() {
            let z = sum.z.abs() + size;
            let square = sum.x * sum.x + sum.y * sum.y + z * z;
            if square > stop.square {
                stop = WalkMaximum { square, flips, side: 1f64.copysign(sum.z) };
            }
            sum -= self.at[usize::from(*k) % MAX_GENERATORS] * 2.0;
        }
        stop
    }

    /// Calls `set` for each of the first `n` generators, with its index and its sign in the sum `stop`. This
    /// sum must come from the latest walk.
    pub(super) fn signs_at(&self, stop: &WalkMaximum, mut set: impl FnMut(usize, f64), n: usize) {
        for (place, k) in self.order[..n].iter().enumerate() {
            let k = usize::from(*k) % MAX_GENERATORS;
            set(k, if place < stop.flips { -self.fold[k] } else { self.fold[k] });
        }
    }

    /// Sorts the keys: the place of a key is the number of smaller keys.
    ///
    /// The sort has no branches, so it is faster than `sort_unstable` for up to 64 keys.
    fn sort(&mut self, n: usize) {
        let keys = &self.key[..n];
        for (k, key) in keys.iter().enumerate() {
            let below: u64 = keys.iter().map(|other| u64::from(other < key)).sum();
            self.order[below as usize % MAX_GENERATORS] = k as u8;
        }
    }
}

/// Finds the signs of the longest sum in 3-D by walks along the great circles of all generators but one.
///
/// The circles cut the sphere of directions into cells, each with one choice of signs. One circle can be left
/// out, because every cell borders on at least two circles.
pub(super) fn walk_circles(generators: &[Vector3<f64>], walk: &mut CircleWalk, corner: &mut [f64]) {
    climb(generators, corner);
    let sum: Vector3<f64> = generators.iter().zip(&*corner).map(|(g, s)| g * *s).sum();
    let mut best = sum.norm_squared();
    for (i, g) in generators.iter().enumerate().skip(1) {
        let size = g.norm();
        let axis = g / size;
        let (e1, e2) = across(&axis);
        for (k, g) in generators[..i].iter().chain(&generators[i + 1..]).enumerate() {
            walk.put(k, g.dot(&e1), g.dot(&e2), g.dot(&axis));
        }
        let n = generators.len() - 1;
        let stop = walk.farthest(n, size);
        if stop.square > best {
            best = stop.square;
            walk.signs_at(&stop, |k, s| corner[k + usize::from(k >= i)] = s, n);
            corner[i] = stop.side;
        }
    }
}

/// Returns two unit vectors perpendicular to a unit vector and to each other.
///
/// The source is T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6 (2017).
fn across(axis: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let sign = 1f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    (
        Vector3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        Vector3::new(b, sign + axis.y * axis.y * a, -axis.y),
    )
}

/// Solves the 3-D case in which every generator is parallel or perpendicular to one axis.
///
/// The signs along the axis and the signs in the plane are found separately. Returns false if there is no
/// such axis.
pub(super) fn split(generators: &[Vector3<f64>], walk: &mut CircleWalk, signs: &mut [f64]) -> bool {
    let Some(axis) = axis(generators) else { return false };
    let (e1, e2) = across(&axis);
    for (k, g) in generators.iter().enumerate() {
        walk.put(k, g.dot(&e1), g.dot(&e2), 0.0);
    }
    let stop = walk.farthest(generators.len(), 0.0);
    walk.signs_at(&stop, |k, s| signs[k] = s, generators.len());
    for (g, s) in generators.iter().zip(signs) {
        if is_along(g, &axis) {
            *s = 1f64.copysign(g.dot(&axis));
        }
    }
    true
}

/// Returns an axis to which every generator is parallel or perpendicular.
///
/// The candidates are the first generator a, the first generator b that is not parallel to a, and the
/// perpendicular to a and b.
fn axis(generators: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let a = generators.iter().find(|g| g.norm_squared() > 0.0)?.normalize();
    let sine = |g: &&Vector3<f64>| a.cross(g).norm_squared() > 0.01 * g.norm_squared();
    let Some(b) = generators.iter().find(sine) else {
        return is_axis(&a, generators).then_some(a);
    };
    let candidates = [a, b.normalize(), a.cross(b).normalize()];
    candidates.into_iter().find(|axis| is_axis(axis, generators))
}

fn is_axis(axis: &Vector3<f64>, generators: &[Vector3<f64>]) -> bool {
    let across = |g: &Vector3<f64>| g.dot(axis).powi(2) <= PERPENDICULAR * PERPENDICULAR * g.norm_squared();
    generators.iter().all(|g| across(g) || is_along(g, axis))
}

fn is_along(g: &Vector3<f64>, axis: &Vector3<f64>) -> bool {
    let rest = g - axis * g.dot(axis);
    rest.norm_squared() <= PERPENDICULAR * PERPENDICULAR * g.norm_squared()
}
