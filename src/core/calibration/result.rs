//! Result of a calibration of a robot, and its test with other measured positions.

use super::accuracy::Accuracy;
use super::deformed::Deformed;
use super::fit::{Fit, Residual, spreads};
use super::fit_state::{FitProblem, drives};
use super::residual_variances::ResidualVariances;
use super::rigid::{SessionFrames, aligned};
use super::session::{MeasuredPosition, MeasuringSession};
use super::taken_up::{PositionJacobians, jacobian, taken_up};
use super::unknown::{Identified, Unknown};
use super::validation::held_out;
use crate::cell::JointVector;
use crate::robot::Chain;
use nalgebra::{DMatrix, SymmetricEigen};

/// 95 % quantile of the chi-squared distribution with three degrees of freedom.
pub const CHI_SQUARED_95: f64 = 7.814727903251179;
/// Distance above which a position does not count for the fit of base and reflectors to a test, as a multiple
/// of the median distance.
const GROSS: f64 = 10.0;
/// Largest number of such fits.
const ROUNDS: usize = 10;
/// Normalized residual above which a position is an outlier.
const OUTLIER: f64 = 6.0;

/// One session after the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSession {
    pub frames: SessionFrames,
    /// Distance of every measured position from the predicted position, m.
    pub distances: Vec<f64>,
    /// Row and distance (m) of every outlier. An outlier is a position with a normalized residual above 6.
    pub outliers: Vec<(usize, f64)>,
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Unknowns after the fit, harmonics last.
    pub identified: Vec<Identified>,
    /// Covariance of the unknowns, in products of their units (m, rad, rad/m).
    pub covariance: DMatrix<f64>,
    /// Every session after the fit.
    pub sessions: Vec<FittedSession>,
    /// Number of identified directions. In an identified direction, the standard deviation after the fit is
    /// less than half the prior standard deviation. The space of these directions has one coordinate for each
    /// unknown that is not a harmonic. Every coordinate is divided by the prior standard deviation of its
    /// unknown.
    pub rank: usize,
    /// Directions that the data do not identify, as unit vectors. Each vector has one component for each
    /// unknown that is not a harmonic. Every component is divided by the prior standard deviation of its
    /// unknown.
    pub unidentified: Vec<Vec<f64>>,
    /// Root mean square of the residuals per axis, m.
    pub residual: f64,
    /// Statistics of the distances (m) between measured and predicted positions in the cross-validation. Each
    /// prediction comes from a fit without the block of the joint space that contains the position. None
    /// means that no block can be left out.
    pub held_out: Option<Accuracy>,
    /// Variances of the errors that the parameters do not explain.
    pub misfit: ResidualVariances,
    /// Least and largest measured coordinate of every joint, rad or m.
    pub ranges: Vec<(f64, f64)>,
    chain: Chain,
}

/// Fits the unknowns to the sessions; `priors` holds the prior standard deviations of the unknowns.
///
/// Harmonics must come after all other unknowns. The fit adjusts the prior standard deviations of the
/// harmonics.
///
/// # Errors
/// Returns the reason if the sessions cannot be fitted.
pub fn calibrate(
    chain: &Chain,
    sessions: &[MeasuringSession],
    unknowns: &[Unknown],
    priors: &[f64],
) -> Result<Calibration, String> {
    let equations: usize = sessions.iter().map(|s| 3 * s.measured.len()).sum();
    let of_sessions = sessions.iter().map(|s| SessionFrames::unknowns(&s.measured)).sum::<usize>();
    // The data need not determine the harmonics, so harmonics are left out here.
    let parameters: Vec<usize> = (0..unknowns.len()).filter(|&k| !unknowns[k].is_harmonic()).collect();
    let count = parameters.len() + of_sessions;
    if equations < count {
        return Err(format!("{equations} measured coordinates cannot determine {count} unknowns"));
    }
    let fit = Fit::new(FitProblem { chain, unknowns, priors }, sessions)?;
    let left_out = held_out(&fit, sessions);
    let covariance = fit.covariance.view((0, 0), (unknowns.len(), unknowns.len())).into_owned();
    let values = fit.state.values.iter().zip(unknowns).zip(&fit.state.priors).enumerate();
    let identified = values.map(|(k, ((value, unknown), prior))| Identified {
        unknown: *unknown,
        value: *value,
        prior: *prior,
        sigma: covariance[(k, k)].sqrt(),
    });
    let unidentified = undetermined(&covariance, &fit.state.priors, &parameters);
    let of_harmonics: f64 = (0..unknowns.len())
        .filter(|&k| unknowns[k].is_harmonic())
        .map(|k| 1.0 - covariance[(k, k)] / fit.state.priors[k].powi(2))
        .sum();
    let mut squares = 0.0;
    let fitted = sessions.iter().enumerate().map(|(s, session)| {
        let residuals = fit.residuals(&session.measured, s);
        squares += residuals.iter().map(|r| r.by.norm_squared()).sum::<f64>();
        FittedSession::new(fit.state.frames[s].clone(), &residuals)
    });
    let fitted = fitted.collect();
    Ok(Calibration {
        identified: identified.collect(),
        sessions: fitted,
        rank: parameters.len() - unidentified.len(),
        unidentified,
        residual: (squares / (equations as f64 - count as f64 - of_harmonics).max(1.0)).sqrt(),
        held_out: Accuracy::of(left_out.iter().map(|r| r.by.norm()).collect()),
        misfit: fit.state.misfit.clone(),
        ranges: (0..chain.links.len()).map(|joint| range_of(sessions, joint)).collect(),
        covariance,
        chain: chain.clone(),
    })
}

/// Fits base and reflectors like [`aligned`], but without positions whose distance exceeds the median
/// distance by the factor [`GROSS`]. A few gross errors would otherwise spoil the distances of all positions.
fn aligned_without_gross_errors(poses: &[Deformed], measured: &[MeasuredPosition]) -> Option<SessionFrames> {
    let mut frames = aligned(poses, measured)?;
    for _ in 0..ROUNDS {
        let pairs = || poses.iter().zip(measured);
        let distances: Vec<f64> = pairs().map(|(p, m)| frames.residual(&p.interface, m).norm()).collect();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let most = GROSS * sorted.get(sorted.len() / 2)?;
        let kept = pairs().zip(&distances).filter(|(_, distance)| **distance <= most);
        let (some, others): (Vec<_>, Vec<_>) = kept.map(|((p, m), _)| (p.clone(), *m)).unzip();
        let is_whole = some.len() == measured.len();
        if is_whole || super::session::reflectors(&others) < super::session::reflectors(measured) {
            break;
        }
        frames = aligned(&some, &others)?;
    }
    Some(frames)
}

/// Returns the least and the largest measured coordinate of a joint.
fn range_of(sessions: &[MeasuringSession], joint: usize) -> (f64, f64) {
    let all = sessions.iter().flat_map(|session| &session.measured).map(|m| m.joints[joint]);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)))
}

/// Returns the directions in which the standard deviation after the fit is at least half the prior standard
/// deviation. These directions are eigenvectors of a scaled covariance. In this covariance, each parameter is
/// divided by its prior standard deviation.
fn undetermined(covariance: &DMatrix<f64>, priors: &[f64], parameters: &[usize]) -> Vec<Vec<f64>> {
    let count = parameters.len();
    let scaled = DMatrix::from_fn(count, count, |i, j| {
        let (i, j) = (parameters[i], parameters[j]);
        covariance[(i, j)] / (priors[i] * priors[j])
    });
    let eigen = SymmetricEigen::new(scaled);
    let weak = (0..count).filter(|&k| eigen.eigenvalues[k] >= 0.25);
    weak.map(|k| eigen.eigenvectors.column(k).iter().copied().collect()).collect()
}

impl FittedSession {
    fn new(frames: SessionFrames, residuals: &[Residual]) -> Self {
        let outliers = residuals.iter().filter(|r| r.normalised() > OUTLIER.powi(2));
        Self {
            frames,
            distances: residuals.iter().map(|r| r.by.norm()).collect(),
            outliers: outliers.map(|r| (r.row, r.by.norm())).collect(),
        }
    }
}

impl Calibration {
    /// Returns the identified unknowns without the harmonics.
    pub fn parameters(&self) -> &[Identified] {
        let count = self.identified.iter().take_while(|i| !i.unknown.is_harmonic()).count();
        &self.identified[..count]
    }

    /// Returns the harmonics of a joint.
    pub fn harmonics_of(&self, joint: usize) -> impl Iterator<Item = &Identified> {
        let is_own =
            move |i: &&Identified| matches!(i.unknown, Unknown::Harmonic { joint: of, .. } if of == joint);
        self.identified.iter().filter(is_own)
    }

    /// Returns the prior variance of the periodic error of a joint, averaged over a revolution, rad^2.
    pub fn periodic_variance(&self, joint: usize) -> f64 {
        self.harmonics_of(joint).map(|i| i.prior.powi(2)).sum::<f64>() / 2.0
    }

    /// Returns the chain with errors at actuator coordinates `q` (rad or m).
    pub fn deformed(&self, q: &JointVector) -> Deformed {
        let (unknowns, values) = self.unknowns_and_values();
        Deformed::new(&self.chain, q, &unknowns, &values)
    }

    /// Fits base and reflectors to positions that were not part of the calibration.
    ///
    /// Returns the session, and the share of its positions inside their 95 % ellipsoids. An ellipsoid
    /// accounts for the misfit and for the uncertainty of the unknowns. It leaves out the part of the error
    /// that the fit of base and reflectors absorbs. Returns None if the positions do not determine base and
    /// reflectors.
    pub fn tested(&self, measured: &[MeasuredPosition]) -> Option<(FittedSession, f64)> {
        let (unknowns, _) = self.unknowns_and_values();
        let poses: Vec<_> = measured.iter().map(|m| self.deformed(&m.joints)).collect();
        let frames = aligned_without_gross_errors(&poses, measured)?;
        let columns: Vec<PositionJacobians> = poses
            .iter()
            .zip(measured)
            .map(|(pose, m)| {
                let at = frames.reached(&pose.interface, m.reflector);
                let of_chain = unknowns.iter().map(|u| pose.motion(&self.chain, *u, &at).slope);
                let of_frames = frames.motions(&pose.interface, m.reflector);
                (jacobian(of_chain), jacobian(of_frames.iter().map(|motion| motion.slope)))
            })
            .collect();
        let taken_up = taken_up(&columns)?;
        let free = columns.iter().map(|(of_chain, of_frames)| of_chain - of_frames * &taken_up);
        let spreads = spreads(&free.collect::<Vec<_>>(), &self.covariance);
        let residuals = poses.iter().zip(measured).zip(spreads).map(|((pose, m), spread)| {
            let at = frames.reached(&pose.interface, m.reflector);
            Residual {
                row: m.row,
                by: frames.residual(&pose.interface, m),
                misfit: self.misfit.covariance(&drives(&self.chain, pose, &at), m.sigma),
                spread,
            }
        });
        let residuals: Vec<_> = residuals.collect();
        let inside = residuals.iter().filter(|r| r.normalised() <= CHI_SQUARED_95).count();
        let share = inside as f64 / residuals.len() as f64;
        Some((FittedSession::new(frames, &residuals), share))
    }

    /// Returns whether an actuator of the arm moves more than its own D-H coordinate.
    pub fn is_coupled(&self) -> bool {
        let rows = self.chain.coupling.iter().enumerate();
        rows.into_iter().any(|(i, row)| row.iter().take(i).any(|c| *c != 0.0))
    }

    fn unknowns_and_values(&self) -> (Vec<Unknown>, Vec<f64>) {
        self.identified.iter().map(|i| (i.unknown, i.value)).unzip()
    }
}
