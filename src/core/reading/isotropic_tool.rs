//! Tool errors whose distribution does not change when the tool rotates about its axis.

use super::error_sources::{ErrorSources, is_behind};
use crate::cell::Parameter;
use nalgebra::{Matrix3, Vector3};

/// Largest deviation from isotropy, relative to the sum of the variances, that counts as a rounding error.
const ROUNDING: f64 = 1e-12;

/// Returns whether a rotation of the tool about `axis` (TCP frame, unit vector) leaves the distribution of
/// the TCP position error unchanged.
///
/// The result is false if the last joint may change the effect of an error of the robot ([`is_behind`]). A
/// compliance of any joint is such an error. All errors of the tool must be independent normal errors with
/// zero mean. The number of joints is `axes`. The covariance C of the tool position must be `a I + b u u^T`,
/// where u is the axis. Rotation errors of the tool leave the TCP in place.
pub fn is_isotropic(sources: &ErrorSources, axes: usize, axis: &Vector3<f64>) -> bool {
    let mut variances = Vector3::zeros();
    for source in sources.list.iter().filter(|source| is_behind(source.parameter, axes)) {
        let is_normal = source.spread.is_some() && source.kurtosis == 0.0 && source.mean == 0.0;
        match source.parameter {
            Parameter::Tool(component) if is_normal && component < 3 => {
                variances[component] = source.deviation.powi(2);
            }
            Parameter::Tool(_) if is_normal => {}
            _ => return false,
        }
    }
    let covariance = Matrix3::from_diagonal(&variances);
    let along = axis.dot(&(covariance * axis));
    let across = (variances.sum() - along) / 2.0;
    let isotropic = Matrix3::identity() * across + axis * axis.transpose() * (along - across);
    (covariance - isotropic).norm() <= ROUNDING * variances.sum()
}
