//! Correction of the Laplace transform `L(z)` of `|e|^2` for parameters that are not normal, to second order
//! in their cumulants.
//!
//! Let parameter k have unit variance, the fourth cumulant (excess kurtosis) `gamma_k`, the sixth cumulant
//! `six_k` and the effect `g_k` on `e`. Let `mu` be the mean and `S` the covariance of `e`. The parameter
//! adds `gamma_k (g_k.t)^4 / 24 - six_k (g_k.t)^6 / 720` to the log of the characteristic function of `e` at
//! `t`. The transform is a mean over normal vectors `w ~ N(0, I)`: `exp(-z |e|^2) = E_w exp(i sqrt(2z) w.e)`.
//! Let p be the density of `w`, and f the characteristic function of the normal part of `e`. The product
//! `p(w) f(sqrt(2z) w)` equals `L` times another normal density of `w`. This other density has the covariance
//! `A^-1 = (I + 2 z S)^-1` and the mean `i sqrt(2z) A^-1 mu`. With `q_kl = z g_k^T A^-1 g_l`, `q_k = q_kk`
//! and `b_k = z g_k^T A^-1 mu`, the transform becomes
//!
//! ```text
//! L -> L [1 + t + t^2 / 2 + sum_k (-2 gamma_k b_k^2 q_k + 2/3 gamma_k b_k^4 - 1/6 six_k q_k^3)
//!           + sum_kl gamma_k gamma_l (q_k q_l q_kl^2 + q_kl^4 / 3)],   t = 1/2 sum_k gamma_k q_k^2
//! ```
//!
//! All first-order terms are included. Second-order terms that contain the mean are left out. In the
//! eigenbasis of `S` with the eigenvalues `l_i`, the bracket is a polynomial in `z r_i`. Here `r_i` is `1 /
//! (1 + 2 l_i z)`. The number of terms of this polynomial does not depend on the number of parameters.

use nalgebra::{Complex, Vector6};

/// Ratio of the sixth cumulant to the square of the fourth cumulant, for the uniform distribution.
///
/// A sum of equal uniform variables, such as a triangular one, has the same ratio.
const SIXTH_CUMULANT_RATIO: f64 = 100.0 / 21.0;

/// Principal axes of the covariance, except the axes whose eigenvalue is zero.
///
/// The first `m` components of each axis are used. `scale` converts the effects of parameters to the unit of
/// length of the spectrum.
pub struct Axes<'a> {
    pub rows: &'a [[f64; 6]],
    pub m: usize,
    pub scale: f64,
}

/// Polynomial in `z r_i` that corrects the Laplace transform: coefficients of the products of two, three and
/// four `z r_i`.
///
/// Here z is the argument of the transform, `r_i = 1 / (1 + 2 l_i z)`, and `l_i` is the i-th eigenvalue of
/// the covariance. Products are in lexicographic order of their indices.
pub struct Cumulants {
    two: [f64; 21],
    three: [f64; 56],
    four: [f64; 126],
}

/// Sums over the parameters k, for combinations of the axes a, b, c and d.
///
/// `g_ka` is the component of the effect of parameter k along axis a. `gamma_k` is the fourth cumulant of
/// this parameter, and `six_k` is the sixth cumulant.
struct Sums {
    /// Sum over k of `gamma_k g_ka g_kb g_kc g_kd` (symbols of [`Sums`]) for each a <= b <= c <= d, in
    /// lexicographic order.
    four: [f64; 126],
    /// Sum over k of `gamma_k g_ka^2 g_kb g_kc` (symbols of [`Sums`]) at `[a][b][c]`, for b <= c.
    twice: [[[f64; 6]; 6]; 6],
    /// Sum over k of `(six_k / 6) g_ka^2 g_kb^2 g_kc^2` (symbols of [`Sums`]) for each a <= b <= c, in
    /// lexicographic order.
    six: [f64; 56],
}

impl Cumulants {
    /// Returns the correction; None if all parameters are normal. `mu` holds the components of the mean along
    /// the axes.
    pub fn new(axes: &Axes, columns: &[Vector6<f64>], kurtosis: &[f64], mu: &[f64; 6]) -> Option<Self> {
        if kurtosis.iter().take(columns.len()).all(|&gamma| gamma == 0.0) {
            return None;
        }
        let n = axes.rows.len();
        let mut sums = Sums { four: [0.0; 126], twice: [[[0.0; 6]; 6]; 6], six: [0.0; 56] };
        for (column, &gamma) in columns.iter().zip(kurtosis).filter(|(_, gamma)| **gamma != 0.0) {
            let mut g = [0.0; 6];
            for (along, axis) in g.iter_mut().zip(axes.rows) {
                *along = (0..axes.m).map(|j| axis[j] * column[j]).sum::<f64>() * axes.scale;
            }
            sums.add(gamma, &g[..n]);
        }
        Some(sums.coefficients(n, mu))
    }

    /// Returns the factor that corrects the Laplace transform at z; `zr` holds `z r_i` for every axis i.
    ///
    /// Here `r_i = 1 / (1 + 2 l_i z)`, where `l_i` is the eigenvalue of axis i.
    pub fn factor(&self, zr: &[Complex<f64>]) -> Complex<f64> {
        let n = zr.len();
        let (mut at2, mut at3, mut at4) = (0, 0, 0);
        let (mut t, mut rest) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for i in 0..n {
            for j in i..n {
                let product = zr[i] * zr[j];
                t += self.two[at2] * product;
                at2 += 1;
                let mut two = Complex::new(0.0, 0.0);
                for k in j..n {
                    let mut three = Complex::new(self.three[at3], 0.0);
                    at3 += 1;
                    for z in &zr[k..] {
                        three += self.four[at4] * z;
                        at4 += 1;
                    }
                    two += three * zr[k];
                }
                rest += product * two;
            }
        }
        1.0 + t + 0.5 * t * t + rest
    }

    /// Returns the contribution of the fourth cumulants to the variance of `|e - mu|^2`: `sum gamma_k
    /// |g_k|^4`.
    ///
    /// Here `mu` is the mean of `e`. Parameter k has the effect `g_k` and the fourth cumulant `gamma_k`.
    pub fn variance(&self) -> f64 {
        2.0 * self.two.iter().sum::<f64>()
    }
}

impl Sums {
    fn add(&mut self, gamma: f64, g: &[f64]) {
        let n = g.len();
        let six = if gamma < 0.0 { SIXTH_CUMULANT_RATIO * gamma * gamma / 6.0 } else { 0.0 };
        let (mut at3, mut at4) = (0, 0);
        for i in 0..n {
            for j in i..n {
                let gij = g[i] * g[j];
                for (sum, along) in self.twice.iter_mut().zip(g) {
                    sum[i][j] += gamma * gij * along * along;
                }
                for k in j..n {
                    let gijk = gij * g[k];
                    self.six[at3] += six * gijk * gijk;
                    at3 += 1;
                    for along in &g[k..] {
                        self.four[at4] += gamma * gijk * along;
                        at4 += 1;
                    }
                }
            }
        }
    }

    fn coefficients(&self, n: usize, mu: &[f64; 6]) -> Cumulants {
        let mut all = Cumulants { two: [0.0; 21], three: [0.0; 56], four: [0.0; 126] };
        let (mut at2, mut at3, mut at4) = (0, 0, 0);
        for i in 0..n {
            for j in i..n {
                let twice = |k: usize, i: usize, j: usize| self.twice[k][i.min(j)][i.max(j)];
                all.two[at2] = 0.5 * orders(&[i, j]) * twice(i, j, j);
                at2 += 1;
                for k in j..n {
                    let part = |i: usize, j: usize, k: usize| mu[i] * mu[j] * twice(k, i, j);
                    let mixed = part(i, j, k) + part(i, k, j) + part(j, k, i);
                    all.three[at3] = -orders(&[i, j, k]) * (2.0 / 3.0 * mixed + self.six[at3]);
                    at3 += 1;
                    for l in k..n {
                        let split =
                            |b, c, a, d| twice(a, b, c) * twice(d, b, c) + twice(b, a, d) * twice(c, a, d);
                        let pairs = (split(i, j, k, l) + split(i, k, j, l) + split(i, l, j, k)) / 6.0;
                        let (one, means) = (self.four[at4], mu[i] * mu[j] * mu[k] * mu[l]);
                        let sum = 2.0 / 3.0 * one * means + pairs + one * one / 3.0;
                        all.four[at4] = orders(&[i, j, k, l]) * sum;
                        at4 += 1;
                    }
                }
            }
        }
        all
    }
}

/// Returns the number of distinct permutations of sorted indices.
fn orders(sorted: &[usize]) -> f64 {
    let (mut count, mut run) = (1, 1);
    for k in 1..sorted.len() {
        run = if sorted[k] == sorted[k - 1] { run + 1 } else { 1 };
        count = count * (k + 1) / run;
    }
    count as f64
}
