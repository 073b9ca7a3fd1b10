//! The quantile function of the standard normal distribution.

use statrs::function::erf::erfc_inv;

/// Returns the `z` with `P(Z <= z) = p` for a standard normal `Z`; infinite at p = 0 and p = 1.
pub fn normal_quantile(p: f64) -> f64 {
    -std::f64::consts::SQRT_2 * erfc_inv(2.0 * p)
}
