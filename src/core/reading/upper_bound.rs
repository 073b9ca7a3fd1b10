//! Upper bound of the value of an operation at a posture. The bound takes much less computing time than the
//! value.
//!
//! - Normal position errors: an upper bound of the value for mean error 0, plus an upper bound of the length
//!   of the mean error.
//! - Worst case: the linear worst case plus the largest products of two and more errors.

use super::spin_bound::SpinBound;
use super::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::cell::{Quantity, Reading};
use crate::robot::Frames;

/// Largest rounding error of a bound, as a share of the bound.
const ROUNDING: f64 = 1e-9;

impl ErrorEvaluator {
    /// Returns an upper bound of [`Self::value`] at a posture; None if no bound is known.
    pub fn most(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> Option<f64> {
        match self.reading {
            Reading::Signed => None,
            Reading::Statistical => self.most_statistical(context, frames, memory),
            Reading::WorstCase => self.most_worst(context, frames, memory),
        }
    }

    fn most_statistical(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Option<f64> {
        let (Some(SpinBound::Normal(bound)), Some(expansion)) = (&self.spin_bound, &mut memory.position)
        else {
            return None;
        };
        if self.mean.is_some() || self.quantity == Quantity::Yield {
            return None;
        }
        let factors = bound.factors.as_ref()?;
        let rows = self.measure(&self.sense, context, frames).position_rows();
        let staying = factors.covariance(frames, expansion);
        let all = factors.rotating(expansion).fold(staying, |sum, e| sum + e * e.transpose());
        let c = rows * all * rows.transpose();
        let centred = bound.figure.most(&[c.m11, c.m22, c.m33, c.m12, c.m13, c.m23]);
        let mean = if self.takes_mean() { rows.norm() * factors.most_mean(&all)? } else { 0.0 };
        Some((centred + mean) * (1.0 + ROUNDING))
    }

    fn most_worst(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Option<f64> {
        let linear = self.linear_worst(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let products = self.products(&measure, context, frames, memory)?.all;
        Some((linear + products) * (1.0 + ROUNDING))
    }
}
