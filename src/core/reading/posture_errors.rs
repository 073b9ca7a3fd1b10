//! All error figures of one posture, for maps and reports.

use super::error_sources::MAX_SOURCES;
use super::evaluator::{ErrorEvaluator, EvaluatorScratch};
use super::figures::{Figures, PostureErrors};
use super::work_context::WorkContext;
use super::worst_case::WorstCase;
use crate::cell::{Model, Reading, Sense};
use crate::pose::Displacement;
use crate::robot::Frames;

impl ErrorEvaluator {
    /// Returns whether the errors of the posture have a worst case and statistics.
    ///
    /// In some signed samples, the errors compensate each other ([`crate::cell::Cell::errors_compensate`]).
    /// In the signed reading, such a sample has no worst case and no statistics.
    pub fn has_tolerances(&self) -> bool {
        self.reading != Reading::Signed || !self.errors_compensate
    }

    /// Returns the error figures of a signed sample whose errors compensate each other. Such a sample has
    /// neither a worst case nor statistics.
    fn judge_sample(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        self.prepare(context, frames, memory);
        let by_model = self.by_all_models(&self.signed_values, context, frames, memory);
        let error = self.of_model(by_model);
        let of_sense = |sense: &Sense| Figures::of_sample(self.measure(sense, context, frames).size(&error));
        let figures = self.reported.iter().map(of_sense).collect();
        let value = self.value(context, frames, memory);
        let [nonlinear, linear, second_order] = by_model;
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success: None }
    }

    /// Returns the error under the nonlinear, the linear and the second-order model, for the given source
    /// values.
    fn by_all_models(
        &self,
        values: &[f64],
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> [Displacement; 3] {
        [Model::Nonlinear, Model::Linear, Model::SecondOrder]
            .map(|model| self.error_of(values, context, frames, model, memory))
    }

    /// Returns the error under the chosen model.
    fn of_model(&self, [nonlinear, linear, second_order]: [Displacement; 3]) -> Displacement {
        match self.model {
            Model::Nonlinear => nonlinear,
            Model::Linear => linear,
            Model::SecondOrder => second_order,
        }
    }

    /// Returns all error figures of a posture, in every sense of [`ErrorEvaluator::reported`].
    ///
    /// The worst case and the statistics are infinite unless [`Self::has_tolerances`] returns true.
    pub fn judge(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        if !self.has_tolerances() {
            return self.judge_sample(context, frames, memory);
        }
        self.prepare(context, frames, memory);
        let each = |sense: &Sense| self.worst(sense, context, frames, memory);
        let worst: Vec<_> = self.reported.iter().map(each).collect();
        let pairs = self.reported.iter().zip(&worst);
        let each = |(sense, worst): (&Sense, &WorstCase)| {
            self.statistics(sense, context, frames, worst.by_model, memory)
        };
        let statistics: Vec<_> = pairs.map(each).collect();
        let own = self.own();
        let success = self.limit.map(|limit| self.norm(&self.sense, context, frames, memory).cdf(limit));
        let mut values = [0.0; MAX_SOURCES];
        match self.reading {
            Reading::Signed => values[..self.signed_values.len()].copy_from_slice(&self.signed_values),
            _ => self.corner(worst[own].corner, &mut values),
        }
        let values = &values[..self.sources.list.len()];
        let by_model = self.by_all_models(values, context, frames, memory);
        let error = self.of_model(by_model);
        let figures =
            self.reported.iter().zip(worst.iter().zip(&statistics)).map(|(sense, (worst, random))| Figures {
                error: self.measure(sense, context, frames).size(&error),
                worst_linear: worst.linear,
                worst: worst.by_model,
                rms: random.rms,
                mean: random.mean,
                p95: random.p95,
                p99: random.p99,
            });
        let figures: Vec<Figures> = figures.collect();
        let value = match (self.reading, self.quantity) {
            (Reading::Signed, _) => self.value(context, frames, memory),
            (Reading::Statistical, _) if self.takes_zero_spin => self.value(context, frames, memory),
            (Reading::Statistical, quantity) => figures[own].statistic(quantity, success),
            (reading, quantity) => figures[own].in_reading(reading, quantity),
        };
        let [nonlinear, linear, second_order] = by_model;
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success }
    }
}
