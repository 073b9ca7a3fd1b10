//! Laplace transform of the squared norm `Q = |e|^2` of a nearly normal vector `e`.
//!
//! The covariance of `e` has the eigenvalues `l_i`, and the mean of `e` has the components `mu_i` along the
//! eigenvectors. With `r_i = 1 / (1 + 2 l_i z)`, the transform for normal `e` is
//!
//! ```text
//! L(z) = E exp(-z Q) = prod_i sqrt(r_i) exp(-mu_i^2 z r_i)
//! ```

use super::cumulants::{Axes, Cumulants};
use super::jacobi::{covariance, diagonalize};
use nalgebra::{Complex, Vector6};
use std::ops::{Add, Mul};

/// An eigenvalue counts as zero if it is below this share of the trace of the covariance, because it may be a
/// rounding error.
const EIGENVALUE_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Limit of the components: a vector counts as zero if all its components are smaller in absolute value.
const MIN_SIZE: f64 = 1e-300;

/// Exponents of a smaller absolute value use the first terms of the exponential series, to rounding
/// accuracy. The mean of an error is often small, and then all exponents are small.
const SMALL_EXPONENT: f64 = 1e-3;

/// Laplace transform of `Q = |e|^2` for a nearly normal vector `e`.
///
/// The unit of length is the RMS of `|e|`, so `Q` has the mean 1.
#[derive(Default)]
pub struct Spectrum {
    /// Number of positive eigenvalues of the covariance of `e`.
    pub rank: usize,
    /// Positive eigenvalues of the covariance of `e`; the unused tail is zero.
    pub l: [f64; 6],
    /// Squares of the components of the mean of `e` along the eigenvectors with a positive eigenvalue.
    pub mean2: [f64; 6],
    /// Constant part of `|e|^2`: the squared length of the mean in the directions in which `e` does not vary.
    pub shift: f64,
    /// Squared length of the mean of `e`.
    pub square: f64,
    /// Noncentrality `sum mu_i^2 / l_i`, where `l_i` is an eigenvalue and `mu_i` the component of the mean
    /// along its eigenvector.
    pub noncentrality: f64,
    /// Correction for parameters that are not normal; None if all parameters are normal.
    pub correction: Option<Cumulants>,
}

impl Spectrum {
    /// Returns the spectrum of a vector `e` and the unit of length, the RMS of `|e|`; None if `e` is zero.
    pub fn new(
        m: usize,
        columns: &[Vector6<f64>],
        kurtosis: &[f64],
        mean: &Vector6<f64>,
    ) -> Option<(Self, f64)> {
        let m = m.clamp(1, 6);
        let largest = |v: &Vector6<f64>| v.as_slice()[..m].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let size = columns.iter().map(largest).fold(largest(mean), f64::max);
        if size < MIN_SIZE {
            return None;
        }
        let mut s = covariance(m, columns, 1.0 / size);
        let trace: f64 = (0..m).map(|i| s[i][i]).sum();
        let square: f64 = (0..m).map(|i| (mean[i] / size).powi(2)).sum();
        let axes = diagonalize(m, &mut s);
        let unit = (trace + square).sqrt();
        let mut this = Self { square: square / (unit * unit), ..Self::default() };
        let (mut varying, mut mu) = ([[0.0; 6]; 6], [0.0; 6]);
        let floor = (EIGENVALUE_ROUNDING * trace).max(1e-30 * square);
        for (i, axis) in axes.iter().enumerate().take(m) {
            let along = (0..m).map(|j| axis[j] * mean[j]).sum::<f64>() / size / unit;
            if s[i][i] <= floor {
                this.shift += along * along;
                continue;
            }
            let (k, l) = (this.rank, s[i][i] / (unit * unit));
            (this.l[k], this.mean2[k]) = (l, along * along);
            this.noncentrality += along * along / l;
            (varying[k], mu[k]) = (*axis, along);
            this.rank += 1;
        }
        let to_axes = Axes { rows: &varying[..this.rank], m, scale: 1.0 / size / unit };
        this.correction = Cumulants::new(&to_axes, columns, kurtosis, &mu);
        Some((this, size * unit))
    }

    /// Returns the first three cumulants of `Q - shift`, where `Q = |e|^2` and `shift` is the constant part
    /// of `Q`.
    ///
    /// The second cumulant includes the effect of the excess kurtosis of the parameters. The effect on the
    /// third cumulant is estimated.
    pub fn cumulants(&self) -> [f64; 3] {
        let mut k = [0.0; 3];
        for (l, mean2) in self.varying() {
            k[0] += l + mean2;
            k[1] += 2.0 * l * (l + 2.0 * mean2);
            k[2] += 8.0 * l * l * (l + 3.0 * mean2);
        }
        let more = self.correction.as_ref().map_or(0.0, Cumulants::variance);
        let ratio = ((k[1] + more) / k[1]).max(0.05);
        [k[0], k[1] * ratio, k[2] * ratio * ratio.sqrt()]
    }

    /// Returns each positive eigenvalue, with the squared component of the mean along its eigenvector.
    pub fn varying(&self) -> impl Iterator<Item = (f64, f64)> {
        self.l.iter().copied().zip(self.mean2).take(self.rank)
    }

    /// Returns the Laplace transform of `|e|^2` at a real z.
    pub fn real(&self, z: f64) -> f64 {
        let (mut product, mut exponent) = (1.0, self.shift * z);
        let mut zr = [Complex::new(0.0, 0.0); 6];
        for (i, (l, mean2)) in self.varying().enumerate() {
            let w = 1.0 + 2.0 * l * z;
            product *= w;
            zr[i].re = z / w;
            exponent += mean2 * zr[i].re;
        }
        let decay = if exponent < SMALL_EXPONENT { series(-exponent) } else { (-exponent).exp() };
        decay / f64::sqrt(product) * self.correction.as_ref().map_or(1.0, |f| f.factor(&zr[..self.rank]).re)
    }

    /// Returns the Laplace transform for a zero mean and normal parameters: `prod_i 1 / sqrt(1 + 2 l_i z)`.
    ///
    /// Here `l_i` is the i-th eigenvalue of the covariance.
    pub fn central(&self, z: Complex<f64>) -> Complex<f64> {
        let one = Complex::new(1.0, 0.0);
        self.varying().fold(one, |product, (l, _)| product * principal_root(1.0 + 2.0 * l * z)).inv()
    }

    /// Returns `(h, f)` such that the Laplace transform of `|e|^2` is `central(z) exp(h - |mu|^2 z) f`.
    ///
    /// Here `mu` is the mean of `e`.
    ///
    /// The term `h = sum 2 l_i mu_i^2 z^2 r_i` is due to mean and variance along the same axis. Here `l_i` is
    /// the i-th eigenvalue, `mu_i` the component of the mean along its axis, and `r_i = 1 / (1 + 2 l_i z)`.
    /// The factor `f` is due to the higher cumulants of the parameters.
    pub fn factors(&self, z: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
        let mut h = Complex::new(0.0, 0.0);
        let mut zr = [h; 6];
        for (i, (l, mean2)) in self.varying().enumerate() {
            let w = 1.0 + 2.0 * l * z;
            zr[i] = z * w.conj() / w.norm_sqr();
            h += 2.0 * l * mean2 * (z * zr[i]);
        }
        (h, self.correction.as_ref().map_or(Complex::new(1.0, 0.0), |f| f.factor(&zr[..self.rank])))
    }
}

/// Returns `exp(w)`.
pub fn exponential(w: Complex<f64>) -> Complex<f64> {
    if w.norm_sqr() < SMALL_EXPONENT * SMALL_EXPONENT { series(w) } else { w.exp() }
}

/// Returns the terms of the exponential series up to the fourth power.
fn series<T>(x: T) -> T
where
    T: Copy + Add<f64, Output = T> + Mul<Output = T> + Mul<f64, Output = T>,
{
    let inner = x * (1.0 / 24.0) + 1.0 / 6.0;
    x * (x * (x * inner + 0.5) + 1.0) + 1.0
}

/// Returns the square root whose real part is not negative.
fn principal_root(w: Complex<f64>) -> Complex<f64> {
    let t = (0.5 * (w.re.abs() + (w.re * w.re + w.im * w.im).sqrt())).sqrt();
    let other = 0.5 * w.im / t;
    if w.re >= 0.0 { Complex::new(t, other) } else { Complex::new(other.abs(), t.copysign(w.im)) }
}
