//! Dominance of single parameters in an error, measured by their shares in its variance.

use super::jacobi::covariance;
use nalgebra::Vector6;

/// Covariance of the first `m` components of an error, from which the shares of single parameters follow.
pub struct Dominance {
    m: usize,
    covariance: [[f64; 6]; 6],
    trace: f64,
}

impl Dominance {
    /// Computes the covariance of an error from the effects of all parameters at one standard deviation.
    pub fn among(m: usize, effects: &[Vector6<f64>]) -> Self {
        let covariance = covariance(m, effects, 1.0);
        Self { m, covariance, trace: (0..m).map(|i| covariance[i][i]).sum() }
    }

    /// Returns two shares of the parameter with the effect `g`. The first share is the share in the variance
    /// of the error. The second share is the share in the variance of the component along `g`.
    ///
    /// The second share is 1 if all other effects are perpendicular to `g`.
    pub fn shares(&self, g: &Vector6<f64>) -> (f64, f64) {
        let m = 0..self.m;
        let own: f64 = m.clone().map(|i| g[i] * g[i]).sum();
        if own == 0.0 {
            return (0.0, 0.0);
        }
        let row = |i: usize| m.clone().map(|j| self.covariance[i][j] * g[j]).sum::<f64>();
        let along: f64 = m.clone().map(|i| g[i] * row(i)).sum();
        (own / self.trace, own * own / along)
    }
}
