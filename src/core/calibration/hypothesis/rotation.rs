//! Convention of measured orientations, found by how well they fit the nominal robot.

use super::data_reading::DataReading;
use super::spread_out::spread_out;
use crate::calibration::raw::{RawMeasurement, RawRotation, RotationConvention};
use crate::robot::Chain;
use crate::units::rad_from_deg;
use nalgebra::{Matrix3, Vector3};

/// Interpretation of the orientations in a file of measured positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationReading {
    pub convention: RotationConvention,
    /// Whether angles are in degrees, not rad.
    pub degrees: bool,
    /// Root mean square angle between measured and nominal orientations, rad; base and tool are fitted.
    pub rms: f64,
}

/// Largest plausible root mean square angle, rad, between measured and nominal orientations.
const IMPLAUSIBLE: f64 = 0.05;

/// Largest number of rows with which the conventions are compared.
const ROWS: usize = 80;

/// Least number of orientations with which conventions are compared.
const MIN_ORIENTATIONS: usize = 4;

impl RotationReading {
    /// Returns the measured orientation in the frame of the instrument; None if its numbers are not a
    /// rotation.
    pub fn applied(&self, raw: &RawRotation) -> Option<Matrix3<f64>> {
        self.convention.matrix(raw, if self.degrees { rad_from_deg(1.0) } else { 1.0 })
    }

    /// Returns whether the nominal arm explains the orientations.
    pub fn is_plausible(&self) -> bool {
        self.rms < IMPLAUSIBLE
    }
}

/// Returns the convention that explains the orientations best; `reading` is the interpretation of joints and
/// positions.
///
/// Returns None if there are fewer than four orientations, or if the positions are mirrored.
pub fn explain_rotations(
    chain: &Chain,
    reading: &DataReading,
    raw: &[RawMeasurement],
) -> Option<RotationReading> {
    let own: Vec<_> = raw.iter().filter_map(|m| Some((m, m.rotation?))).collect();
    if own.len() < MIN_ORIENTATIONS || reading.mirrored {
        return None;
    }
    let some: Vec<_> = spread_out(own.len(), ROWS).into_iter().map(|k| own[k]).collect();
    let nominal: Vec<Matrix3<f64>> = some
        .iter()
        .map(|(m, _)| {
            let q = reading.joints.applied(chain, &m.numbers.joints, reading.degrees, reading.unit);
            chain.frames(&chain.posture(&q)).links[chain.axes()].rotation
        })
        .collect();
    let conventions = RotationConvention::of(&some.first()?.1);
    let readings = conventions.iter().flat_map(|&convention| {
        let rms = f64::INFINITY;
        [true, false].map(|degrees| RotationReading { convention, degrees, rms })
    });
    let judged = readings.filter_map(|reading| {
        let measured = some.iter().map(|(_, raw)| reading.applied(raw)).collect::<Option<Vec<_>>>()?;
        Some(RotationReading { rms: distance(&nominal, &measured)?, ..reading })
    });
    judged.min_by(|a, b| a.rms.total_cmp(&b.rms))
}

/// Returns the root mean square angle, rad, between `measured` and `B nominal F` with the best constant
/// rotations B and F.
///
/// Let M_i be the measured and N_i the nominal orientations. Rotations between successive orientations
/// satisfy `M_i' M_(i+1) = F' (N_i' N_(i+1)) F`, where a prime denotes the transpose. So F rotates the axes
/// of the measured rotations onto the axes of the nominal rotations.
fn distance(nominal: &[Matrix3<f64>], measured: &[Matrix3<f64>]) -> Option<f64> {
    let axes = |of: &[Matrix3<f64>]| -> Vec<Vector3<f64>> {
        of.windows(2).map(|pair| doubled_axis(&(pair[0].transpose() * pair[1]))).collect()
    };
    let pairs = axes(nominal).into_iter().zip(axes(measured));
    let tool = nearest_rotation(&pairs.map(|(n, m)| n * m.transpose()).sum())?;
    let bases: Vec<_> = nominal.iter().zip(measured).map(|(n, m)| m * (n * tool).transpose()).collect();
    let base = nearest_rotation(&bases.iter().sum())?;
    let squares: f64 = bases.iter().map(|own| angle(&(base.transpose() * own)).powi(2)).sum();
    Some((squares / bases.len() as f64).sqrt()).filter(|rms| rms.is_finite())
}

/// Returns the angle of a rotation, rad. The result is accurate even near 0.
fn angle(r: &Matrix3<f64>) -> f64 {
    doubled_axis(r).norm().atan2(r.trace() - 1.0)
}

/// Returns the rotation axis times twice the sine of the angle.
fn doubled_axis(r: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)])
}

/// Returns the rotation nearest to a matrix.
fn nearest_rotation(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let svd = matrix.svd(true, true);
    let (u, v) = (svd.u?, svd.v_t?);
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
    Some(u * mirror * v)
}
