//! Real roots of polynomials up to the fourth degree.

/// Polynomial up to the fourth degree: coefficients of 1, x, ..., x^4.
pub(in crate::reach) type Polynomial = [f64; 5];

/// Polynomial up to the second degree: coefficients of 1, x, x^2.
pub(in crate::reach) type Quadratic = [f64; 3];

/// An extremum counts as a double root if the absolute value of the polynomial there is at most this value.
///
/// The limit is relative to the sum of the absolute values of the polynomial's terms at the extremum.
const DOUBLE_ROOT: f64 = 1e-7;

/// Up to four real roots in ascending order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::reach) struct Roots {
    x: [f64; 4],
    count: usize,
}

impl Roots {
    /// Returns the roots in ascending order.
    pub fn all(&self) -> &[f64] {
        &self.x[..self.count]
    }

    fn push(&mut self, x: f64) {
        if self.count < 4 {
            self.x[self.count] = x;
            self.count += 1;
        }
    }
}

/// Returns the product of two quadratics.
pub(in crate::reach) fn product(a: &Quadratic, b: &Quadratic) -> Polynomial {
    let mut p = [0.0; 5];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            p[i + j] += a * b;
        }
    }
    p
}

/// Returns the quadratic `f a + g b + constant`.
pub(in crate::reach) fn combined(f: f64, a: &Quadratic, g: f64, b: &Quadratic, constant: f64) -> Quadratic {
    [f * a[0] + g * b[0] + constant, f * a[1] + g * b[1], f * a[2] + g * b[2]]
}

/// Returns the value of a polynomial at `x` by Horner's method.
pub(in crate::reach) fn value(p: &Polynomial, x: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

fn derivative(p: &Polynomial) -> Polynomial {
    [p[1], 2.0 * p[2], 3.0 * p[3], 4.0 * p[4], 0.0]
}

/// Returns the real roots of a polynomial, each multiple root once.
///
/// A polynomial is monotonic between neighbouring roots of its derivative. The roots of the derivative
/// therefore bracket the roots of the polynomial, and cancellation cannot lose a root.
pub(in crate::reach) fn real_roots(p: &Polynomial) -> Roots {
    let largest = p.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let degree = (1..5).rev().find(|&k| p[k].abs() > 1e-14 * largest).unwrap_or(0);
    let mut derivatives = [*p; 4];
    for k in 1..4 {
        derivatives[k] = derivative(&derivatives[k - 1]);
    }
    let mut roots = Roots { x: [0.0; 4], count: 0 };
    for k in 1..=degree {
        let mut p = derivatives[degree - k];
        p[k + 1..].fill(0.0);
        roots = between(&p, p[k], &roots);
    }
    roots
}

/// Returns the real roots of the polynomial `p`.
///
/// `leading` is the leading coefficient of `p`, and `critical` holds the real roots of the derivative of `p`.
fn between(p: &Polynomial, leading: f64, critical: &Roots) -> Roots {
    // Cauchy's bound of the absolute values of the roots.
    let bound = 1.0 + p.iter().fold(0.0f64, |m, c| m.max((c / leading).abs()));
    let mut roots = Roots { x: [0.0; 4], count: 0 };
    let mut crossed = false;
    let mut lo = -bound;
    for k in 0..=critical.count {
        let hi = critical.all().get(k).copied().unwrap_or(bound);
        let crosses = value(p, lo) * value(p, hi) < 0.0;
        if k > 0 && !crossed && !crosses && touches(p, lo) {
            roots.push(lo);
        }
        if crosses {
            roots.push(bracketed(p, lo, hi));
        }
        (crossed, lo) = (crosses, hi);
    }
    roots
}

fn touches(p: &Polynomial, x: f64) -> bool {
    let terms = p.iter().rev().fold(0.0, |sum, c| sum * x.abs() + c.abs());
    value(p, x).abs() <= DOUBLE_ROOT * terms
}

/// Returns the root between `lo` and `hi` by Newton's method, safeguarded by bisection.
///
/// An end of the interval is an extremum of the polynomial or a bound of all roots. Newton's method therefore
/// starts at the root of the parabola that osculates the polynomial at such an extremum.
fn bracketed(p: &Polynomial, mut lo: f64, mut hi: f64) -> f64 {
    const MAX_STEPS: usize = 100;
    /// Relative step below which Newton's method has converged, because it converges quadratically.
    const LAST_STEP: f64 = 1e-9;
    let slope = derivative(p);
    let curvature = derivative(&slope);
    let rising = value(p, hi) > 0.0;
    let from = |extremum: f64, direction: f64| {
        let square = -2.0 * value(p, extremum) / value(&curvature, extremum);
        Some(extremum + direction * square.sqrt()).filter(|x| *x > lo && *x < hi)
    };
    let mut x = from(lo, 1.0).or_else(|| from(hi, -1.0)).unwrap_or(0.5 * (lo + hi));
    for _ in 0..MAX_STEPS {
        let f = value(p, x);
        if f == 0.0 {
            return x;
        }
        if (f > 0.0) == rising {
            hi = x
        } else {
            lo = x
        }
        let newton = x - f / value(&slope, x);
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if (next - x).abs() <= LAST_STEP * x.abs().max(1e-3) && next == newton {
            return next;
        }
        x = next;
    }
    x
}
