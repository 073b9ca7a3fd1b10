//! Weighted low-discrepancy points of [`super::ConditionalNorm`], in units of the standard deviations.
//!
//! The points are a Hammersley set (J. M. Hammersley, "Monte Carlo methods for solving multivariable
//! problems", Ann. New York Acad. Sci. 86, 1960). Percentiles depend on the tails of the distributions.
//! So each coordinate is drawn from a distribution with more points in the tails, and weighted by the ratio
//! of the densities (importance sampling).

use crate::cell::Distribution;
use crate::low_discrepancy::{primes, radical_inverse};
use crate::reading::normal_quantile::normal_quantile;
use std::sync::LazyLock;

/// Number of points.
pub const POINTS: usize = 8192;

/// Number of coordinates of a point.
pub const COORDINATES: usize = 13;

/// Standard deviation of the normal distribution from which the normal coordinates are drawn.
const WIDENED: f64 = 1.2;

/// Values and weights of one distribution at all points, coordinate by coordinate.
struct WeightedPoints {
    values: Vec<f64>,
    weights: Vec<f64>,
}

/// Weighted points of each distribution, in the order of [`Distribution::ALL`].
static ALL: LazyLock<[WeightedPoints; 3]> = LazyLock::new(|| {
    let mut unit = Vec::with_capacity(COORDINATES * POINTS);
    unit.extend((0..POINTS).map(|n| (n as f64 + 0.5) / POINTS as f64));
    for base in primes().take(COORDINATES - 1) {
        unit.extend((1..=POINTS).map(|n| radical_inverse(n as u64, base)));
    }
    Distribution::ALL.map(|distribution| {
        let (values, weights) = unit.iter().map(|u| weighted(distribution, *u)).unzip();
        WeightedPoints { values, weights }
    })
});

/// Returns the values and weights of coordinate `k` of all points for a distribution of unit variance.
pub fn coordinate(k: usize, distribution: Distribution) -> (&'static [f64], &'static [f64]) {
    let of = Distribution::ALL.iter().position(|d| *d == distribution).unwrap_or(0);
    let place = k * POINTS..(k + 1) * POINTS;
    (&ALL[of].values[place.clone()], &ALL[of].weights[place])
}

/// Returns half the width of a distribution of unit variance; infinite for the normal distribution.
pub fn half_width(distribution: Distribution) -> f64 {
    match distribution {
        Distribution::Normal => f64::INFINITY,
        Distribution::Uniform => 3f64.sqrt(),
        Distribution::Triangular => 6f64.sqrt(),
    }
}

/// Returns the value at the coordinate `u` between 0 and 1, and its weight.
fn weighted(distribution: Distribution, u: f64) -> (f64, f64) {
    let centred = 2.0 * u - 1.0;
    match distribution {
        Distribution::Normal => {
            let z = normal_quantile(u);
            (WIDENED * z, WIDENED * (-0.5 * z * z * (WIDENED * WIDENED - 1.0)).exp())
        }
        Distribution::Uniform => (half_width(distribution) * centred, 1.0),
        Distribution::Triangular => {
            let inward = 1.0 - (1.0 - centred.abs()).sqrt();
            (half_width(distribution) * inward.copysign(centred), 1.0)
        }
    }
}
