//! Roots of several functions of one angle. Each function may exist only on a part of the circle.
//!
//! The circle is scanned adaptively. An interval is halved until every function in it is nearly linear, or
//! too far from zero to have a root. Between two neighbouring angles, a function then has one root if its
//! sign changes, and otherwise none. An interval in which a function begins or ends is halved down to
//! the width `LEAST_WIDTH_AT_END`.

use super::positioning_arm::PositioningArm;
use std::f64::consts::TAU;

/// Number of functions whose roots are searched: one per branch index of the first three joints.
const COUNT: usize = PositioningArm::BRANCHES;
/// Number of intervals with which the scan begins.
const INTERVALS: usize = 32;
/// Largest number of roots that [`CircleRoots`] holds; further roots are ignored.
const MAX_ROOTS: usize = 16;
/// The scan does not halve an interval that is at most this wide, rad.
///
/// If a function begins or ends in the interval, the limit is [`LEAST_WIDTH_AT_END`] instead.
const LEAST_WIDTH: f64 = 1e-5;
/// Width, rad, down to which the scan halves an interval in which a function begins or ends.
const LEAST_WIDTH_AT_END: f64 = 1e-9;
/// A function has no root between three angles if its absolute values there exceed this factor times its
/// second difference. For a parabola, the factor 1/8 would be enough.
const NEAR_ZERO: f64 = 2.0;
/// Largest second difference of a nearly linear function, as a share of the change of its value.
const NEARLY_LINEAR: f64 = 0.5;
/// Largest squared change of [`CircleValues::aside`] between two neighbouring angles.
///
/// If the change is larger, the scan halves the interval.
const MAX_SWING: f64 = 0.2;
/// Largest absolute value of a function at an accepted root.
const ACCURACY: f64 = 1e-9;
/// Absolute value of a function below which the iteration for a root ends.
const EXACT: f64 = 1e-15;
/// Largest number of iterations that refine one root.
const STEPS: usize = 60;
/// Number of consecutive slow steps after which an interval is bisected.
///
/// A step of the false-position method is slow if more than half of the interval remains.
const MAX_SLOW_STEPS: usize = 3;

/// Values of the functions at one angle.
#[derive(Clone, Copy)]
pub(super) struct CircleValues {
    /// Value of each function; NaN if the function does not exist.
    pub functions: [f64; COUNT],
    /// Two coordinates per function. Each function belongs to one point, which moves along a curve in space
    /// as the angle changes.
    ///
    /// The third coordinate of the point is the function value plus a constant. A large change of the first
    /// two coordinates shows that the point moves far between two angles.
    pub aside: [(f64, f64); COUNT],
    /// Measure of how nearly a function exists at this angle: 0 if a function exists, otherwise positive.
    pub gap: f64,
}

/// Angle, rad, and the values of the functions at this angle.
type Sample = (f64, CircleValues);

/// Roots found so far.
pub(super) struct CircleRoots {
    all: [(usize, f64); MAX_ROOTS],
    count: usize,
    least: f64,
}

impl CircleValues {
    /// Result for an angle at which none of the functions is defined.
    pub const NONE: Self =
        Self { functions: [f64::NAN; COUNT], aside: [(0.0, 0.0); COUNT], gap: f64::INFINITY };
}

impl CircleRoots {
    /// Finds the roots of the functions that `values` computes from the cosine and the sine of an angle.
    pub fn new(mut values: impl FnMut((f64, f64)) -> CircleValues) -> Self {
        let mut roots = Self { all: [(0, 0.0); MAX_ROOTS], count: 0, least: f64::INFINITY };
        let mut at = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            (angle, values((cos, sin)))
        };
        let first = at(0.0);
        let (mut low, step) = (first, TAU / INTERVALS as f64);
        for k in 0..INTERVALS {
            let middle = at((k as f64 + 0.5) * step);
            let high = if k + 1 == INTERVALS { (TAU, first.1) } else { at((k + 1) as f64 * step) };
            let values = low.1.functions.iter().chain(&middle.1.functions);
            roots.least = values.fold(roots.least, |least, value| least.min(value.abs()));
            roots.search(&mut at, &low, &middle, &high);
            low = high;
        }
        roots
    }

    /// Returns every root: the index of the function, and the angle, rad.
    ///
    /// The roots of one function are in ascending order of their angles.
    pub fn all(&self) -> &[(usize, f64)] {
        &self.all[..self.count]
    }

    /// Returns the least absolute value of a function in a coarse scan; infinite if no function exists there.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// Searches the interval from `low` to `high` and adds its roots to the roots found so far.
    ///
    /// `middle` is the sample in the middle of the interval.
    fn search(&mut self, at: &mut impl FnMut(f64) -> Sample, low: &Sample, middle: &Sample, high: &Sample) {
        let width = high.0 - low.0;
        if (0..COUNT).any(|k| hides_roots([low, middle, high], k, width))
            || hides_functions([low, middle, high])
        {
            let left = at((low.0 + middle.0) / 2.0);
            let right = at((middle.0 + high.0) / 2.0);
            self.search(at, low, &left, middle);
            self.search(at, middle, &right, high);
            return;
        }
        for (from, to) in [(low, middle), (middle, high)] {
            for k in 0..COUNT {
                let (before, after) = (from.1.functions[k], to.1.functions[k]);
                if before * after < 0.0 || before == 0.0 {
                    self.locate(at, k, (from.0, before), (to.0, after));
                }
            }
        }
    }

    /// Adds the root of function `k` in an interval, if the function is continuous in this interval.
    ///
    /// `low` and `high` contain the angle (rad) and the function value at the ends of the interval.
    ///
    /// The method is the false position of N. Anderson and A. Bjorck, "A new high order method of regula
    /// falsi type for computing a root of an equation", BIT 13, 1973. After [`MAX_SLOW_STEPS`] slow steps, a
    /// bisection follows.
    fn locate(
        &mut self,
        at: &mut impl FnMut(f64) -> Sample,
        k: usize,
        mut low: (f64, f64),
        mut high: (f64, f64),
    ) {
        let (mut best, mut slow) = (if low.1.abs() < high.1.abs() { low } else { high }, 0);
        for _ in 0..STEPS {
            let width = high.0 - low.0;
            if best.1.abs() < EXACT || width < f64::EPSILON * high.0.max(1.0) {
                break;
            }
            let falsi = low.0 - low.1 * width / (high.1 - low.1);
            let is_taken = slow < MAX_SLOW_STEPS && falsi > low.0 && falsi < high.0;
            let angle = if is_taken { falsi } else { (low.0 + high.0) / 2.0 };
            let value = at(angle).1.functions[k];
            if value.is_nan() {
                return;
            }
            if value.abs() < best.1.abs() {
                best = (angle, value);
            }
            // The end that stays gets a smaller weight, so that the next step does not keep it again.
            let weight = |replaced: f64| match 1.0 - value / replaced {
                weight if weight > 0.0 => weight,
                _ => 0.5,
            };
            if value * high.1 < 0.0 {
                high.1 *= weight(low.1);
                low = (angle, value);
            } else {
                low.1 *= weight(high.1);
                high = (angle, value);
            }
            slow = if high.0 - low.0 > width / 2.0 && is_taken { slow + 1 } else { 0 };
        }
        if best.1.abs() < ACCURACY && self.count < MAX_ROOTS {
            self.all[self.count] = (k, best.0);
            self.count += 1;
        }
    }
}

/// Returns whether function `k` may have roots that the signs of its values at three neighbouring angles do
/// not show.
///
/// `width` is the distance between the outer angles, rad.
fn hides_roots(samples: [&Sample; 3], k: usize, width: f64) -> bool {
    let values @ [a, b, c] = samples.map(|sample| sample.1.functions[k]);
    match values.iter().filter(|value| value.is_nan()).count() {
        0 => {}
        3 => return false,
        _ => return width > LEAST_WIDTH_AT_END,
    }
    if width <= LEAST_WIDTH {
        return false;
    }
    let second = (a - 2.0 * b + c).abs();
    let is_near = match (a * b > 0.0, b * c > 0.0) {
        (true, true) => a.abs().min(b.abs()).min(c.abs()) < NEAR_ZERO * second,
        (false, true) => second > NEARLY_LINEAR * (b - a).abs(),
        (true, false) => second > NEARLY_LINEAR * (c - b).abs(),
        (false, false) => second > NEARLY_LINEAR * (b - a).abs().min((c - b).abs()),
    };
    let [first, middle, last] = samples.map(|sample| sample.1.aside[k]);
    let swing = |p: (f64, f64), q: (f64, f64)| (p.0 - q.0).powi(2) + (p.1 - q.1).powi(2);
    is_near || swing(first, middle) > MAX_SWING || swing(middle, last) > MAX_SWING
}

/// Returns whether a function may exist between three neighbouring angles although no function exists at
/// these angles.
fn hides_functions([low, middle, high]: [&Sample; 3]) -> bool {
    let (a, b, c) = (low.1.gap, middle.1.gap, high.1.gap);
    let least = a.min(b).min(c);
    least > 0.0 && high.0 - low.0 > LEAST_WIDTH && least < NEAR_ZERO * (a - 2.0 * b + c).abs()
}
