//! Error budget of a posture: which parameter to tighten first.

use super::work_context::WorkContext;
use super::{ErrorEvaluator, ErrorSources, EvaluatorScratch};
use crate::cell::{Parameter, Reading};
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::{Vector3, Vector6};

/// Contribution of one error source to the error in the operation's [sense](crate::cell::Sense).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    pub parameter: Parameter,
    /// Value of the parameter in the signed sample, m or rad.
    pub signed: f64,
    /// Half width of the tolerance of the parameter, m or rad.
    pub plus_minus: f64,
    /// Linear position error of the TCP that this source causes, in world axes, m.
    ///
    /// In the signed reading, the parameter has the value `signed`. In the other readings, the parameter
    /// deviates from its mean by `plus_minus`.
    pub term: Vector3<f64>,
    /// Size of the linear error that this source alone causes at its tolerance, m or rad. The size is
    /// measured in the operation's sense.
    pub alone: f64,
    /// Share of this source in the linear worst case. The shares of all sources add up to 1.
    ///
    /// This share and [`Self::of_variance`] are 0 if the errors are not tolerances
    /// ([`ErrorEvaluator::has_tolerances`]).
    pub of_worst: f64,
    /// Share of this source in the variance of the linear error. The shares of all sources add up to 1.
    pub of_variance: f64,
}

/// Error budget of one posture, with the largest contribution first.
///
/// The budget is sorted by [`Share::of_variance`] in the statistical reading, and by [`Share::of_worst`] in
/// the other readings. If the errors are not tolerances ([`ErrorEvaluator::has_tolerances`]), the budget is
/// sorted by [`Share::alone`].
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    pub shares: Vec<Share>,
    /// Linear worst case of the error in the operation's sense, m or rad; infinite if the errors are not
    /// tolerances.
    pub worst: f64,
    /// Standard deviation of the linear error in the operation's sense, m or rad; infinite if the errors are
    /// not tolerances.
    pub deviation: f64,
}

impl Budget {
    /// Computes the budget of a posture.
    pub fn new(
        evaluator: &ErrorEvaluator,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Self {
        evaluator.prepare(context, frames, memory);
        let measure = evaluator.measure(&evaluator.sense, context, frames);
        let has_tolerances = evaluator.has_tolerances();
        let (worst, corner) = evaluator.linear_corner(&measure, memory);
        let sources = &evaluator.sources;
        let unit: Vec<Vector6<f64>> =
            (0..sources.list.len()).map(|k| measure.column(&memory.effects().columns[k])).collect();
        let sum: Vector6<f64> =
            sources.list.iter().zip(&unit).zip(&corner).map(|((s, g), sign)| g * s.at(*sign)).sum();
        let variances = variances(sources, &unit);
        let total: f64 = variances.iter().sum();
        let of = |part: f64, whole: f64| if has_tolerances && whole > 0.0 { part / whole } else { 0.0 };
        let mut shares: Vec<Share> = sources
            .list
            .iter()
            .enumerate()
            .map(|(k, source)| {
                let at = if evaluator.reading == Reading::Signed { source.signed } else { source.plus_minus };
                let term: Displacement = memory.effects().columns[k] * at;
                Share {
                    parameter: source.parameter,
                    signed: source.signed,
                    plus_minus: source.plus_minus,
                    term: context.site.world.transpose() * term.position,
                    alone: unit[k].norm() * source.plus_minus,
                    of_worst: of(unit[k].dot(&sum) * source.at(corner[k]), sum.norm_squared()),
                    of_variance: of(variances[k], total),
                }
            })
            .collect();
        let key = |s: &Share| match evaluator.reading {
            Reading::Statistical => s.of_variance,
            _ if has_tolerances => s.of_worst,
            _ => s.alone,
        };
        shares.sort_by(|a, b| key(b).total_cmp(&key(a)));
        let known = |figure: f64| if has_tolerances { figure } else { f64::INFINITY };
        Self { shares, worst: known(worst.value), deviation: known(total.sqrt()) }
    }
}

/// Returns the contribution of each source k to the variance: `g_k . sum_j C_kj g_j`.
///
/// Here `g_k` is the effect of one unit of source k (`unit`), and `C` is the covariance of the sources.
fn variances(sources: &ErrorSources, unit: &[Vector6<f64>]) -> Vec<f64> {
    let alone = |(k, s): (usize, &super::ErrorSource)| match s.spread {
        Some(_) => unit[k].norm_squared() * s.deviation * s.deviation,
        None => 0.0,
    };
    let mut parts: Vec<f64> = sources.list.iter().enumerate().map(alone).collect();
    for factor in &sources.factors {
        let whole: Vector6<f64> = factor.iter().map(|&(k, v)| unit[k] * v).sum();
        factor.iter().for_each(|&(k, v)| parts[k] += (unit[k] * v).dot(&whole));
    }
    parts
}
