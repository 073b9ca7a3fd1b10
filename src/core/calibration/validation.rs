//! Cross-validation over blocks of the joint space.

use super::fit::{Fit, Residual};
use super::normal_equations::NormalEquations;
use super::session::{MeasuredPosition, MeasuringSession};
use crate::cell::MAX_JOINTS;
use std::cell::OnceCell;

/// Number of blocks of the joint space.
const BLOCKS: usize = 8;

/// Returns the residuals of positions whose block of the joint space was left out of the fit.
///
/// The function skips a block if the other blocks do not determine all unknowns.
pub(super) fn held_out(fit: &Fit<'_>, sessions: &[MeasuringSession]) -> Vec<Residual> {
    let blocks: Vec<Vec<usize>> = sessions.iter().map(|s| blocks(&s.measured)).collect();
    let all = NormalEquations::of_positions(&fit.state, sessions, 1.0);
    let gauss_newton = OnceCell::new();
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
        let kept = split(true);
        let reflectors = |s: &MeasuringSession| super::session::reflectors(&s.measured);
        if kept.iter().map(reflectors).ne(sessions.iter().map(reflectors)) {
            continue;
        }
        let left_out = split(false);
        // The Hessian without the block can be indefinite. The Gauss-Newton matrix is never indefinite.
        let without = fit.without((&all, 1.0), &left_out).or_else(|| {
            let all = gauss_newton.get_or_init(|| NormalEquations::of_positions(&fit.state, sessions, 0.0));
            fit.without((all, 0.0), &left_out)
        });
        let Some(fit) = without else { continue };
        for (s, session) in left_out.iter().enumerate() {
            residuals.extend(fit.residuals(&session.measured, s));
        }
    }
    residuals
}

/// Returns the index of the block of every position. The function repeatedly halves each block at the median
/// of the joint coordinate with the greatest variance. So the blocks have about equal numbers of positions.
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
