//! Covariance of the error of an operation at one posture, to first order.

use super::spin_bound::SpinBound;
use super::{ErrorEvaluator, EvaluatorScratch, SenseRows, WorkContext};
use crate::robot::Frames;
use nalgebra::Matrix6;

impl ErrorEvaluator {
    /// Returns the covariance (m or rad, squared) of the error of the operation in its sense. Every row of
    /// the sense is a weighted direction ([`SenseRows`]), and the error has one component along each row. The
    /// second and third results are the number of rows and the size of the mean error (m or rad).
    pub fn covariance(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> (Matrix6<f64>, usize, f64) {
        self.prepare(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let mean = measure.column(&memory.effects.mean).norm();
        (self.covariance_of_effects(&measure, memory), measure.rows(), mean)
    }

    /// Returns only the covariance of [`Self::covariance`], in less computing time.
    pub fn covariance_alone(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Matrix6<f64> {
        let measure = self.measure(&self.sense, context, frames);
        let factors = self.spin_bound.as_ref().and_then(SpinBound::factors);
        if let (Some(factors), Some(expansion)) = (factors, &mut memory.position) {
            let rows = measure.position_rows();
            let staying = factors.covariance(frames, expansion);
            let all = factors.rotating(expansion).fold(staying, |sum, e| sum + e * e.transpose());
            let mut covariance = Matrix6::zeros();
            covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&(rows * all * rows.transpose()));
            return covariance;
        }
        self.prepare_effects(context, frames, memory);
        self.covariance_of_effects(&measure, memory)
    }

    /// Returns the covariance of the error from the prepared effects. The error has one component along each
    /// row of `measure`.
    fn covariance_of_effects(&self, measure: &SenseRows, memory: &EvaluatorScratch) -> Matrix6<f64> {
        let (mut covariance, rows) = (Matrix6::zeros(), measure.rows());
        memory.effects.independent(&self.sources, |effect, _| {
            let column = measure.column(&effect);
            for (i, j) in (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j))) {
                covariance[(i, j)] += column[i] * column[j];
            }
        });
        covariance
    }
}
