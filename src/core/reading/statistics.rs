//! Figures of the statistical reading at one posture.

use super::norm::NormLaw;
use super::work_context::WorkContext;
use super::{ErrorEvaluator, EvaluatorScratch};
use crate::cell::{Quantity, Sense};
use crate::robot::Frames;

/// Figures of the size of a random error in one [`Sense`], m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Statistics {
    pub rms: f64,
    pub mean: f64,
    pub p95: f64,
    pub p99: f64,
}

impl ErrorEvaluator {
    /// Returns the statistical figures of the error in a [`Sense`]; `worst` (m or rad) is the worst case in
    /// this sense. Call [`Self::prepare`] first.
    pub(super) fn statistics(
        &self,
        sense: &Sense,
        context: &WorkContext,
        frames: &Frames,
        worst: f64,
        memory: &mut EvaluatorScratch,
    ) -> Statistics {
        let norm = self.norm(sense, context, frames, memory);
        let most = if self.caps(&norm) { worst } else { f64::INFINITY };
        Statistics {
            rms: norm.rms(),
            mean: norm.mean(),
            p95: norm.quantile(0.95).min(most),
            p99: norm.quantile(0.99).min(most),
        }
    }

    /// Returns the quantity of the statistical reading: an error (m or rad), or a share of failures.
    pub(super) fn statistical_value(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        self.prepare(context, frames, memory);
        let norm = self.norm(&self.sense, context, frames, memory);
        let (figure, is_capped) = (self.figure_of(&norm), self.caps(&norm));
        match (self.quantity, is_capped) {
            (Quantity::P95 | Quantity::P99, true) => {
                figure.min(self.worst(&self.sense, context, frames, memory).by_model)
            }
            _ => figure,
        }
    }

    /// Returns the quantity of the statistical reading for the distribution `norm`. The result may exceed the
    /// worst case.
    fn figure_of(&self, norm: &NormLaw<'_>) -> f64 {
        match self.quantity {
            Quantity::Rms => norm.rms(),
            Quantity::Mean => norm.mean(),
            Quantity::Yield => 1.0 - self.limit.map_or(1.0, |limit| norm.cdf(limit)),
            Quantity::P95 => norm.quantile(0.95),
            Quantity::P99 => norm.quantile(0.99),
        }
    }

    /// Returns whether the worst case limits the percentiles. This is the case if bounded parameters
    /// dominate, and no parameter has an unbounded distribution.
    fn caps(&self, norm: &NormLaw<'_>) -> bool {
        matches!(norm, NormLaw::Bounded(_)) && self.sources.are_all_bounded()
    }
}
