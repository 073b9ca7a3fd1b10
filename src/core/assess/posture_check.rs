//! Monte Carlo check of one posture. At the spot of an operation, the samples equal those in
//! [`super::Assessment::samples`].

use super::SAMPLES;
use super::posture_context::PostureContext;
use crate::cell::Reading;
use crate::reading::{EvaluatorScratch, MonteCarlo, PostureErrors, SampleSpace, SampledPosture};

/// Monte Carlo check of the statistical figures of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureCheck {
    pub samples: MonteCarlo,
    /// Whether the samples confirm the first-order figures. If not, the figures of the samples replace the
    /// first-order figures.
    pub confirmed: bool,
}

impl PostureCheck {
    /// Returns the error figures of a posture. In the statistical reading, Monte Carlo samples check these
    /// figures.
    ///
    /// At the spot of an operation, the samples equal those in [`super::Assessment::samples`].
    pub fn judged(
        context: &PostureContext<'_>,
        memory: &mut EvaluatorScratch,
    ) -> (PostureErrors, Option<Self>) {
        let PostureContext { cell, evaluator, situation, frames, .. } = context;
        let mut judged = evaluator.judge(situation, frames, memory);
        if evaluator.reading != Reading::Statistical {
            return (judged, None);
        }
        let own = evaluator.own();
        let p95 = judged.figures[own].p95;
        let posture = SampledPosture { evaluator, context: situation, frames, p95 };
        let samples = posture.monte_carlo(&SampleSpace::of_cell(cell), SAMPLES, cell.search.seed);
        let PostureErrors { figures, success, value, .. } = &mut judged;
        let confirmed = samples.check(evaluator.quantity, &mut figures[own], success, value);
        (judged, Some(Self { samples, confirmed }))
    }
}
