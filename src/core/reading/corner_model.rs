//! Error by a nonlinear model at corners of the tolerance box, at one posture and in one sense.

use super::MAX_SOURCES;
use super::evaluator::ErrorEvaluator;
use super::flip_prediction::FlipPrediction;
use super::pair_gains::PairGains;
use super::sense_rows::SenseRows;
use super::work_context::WorkContext;
use crate::kinematic_error::{Expansion, position_error};
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::{Vector3, Vector6};

/// Upper bound of the relative rounding error of a computed error size.
const ROUNDING: f64 = 1e-12;
/// Largest number of sources whose signs are tried in every combination.
pub const MAX_FREE: usize = 8;

/// Error at a corner of the tolerance box.
#[derive(Debug, Clone, Copy)]
pub struct CornerError {
    /// Root sum square of the components, m or rad.
    pub size: f64,
    /// Components along the rows of the sense.
    pub components: Vector6<f64>,
}

/// Nonlinear model of the error at corners of the tolerance box, with bounds for neighbouring corners.
pub struct CornerModel<'a> {
    evaluator: &'a ErrorEvaluator,
    context: &'a WorkContext,
    frames: &'a Frames,
    measure: SenseRows,
    /// Prediction of the changes of the error that sign flips cause. None if the evaluator has no prediction,
    /// or if the errors are too large for a prediction.
    prediction: Option<&'a mut FlipPrediction>,
}

impl<'a> CornerModel<'a> {
    /// Returns the model at a posture; `expansion` must hold the derivatives at this posture.
    pub fn new(
        evaluator: &'a ErrorEvaluator,
        measure: SenseRows,
        (context, frames): (&'a WorkContext, &'a Frames),
        expansion: &Expansion,
        prediction: Option<&'a mut FlipPrediction>,
    ) -> Self {
        let (work, tip) = (&context.site.work, &frames.tcp.translation);
        let prediction = prediction.and_then(|flips| {
            let is_small = flips.set_posture(&evaluator.sources, expansion, &measure, work, tip);
            is_small.then_some(flips)
        });
        Self { evaluator, context, frames, measure, prediction }
    }

    /// Returns the error at a corner.
    pub fn error(&self, signs: &[f64; MAX_SOURCES]) -> CornerError {
        let ErrorEvaluator { chain, sources, model, .. } = self.evaluator;
        let n = sources.list.len();
        let mut values = [0.0; MAX_SOURCES];
        self.evaluator.corner(&self.evaluator.signs_of_sources(signs), &mut values);
        if self.evaluator.alone && self.measure.is_of_position() {
            let position = position_error(self.frames, &sources.perturbation(chain, &values[..n]), *model);
            let size = self.measure.size_of_position(&position);
            let error = Displacement { position, rotation: Vector3::zeros() };
            return CornerError { size, components: self.measure.components(&error) };
        }
        let propagation = self.evaluator.propagation();
        let sample = propagation.sample(&values[..n], *model);
        let error = propagation.error(self.context, self.frames, &sample, *model);
        let components = self.measure.vector(&error);
        CornerError { size: components.norm(), components }
    }

    /// Predicts how a flip of each sign changes the error at a corner. [`Self::may_exceed`] uses these
    /// predictions.
    pub fn stand_at(&mut self, signs: &[f64; MAX_SOURCES]) {
        if let Some(flips) = &mut self.prediction {
            flips.set_corner(&self.evaluator.sources, &self.evaluator.signs_of_sources(signs), &self.measure);
        }
    }

    /// Returns whether the sign flips `flips`, made together at the corner of [`Self::stand_at`], may
    /// increase the error.
    ///
    /// `error` must be the error at that corner. The function returns true if the flips cannot be predicted.
    pub fn may_exceed(&self, error: &CornerError, mut flips: impl Iterator<Item = usize>) -> bool {
        let Some(prediction) = &self.prediction else { return true };
        let (mut components, mut margin) = (error.components, ROUNDING * error.size);
        let (mut rotation, mut displacement) = (0.0, 0.0);
        let all_known = flips.all(|k| {
            let Some(flip) = prediction.flip_of(k) else { return false };
            components += flip.change;
            margin += flip.margin + prediction.product_bound((rotation, displacement), flip);
            rotation += flip.rotation;
            displacement += flip.displacement;
            true
        });
        !all_known || components.norm() + margin >= error.size
    }

    /// Returns upper bounds of the increase of the error by flips of two signs at the corner of
    /// [`Self::stand_at`]. Returns None if there is no prediction.
    ///
    /// `error` must be the error at that corner.
    pub fn pair_gains(&self, error: &CornerError) -> Option<PairGains> {
        let flips = self.prediction.as_ref()?;
        Some(PairGains::new(flips.flips(), flips.weights(), &error.components))
    }

    /// Predicts the size of the error for every combination of the signs of the sources `free`, in the order
    /// of [`gray_code`]. All other signs are the signs at the corner of [`Self::stand_at`].
    ///
    /// `signs` and `error` must be the signs and the error at that corner. Returns an upper bound of the
    /// prediction error of the sizes, m or rad; None if there is no prediction.
    pub fn predict_combinations(
        &self,
        signs: &[f64; MAX_SOURCES],
        error: &CornerError,
        free: &[usize],
        sizes: &mut [f64; 1 << MAX_FREE],
    ) -> Option<f64> {
        let prediction = self.prediction.as_ref()?;
        let (signs, sources) = (self.evaluator.signs_of_sources(signs), &self.evaluator.sources);
        let mut margin = ROUNDING * error.size;
        let mut products = [[Vector6::zeros(); MAX_FREE]; MAX_FREE];
        for (a, &k) in free.iter().enumerate() {
            margin += prediction.flip_of(k)?.margin;
            for (b, &l) in free.iter().enumerate().take(a) {
                products[a][b] = prediction.product_of(sources, &signs, (k, l), &self.measure);
                products[b][a] = products[a][b];
            }
        }
        let (mut components, mut flipped) = (error.components, 0u32);
        for (step, a) in gray_code(free.len()) {
            let partners = (0..free.len()).filter(|&b| b != a && flipped >> b & 1 == 1);
            let change =
                prediction.flip_of(free[a])?.change + partners.map(|b| products[a][b]).sum::<Vector6<f64>>();
            components += if flipped >> a & 1 == 1 { -change } else { change };
            flipped ^= 1 << a;
            sizes[step] = components.norm();
        }
        Some(margin)
    }
}

/// Returns the steps of the Gray code of `count` bits: the number of each step, from 1, and the bit that it
/// flips.
pub fn gray_code(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (1usize..1 << count).map(|step| (step, step.trailing_zeros() as usize))
}
