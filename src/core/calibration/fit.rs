//! The fit of all unknowns to the measured positions of all sessions.

use super::accuracy::Accuracy;
use super::deformed::{Deformed, PointMotion};
use super::rigid::{SessionFrames, aligned};
use super::session::{MeasuredPosition, MeasuringSession};
use super::unknown::{Identified, Unknown};
use crate::cell::{JointVector, MAX_JOINTS};
use crate::robot::Chain;
use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use std::cmp::Ordering;

/// Largest number of Newton steps.
const STEPS: usize = 60;
/// Largest step, in standard deviations before the measurement, at which the fit has converged.
const CONVERGED: f64 = 1e-6;
/// Residual, in standard deviations per axis, above which the loss grows linearly (Huber 1964).
const HUBER: f64 = 3.0;
/// Smallest standard deviation of a measured position per axis, m.
const FINEST: f64 = 1e-9;
/// Standard deviation of the coordinates of a reflector before the measurement, m.
const FARTHEST_REFLECTOR: f64 = 1.0;
/// Number of blocks of the joint space of the cross-validation.
const BLOCKS: usize = 8;
/// 95 % quantile of the chi-squared distribution with three degrees of freedom.
const CHI_SQUARED_95: f64 = 7.814727903251179;

/// One session after the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSession {
    pub frames: SessionFrames,
    /// Distance of every measured position from the predicted one, m.
    pub distances: Vec<f64>,
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    pub identified: Vec<Identified>,
    /// Covariance of the unknowns, in products of their units (m, rad, rad/m).
    pub covariance: DMatrix<f64>,
    /// Every session after the fit.
    pub sessions: Vec<FittedSession>,
    /// Number of directions, in the space of the unknowns divided by their standard deviations, whose
    /// standard deviation the data reduce to less than half.
    pub rank: usize,
    /// The other directions: shares of the unknowns, unit length.
    pub unidentified: Vec<Vec<f64>>,
    /// Residual standard deviation per axis, m.
    pub residual: f64,
    /// Distances of measured positions from predictions of a fit without their block of the joint space, m.
    pub held_out: Option<Accuracy>,
    /// Covariance of these differences, m^2, base frame; the residual variance if there is no such fit.
    pub misfit: Matrix3<f64>,
    chain: Chain,
}

/// Fits the unknowns to the sessions; `priors` holds their standard deviations before the measurement.
///
/// Returns an error that states why the sessions cannot be fitted.
pub fn calibrate(
    chain: &Chain,
    sessions: &[MeasuringSession],
    unknowns: &[Unknown],
    priors: &[f64],
) -> Result<Calibration, String> {
    let equations: usize = sessions.iter().map(|s| 3 * s.measured.len()).sum();
    let of_sessions = sessions.iter().map(|s| SessionFrames::unknowns(&s.measured)).sum::<usize>();
    let count = unknowns.len() + of_sessions;
    if equations < count {
        return Err(format!("{equations} measured coordinates cannot determine {count} unknowns"));
    }
    let fit = Fit::new(chain, sessions, unknowns, priors)?;
    let (held_out, misfit) = cross_validated(chain, sessions, unknowns, priors);
    let values = fit.values.iter().zip(unknowns).zip(priors).enumerate();
    let identified = values.map(|(k, ((value, unknown), prior))| Identified {
        unknown: *unknown,
        value: *value,
        prior: *prior,
        sigma: fit.covariance[(k, k)].sqrt(),
    });
    let scaled = DMatrix::from_fn(unknowns.len(), unknowns.len(), |i, j| {
        fit.covariance[(i, j)] / (priors[i] * priors[j])
    });
    let eigen = SymmetricEigen::new(scaled);
    let weak = (0..unknowns.len()).filter(|&k| eigen.eigenvalues[k] >= 0.25);
    let unidentified: Vec<Vec<f64>> =
        weak.map(|k| eigen.eigenvectors.column(k).iter().copied().collect()).collect();
    let fitted = sessions.iter().zip(&fit.frames).map(|(session, frames)| {
        let residuals = fit.residuals(&session.measured, frames);
        FittedSession { frames: frames.clone(), distances: residuals.iter().map(Vector3::norm).collect() }
    });
    Ok(Calibration {
        identified: identified.collect(),
        sessions: fitted.collect(),
        rank: unknowns.len() - unidentified.len(),
        unidentified,
        residual: fit.sigma,
        held_out,
        misfit: misfit.unwrap_or(Matrix3::identity() * fit.sigma.powi(2)),
        covariance: fit.covariance,
        chain: chain.clone(),
    })
}

impl Calibration {
    /// Returns the chain with errors at actuator coordinates `q` (rad or m).
    pub fn deformed(&self, q: &JointVector) -> Deformed {
        let (unknowns, values) = self.unknowns_and_values();
        Deformed::new(&self.chain, q, &unknowns, &values)
    }

    /// Fits base and reflector to positions that were not part of the calibration.
    ///
    /// Returns the session, and the share of its positions inside their 95 % ellipsoids. An ellipsoid
    /// contains the uncertainty of the unknowns and the misfit of the cross-validation. Returns None if the
    /// positions do not determine base and reflector.
    pub fn tested(&self, measured: &[MeasuredPosition]) -> Option<(FittedSession, f64)> {
        let (unknowns, _) = self.unknowns_and_values();
        let poses: Vec<_> = measured.iter().map(|m| self.deformed(&m.joints)).collect();
        let frames = aligned(&poses, measured)?;
        let (mut distances, mut inside) = (Vec::new(), 0);
        for (pose, measured) in poses.iter().zip(measured) {
            let residual = frames.residual(&pose.interface, measured);
            let at = frames.reached(&pose.interface, measured.reflector);
            let columns: Vec<_> = unknowns.iter().map(|u| pose.motion(&self.chain, *u, &at).slope).collect();
            let jacobian = DMatrix::from_fn(3, columns.len(), |i, k| columns[k][i]);
            let spread = &jacobian * &self.covariance * jacobian.transpose();
            let spread = Matrix3::from_fn(|i, j| spread[(i, j)]) + self.misfit;
            let squared = spread.cholesky().map_or(f64::INFINITY, |c| residual.dot(&c.solve(&residual)));
            inside += usize::from(squared <= CHI_SQUARED_95);
            distances.push(residual.norm());
        }
        let share = inside as f64 / distances.len() as f64;
        Some((FittedSession { frames, distances }, share))
    }

    fn unknowns_and_values(&self) -> (Vec<Unknown>, Vec<f64>) {
        self.identified.iter().map(|i| (i.unknown, i.value)).unzip()
    }
}

/// Values of the unknowns and the frames of the sessions at the minimum.
struct Fit<'a> {
    chain: &'a Chain,
    unknowns: &'a [Unknown],
    values: Vec<f64>,
    frames: Vec<SessionFrames>,
    sigma: f64,
    covariance: DMatrix<f64>,
}

impl<'a> Fit<'a> {
    fn new(
        chain: &'a Chain,
        sessions: &[MeasuringSession],
        unknowns: &'a [Unknown],
        priors: &[f64],
    ) -> Result<Self, String> {
        let values = vec![0.0; unknowns.len()];
        let covariance = DMatrix::zeros(0, 0);
        let mut fit = Self { chain, unknowns, values, frames: Vec::new(), sigma: FINEST, covariance };
        for session in sessions {
            let poses: Vec<_> = session.measured.iter().map(|m| fit.deformed(m)).collect();
            let Some(frames) = aligned(&poses, &session.measured) else {
                let name = &session.name;
                return Err(format!("the positions of {name} do not determine the pose of the robot base"));
            };
            fit.frames.push(frames);
        }
        fit.sigma = fit.spread(sessions).max(FINEST);
        for _ in 0..STEPS {
            // Far from the minimum, the Hessian can be indefinite.
            let (hessian, right) = fit.equations(sessions, priors, 1.0);
            let factor = hessian.cholesky().or_else(|| fit.equations(sessions, priors, 0.0).0.cholesky());
            let Some(factor) = factor else {
                return Err("the measured positions do not determine base and reflector".into());
            };
            let step = factor.solve(&right);
            let (of_unknowns, of_sessions) = step.as_slice().split_at(unknowns.len());
            fit.values.iter_mut().zip(of_unknowns).for_each(|(value, by)| *value += by);
            let mut left = of_sessions;
            for (session, frames) in sessions.iter().zip(&mut fit.frames) {
                let (own, others) = left.split_at(SessionFrames::unknowns(&session.measured));
                frames.take_step(own);
                left = others;
            }
            let before = fit.sigma;
            fit.sigma = fit.spread(sessions).max(FINEST);
            fit.covariance = factor.inverse().view((0, 0), (unknowns.len(), unknowns.len())).into_owned();
            let largest =
                of_unknowns.iter().zip(priors).fold(0.0_f64, |most, (by, s)| most.max((by / s).abs()));
            if largest < CONVERGED && (fit.sigma / before - 1.0).abs() < CONVERGED {
                return Ok(fit);
            }
        }
        Err(format!("the fit has not converged after {STEPS} steps"))
    }

    fn deformed(&self, measured: &MeasuredPosition) -> Deformed {
        Deformed::new(self.chain, &measured.joints, self.unknowns, &self.values)
    }

    fn residuals(&self, measured: &[MeasuredPosition], frames: &SessionFrames) -> Vec<Vector3<f64>> {
        measured.iter().map(|m| frames.residual(&self.deformed(m).interface, m)).collect()
    }

    /// Returns the weight of a residual in the sum of squares (Huber's loss).
    fn weight(&self, residual: &Vector3<f64>) -> f64 {
        (HUBER * self.sigma / residual.norm()).min(1.0)
    }

    /// Returns the residual standard deviation per axis, m, with the present weights.
    fn spread(&self, sessions: &[MeasuringSession]) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0);
        let first = self.sigma <= FINEST;
        for (session, frames) in sessions.iter().zip(&self.frames) {
            for residual in self.residuals(&session.measured, frames) {
                let weight = if first { 1.0 } else { self.weight(&residual) };
                squares += weight * residual.norm_squared();
                count += 3.0 * weight;
            }
        }
        let of_sessions = sessions.iter().map(|s| SessionFrames::unknowns(&s.measured)).sum::<usize>();
        let unknowns = self.values.len() + of_sessions;
        (squares / (count - unknowns as f64).max(1.0)).sqrt()
    }

    /// Returns the Hessian of half the sum of squares, and its negative gradient.
    ///
    /// The Hessian has `newton` times the second derivatives of the positions: 1 for Newton's method, 0 for
    /// the method of Gauss and Newton.
    fn equations(
        &self,
        sessions: &[MeasuringSession],
        priors: &[f64],
        newton: f64,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let common = self.unknowns.len();
        let owns: Vec<_> = sessions.iter().map(|s| SessionFrames::unknowns(&s.measured)).collect();
        let size = common + owns.iter().sum::<usize>();
        let (mut normal, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut first = common;
        for ((session, frames), own) in sessions.iter().zip(&self.frames).zip(owns) {
            let count = 3 * session.measured.len();
            let mut rows = DMatrix::zeros(common + own, count);
            let mut residuals = DVector::zeros(count);
            let mut bent = DMatrix::zeros(common + own, common + own);
            for (i, measured) in session.measured.iter().enumerate() {
                let pose = self.deformed(measured);
                let at = frames.reached(&pose.interface, measured.reflector);
                let residual = frames.residual(&pose.interface, measured);
                let scale = self.weight(&residual).sqrt() / self.sigma;
                let of_chain = self.unknowns.iter().map(|u| pose.motion(self.chain, *u, &at));
                let motions: Vec<_> =
                    of_chain.chain(frames.motions(&pose.interface, measured.reflector)).collect();
                for (k, motion) in motions.iter().enumerate() {
                    let column = motion.slope * scale;
                    rows.fixed_view_mut::<1, 3>(k, 3 * i).copy_from(&column.transpose());
                }
                residuals.fixed_rows_mut::<3>(3 * i).copy_from(&(residual * scale));
                add_curvature(&mut bent, &motions, &(residual * scale.powi(2)));
            }
            let (square, along) = (&rows * rows.transpose() - bent * newton, &rows * &residuals);
            let place = |k: usize| if k < common { k } else { k - common + first };
            for i in 0..common + own {
                right[place(i)] += along[i];
                for j in 0..common + own {
                    normal[(place(i), place(j))] += square[(i, j)];
                }
            }
            // Without this, an arm whose tool is always upright leaves the height of its reflector undetermined.
            let coordinates = frames.reflectors.iter().flat_map(|r| r.iter().copied());
            for (k, coordinate) in coordinates.enumerate() {
                let k = first + SessionFrames::OF_BASE + k;
                normal[(k, k)] += FARTHEST_REFLECTOR.powi(-2);
                right[k] -= coordinate / FARTHEST_REFLECTOR.powi(2);
            }
            first += own;
        }
        for (k, prior) in priors.iter().enumerate() {
            normal[(k, k)] += prior.powi(-2);
            right[k] -= self.values[k] / prior.powi(2);
        }
        (normal, right)
    }
}

/// Adds the scalar products of `residual` with the second derivatives of a position.
///
/// The second derivative by two motions is the axis of the one nearer to the base times (vector product) the
/// displacement by the other one.
fn add_curvature(bent: &mut DMatrix<f64>, motions: &[PointMotion], residual: &Vector3<f64>) {
    for (j, a) in motions.iter().enumerate() {
        for (k, b) in motions.iter().enumerate().take(j + 1) {
            let second = match a.place.cmp(&b.place) {
                Ordering::Less => a.axis.cross(&b.slope),
                Ordering::Greater => b.axis.cross(&a.slope),
                Ordering::Equal => (a.axis.cross(&b.slope) + b.axis.cross(&a.slope)) / 2.0,
            };
            let term = residual.dot(&second);
            bent[(j, k)] += term;
            if j != k {
                bent[(k, j)] += term;
            }
        }
    }
}

/// Returns the accuracy and the covariance of predictions at positions whose block of the joint space was
/// left out of the fit; None if no such fit exists.
fn cross_validated(
    chain: &Chain,
    sessions: &[MeasuringSession],
    unknowns: &[Unknown],
    priors: &[f64],
) -> (Option<Accuracy>, Option<Matrix3<f64>>) {
    let blocks: Vec<Vec<usize>> = sessions.iter().map(|s| blocks(&s.measured)).collect();
    let mut residuals = Vec::new();
    for left_out in 0..BLOCKS {
        let split = |keep: bool| -> Vec<MeasuringSession> {
            let sessions = sessions.iter().zip(&blocks);
            sessions
                .map(|(session, blocks)| {
                    let measured = session.measured.iter().zip(blocks);
                    let kept = measured.filter(|(_, block)| (**block != left_out) == keep).map(|(m, _)| *m);
                    MeasuringSession { name: session.name.clone(), measured: kept.collect() }
                })
                .collect()
        };
        let Ok(fit) = Fit::new(chain, &split(true), unknowns, priors) else { continue };
        for (session, frames) in split(false).iter().zip(&fit.frames) {
            residuals.extend(fit.residuals(&session.measured, frames));
        }
    }
    let count = residuals.len() as f64;
    let spread = residuals.iter().map(|r| r * r.transpose()).sum::<Matrix3<f64>>() / count;
    let accuracy = Accuracy::of(residuals.iter().map(Vector3::norm).collect());
    (accuracy, accuracy.map(|_| spread))
}

/// Returns the number of the block of every position. The blocks have about equal numbers of positions; each
/// cut is at the median of the joint coordinate with the greatest variance.
///
/// Positions of different reflectors at one posture are in one block.
fn blocks(measured: &[MeasuredPosition]) -> Vec<usize> {
    let mut number = vec![0; measured.len()];
    let mut count = 1;
    while count < BLOCKS {
        for block in 0..count {
            let members: Vec<usize> = (0..measured.len()).filter(|&i| number[i] == block).collect();
            let coordinates = |joint: usize| members.iter().map(move |&i| measured[i].joints[joint]);
            let variance = |joint: usize| {
                let mean = coordinates(joint).sum::<f64>() / members.len() as f64;
                coordinates(joint).map(|q| (q - mean).powi(2)).sum::<f64>()
            };
            let widest = (0..MAX_JOINTS).max_by(|a, b| variance(*a).total_cmp(&variance(*b))).unwrap_or(0);
            let mut sorted: Vec<f64> = coordinates(widest).collect();
            sorted.sort_by(f64::total_cmp);
            let Some(median) = sorted.get(sorted.len() / 2) else { continue };
            let upper = members.iter().filter(|&&i| measured[i].joints[widest] >= *median);
            upper.for_each(|&i| number[i] = block + count);
        }
        count *= 2;
    }
    number
}
