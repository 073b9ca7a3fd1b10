//! Distribution of the norm of a nearly normal vector: `|e|` with `e ~ N(mu, sum_k g_k g_k^T)`.
//!
//! It is a generalized chi distribution, known by the characteristic function (here the Laplace transform) of
//! `|e|^2`. `P(|e| <= c)` is computed by its inverse transform, not by fitting moments. It is accurate to
//! 1e-10 for normal parameters, whatever the ratios of the eigenvalues. For parameters that are not normal,
//! the fourth and sixth cumulants correct it to second order. With ten uniform parameters in three dimensions
//! it is accurate within 0.2 %, with five within 3 %. It does not suit fewer parameters.

mod bromwich;
mod cumulants;
mod jacobi;
mod spectrum;

use super::normal_quantile::normal_quantile;
use bromwich::invert;
use nalgebra::Vector6;
use spectrum::Spectrum;
use std::f64::consts::PI;

/// Distribution of `|e|`.
pub struct NormDistribution {
    /// Transform of `|e|^2`; None if `e` is zero or does not vary.
    spectrum: Option<Spectrum>,
    /// Unit of length of the spectrum, measured in the unit of the columns.
    unit: f64,
}

impl NormDistribution {
    /// Returns the distribution of the norm of the first `m` rows.
    ///
    /// `columns` are the effects of unit-variance parameters and `mean` is the mean of `e`. `kurtosis` is the
    /// excess kurtosis of the parameters, 0 beyond the end of the slice. A negative one must be that of a
    /// sum of equal uniform parameters: -1.2 for uniform, -0.6 for triangular ones.
    pub fn new(m: usize, columns: &[Vector6<f64>], kurtosis: &[f64], mean: &Vector6<f64>) -> Self {
        match Spectrum::new(m, columns, kurtosis, mean) {
            None => Self { spectrum: None, unit: 0.0 },
            Some((spectrum, unit)) => Self { spectrum: (spectrum.rank > 0).then_some(spectrum), unit },
        }
    }

    /// Returns `sqrt(E |e|^2)`, exact for any distribution of the parameters.
    pub fn rms(&self) -> f64 {
        self.unit
    }

    /// Returns the mean `E |e| = 1 / (2 sqrt(pi)) int_0^inf (1 - L(z)) z^(-3/2) dz`.
    ///
    /// The integral is a trapezoidal sum in `log z`, whose tails are geometric series.
    pub fn mean(&self) -> f64 {
        let Some(spectrum) = &self.spectrum else { return self.unit };
        let step = 0.5; // accurate to 5e-12, however far from zero
        let (first, last) = ((-11.0 / step) as i32, (26.0 / step) as i32);
        let mut sum = 0.0;
        for k in first..=last {
            let t = step * f64::from(k);
            sum += (1.0 - spectrum.real(t.exp())) * (-0.5 * t).exp();
        }
        let tail = |t: f64, power: f64| (power * t).exp() / ((power.abs() * step).exp() - 1.0);
        let second = 0.5 * (1.0 + spectrum.cumulants()[1]);
        let (start, end) = (step * f64::from(first), step * f64::from(last));
        sum += tail(start, 0.5) - second * tail(start, 1.5) + tail(end, -0.5);
        self.unit * step * sum / (2.0 * PI.sqrt())
    }

    /// Returns `P(|e| <= c)`.
    pub fn cdf(&self, c: f64) -> f64 {
        let Some(spectrum) = &self.spectrum else { return if c >= self.unit { 1.0 } else { 0.0 } };
        let c = c / self.unit;
        let rest = spectrum.shift.sqrt();
        if c <= rest {
            return 0.0;
        }
        invert(spectrum, ((c - rest) * (c + rest)).min(1e100))[0].clamp(0.0, 1.0)
    }

    /// Returns the least c with `P(|e| <= c) = p`; a p above 1 - 1e-9 counts as 1 - 1e-9.
    pub fn quantile(&self, p: f64) -> f64 {
        let Some(spectrum) = &self.spectrum else { return self.unit };
        if p <= 0.0 {
            return self.unit * spectrum.shift.sqrt();
        }
        self.unit * (spectrum.shift + above(spectrum, p.min(1.0 - 1e-9))).sqrt()
    }

    /// Returns a lower bound of `quantile(p)` at almost no cost; 0 unless all parameters are normal.
    ///
    /// No component exceeds the norm, and a mean only enlarges a component. The function belongs to the
    /// public interface: it discards hopeless postures before the exact quantile.
    pub fn quantile_lower_bound(&self, p: f64) -> f64 {
        let Some(spectrum) = &self.spectrum else { return self.unit };
        if spectrum.correction.is_some() || p <= 0.0 {
            return 0.0;
        }
        let largest = spectrum.l.iter().fold(0.0, |a: f64, &b| a.max(b));
        let z = normal_quantile(0.5 * (1.0 + p.min(1.0 - 1e-9)));
        (1.0 - 1e-8) * z * largest.sqrt() * self.unit
    }
}

/// Returns the quantile of `Q - shift` by Halley's method on the log of the nearer tail, in a bracket.
fn above(spectrum: &Spectrum, p: f64) -> f64 {
    const MAX_STEPS: usize = 200;
    let mut x = start(spectrum, p);
    let (mut low, mut high) = (0.0, f64::INFINITY);
    for _ in 0..MAX_STEPS {
        let [f, d, slope] = invert(spectrum, x);
        if f < p {
            low = x
        } else {
            high = x
        }
        let upper = p >= 0.5;
        // g and its derivatives by x, or by log x in the lower tail
        let (g, g1, g2) = if upper {
            let g1 = -d / (1.0 - f);
            (((1.0 - f) / (1.0 - p)).ln(), g1, -slope / (1.0 - f) - g1 * g1)
        } else {
            let g1 = x * d / f;
            ((f / p).ln(), g1, x * (d + x * slope) / f - g1 * g1)
        };
        let newton = -g / g1;
        let bend = (1.0 + 0.5 * newton * g2 / g1).clamp(0.5, 2.0);
        let next = if upper { x + newton / bend } else { x * (newton / bend).exp() };
        if g.abs() < 1e-13 || (high - low) / high <= 1e-15 {
            return x;
        }
        if next > low && next < high {
            x = next;
            if g.abs() < 1e-4 {
                return x;
            }
        } else {
            x = if high == f64::INFINITY { 2.0 * x } else { 0.5 * (low + high) };
        }
    }
    x
}

/// Returns a start value: the quantile of the chi-square distribution with the first three cumulants of Q.
///
/// E. B. Wilson, M. M. Hilferty, "The distribution of chi-square", PNAS 17 (1931) 684-688.
fn start(spectrum: &Spectrum, p: f64) -> f64 {
    let [k1, k2, k3] = spectrum.cumulants();
    let z = normal_quantile(p);
    let nu = 8.0 * k2 * k2 * k2 / (k3 * k3);
    let a = 2.0 / (9.0 * nu);
    let x = if a > 1e-8 {
        let cube = 1.0 - a + z * a.sqrt();
        k1 + (k2 * nu / 2.0).sqrt() * (cube * cube * cube - 1.0)
    } else {
        k1 + z * k2.sqrt()
    };
    x.max(k1 / 1024.0)
}
