//! Discrepancy between the linear and the nonlinear model in percent, eq. (9) of the seed paper.

use nalgebra::Vector3;

/// Discrepancy `D_i = |dNL_i - dL_i| / |dNL_i|` in percent, eq. (9) of the seed paper.
///
/// Here `dNL_i` and `dL_i` are the errors under the nonlinear and the linear model. The index i is x, y, z or
/// the resultant (length of the vector). A field is None if the nonlinear error is 0 up to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    pub x: Option<f64>,
    pub y: Option<f64>,
    pub z: Option<f64>,
    pub resultant: Option<f64>,
}

/// Returns the discrepancy between the position errors under the nonlinear and the linear model.
///
/// The field `resultant` compares the lengths of the two vectors, as in the seed paper.
pub fn discrepancy(nonlinear: &Vector3<f64>, linear: &Vector3<f64>) -> Discrepancy {
    Discrepancy {
        x: percent(nonlinear.x, linear.x),
        y: percent(nonlinear.y, linear.y),
        z: percent(nonlinear.z, linear.z),
        resultant: percent(nonlinear.norm(), linear.norm()),
    }
}

/// Threshold, m or rad, below which an error counts as a rounding error. For example, a registration can
/// leave a rounding error where the exact error is 0.
pub const NEGLIGIBLE: f64 = 1e-12;

/// Returns the deviation of a model from the nonlinear model, as a share of the length of the nonlinear
/// error.
///
/// The deviation is the length of the difference vector, divided by the length of the nonlinear error. So the
/// deviation is not 0 if the two errors have equal length but different directions. The deviation is 0 if
/// the two errors differ by rounding alone.
pub fn deviation(nonlinear: &Vector3<f64>, model: &Vector3<f64>) -> f64 {
    let (off, size) = ((model - nonlinear).norm(), nonlinear.norm());
    if off < NEGLIGIBLE { 0.0 } else { off / size.max(NEGLIGIBLE) }
}

fn percent(nonlinear: f64, linear: f64) -> Option<f64> {
    (nonlinear.abs() > NEGLIGIBLE).then(|| (nonlinear - linear).abs() / nonlinear.abs() * 100.0)
}
