//! Comparison of one measured session with the predicted errors, pose by pose.

use super::compared_pose::ComparedPose;
use super::prediction::{PredictedErrors, ReflectorErrors};
use super::rank_correlation::rank_correlation;
use super::repeats::Repeatability;
use super::spots::SpotRanking;
use crate::calibration::{
    Accuracy, CHI_SQUARED_95, Deformed, MeasuredPosition, MeasuringSession, PositionJacobians, SessionFrames,
    aligned, jacobian, taken_up,
};
use crate::robot::Frames;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Least standard deviation of a measured position per axis, m; no instrument is more accurate.
const FINEST: f64 = 1e-6;

/// Largest distance, m, between the positions of a reflector in the fits of two arms.
const FARTHEST: f64 = 0.3;

/// Measured and predicted errors of one session.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredComparison {
    /// Name of the session.
    pub name: String,
    pub poses: Vec<ComparedPose>,
    /// Statistics of the sizes of the measured errors.
    pub measured: Accuracy,
    /// Statistics of the predicted sizes of the errors.
    pub predicted: Accuracy,
    /// Statistics of the sizes of the differences between measured and predicted errors.
    pub residual: Accuracy,
    /// Share of the poses whose measured error is inside its 95 % ellipsoid; None if the prediction contains
    /// no random deviations.
    pub coverage: Option<f64>,
    /// Share of the poses whose measured error is inside a second 95 % ellipsoid. The second ellipsoid
    /// assumes that the random errors of the parameters change from pose to pose. None unless the errors of
    /// the error set are measured.
    ///
    /// The covariance of a calibration contains the misfit of the calibrated model. This misfit changes with
    /// the posture, and the second ellipsoid takes this change into account.
    pub coverage_varying: Option<f64>,
    /// Spearman correlation of predicted and measured sizes over all poses; None if all predicted sizes are
    /// equal, or if all measured sizes are equal.
    pub correlation: Option<f64>,
    pub ranking: SpotRanking,
    /// Repeated postures; None if no posture was visited twice.
    pub repeats: Option<Repeatability>,
}

impl MeasuredComparison {
    /// Compares a session with predicted errors. The function also groups the poses by command position
    /// ([`SpotRanking`]). Along every axis, all command positions of a group are within `spot` (m) of the
    /// first command position of the group.
    ///
    /// # Errors
    /// Returns the reason why base and reflectors cannot be fitted.
    pub fn new(errors: &PredictedErrors, session: &MeasuringSession, spot: f64) -> Result<Self, String> {
        let measured = &session.measured;
        let (known, unknown) = (3 * measured.len(), SessionFrames::unknowns(measured));
        if known <= unknown {
            return Err(format!(
                "{known} measured coordinates cannot determine the {unknown} unknowns of base and reflectors"
            ));
        }
        let chain = errors.chain();
        let nominal: Vec<_> = measured.iter().map(|m| Deformed::new(chain, &m.joints, &[], &[])).collect();
        let fitted =
            || aligned(&nominal, measured).and_then(|frames| compared(errors, measured, &nominal, &frames));
        let poses = fitted().ok_or("the measured positions do not determine the pose of the robot base")?;
        let tcp: Vec<_> =
            nominal.iter().map(|pose| pose.interface.transform(&chain.tool.translation)).collect();
        let sizes = |of: fn(&ComparedPose) -> f64| poses.iter().map(of).collect::<Vec<_>>();
        let (of_measured, of_predicted) = (sizes(|p| p.measured.norm()), sizes(|p| p.size));
        let share = |of: fn(&ComparedPose) -> Option<bool>| {
            let known: Vec<bool> = poses.iter().filter_map(of).collect();
            let inside = known.iter().filter(|is_inside| **is_inside).count();
            (!known.is_empty()).then(|| inside as f64 / known.len() as f64)
        };
        let (coverage, coverage_varying) = (share(|p| p.is_inside), share(|p| p.is_inside_varying));
        let accuracy = |sizes: Vec<f64>| Accuracy::of(sizes).ok_or("there are no measured positions");
        Ok(Self {
            name: session.name.clone(),
            correlation: rank_correlation(&of_predicted, &of_measured),
            measured: accuracy(of_measured)?,
            predicted: accuracy(of_predicted)?,
            residual: accuracy(sizes(|p| p.residual().norm()))?,
            coverage,
            coverage_varying,
            ranking: SpotRanking::new(&poses, &tcp, spot).ok_or("there are no measured positions")?,
            repeats: Repeatability::of(&poses),
            poses,
        })
    }
}

/// Returns the positions of the reflectors that fit best to an arm with the mean errors of the prediction, in
/// the frame of the mechanical interface, m.
///
/// The nominal arm may leave the height of a reflector undetermined, for example if the mechanical interface
/// always points down. The tilts of an arm with errors often determine this height. A position that is far
/// from the fit of the nominal arm is determined by neither, and the fit of the nominal arm is kept.
fn reflectors_of_prediction(
    errors: &PredictedErrors,
    measured: &[MeasuredPosition],
    nominal: &[Deformed],
    frames: &SessionFrames,
) -> Option<Vec<Vector3<f64>>> {
    let interface = errors.at_reflector(&Vector3::zeros());
    let with_errors = measured.iter().zip(nominal).map(|(m, pose)| {
        let displacement = interface.mean_displacement(&interface.frames(&m.joints));
        pose.clone().displaced(&displacement)
    });
    let found = aligned(&with_errors.collect::<Vec<_>>(), measured)?.reflectors;
    let both = frames.reflectors.iter().zip(found);
    Some(both.map(|(own, found)| if (own - found).norm() < FARTHEST { found } else { *own }).collect())
}

/// Compares all poses of a session; `frames` is the fit of the nominal arm to the measured positions.
fn compared(
    errors: &PredictedErrors,
    measured: &[MeasuredPosition],
    nominal: &[Deformed],
    frames: &SessionFrames,
) -> Option<Vec<ComparedPose>> {
    let reflectors = reflectors_of_prediction(errors, measured, nominal, frames)?;
    let mut reflectors: Vec<ReflectorErrors<'_>> =
        reflectors.iter().map(|reflector| errors.at_reflector(reflector)).collect();
    let postures: Vec<Frames> = measured.iter().map(|m| reflectors[m.reflector].frames(&m.joints)).collect();
    let predicted = measured.iter().zip(&postures).map(|(m, posture)| MeasuredPosition {
        position: posture.tcp.translation + reflectors[m.reflector].mean(posture),
        ..*m
    });
    let predicted: Vec<_> = predicted.collect();
    let of_prediction = aligned(nominal, &predicted)?;
    let mut spreads = vec![None; measured.len()];
    if errors.has_deviations() {
        let of_position = |((m, posture), pose): ((&MeasuredPosition, &Frames), &Deformed)| {
            let of_chain = reflectors[m.reflector].deviations(posture);
            let of_frames = frames.motions(&pose.interface, m.reflector);
            (jacobian(of_chain.into_iter()), jacobian(of_frames.iter().map(|motion| motion.slope)))
        };
        let columns: Vec<PositionJacobians> =
            measured.iter().zip(&postures).zip(nominal).map(of_position).collect();
        let taken_up = taken_up(&columns)?;
        let constant = columns.iter().map(|(of_chain, of_frames)| {
            let free = of_chain - of_frames * &taken_up;
            &free * free.transpose()
        });
        let both = constant.zip(varying_spreads(&columns)?);
        let sized = |spread: DMatrix<f64>| Matrix3::from_fn(|i, j| spread[(i, j)]);
        spreads = both.map(|(constant, varying)| Some([sized(constant), sized(varying)])).collect();
    }
    let poses = measured.iter().zip(&predicted).zip(nominal).zip(spreads);
    Some(
        poses
            .map(|(((measured, predicted), pose), spread)| {
                let by = frames.residual(&pose.interface, measured);
                let mean = of_prediction.residual(&pose.interface, predicted);
                // A mean this small is a rounding error, which has no direction, size or rank.
                let mean = if mean.norm() < FINEST { Vector3::zeros() } else { mean };
                let variance = spread
                    .filter(|_| errors.counts_deviations())
                    .map_or(0.0, |[constant, _]| constant.trace());
                let is_in = |spread: &Matrix3<f64>| is_inside(&(by - mean), spread, measured.sigma);
                ComparedPose {
                    row: measured.row,
                    joints: measured.joints,
                    reflector: measured.reflector,
                    nominal: frames.reached(&pose.interface, measured.reflector),
                    measured: by,
                    predicted: mean,
                    size: (mean.norm_squared() + variance).sqrt(),
                    is_inside: spread.map(|[constant, _]| is_in(&constant)),
                    is_inside_varying: spread
                        .filter(|_| errors.may_vary())
                        .map(|[_, varying]| is_in(&varying)),
                }
            })
            .collect(),
    )
}

/// Returns the covariances (m^2) of residuals whose random errors are independent from pose to pose.
///
/// The fit of the frames adds a part of the errors of all poses to each residual. Let e be the error at one
/// pose, F the Jacobian of the frames at this pose, and `N = sum F^T F`. The residual is `e - F N^-1 sum F^T
/// e`.
fn varying_spreads(columns: &[PositionJacobians]) -> Option<Vec<DMatrix<f64>>> {
    let frames = columns.first()?.1.ncols();
    let own: Vec<_> = columns.iter().map(|(of_chain, _)| of_chain * of_chain.transpose()).collect();
    let mut normal = DMatrix::identity(frames, frames) * 1e-12;
    let mut of_all = DMatrix::zeros(frames, frames);
    for ((_, f), own) in columns.iter().zip(&own) {
        normal += f.transpose() * f;
        of_all += f.transpose() * own * f;
    }
    let inverse = normal.cholesky()?.inverse();
    let of_fit = &inverse * of_all * &inverse;
    let residual = |((_, f), own): (&PositionJacobians, &DMatrix<f64>)| {
        let shared = f * &inverse * f.transpose() * own;
        own - &shared - shared.transpose() + f * &of_fit * f.transpose()
    };
    Some(columns.iter().zip(&own).map(residual).collect())
}

/// Returns whether a residual (m) is inside the 95 % ellipsoid of the errors of prediction and measurement.
fn is_inside(residual: &Vector3<f64>, spread: &Matrix3<f64>, sigma: Option<f64>) -> bool {
    let own = sigma.unwrap_or(0.0).max(FINEST);
    let covariance = spread + Matrix3::identity() * own.powi(2);
    covariance.cholesky().is_some_and(|c| residual.dot(&c.solve(residual)) <= CHI_SQUARED_95)
}
