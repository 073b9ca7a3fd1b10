//! All error figures of one posture, for maps and reports.

use super::error_sources::MAX_SOURCES;
use super::evaluator::{ErrorEvaluator, EvaluatorScratch};
use super::figures::{Figures, PostureErrors};
use super::work_context::WorkContext;
use super::worst_case::WorstCase;
use crate::cell::{Model, Quantity, Reading, Sense};
use crate::pose::Displacement;
use crate::robot::Frames;

impl ErrorEvaluator {
    /// Returns whether the errors of the posture have a worst case and statistics.
    ///
    /// They have none in the signed reading if they compensate each other
    /// ([`crate::cell::Cell::errors_compensate`]).
    pub fn has_tolerances(&self) -> bool {
        self.reading != Reading::Signed || !self.errors_compensate
    }

    /// Returns the error figures of a signed sample that has neither a worst case nor statistics.
    fn judge_sample(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        self.prepare(context, frames, memory);
        let [nonlinear, linear, second_order] = [Model::Nonlinear, Model::Linear, Model::SecondOrder]
            .map(|model| self.error_of(&self.signed_values, context, frames, model, memory));
        let error = self.of_model([nonlinear, linear, second_order]);
        let of_sense = |sense: &Sense| Figures::of_sample(self.measure(sense, context, frames).size(&error));
        let figures = self.reported.iter().map(of_sense).collect();
        let value = self.value(context, frames, memory);
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success: None }
    }

    /// Returns the figures of the worst-case or statistical reading alone.
    fn judge_reading(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        self.prepare(context, frames, memory);
        let worst_at_own = self.worst(&self.sense, context, frames, memory);
        let mut figures = Vec::with_capacity(self.reported.len());
        for sense in &self.reported {
            let worst = |memory: &mut EvaluatorScratch| match *sense == self.sense {
                true => worst_at_own,
                false => self.worst(sense, context, frames, memory),
            };
            let mut of_sense = Figures::of_sample(f64::INFINITY);
            if self.reading == Reading::WorstCase {
                let WorstCase { linear, by_model, .. } = worst(memory);
                (of_sense.worst_linear, of_sense.worst) = (linear, by_model);
            } else {
                let (figure, is_limited) = self.unlimited_statistic(sense, context, frames, memory);
                let most = if is_limited { worst(memory).by_model } else { f64::INFINITY };
                of_sense.set_statistic(self.quantity, figure.min(most));
            }
            figures.push(of_sense);
        }
        let is_yield = self.reading == Reading::Statistical && self.quantity == Quantity::Yield;
        let limit = self.limit.filter(|_| is_yield);
        let success = limit.map(|limit| self.norm(&self.sense, context, frames, memory).cdf(limit));
        let mut values = [0.0; MAX_SOURCES];
        self.corner(&worst_at_own.corner, &mut values);
        let values = &values[..self.sources.list.len()];
        let [nonlinear, linear, second_order] = [Model::Nonlinear, Model::Linear, Model::SecondOrder]
            .map(|model| self.error_of(values, context, frames, model, memory));
        let error = self.of_model([nonlinear, linear, second_order]);
        for (of_sense, sense) in figures.iter_mut().zip(&self.reported) {
            of_sense.error = self.measure(sense, context, frames).size(&error);
        }
        let own = &figures[self.own()];
        let value = match self.reading {
            Reading::Statistical => own.statistic(self.quantity, success),
            reading => own.in_reading(reading, self.quantity),
        };
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success }
    }

    /// Returns the error by the chosen model.
    fn of_model(&self, [nonlinear, linear, second_order]: [Displacement; 3]) -> Displacement {
        match self.model {
            Model::Nonlinear => nonlinear,
            Model::Linear => linear,
            Model::SecondOrder => second_order,
        }
    }

    /// Returns all error figures of a posture, in every sense of [`ErrorEvaluator::reported`].
    ///
    /// The worst case and the statistics are infinite unless [`Self::has_tolerances`].
    pub fn judge(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        if !self.has_tolerances() || self.reports_own_reading && self.reading == Reading::Signed {
            return self.judge_sample(context, frames, memory);
        }
        if self.reports_own_reading {
            return self.judge_reading(context, frames, memory);
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
            _ => self.corner(&worst[own].corner, &mut values),
        }
        let values = &values[..self.sources.list.len()];
        let [nonlinear, linear, second_order] = [Model::Nonlinear, Model::Linear, Model::SecondOrder]
            .map(|model| self.error_of(values, context, frames, model, memory));
        let error = self.of_model([nonlinear, linear, second_order]);
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
            (Reading::Statistical, quantity) => figures[own].statistic(quantity, success),
            (reading, quantity) => figures[own].in_reading(reading, quantity),
        };
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success }
    }
}
