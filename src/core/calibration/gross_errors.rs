//! Gross errors: measured positions that do not belong to their posture, such as a lost beam or a typing
//! error.
//!
//! A few gross errors would enlarge the fitted variance of all positions until the robust loss no longer
//! recognizes them. They are therefore found before the fit. The search first compares the positions with
//! the nominal arm. It then repeats a fit, and leaves out the gross errors that each fit reveals.

use super::deformed::Deformed;
use super::fit::Fit;
use super::fit_state::FitProblem;
use super::rigid::aligned;
use super::session::{MeasuredPosition, MeasuringSession};
use super::unknown::Unknown;
use crate::robot::Chain;

/// A residual is gross if it exceeds the median residual of its session by this factor. The largest of 10 000
/// normally distributed errors exceeds the median by a factor of about 3.
const GROSS: f64 = 10.0;
/// Least distance, m, of a gross error from the prediction of the nominal arm. The errors of an arm before
/// its calibration are smaller, although they vary with the posture.
const FAR: f64 = 0.05;
/// Largest share of the positions of a session that are left out as gross errors. If more positions are
/// suspect, the model may not fit the session.
const MOST: f64 = 0.1;
/// Least number of positions in a session. Gross errors are not sought in a session with fewer positions.
pub const LEAST_POSITIONS: usize = 20;
/// Least number of positions that remain for each reflector.
const LEAST_OF_REFLECTOR: usize = 3;
/// Largest number of fits, and of alignments of the nominal arm.
const ROUNDS: usize = 10;

/// Measured position with a gross error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrossError {
    pub row: usize,
    pub reflector: usize,
    /// Distance of the measured position from its prediction, m.
    pub distance: f64,
}

impl GrossError {
    /// Returns whether `measured` is the position with this gross error.
    pub fn is_at(&self, measured: &MeasuredPosition) -> bool {
        (self.row, self.reflector) == (measured.row, measured.reflector)
    }
}

/// Gross errors of one session.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GrossErrors {
    pub errors: Vec<GrossError>,
    /// Whether so many positions are suspect that none of them should be left out.
    pub too_many: bool,
}

/// Returns the gross errors of every session. `priors` holds the prior standard deviations of the unknowns.
pub fn gross_errors(
    chain: &Chain,
    sessions: &[MeasuringSession],
    unknowns: &[Unknown],
    priors: &[f64],
) -> Vec<GrossErrors> {
    let mut kept = sessions.to_vec();
    let mut found = vec![Vec::new(); sessions.len()];
    for (session, found) in kept.iter_mut().zip(&mut found) {
        for _ in 0..ROUNDS {
            let poses: Vec<_> =
                session.measured.iter().map(|m| Deformed::new(chain, &m.joints, &[], &[])).collect();
            let Some(frames) = aligned(&poses, &session.measured) else { break };
            let pairs = poses.iter().zip(&session.measured);
            let distances: Vec<_> = pairs.map(|(p, m)| frames.residual(&p.interface, m).norm()).collect();
            if !leave_out(session, found, &distances, (&distances, FAR)) {
                break;
            }
        }
    }
    for _ in 0..ROUNDS {
        let Ok(fit) = Fit::new(FitProblem { chain, unknowns, priors }, &kept) else {
            // Positions without which nothing can be fitted are not gross errors, but informative.
            found.iter_mut().for_each(Vec::clear);
            break;
        };
        let mut any = false;
        for (s, (session, found)) in kept.iter_mut().zip(&mut found).enumerate() {
            let residuals = fit.residuals(&session.measured, s);
            let distances: Vec<_> = residuals.iter().map(|r| r.by.norm()).collect();
            let normalised: Vec<_> = residuals.iter().map(|r| r.normalised().sqrt()).collect();
            any |= leave_out(session, found, &distances, (&normalised, 0.0));
        }
        if !any {
            readmit(&fit, &kept, sessions, &mut found);
            break;
        }
    }
    let judged = found.into_iter().zip(sessions).map(|(errors, session)| GrossErrors {
        too_many: errors.len() as f64 > MOST * session.measured.len() as f64,
        errors,
    });
    judged.collect()
}

/// Removes positions from the list of gross errors if the final fit explains them. The first fits may have
/// been too inaccurate to judge them.
fn readmit(
    fit: &Fit<'_>,
    kept: &[MeasuringSession],
    sessions: &[MeasuringSession],
    found: &mut [Vec<GrossError>],
) {
    for (s, errors) in found.iter_mut().enumerate() {
        let sizes = |measured: &[MeasuredPosition]| -> Vec<f64> {
            fit.residuals(measured, s).iter().map(|r| r.normalised().sqrt()).collect()
        };
        let mut sorted = sizes(&kept[s].measured);
        sorted.sort_by(f64::total_cmp);
        let Some(median) = sorted.get(sorted.len() / 2) else { continue };
        let is_explained = |error: &GrossError| {
            let own: Vec<_> = sessions[s].measured.iter().filter(|m| error.is_at(m)).copied().collect();
            sizes(&own).iter().all(|size| *size <= GROSS * median)
        };
        errors.retain(|error| !is_explained(error));
    }
}

/// Moves the positions whose residuals are gross, and at least `least`, from a session to the list of gross
/// errors. Returns whether any position was moved.
fn leave_out(
    session: &mut MeasuringSession,
    found: &mut Vec<GrossError>,
    distances: &[f64],
    (residuals, least): (&[f64], f64),
) -> bool {
    let mut sorted = residuals.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2).filter(|_| sorted.len() >= LEAST_POSITIONS) else {
        return false;
    };
    let count = |of: usize| session.measured.iter().filter(|m| m.reflector == of).count();
    let reflectors = session.measured.iter().map(|m| m.reflector + 1).max().unwrap_or(0);
    let mut left: Vec<usize> = (0..reflectors).map(count).collect();
    let before = found.len();
    for (k, measured) in session.measured.iter().enumerate() {
        if residuals[k] > (GROSS * median).max(least) && left[measured.reflector] > LEAST_OF_REFLECTOR {
            left[measured.reflector] -= 1;
            let MeasuredPosition { row, reflector, .. } = *measured;
            found.push(GrossError { row, reflector, distance: distances[k] });
        }
    }
    session.measured.retain(|m| !found.iter().any(|error| error.is_at(m)));
    found.len() > before
}
