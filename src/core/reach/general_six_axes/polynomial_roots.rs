//! Real roots of a trigonometric polynomial, with the uncertainty that rounding causes.
//!
//! The circle is divided into intervals. The Taylor series at the middle of an interval, with a bound of its
//! remainder, can show one of three cases. The interval has no root, or the value is monotonic, or the second
//! derivative does not change its sign. In the third case, the interval has at most two roots. If none of
//! these cases is certain, the interval is halved.

use super::circle_polynomial::CirclePolynomial;
use std::f64::consts::PI;

/// A value certainly differs from zero if its absolute value is above this multiple of the noise.
const CLEAR: f64 = 30.0;

/// An interval is not halved, and all its roots count as one root, if its half width is below this value,
/// rad.
const NARROWEST: f64 = 2e-6;

/// An interval whose values may all be noise counts as one root if its half width is below this value, rad.
const NARROW: f64 = 0.01;

/// Two roots belong to one multiple root if their distance is below this value, rad.
const SAME_ROOT: f64 = 1e-5;

/// Number of intervals with which the search begins.
const INTERVALS: usize = 32;

/// Newton's method for an extremum ends after a step shorter than this value, rad.
const EXTREMUM_ACCURACY: f64 = 1e-9;

/// The iteration for a root ends after a step shorter than this value, rad.
const ROOT_ACCURACY: f64 = 1e-13;

/// A value counts as zero if it is below this multiple of the noise.
const ZERO: f64 = 0.1;

/// Largest number of Newton steps in the search for an extremum.
const STEPS_TO_EXTREMUM: usize = 10;

/// Largest number of steps in the iteration for a root.
const STEPS_TO_ROOT: usize = 60;

/// Taylor series of a polynomial at the middle of an interval.
struct TaylorSeries {
    /// Values of the terms of degree 0 to 5 at the upper end of the interval.
    terms: [f64; 6],
    /// Upper bound of the absolute value of the remainder in the interval.
    rest: f64,
}

impl TaylorSeries {
    /// Returns the series in an interval, given by its middle and half its width (rad).
    fn new(polynomial: &CirclePolynomial, middle: f64, half: f64) -> Self {
        let mut terms: [f64; 6] = polynomial.derivatives(middle);
        let mut factor = 1.0;
        for (n, term) in terms.iter_mut().enumerate().skip(1) {
            factor *= half / n as f64;
            *term *= factor;
        }
        Self { terms, rest: polynomial.sixth_derivative() * factor * half / 6.0 }
    }

    /// Returns an upper bound of the absolute value that a weighted sum of terms has in the interval.
    ///
    /// The sum contains the terms from term `from` on, and the remainder as term 6. The function `weight`
    /// returns the weight of a term.
    ///
    /// Let h be half the width of the interval. If term n has the weight n, the sum of all weighted terms is
    /// h times the first derivative. If the weight is n (n - 1) / 2, this sum is `h^2 / 2` times the second
    /// derivative.
    #[inline]
    fn bound(&self, weight: fn(f64) -> f64, from: usize) -> f64 {
        let terms = self.terms.iter().enumerate().skip(from);
        terms.map(|(n, term)| weight(n as f64) * term.abs()).sum::<f64>() + weight(6.0) * self.rest
    }
}

/// Calls `found` with every root (rad) and its uncertainty (rad), until `found` returns false.
///
/// Intervals in which the value is nearly zero count as roots, too; their uncertainty is large.
pub(super) fn polynomial_roots(polynomial: &CirclePolynomial, found: &mut impl FnMut(f64, f64) -> bool) {
    if !polynomial.is_finite() {
        return;
    }
    let half = PI / INTERVALS as f64;
    let mut last = f64::NEG_INFINITY;
    let mut once = |root: f64, uncertainty: f64| {
        let is_new = (root - last).abs() > SAME_ROOT;
        last = root;
        !is_new || found(root, uncertainty)
    };
    for k in 0..INTERVALS {
        if !search(polynomial, (2 * k + 1) as f64 * half - PI, half, &mut once) {
            return;
        }
    }
}

/// Calls `found` with the roots of one interval, given by its middle and half its width (rad).
///
/// Returns whether the search should continue.
fn search(
    polynomial: &CirclePolynomial,
    middle: f64,
    half: f64,
    found: &mut impl FnMut(f64, f64) -> bool,
) -> bool {
    let series = TaylorSeries::new(polynomial, middle, half);
    let (terms, rest) = (&series.terms, series.rest);
    let clear = CLEAR * polynomial.noise();
    let varies = series.bound(|_| 1.0, 1);
    if terms[0].abs() > clear + varies {
        return true;
    }
    if half < NARROWEST || (half < NARROW && terms[0].abs() + varies <= clear) {
        return found(middle, half);
    }
    let (even, odd) = (terms[0] + terms[2] + terms[4], terms[1] + terms[3] + terms[5]);
    let (low, high) = ((middle - half, even - odd), (middle + half, even + odd));
    let mut between = |start: f64, from: (f64, f64), to: (f64, f64)| {
        // The values at the ends are known up to noise and remainder.
        if from.1 * to.1 > 0.0 && from.1.abs().min(to.1.abs()) > clear + rest {
            return true;
        }
        let root = root_between(polynomial, start, from.0, to.0, to.1 > from.1);
        let [_, slope] = polynomial.derivatives(root);
        found(root, clear / slope.abs())
    };
    let bends_one_way = terms[2].abs() > series.bound(|n| 0.5 * n * (n - 1.0), 3);
    if bends_one_way && let Some(extremum) = extremum_near(polynomial, middle, half) {
        let [value, _, bend] = polynomial.derivatives(extremum);
        if value.abs() < clear {
            return found(extremum, (2.0 * clear / bend.abs()).sqrt());
        }
        if value * bend > 0.0 {
            return true;
        }
        let away = (-2.0 * value / bend).sqrt();
        return between(extremum - away, low, (extremum, value))
            && between(extremum + away, (extremum, value), high);
    }
    let is_monotonic = terms[1].abs() > series.bound(|n| n, 2);
    if is_monotonic {
        return between(middle, low, high);
    }
    let quarter = half / 2.0;
    search(polynomial, middle - quarter, quarter, found)
        && search(polynomial, middle + quarter, quarter, found)
}

/// Returns the extremum (rad) to which Newton's method leads; None if it is not in the interval.
fn extremum_near(polynomial: &CirclePolynomial, middle: f64, half: f64) -> Option<f64> {
    let mut angle = middle;
    for _ in 0..STEPS_TO_EXTREMUM {
        let [_, slope, bend] = polynomial.derivatives(angle);
        let step = -slope / bend;
        angle += step;
        if (angle - middle).abs() > half || angle.is_nan() {
            return None;
        }
        if step.abs() < EXTREMUM_ACCURACY {
            break;
        }
    }
    Some(angle)
}

/// Returns the root (rad) in an interval in which the value rises or falls.
///
/// Steps of Newton's method that leave the interval are replaced by bisections.
fn root_between(polynomial: &CirclePolynomial, start: f64, mut low: f64, mut high: f64, rises: bool) -> f64 {
    let mut angle = start;
    for _ in 0..STEPS_TO_ROOT {
        let [value, slope] = polynomial.derivatives(angle);
        if (value > 0.0) == rises {
            high = angle;
        } else {
            low = angle;
        }
        let newton = angle - value / slope;
        let next = if low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
        let is_done = (next - angle).abs() < ROOT_ACCURACY || value.abs() < ZERO * polynomial.noise();
        angle = next;
        if is_done {
            break;
        }
    }
    angle
}
