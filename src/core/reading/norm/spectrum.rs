//! Laplace transform of the squared norm `Q = |e|^2` of a nearly normal vector `e`.
//!
//! In the eigenbasis of the covariance, with eigenvalues `l_i`, mean components `mu_i` and
//! `r_i = 1 / (1 + 2 l_i z)`,
//!
//! ```text
//! L(z) = E exp(-z Q) = prod_i sqrt(r_i) exp(-mu_i^2 z r_i)
//! ```

use super::cumulants::{Axes, Cumulants};
use super::jacobi::{covariance, diagonalize};
use nalgebra::{Complex, Vector6};

/// Share of the trace below which an eigenvalue is rounding.
const EIGENVALUE_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Size below which a vector counts as zero.
const MIN_SIZE: f64 = 1e-300;

/// Transform of Q, in the unit in which the normal part has `E Q = 1`.
#[derive(Default)]
pub struct Spectrum {
    /// Number of positive eigenvalues.
    pub rank: usize,
    /// Positive eigenvalues.
    pub l: [f64; 6],
    /// Squares of the mean along the axes of these eigenvalues.
    pub mean2: [f64; 6],
    /// Square of the mean along the axes without variation, a constant part of Q.
    pub shift: f64,
    /// Square of the whole mean.
    pub square: f64,
    /// Noncentrality `sum mu_i^2 / l_i`.
    pub noncentrality: f64,
    /// Correction for parameters that are not normal; None if all are.
    pub correction: Option<Cumulants>,
}

impl Spectrum {
    /// Returns the spectrum and its unit of length; None if `e` is zero.
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

    /// Returns cumulants 1 to 3 of `Q - shift`; the second includes the fourth cumulant of `e`.
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

    /// Returns eigenvalue and squared mean along each axis with a positive eigenvalue.
    pub fn varying(&self) -> impl Iterator<Item = (f64, f64)> {
        self.l.iter().copied().zip(self.mean2).take(self.rank)
    }

    /// Returns the transform at a real z.
    pub fn real(&self, z: f64) -> f64 {
        let (mut product, mut exponent) = (1.0, self.shift * z);
        let mut zr = [Complex::new(0.0, 0.0); 6];
        for (i, (l, mean2)) in self.varying().enumerate() {
            let w = 1.0 + 2.0 * l * z;
            product *= w;
            zr[i].re = z / w;
            exponent += mean2 * zr[i].re;
        }
        (-exponent).exp() / f64::sqrt(product)
            * self.correction.as_ref().map_or(1.0, |f| f.factor(&zr[..self.rank]).re)
    }

    /// Returns the transform without mean and correction, `prod_i sqrt(r_i)`.
    pub fn central(&self, z: Complex<f64>) -> Complex<f64> {
        let one = Complex::new(1.0, 0.0);
        self.varying().fold(one, |product, (l, _)| product * principal_root(1.0 + 2.0 * l * z)).inv()
    }

    /// Returns `(h, f)` such that the transform is `central(z) exp(h - |mu|^2 z) f`.
    ///
    /// `h = sum 2 l_i mu_i^2 z^2 r_i` is due to mean and variance along the same axis, `f` to higher
    /// cumulants.
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

/// Returns the square root with a real part that is not negative.
fn principal_root(w: Complex<f64>) -> Complex<f64> {
    let t = (0.5 * (w.re.abs() + (w.re * w.re + w.im * w.im).sqrt())).sqrt();
    let other = 0.5 * w.im / t;
    if w.re >= 0.0 { Complex::new(t, other) } else { Complex::new(other.abs(), t.copysign(w.im)) }
}
