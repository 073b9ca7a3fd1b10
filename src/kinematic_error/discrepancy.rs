//! Eq. (9): how far the linearized model is from the nonlinear one, in percent.

use nalgebra::Vector3;

/// `D_i = |dNL_i - dL_i| / |dNL_i|` in percent, for x, y, z and the resultant r. None where the
/// nonlinear error vanishes, for there the ratio says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    pub x: Option<f64>,
    pub y: Option<f64>,
    pub z: Option<f64>,
    pub resultant: Option<f64>,
}

/// Compares two position errors of one node. The resultant is compared as the paper does: size with
/// size.
pub fn discrepancy(nonlinear: &Vector3<f64>, linear: &Vector3<f64>) -> Discrepancy {
    Discrepancy {
        x: percent(nonlinear.x, linear.x),
        y: percent(nonlinear.y, linear.y),
        z: percent(nonlinear.z, linear.z),
        resultant: percent(nonlinear.norm(), linear.norm()),
    }
}

/// Below this an error is rounding, m or rad: where it was taken off by what was measured with the
/// robot itself.
pub const NOTHING: f64 = 1e-12;

/// How far a model is from the nonlinear one, as a share of the nonlinear resultant: vector against
/// vector, so that nothing hides in a size that happens to agree. 0 if they differ by rounding.
pub fn deviation(nonlinear: &Vector3<f64>, model: &Vector3<f64>) -> f64 {
    let (off, size) = ((model - nonlinear).norm(), nonlinear.norm());
    if off < NOTHING { 0.0 } else { off / size.max(NOTHING) }
}

fn percent(nonlinear: f64, linear: f64) -> Option<f64> {
    (nonlinear.abs() > NOTHING).then(|| (nonlinear - linear).abs() / nonlinear.abs() * 100.0)
}
