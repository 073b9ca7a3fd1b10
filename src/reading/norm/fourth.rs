//! What parameters that are not normal change in the transform, to first order in their fourth
//! cumulants (exact in these; sixth and higher ones are left out).
//!
//! A unit-variance parameter of excess kurtosis `gamma_k` adds `gamma_k (g_k.t)^4 / 24` to the log of
//! the characteristic function of `e`. With `exp(-z |e|^2) = E_w exp(i sqrt(2z) w.e)`, `w ~ N(0, I)`,
//! the normal part of `e` turns `w` into a normal vector of covariance `A^-1 = (I + 2 z S)^-1` and mean
//! `i sqrt(2z) A^-1 mu`, so that, with `q_k = g_k^T A^-1 g_k` and `b_k = g_k^T A^-1 mu`,
//!
//! ```text
//! L -> L [1 + sum_k gamma_k (1/2 (z q_k)^2 - 2 (z b_k)^2 (z q_k) + 2/3 (z b_k)^4)]
//! ```
//!
//! In the eigenbasis this is a polynomial in `z r_i`: its size does not depend on the number of
//! parameters.

use nalgebra::{Complex, Vector6};

/// Axes of the covariance along which anything varies, of which `m` components count, and what turns
/// a column into the spectrum's unit.
pub struct Axes<'a> {
    pub rows: &'a [[f64; 6]],
    pub m: usize,
    pub scale: f64,
}

/// Coefficients of the sorted products of two, three and four `z r_i`, in the order of the loops.
pub struct Fourth {
    two: [f64; 21],
    three: [f64; 56],
    four: [f64; 126],
    with_mean: bool,
}

impl Fourth {
    /// None if all parameters are normal; `mu` is the mean along the axes.
    pub fn new(axes: &Axes, columns: &[Vector6<f64>], kurtosis: &[f64], mu: &[f64; 6]) -> Option<Self> {
        if kurtosis.iter().take(columns.len()).all(|&gamma| gamma == 0.0) {
            return None;
        }
        let with_mean = mu.iter().any(|&along| along != 0.0);
        let mut this = Self { two: [0.0; 21], three: [0.0; 56], four: [0.0; 126], with_mean };
        for (column, &gamma) in columns.iter().zip(kurtosis).filter(|(_, gamma)| **gamma != 0.0) {
            let (mut s, mut b) = ([0.0; 6], [0.0; 6]);
            for (i, axis) in axes.rows.iter().enumerate() {
                let g = (0..axes.m).map(|j| axis[j] * column[j]).sum::<f64>() * axes.scale;
                (s[i], b[i]) = (g * g, g * mu[i]);
            }
            this.add(gamma, &s[..axes.rows.len()], &b);
        }
        Some(this)
    }

    fn add(&mut self, gamma: f64, s: &[f64], b: &[f64; 6]) {
        let n = s.len();
        let (mut at2, mut at3, mut at4) = (0, 0, 0);
        for i in 0..n {
            for j in i..n {
                self.two[at2] += 0.5 * gamma * orders(&[i, j]) * s[i] * s[j];
                at2 += 1;
                if !self.with_mean {
                    continue;
                }
                for k in j..n {
                    let bbs = b[i] * b[j] * s[k] + b[i] * b[k] * s[j] + b[j] * b[k] * s[i];
                    self.three[at3] -= 2.0 / 3.0 * gamma * orders(&[i, j, k]) * bbs;
                    at3 += 1;
                    for l in k..n {
                        let bbbb = b[i] * b[j] * b[k] * b[l];
                        self.four[at4] += 2.0 / 3.0 * gamma * orders(&[i, j, k, l]) * bbbb;
                        at4 += 1;
                    }
                }
            }
        }
    }

    /// The factor of the transform, of `z r_i` along the axes.
    pub fn factor(&self, zr: &[Complex<f64>]) -> Complex<f64> {
        let n = zr.len();
        let (mut at2, mut at3, mut at4) = (0, 0, 0);
        let mut sum = Complex::new(1.0, 0.0);
        for i in 0..n {
            for j in i..n {
                let mut two = Complex::new(self.two[at2], 0.0);
                at2 += 1;
                for k in j..if self.with_mean { n } else { j } {
                    let mut three = Complex::new(self.three[at3], 0.0);
                    at3 += 1;
                    for z in &zr[k..] {
                        three += self.four[at4] * z;
                        at4 += 1;
                    }
                    two += three * zr[k];
                }
                sum += zr[i] * zr[j] * two;
            }
        }
        sum
    }

    /// What the fourth cumulants add to the variance of `|e - mu|^2`: `sum gamma_k |g_k|^4`.
    pub fn variance(&self) -> f64 {
        2.0 * self.two.iter().sum::<f64>()
    }
}

/// In how many orders sorted indices can be written.
fn orders(sorted: &[usize]) -> f64 {
    let (mut count, mut run) = (1, 1);
    for k in 1..sorted.len() {
        run = if sorted[k] == sorted[k - 1] { run + 1 } else { 1 };
        count = count * (k + 1) / run;
    }
    count as f64
}
