//! The distribution of the length of a nearly normal vector: `|e|`, `e ~ N(mu, sum_k g_k g_k^T)`.
//!
//! Nothing here is fitted to moments: `P(|e| <= c)` is the inverse Laplace transform of that of
//! `|e|^2`, good to 1e-10 for normal parameters, whatever the ratios of the eigenvalues. Parameters
//! that are not normal enter by their fourth and sixth cumulants, to second order: ten uniform ones
//! in space come out within 0.2 %, five within 3 %, fewer are not meant.

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
    /// None where `e` is zero or does not vary.
    spectrum: Option<Spectrum>,
    /// Metres, or whatever the columns are in, of the spectrum's unit.
    unit: f64,
}

impl NormDistribution {
    /// `columns`: effect of each unit-variance parameter, of which the first `m` rows count;
    /// `kurtosis`: their excess kurtosis (0 where the slice ends early), a negative one that of a sum of
    /// alike uniform parameters (-1.2 uniform, -0.6 triangular); `mean`: the mean of `e`.
    pub fn new(m: usize, columns: &[Vector6<f64>], kurtosis: &[f64], mean: &Vector6<f64>) -> Self {
        match Spectrum::new(m, columns, kurtosis, mean) {
            None => Self { spectrum: None, unit: 0.0 },
            Some((spectrum, unit)) => Self { spectrum: (spectrum.rank > 0).then_some(spectrum), unit },
        }
    }

    /// `sqrt(E |e|^2)`: exact, whatever the parameters' distributions.
    pub fn rms(&self) -> f64 {
        self.unit
    }

    /// `E |e| = 1 / (2 sqrt(pi)) int_0^inf (1 - L(z)) z^(-3/2) dz`, by the trapezoid rule in `log z`,
    /// whose tails are geometric series.
    pub fn mean(&self) -> f64 {
        let Some(spectrum) = &self.spectrum else { return self.unit };
        let step = 0.5; // 5e-12, however far from zero
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

    /// `P(|e| <= c)`.
    pub fn cdf(&self, c: f64) -> f64 {
        let Some(spectrum) = &self.spectrum else { return if c >= self.unit { 1.0 } else { 0.0 } };
        let c = c / self.unit;
        let rest = spectrum.shift.sqrt();
        if c <= rest {
            return 0.0;
        }
        invert(spectrum, ((c - rest) * (c + rest)).min(1e100))[0].clamp(0.0, 1.0)
    }

    /// The least c with `P(|e| <= c) = p`, for p up to 1 - 1e-9 (above, that of 1 - 1e-9).
    pub fn quantile(&self, p: f64) -> f64 {
        let Some(spectrum) = &self.spectrum else { return self.unit };
        if p <= 0.0 {
            return self.unit * spectrum.shift.sqrt();
        }
        self.unit * (spectrum.shift + above(spectrum, p.min(1.0 - 1e-9))).sqrt()
    }

    /// No more than `quantile(p)`, at the cost of nothing: no component exceeds the norm, and a mean
    /// only makes a component larger. 0 unless all parameters are normal.
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

/// The quantile of `Q - shift`: third-order steps on the log of the nearer tail, in a bracket.
fn above(spectrum: &Spectrum, p: f64) -> f64 {
    let mut x = start(spectrum, p);
    let (mut low, mut high) = (0.0, f64::INFINITY);
    for _ in 0..200 {
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

/// The chi-square distribution with the first three cumulants of Q, by Wilson and Hilferty.
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
