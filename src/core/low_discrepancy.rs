//! Low-discrepancy sequences: deterministic points that fill the unit cube more evenly than random points.
//!
//! - Halton: coordinate k is the radical inverse of the point number, with the k-th prime as base (J. H.
//!   Halton, "On the efficiency of certain quasi-random sequences of points in evaluating multi-dimensional
//!   integrals", Numerische Mathematik 2, 1960).
//! - R_d, where d is the number of dimensions: multiples of the powers of a generalized golden ratio, modulo
//!   1 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
//! - Richtmyer: multiples of the square roots of the primes, modulo 1 (R. D. Richtmyer, "The evaluation of
//!   definite integrals, and a quasi-Monte-Carlo method based on the properties of algebraic numbers", 1951).

/// Fractional part of the golden ratio. No other step spreads its multiples, modulo 1, more evenly over the
/// unit interval.
pub const GOLDEN_STEP: f64 = 0.618_033_988_749_894_9;
/// Golden angle, rad. Successive multiples of this angle are spread most evenly over the circle.
pub const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Returns the prime numbers in ascending order.
pub fn primes() -> impl Iterator<Item = u32> {
    let is_prime = |n: &u32| (2..*n).take_while(|d| d * d <= *n).all(|d| !n.is_multiple_of(d));
    (2u32..).filter(is_prime)
}

/// Returns the radical inverse of a number: its digits in base `base`, mirrored at the radix point.
pub fn radical_inverse(mut number: u64, base: u32) -> f64 {
    let base = u64::from(base);
    let (mut value, mut place) = (0.0, 1.0 / base as f64);
    while number > 0 {
        value += (number % base) as f64 * place;
        number /= base;
        place /= base as f64;
    }
    value
}

/// Returns the coordinates of point `number` of the Halton sequence, one for each prime.
///
/// Point 0 is the origin; useful points begin with number 1.
pub fn halton(number: u64) -> impl Iterator<Item = f64> {
    primes().map(move |base| radical_inverse(number, base))
}

/// R_d sequence in d dimensions, based on a generalized golden ratio (M. Roberts, 2018).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobertsSequence {
    /// Positive root g of `g^(d + 1) = g + 1` for d dimensions; for d = 1 it is the golden ratio.
    root: f64,
}

impl RobertsSequence {
    /// Prepares the sequence in `dimensions` dimensions.
    pub fn new(dimensions: usize) -> Self {
        /// Number of fixed-point iterations; fewer suffice for full precision in up to 8 dimensions.
        const ITERATIONS: usize = 64;
        let exponent = 1.0 / (dimensions as f64 + 1.0);
        Self { root: (0..ITERATIONS).fold(2.0, |root: f64, _| (1.0 + root).powf(exponent)) }
    }

    /// Returns coordinate `axis` of point `number`: the fractional part of `1/2 + number / g^(axis + 1)`.
    ///
    /// The number g is the generalized golden ratio of the sequence.
    pub fn coordinate(&self, number: usize, axis: usize) -> f64 {
        (0.5 + number as f64 / self.root.powi(axis as i32 + 1)).fract()
    }
}

/// Returns, for each coordinate, the step between successive points of the Richtmyer sequence, modulo 1.
pub fn richtmyer_steps() -> impl Iterator<Item = f64> {
    primes().map(|p| f64::from(p).sqrt().fract())
}
