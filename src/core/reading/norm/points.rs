//! Weighted low-discrepancy points of [`super::ConditionalNorm`], in units of the standard deviations.
//!
//! The points are a Hammersley set (J. M. Hammersley, "Monte Carlo methods for solving multivariable
//! problems", Ann. New York Acad. Sci. 86, 1960). Percentiles depend on the tails of the distributions. So
//! the normal coordinates are drawn from a wider normal distribution, which has more points in the tails. The
//! weight of such a coordinate is the ratio of the two densities (importance sampling).

use crate::cell::Distribution;
use crate::low_discrepancy::{primes, radical_inverse};
use crate::reading::normal_quantile::normal_quantile;
use std::sync::LazyLock;

/// Number of points: for errors of at most [`FEW_COMPONENTS`] components, and for errors of more components.
const POINTS: [usize; 2] = [8192, 32_768];

/// Largest number of components for which the smaller set suffices.
///
/// Errors of more components depend on more coordinates. In many dimensions, low-discrepancy points are no
/// better than random draws.
const FEW_COMPONENTS: usize = 3;

/// Number of coordinates of a point.
pub const COORDINATES: usize = 13;

/// Standard deviation of the normal distribution from which the normal coordinates are drawn.
const WIDENED: f64 = 1.2;

/// Fixed set of weighted points.
pub struct PointSet {
    /// Number of points; a multiple of 4.
    pub count: usize,
    /// Coordinates of the points for each distribution of [`Distribution::ALL`]: coordinate 0 of all points,
    /// then coordinate 1 of all points, and so on.
    values: [Vec<f64>; 3],
    /// Weights of the coordinates with a normal distribution; the weights of all other coordinates are 1.
    weights: Vec<f64>,
}

/// Point sets with the numbers of points [`POINTS`].
static ALL: [LazyLock<PointSet>; 2] =
    [LazyLock::new(|| PointSet::new(POINTS[0])), LazyLock::new(|| PointSet::new(POINTS[1]))];

impl PointSet {
    /// Returns the set for errors of `m` components.
    pub fn of_components(m: usize) -> &'static Self {
        &ALL[usize::from(m > FEW_COMPONENTS)]
    }

    fn new(count: usize) -> Self {
        let mut unit = Vec::with_capacity(COORDINATES * count);
        unit.extend((0..count).map(|n| (n as f64 + 0.5) / count as f64));
        for base in primes().take(COORDINATES - 1) {
            unit.extend((1..=count).map(|n| radical_inverse(n as u64, base)));
        }
        let values = Distribution::ALL.map(|d| unit.iter().map(|u| value(d, *u)).collect());
        Self { count, values, weights: unit.iter().map(|u| normal_weight(*u)).collect() }
    }

    /// Returns the values of coordinate `k` of all points for a distribution of unit variance, and the
    /// weights of these values. The weights are None if all are 1.
    pub fn coordinate(&self, k: usize, distribution: Distribution) -> (&[f64], Option<&[f64]>) {
        let of = Distribution::ALL.iter().position(|d| *d == distribution).unwrap_or(0);
        let place = k * self.count..(k + 1) * self.count;
        let weighted = distribution == Distribution::Normal;
        (&self.values[of][place.clone()], weighted.then(|| &self.weights[place]))
    }
}

/// Returns half the width of a distribution of unit variance; infinite for the normal distribution.
pub fn half_width(distribution: Distribution) -> f64 {
    match distribution {
        Distribution::Normal => f64::INFINITY,
        Distribution::Uniform => 3f64.sqrt(),
        Distribution::Triangular => 6f64.sqrt(),
    }
}

/// Returns the coordinate of a point for a distribution of unit variance: the quantile at the probability
/// `u`.
///
/// The normal distribution is widened by [`WIDENED`].
fn value(distribution: Distribution, u: f64) -> f64 {
    let centred = 2.0 * u - 1.0;
    match distribution {
        Distribution::Normal => WIDENED * normal_quantile(u),
        Distribution::Uniform => half_width(distribution) * centred,
        Distribution::Triangular => {
            let inward = 1.0 - (1.0 - centred.abs()).sqrt();
            half_width(distribution) * inward.copysign(centred)
        }
    }
}

/// Returns the weight of a normal coordinate at the probability `u`: the normal density divided by the
/// density of the widened normal distribution.
fn normal_weight(u: f64) -> f64 {
    let z = normal_quantile(u);
    WIDENED * (-0.5 * z * z * (WIDENED * WIDENED - 1.0)).exp()
}
