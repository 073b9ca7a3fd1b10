//! The error budget of a posture: which parameter to tighten first.

use super::work_context::WorkContext;
use super::{ErrorEvaluator, ErrorSources, EvaluatorScratch};
use crate::cell::{Parameter, Reading};
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::{Vector3, Vector6};

/// What one source adds to the error in the operation's sense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    pub parameter: Parameter,
    /// The value of the signed sample, and the half width of the tolerance (m or rad).
    pub signed: f64,
    pub plus_minus: f64,
    /// Its linear term: what it does to the position of the TCP in world axes, m, at the signed value
    /// (of a tolerance: at plus).
    pub term: Vector3<f64>,
    /// Size of its effect in the sense when it alone is at its tolerance, m or rad.
    pub alone: f64,
    /// Its part of the linear worst case, and of the variance; each adds up to 1.
    pub of_worst: f64,
    pub of_variance: f64,
}

/// The budget of one posture, the largest share first.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    pub shares: Vec<Share>,
    /// Linear worst case and root of the variance that the shares divide, m or rad.
    pub worst: f64,
    pub deviation: f64,
}

impl Budget {
    pub fn new(
        gauge: &ErrorEvaluator,
        situation: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Self {
        gauge.prepare(situation, frames, memory);
        let measure = gauge.measure(&gauge.sense, situation, frames);
        let (worst, corner) = gauge.linear_corner(&measure, memory);
        let sources = &gauge.sources;
        let unit: Vec<Vector6<f64>> =
            (0..sources.list.len()).map(|k| measure.column(&memory.effects().columns[k])).collect();
        let sum: Vector6<f64> =
            sources.list.iter().zip(&unit).zip(&corner).map(|((s, g), sign)| g * (s.plus_minus * sign)).sum();
        let variances = variances(sources, &unit);
        let total: f64 = variances.iter().sum();
        let of = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let mut shares: Vec<Share> = sources
            .list
            .iter()
            .enumerate()
            .map(|(k, source)| {
                let at = if gauge.reading == Reading::Signed { source.signed } else { source.plus_minus };
                let term: Displacement = memory.effects().columns[k] * at;
                Share {
                    parameter: source.parameter,
                    signed: source.signed,
                    plus_minus: source.plus_minus,
                    term: situation.site.world.transpose() * term.position,
                    alone: unit[k].norm() * source.plus_minus,
                    of_worst: of(unit[k].dot(&sum) * source.plus_minus * corner[k], sum.norm_squared()),
                    of_variance: of(variances[k], total),
                }
            })
            .collect();
        let key = |s: &Share| if gauge.reading == Reading::Statistical { s.of_variance } else { s.of_worst };
        shares.sort_by(|a, b| key(b).total_cmp(&key(a)));
        Self { shares, worst: worst.value, deviation: total.sqrt() }
    }
}

/// Each source's part of the variance: `g_k . sum_j C_kj g_j`.
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
