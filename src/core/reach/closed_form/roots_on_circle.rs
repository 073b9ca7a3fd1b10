//! Roots of several functions of one angle, each of which exists on a part of the circle only.
//!
//! The circle is scanned at equidistant angles. Between two neighbouring angles, a function has a root where its
//! sign changes. A parabola through three neighbouring values shows where two roots may lie between two angles.
//! Where a function begins or ends, the interval is halved until the end is known. Functions that end together
//! meet there, so a root between the two last known values is too near to the end to matter.

use super::positioning_arm::PositioningArm;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Number of functions.
const COUNT: usize = PositioningArm::BRANCHES;
/// Number of angles at which the circle is scanned.
const ANGLES: usize = 96;
/// Largest number of roots.
pub(super) const MAX_ROOTS: usize = 16;
/// Width of an interval, rad, below which the end of a function is not located more precisely.
const LEAST_WIDTH: f64 = 1e-10;
/// Largest value at an accepted root.
const ACCURACY: f64 = 1e-9;
/// Largest number of steps to a root; each step at least halves the interval in the long run.
const STEPS: usize = 60;
/// Largest number of steps towards the least absolute value between two roots.
const VERTEX_STEPS: usize = 6;

/// Values of the functions at one angle; NaN where a function does not exist.
pub(super) type CircleValues = [f64; COUNT];

/// One root: the index of the function, and the angle, rad.
pub(super) type CircleRoot = (usize, f64);

/// Roots found so far.
pub(super) struct CircleRoots {
    all: [CircleRoot; MAX_ROOTS],
    count: usize,
}

/// Angle and values of the functions there.
type Sample = (f64, CircleValues);

/// Share of the value at the middle angle. If the vertex of the parabola is above this share, no root is
/// expected there.
const MIN_DIP: f64 = 0.7;

/// Cosine and sine of every angle of the scan.
static SCAN: LazyLock<[(f64, (f64, f64)); ANGLES]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let angle = TAU * k as f64 / ANGLES as f64;
        (angle, (angle.cos(), angle.sin()))
    })
});

impl CircleRoots {
    /// Returns all roots of the functions that `values` computes from the cosine and the sine of an angle.
    ///
    /// The roots are in ascending order of the angles of their intervals. The second result is the least absolute
    /// value that the scan met; it is infinite if no function exists anywhere.
    pub fn new(mut values: impl FnMut((f64, f64)) -> CircleValues) -> (Self, f64) {
        let mut scan = [(0.0, [f64::NAN; COUNT]); ANGLES + 2];
        let mut least = f64::INFINITY;
        for (sample, (angle, turn)) in scan.iter_mut().zip(SCAN.iter()) {
            *sample = (*angle, values(*turn));
            least = sample.1.iter().fold(least, |least, value| least.min(value.abs()));
        }
        for k in 0..2 {
            scan[ANGLES + k] = (scan[k].0 + TAU, scan[k].1);
        }
        let mut roots = Self { all: [(0, 0.0); MAX_ROOTS], count: 0 };
        let mut at = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            values((cos, sin))
        };
        for k in 0..ANGLES {
            roots.between(&mut at, &scan[k], &scan[k + 1]);
            roots.around(&mut at, &scan[k..k + 3]);
        }
        (roots, least)
    }

    /// Returns the roots.
    pub fn all(&self) -> &[CircleRoot] {
        &self.all[..self.count]
    }

    /// Adds the roots at which functions change their signs between two angles.
    fn between(&mut self, at: &mut impl FnMut(f64) -> CircleValues, low: &Sample, high: &Sample) {
        let differs = |k: usize| low.1[k].is_nan() != high.1[k].is_nan();
        if (0..COUNT).any(differs) {
            if high.0 - low.0 > LEAST_WIDTH {
                let angle = (low.0 + high.0) / 2.0;
                let middle = (angle, at(angle));
                self.between(at, low, &middle);
                self.between(at, &middle, high);
            }
            return;
        }
        for k in (0..COUNT).filter(|&k| low.1[k] * high.1[k] < 0.0 || low.1[k] == 0.0) {
            self.locate(at, k, (low.0, low.1[k]), (high.0, high.1[k]));
        }
    }

    /// Adds pairs of roots about the middle one of three neighbouring angles, where the absolute value of a
    /// function has a local minimum but the function does not change its sign.
    fn around(&mut self, at: &mut impl FnMut(f64) -> CircleValues, scan: &[Sample]) {
        let [low, middle, high] = scan else { return };
        for k in 0..COUNT {
            let mut known = [low, middle, high].map(|sample| (sample.0, sample.1[k]));
            let sign = known[1].1.signum();
            let dips = known.map(|(_, value)| value * sign);
            if !(dips[0] > dips[1] && dips[2] >= dips[1] && dips[1] > 0.0) {
                continue;
            }
            for _ in 0..VERTEX_STEPS {
                let Some((angle, depth)) = vertex(&known) else { break };
                if depth * sign > MIN_DIP * known[1].1 * sign {
                    break;
                }
                let value = at(angle)[k];
                if value.is_nan() {
                    break;
                }
                if value * sign <= 0.0 {
                    let (below, above) =
                        if angle < known[1].0 { (known[0], known[1]) } else { (known[1], known[2]) };
                    self.locate(at, k, below, (angle, value));
                    self.locate(at, k, (angle, value), above);
                    break;
                }
                known = match (angle < known[1].0, value * sign < known[1].1 * sign) {
                    (true, true) => [known[0], (angle, value), known[1]],
                    (true, false) => [(angle, value), known[1], known[2]],
                    (false, true) => [known[1], (angle, value), known[2]],
                    (false, false) => [known[0], known[1], (angle, value)],
                };
            }
        }
    }

    /// Adds the root of one function in an interval at whose ends the function has different signs.
    ///
    /// The method is the false position of Anderson and Bjorck, with a bisection after three slow steps (N. Anderson,
    /// A. Bjorck, "A new high order method of regula falsi type for computing a root of an equation", BIT 13, 1973).
    fn locate(
        &mut self,
        at: &mut impl FnMut(f64) -> CircleValues,
        function: usize,
        mut low: (f64, f64),
        mut high: (f64, f64),
    ) {
        let (mut best, mut slow) = (if low.1.abs() < high.1.abs() { low } else { high }, 0);
        for _ in 0..STEPS {
            let width = high.0 - low.0;
            if best.1 == 0.0 || width < f64::EPSILON * high.0.abs().max(1.0) {
                break;
            }
            let falsi = low.0 - low.1 * width / (high.1 - low.1);
            let angle =
                if slow < 3 && falsi > low.0 && falsi < high.0 { falsi } else { (low.0 + high.0) / 2.0 };
            let value = at(angle)[function];
            if value.is_nan() {
                return;
            }
            if value.abs() < best.1.abs() {
                best = (angle, value);
            }
            let here = (angle, value);
            let weight = |old: f64| if 1.0 - value / old > 0.0 { 1.0 - value / old } else { 0.5 };
            if value * high.1 < 0.0 {
                high.1 *= if low.1 * value > 0.0 { weight(low.1) } else { 1.0 };
                low = here;
            } else {
                low.1 *= if high.1 * value > 0.0 { weight(high.1) } else { 1.0 };
                high = here;
            }
            slow = if high.0 - low.0 > width / 2.0 { (slow + 1) % 4 } else { 0 };
        }
        if best.1.abs() < ACCURACY && self.count < MAX_ROOTS {
            self.all[self.count] = (function, best.0);
            self.count += 1;
        }
    }
}

/// Returns the vertex (angle and value) of the parabola through three points; None if the parabola has no vertex
/// between the outer points.
fn vertex(known: &[(f64, f64); 3]) -> Option<(f64, f64)> {
    let [(a, fa), (b, fb), (c, fc)] = *known;
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let bend = (right - left) / (c - a);
    let slope = left + bend * (b - a);
    let angle = b - slope / (2.0 * bend);
    let is_inside = angle > a && angle < c && angle != b;
    is_inside.then(|| (angle, fb - slope * slope / (4.0 * bend)))
}
