//! Discrepancy of the linear model from the nonlinear one in percent, eq. (9).

use nalgebra::Vector3;

/// Discrepancy `D_i = |dNL_i - dL_i| / |dNL_i|` in percent, for x, y, z and the resultant.
///
/// A component is None where the nonlinear error vanishes and the ratio is undefined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    pub x: Option<f64>,
    pub y: Option<f64>,
    pub z: Option<f64>,
    pub resultant: Option<f64>,
}

/// Returns the discrepancy of two position errors. The resultant compares their sizes, as in the seed paper.
pub fn discrepancy(nonlinear: &Vector3<f64>, linear: &Vector3<f64>) -> Discrepancy {
    Discrepancy {
        x: percent(nonlinear.x, linear.x),
        y: percent(nonlinear.y, linear.y),
        z: percent(nonlinear.z, linear.z),
        resultant: percent(nonlinear.norm(), linear.norm()),
    }
}

/// Size, m or rad, below which an error is only rounding, for example after a registration has removed it.
pub const NEGLIGIBLE: f64 = 1e-12;

/// Returns the deviation of a model from the nonlinear one, as a share of the nonlinear resultant.
///
/// It compares vectors, so that two different errors of equal size do not agree. It is 0 if they
/// differ by rounding alone.
pub fn deviation(nonlinear: &Vector3<f64>, model: &Vector3<f64>) -> f64 {
    let (off, size) = ((model - nonlinear).norm(), nonlinear.norm());
    if off < NEGLIGIBLE { 0.0 } else { off / size.max(NEGLIGIBLE) }
}

fn percent(nonlinear: f64, linear: f64) -> Option<f64> {
    (nonlinear.abs() > NEGLIGIBLE).then(|| (nonlinear - linear).abs() / nonlinear.abs() * 100.0)
}
