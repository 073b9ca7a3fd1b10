//! Lower bounds of the RMS, the mean and percentiles of the norm of a centred normal vector.
//!
//! The norm depends only on the eigenvalues of the covariance. A figure is scaled so that the largest
//! eigenvalue is 1. The scaled figure is a function of one eigenvalue ratio for two components, and of two
//! ratios for three components. The function is symmetric and smooth. A table of samples is interpolated
//! linearly in each ratio. The interpolated value exceeds the function by less than the share [`CURVATURE`].
//! The first lower bound is smaller than the interpolated value by this share. The mean as a function of a
//! ratio has an infinite slope at the ratio 0. The function is concave there, so the interpolated value is
//! below the function.
//!
//! The figure never decreases if a ratio increases (T. W. Anderson, Proc. Amer. Math. Soc. 6 (1955) 170-176).
//! So the sample at the next smaller ratios is a second lower bound. The greater of the two lower bounds
//! counts. The sample at the next greater ratios is an upper bound.

use super::NormDistribution;
use crate::cell::Quantity;
use nalgebra::Vector6;
use std::sync::OnceLock;

/// Number of intervals of the eigenvalue ratio for vectors with two components.
const PLANE_STEPS: usize = 2048;
/// Number of intervals into which the table divides the range of each of the two eigenvalue ratios, for
/// vectors with three components.
const SPACE_STEPS: usize = 96;
/// Largest excess of an interpolated value over the figure, as a share of the interpolated value. The largest
/// excess found among a million random ratios is a tenth of this value.
const CURVATURE: f64 = 1e-4;
/// Largest relative rounding error of an eigenvalue.
const ROUNDING: f64 = 1e-7;
/// Quantities whose bound is a table of samples.
const QUANTITIES: [Quantity; 3] = [Quantity::Mean, Quantity::P95, Quantity::P99];

/// Symmetric matrix with up to three rows, stored as its entries 11, 22, 33, 12, 13 and 23.
pub type CovarianceEntries = [f64; 6];

/// Lower and upper bounds of one quantity of `|v|`, where `v` is a normal vector with mean 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CentredBound {
    quantity: Quantity,
    rows: usize,
    /// Samples of the quantity; None for the RMS, which needs no samples.
    table: Option<&'static [f64]>,
}

impl CentredBound {
    /// Returns the bounds for a vector with `rows` components. Returns None if the quantity is the yield, or
    /// if `rows` is not 1, 2 or 3.
    pub fn new(quantity: Quantity, rows: usize) -> Option<Self> {
        static TABLES: [[OnceLock<Vec<f64>>; 3]; 3] = [const { [const { OnceLock::new() }; 3] }; 3];
        if rows == 0 || rows > 3 || quantity == Quantity::Yield {
            return None;
        }
        let of_quantity = QUANTITIES.iter().position(|q| *q == quantity);
        let table =
            of_quantity.map(|q| TABLES[q][rows - 1].get_or_init(|| samples(quantity, rows)).as_slice());
        Some(Self { quantity, rows, table })
    }

    /// Returns a lower bound of the quantity for a covariance.
    pub fn of(&self, c: &CovarianceEntries) -> f64 {
        let (size, [below, interpolated, _]) = self.samples_at(c, -ROUNDING);
        size * (1.0 - ROUNDING) * below.max(interpolated * (1.0 - CURVATURE))
    }

    /// Returns an upper bound of the quantity for a covariance.
    pub fn most(&self, c: &CovarianceEntries) -> f64 {
        let (size, [_, interpolated, above]) = self.samples_at(c, ROUNDING);
        // Near a ratio of 0, a mean exceeds its interpolated value by more than the curvature.
        let is_smooth = matches!(self.quantity, Quantity::P95 | Quantity::P99);
        let least = if is_smooth { above.min(interpolated * (1.0 + CURVATURE)) } else { above };
        size * (1.0 + ROUNDING) * least
    }

    /// Returns the square root of the largest eigenvalue of a covariance, and three samples at the eigenvalue
    /// ratios. The first and the third sample are at the next smaller and the next greater ratios. The second
    /// is interpolated.
    ///
    /// If there is no table (RMS), returns the square root of the trace, and 1 for each sample. `moved` is
    /// added to both ratios.
    #[inline]
    fn samples_at(&self, c: &CovarianceEntries, moved: f64) -> (f64, [f64; 3]) {
        let Some(table) = self.table else { return ((c[0] + c[1] + c[2]).max(0.0).sqrt(), [1.0; 3]) };
        let [largest, second, third] = self.eigenvalues(c);
        if largest <= 0.0 {
            return (0.0, [0.0; 3]);
        }
        // The index of the next smaller sample of a ratio, and the position in the interval that follows.
        let place = |value: f64, steps: usize| {
            let at = (value / largest + moved).clamp(0.0, 1.0) * steps as f64;
            let below = (at as usize).min(steps - 1);
            (below, at - below as f64)
        };
        let between = |a: f64, b: f64, share: f64| a + (b - a) * share;
        let samples = match self.rows {
            1 => [table[0]; 3],
            2 => {
                let (k, share) = place(second, PLANE_STEPS);
                [table[k], between(table[k], table[k + 1], share), table[k + 1]]
            }
            _ => {
                let ((j, in_row), (k, share)) = (place(second, SPACE_STEPS), place(third, SPACE_STEPS));
                let at = |j: usize| &table[j * (SPACE_STEPS + 1) + k..][..2];
                let [low, high] = [at(j), at(j + 1)].map(|row| between(row[0], row[1], share));
                [at(j)[0], between(low, high, in_row), at(j + 1)[1]]
            }
        };
        (largest.sqrt(), samples)
    }

    /// Returns the eigenvalues of a covariance, the largest first.
    fn eigenvalues(&self, [xx, yy, zz, xy, xz, yz]: &CovarianceEntries) -> [f64; 3] {
        if self.rows < 3 {
            let (mean, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
            let apart = (half * half + xy * xy).sqrt();
            return [mean + apart, mean - apart, 0.0];
        }
        // O. K. Smith, Comm. ACM 4 (1961) 168: the trigonometric solution of the characteristic equation.
        let mean = (xx + yy + zz) / 3.0;
        let [a, b, c] = [xx - mean, yy - mean, zz - mean];
        let size = ((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
        if size <= 0.0 {
            return [mean; 3];
        }
        let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
        let angle = (determinant / (2.0 * size * size * size)).clamp(-1.0, 1.0).acos() / 3.0;
        let largest = mean + 2.0 * size * angle.cos();
        let least = mean + 2.0 * size * (angle + std::f64::consts::TAU / 3.0).cos();
        [largest, 3.0 * mean - largest - least, least]
    }
}

/// Returns the samples of a quantity at all ratios; the largest eigenvalue is 1.
fn samples(quantity: Quantity, rows: usize) -> Vec<f64> {
    let ratio = |k: usize, steps: usize| k as f64 / steps as f64;
    let sample = |ratios: [f64; 2]| {
        let variances = [1.0, ratios[0], ratios[1]];
        let column = |k: usize| Vector6::ith(k, variances[k].sqrt());
        let columns: Vec<Vector6<f64>> = (0..rows).map(column).collect();
        let norm = NormDistribution::new(rows, &columns, &[], &Vector6::zeros());
        match quantity {
            Quantity::Mean => norm.mean(),
            Quantity::P99 => norm.quantile(0.99),
            _ => norm.quantile(0.95),
        }
    };
    match rows {
        1 => vec![sample([0.0; 2])],
        2 => (0..=PLANE_STEPS).map(|k| sample([ratio(k, PLANE_STEPS), 0.0])).collect(),
        _ => {
            let width = SPACE_STEPS + 1;
            let mut table = vec![0.0; width * width];
            for (j, k) in (0..width).flat_map(|j| (0..=j).map(move |k| (j, k))) {
                let figure = sample([ratio(j, SPACE_STEPS), ratio(k, SPACE_STEPS)]);
                (table[j * width + k], table[k * width + j]) = (figure, figure);
            }
            table
        }
    }
}
