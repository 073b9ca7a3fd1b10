//! Inverse Laplace transform (Bromwich integral): `P(Q <= x)` for `Q = |e|^2`, its density and the slope of
//! the density.
//!
//! The three results use the same values of the transform. All singularities of the transform lie on the
//! negative real axis. So the trapezoidal rule on a contour around this axis converges geometrically, for any
//! ratios of the eigenvalues `l_i` of the covariance.
//!
//! For a small mean the contour is the parabola `z x = M (1 + i t)^2` with real t and `M = pi N / 12`. The
//! upper half of the parabola has `N` points, at steps of `3 / N` in t. The points `z x` do not depend on x,
//! and the error is about `8.12^-N` (J. A. C. Weideman, L. N. Trefethen, "Parabolic and hyperbolic contours
//! for computing the Bromwich integral", Math. Comp. 76 (2007)). For a large mean, the parabola would cross
//! the discs with the diameters `[-1/(2 l_i), 0]`. In these discs, the factors `exp(-mu_i^2 z / (1 + 2 l_i
//! z))` of the integrand are large. Here `mu_i` is the component of the mean along the eigenvector of `l_i`.
//! So the contour for a large mean is a steep hyperbola through the saddle point of the integrand. On this
//! hyperbola every term of the sum is small.

use super::spectrum::{Spectrum, exponential};
use nalgebra::Complex;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Number of points on the upper half of the parabola.
const N: usize = 14;
/// Largest noncentrality for which the integral along the parabola is accurate to 1e-10.
///
/// The noncentrality is `sum mu_i^2 / l_i`, where `l_i` is an eigenvalue and `mu_i` the component of the mean
/// along its eigenvector.
const MAX_CENTRAL: f64 = 6.0;
/// The probability is set to 0 if `Q - shift` is below this value, because such small values practically
/// never occur.
///
/// Here `Q` is the squared norm `|e|^2`, and `shift` is the constant part of `Q`. Lengths are in units of the
/// RMS norm, so `Q` has the mean 1.
const MIN_SQUARE: f64 = 1e-100;
/// Tangent of 20 degrees, the angle between the arms of the hyperbola and the vertical.
const TILT: f64 = 0.36;

/// Points and weights on the parabola.
struct Parabola {
    s: [Complex<f64>; N],
    weight: [Complex<f64>; N],
    /// Real parts of the points `s`. `im` holds their imaginary parts, `re2` and `im2` the parts of `s^2`.
    re: [f64; N],
    im: [f64; N],
    re2: [f64; N],
    im2: [f64; N],
}

/// Points `s = z x` on the upper half of the parabola, and their weights `step / pi * exp(s) ds/dt / s`.
///
/// Here z is the argument of the transform, and x is the value at which the distribution is evaluated. The
/// parameter of the parabola is t, and `step` is the step of the trapezoidal rule in t.
static PARABOLA: LazyLock<Parabola> = LazyLock::new(|| {
    let step = 3.0 / N as f64;
    let root = |k: usize| Complex::new(1.0, step * (k as f64 + 0.5));
    let s: [Complex<f64>; N] = std::array::from_fn(|k| PI * N as f64 / 12.0 * root(k) * root(k));
    let weight = std::array::from_fn(|k| step / PI * s[k].exp() * Complex::new(0.0, 2.0) / root(k));
    let s2 = s.map(|s| s * s);
    Parabola {
        s,
        weight,
        re: s.map(|s| s.re),
        im: s.map(|s| s.im),
        re2: s2.map(|s| s.re),
        im2: s2.map(|s| s.im),
    }
});

/// Returns `P(Q <= x)`, its density and the slope of the density at `x = shift + above`.
///
/// Here `Q` is the squared norm `|e|^2`, and `shift` is the constant part of `Q` in `spectrum`.
pub fn invert(spectrum: &Spectrum, above: f64) -> [f64; 3] {
    if above < MIN_SQUARE {
        return [0.0; 3];
    }
    if spectrum.noncentrality <= MAX_CENTRAL {
        on_parabola(spectrum, above)
    } else {
        on_hyperbola(spectrum, above)
    }
}

fn on_parabola(spectrum: &Spectrum, x: f64) -> [f64; 3] {
    let at = &*PARABOLA;
    let (re, im) = roots(spectrum, x, at);
    let plain = spectrum.noncentrality == 0.0 && spectrum.correction.is_none();
    let moved = spectrum.square - spectrum.shift;
    let mut sum = [0.0; 3];
    for k in 0..N {
        let mut l = at.weight[k] * Complex::new(re[k], -im[k]) / (re[k] * re[k] + im[k] * im[k]);
        if !plain {
            let z = at.s[k] / x;
            let (h, f) = spectrum.factors(z);
            l *= exponential(h - moved * z) * f;
        }
        let ls = l * at.s[k];
        sum[0] += l.im;
        sum[1] += ls.im;
        sum[2] += ls.re * at.im[k] + ls.im * at.re[k];
    }
    [sum[0], sum[1] / x, sum[2] / (x * x)]
}

/// Returns the real and imaginary parts of `prod_i sqrt(1 + 2 l_i z)` at all points z of the parabola.
///
/// Here `l_i` is the i-th eigenvalue of the covariance.
///
/// One square root is computed for each pair of factors: the root of the product of the two factors. The
/// argument of this root is between 0 and pi.
fn roots(spectrum: &Spectrum, x: f64, at: &Parabola) -> ([f64; N], [f64; N]) {
    let (mut re, mut im) = ([1.0; N], [0.0; N]);
    for pair in spectrum.l[..spectrum.rank.next_multiple_of(2)].chunks_exact(2) {
        let (a, b) = (2.0 * (pair[0] + pair[1]) / x, 4.0 * (pair[0] / x) * (pair[1] / x));
        for k in 0..N {
            let p = 1.0 + a * at.re[k] + b * at.re2[k];
            let q = a * at.im[k] + b * at.im2[k];
            let t = (0.5 * (p.abs() + (p * p + q * q).sqrt())).sqrt();
            let other = (0.5 * q / t).abs();
            let (u, v) = if p >= 0.0 { (t.copysign(q), other) } else { (other.copysign(q), t) };
            (re[k], im[k]) = (re[k] * u - im[k] * v, re[k] * v + im[k] * u);
        }
    }
    (re, im)
}

/// Integrates on the hyperbola `z = saddle + width (i sinh u - TILT (cosh u - 1))` by the trapezoidal rule in
/// u. The function [`saddle`] returns `saddle` and `width`.
///
/// The step is halved until two successive sums agree.
fn on_hyperbola(spectrum: &Spectrum, above: f64) -> [f64; 3] {
    let x = above - (spectrum.square - spectrum.shift);
    let (saddle, width, log_bound) = saddle(spectrum, above);
    if log_bound < -37.0 {
        return [0.0; 3];
    }
    let term = |u: f64| {
        let z = Complex::new(saddle - TILT * width * (u.cosh() - 1.0), width * u.sinh());
        let slope = Complex::new(-TILT * u.sinh(), u.cosh()) * (width / PI);
        let (h, f) = spectrum.factors(z);
        let value = spectrum.central(z) * (h + x * z).exp() * f * slope;
        [(value / z).im, value.im, (value * z).im]
    };
    let start = term(0.0).map(|t| 0.5 * t);
    let mut step = 0.25;
    let mut sum = add(start, arm(&term, step, step)).map(|s| s * step);
    for _ in 0..6 {
        let between = arm(&term, 0.5 * step, step);
        let next: [f64; 3] = std::array::from_fn(|k| 0.5 * (sum[k] + between[k] * step));
        let change = (next[0] - sum[0]).abs();
        (sum, step) = (next, 0.5 * step);
        if change < 1e-11 {
            break;
        }
    }
    sum
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Returns the sum of `term(u)` along one arm of the hyperbola, from `u = from` in steps of `step` until the
/// terms vanish.
fn arm(term: &impl Fn(f64) -> [f64; 3], from: f64, step: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut u = from;
    while u < 12.0 {
        let t = term(u);
        sum = add(sum, t);
        if t[0].abs() < 1e-17 && t[1].abs() <= 1e-13 * sum[1].abs() {
            break;
        }
        u += step;
    }
    sum
}

/// Returns a point z near the saddle of `exp(z above) L(z) / z`, the width of the saddle, and a Chernoff
/// bound.
///
/// Here `L` is the Laplace transform of `Q - shift` for normal parameters. `Q` is the squared norm `|e|^2`,
/// and `shift` is the constant part of `Q`. The point is on the positive real axis.
///
/// The bound is `z above + log L(z)`. For normal parameters it is an upper bound of `log P(Q <= shift +
/// above)`.
fn saddle(spectrum: &Spectrum, above: f64) -> (f64, f64, f64) {
    let slope = |z: f64| {
        let part = |(l, mean2): (f64, f64)| {
            let r = 1.0 / (1.0 + 2.0 * l * z);
            (l + mean2 * r) * r
        };
        above - 1.0 / z - spectrum.varying().map(part).sum::<f64>()
    };
    let (mut low, mut high) = (1.0 / above, 2.0 / above);
    while slope(high) < 0.0 && high < 1e200 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..6 {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    let z = 0.5 * (low + high);
    let (mut curvature, mut log) = (1.0 / (z * z), z * above);
    for (l, mean2) in spectrum.varying() {
        let r = 1.0 / (1.0 + 2.0 * l * z);
        curvature += 2.0 * l * (l + 2.0 * mean2 * r) * r * r;
        log -= mean2 * z * r - 0.5 * r.ln();
    }
    (z, 1.0 / curvature.sqrt(), log)
}
