//! Error by a nonlinear model at corners of the tolerance box, at one posture and in one sense.

use super::MAX_SOURCES;
use super::corner::ToleranceCorner;
use super::evaluator::ErrorEvaluator;
use super::flip_prediction::FlipPrediction;
use super::pair_gains::PairGains;
use super::sense_rows::SenseRows;
use super::work_context::WorkContext;
use crate::kinematic_error::{Expansion, TwoValuedWalk, position_error};
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::{SVector, Vector3, Vector6};

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
    /// Predictor of how sign flips change the error. None if the evaluator has no predictor, or if the errors
    /// are too large for a prediction.
    prediction: Option<&'a mut FlipPrediction>,
    /// Algorithm that computes the position error of the TCP. None if the evaluator has no such algorithm, or
    /// if the sense measures anything other than the TCP position.
    walk: Option<&'a mut TwoValuedWalk>,
}

impl<'a> CornerModel<'a> {
    /// Returns the model at a posture; `expansion` must hold the derivatives at this posture.
    pub fn new(
        evaluator: &'a ErrorEvaluator,
        measure: SenseRows,
        (context, frames): (&'a WorkContext, &'a Frames),
        expansion: &Expansion,
        prediction: Option<&'a mut FlipPrediction>,
        walk: Option<&'a mut TwoValuedWalk>,
    ) -> Self {
        let (work, tip) = (&context.site.work, &frames.tcp.translation);
        let prediction = prediction.and_then(|flips| {
            let is_small = flips.set_posture(&evaluator.sources, expansion, &measure, work, tip);
            is_small.then_some(flips)
        });
        let mut walk = walk.filter(|_| measure.is_of_position());
        if let Some(walk) = &mut walk {
            walk.set_posture(frames, evaluator.sources.ends());
        }
        Self { evaluator, context, frames, measure, prediction, walk }
    }

    /// Returns the error at a corner.
    pub fn error(&mut self, corner: ToleranceCorner) -> CornerError {
        let ErrorEvaluator { chain, sources, model, .. } = self.evaluator;
        let n = sources.list.len();
        if let Some(walk) = &mut self.walk {
            let lower = self.evaluator.of_sources(corner).negative;
            let position = walk.position_error(&self.frames.tcp.translation, lower);
            return self.of_position(position);
        }
        let mut values = [0.0; MAX_SOURCES];
        self.evaluator.corner(self.evaluator.of_sources(corner), &mut values);
        if self.evaluator.alone && self.measure.is_of_position() {
            let errors = sources.perturbation(chain, &values[..n]);
            return self.of_position(position_error(self.frames, &errors, *model));
        }
        let propagation = self.evaluator.propagation();
        let sample = propagation.sample(&values[..n], *model);
        let error = propagation.error(self.context, self.frames, &sample, *model);
        let components = self.measure.vector(&error);
        CornerError { size: components.norm(), components }
    }

    /// Returns the size of the error at a corner, in less time than [`Self::error`].
    pub fn size(&mut self, corner: ToleranceCorner) -> f64 {
        match &mut self.walk {
            Some(walk) => {
                let lower = self.evaluator.of_sources(corner).negative;
                let position = walk.position_error(&self.frames.tcp.translation, lower);
                self.measure.size_of_position(&position)
            }
            None => self.error(corner).size,
        }
    }

    /// Returns the error along the rows of a sense that measures only the position of the TCP.
    fn of_position(&self, position: Vector3<f64>) -> CornerError {
        let size = self.measure.size_of_position(&position);
        let error = Displacement { position, rotation: Vector3::zeros() };
        CornerError { size, components: self.measure.components(&error) }
    }

    /// Returns the bit set of the sources that are known to leave the error unchanged at every corner.
    pub fn idle(&self) -> u128 {
        self.prediction.as_ref().map_or(0, |prediction| prediction.idle(&self.evaluator.sources))
    }

    /// Sets the corner from which [`Self::may_exceed`] predicts how a flip of each sign changes the error.
    pub fn stand_at(&mut self, corner: ToleranceCorner) {
        if let Some(flips) = &mut self.prediction {
            flips.set_corner(&self.evaluator.sources, self.evaluator.of_sources(corner));
        }
    }

    /// Returns whether the sign flips `flips`, made together at the corner of [`Self::stand_at`], may
    /// increase the error.
    ///
    /// `error` must be the error at that corner. The function returns true if the flips cannot be predicted.
    pub fn may_exceed(&mut self, error: &CornerError, mut flips: impl Iterator<Item = usize>) -> bool {
        let Some(prediction) = &mut self.prediction else { return true };
        let (mut components, mut margin) = (error.components, ROUNDING * error.size);
        let (mut rotation, mut displacement) = (0.0, 0.0);
        let all_known = flips.all(|k| {
            let Some(flip) = prediction.flip_of(k, &self.measure).copied() else { return false };
            components += flip.change;
            margin += flip.margin + prediction.product_bound((rotation, displacement), &flip);
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
    pub fn pair_gains(&mut self, error: &CornerError) -> Option<PairGains> {
        let flips = self.prediction.as_mut()?;
        let weights = flips.weights();
        Some(PairGains::new(flips.flips(&self.measure), weights, &error.components))
    }

    /// Predicts the size of the error for every combination of the signs of the sources `free`, in the order
    /// of [`gray_code`]. All other signs are the signs at the corner of [`Self::stand_at`].
    ///
    /// `corner` and `error` must be that corner and the error there. Returns an upper bound of the
    /// prediction error of the sizes, m or rad; None if there is no prediction.
    pub fn predict_combinations(
        &mut self,
        corner: ToleranceCorner,
        error: &CornerError,
        free: &[usize],
        sizes: &mut [f64; 1 << MAX_FREE],
    ) -> Option<f64> {
        let prediction = self.prediction.as_mut()?;
        let (corner, sources) = (self.evaluator.of_sources(corner), &self.evaluator.sources);
        let mut margin = ROUNDING * error.size;
        let mut flips = CombinedFlips { count: free.len(), ..CombinedFlips::default() };
        for (a, &k) in free.iter().enumerate() {
            let flip = prediction.flip_of(k, &self.measure)?;
            margin += flip.margin;
            flips.alone[a] = flip.change;
            for (b, &l) in free.iter().enumerate().take(a) {
                flips.products[a][b] = prediction.product_of(sources, corner, (k, l), &self.measure);
                flips.products[b][a] = flips.products[a][b];
            }
        }
        match self.measure.rows() {
            1 => flips.sizes_in_rows::<1>(&error.components, sizes),
            2 => flips.sizes_in_rows::<2>(&error.components, sizes),
            3 => flips.sizes_in_rows::<3>(&error.components, sizes),
            _ => flips.sizes_in_rows::<6>(&error.components, sizes),
        }
        Some(margin)
    }
}

/// Predicted changes of the error by flips of a few signs, m or rad.
#[derive(Default)]
struct CombinedFlips {
    /// Number of signs. Entries of the arrays after this number are not used.
    count: usize,
    /// Change by the flip of each sign alone.
    alone: [Vector6<f64>; MAX_FREE],
    /// Additional change if both signs are flipped.
    products: [[Vector6<f64>; MAX_FREE]; MAX_FREE],
}

impl CombinedFlips {
    /// Writes the size of the error for every combination of the signs, in the order of [`gray_code`].
    ///
    /// `error` is the error before any flip. All components after the first `R` must be 0.
    fn sizes_in_rows<const R: usize>(&self, error: &Vector6<f64>, sizes: &mut [f64; 1 << MAX_FREE]) {
        let in_rows = |v: &Vector6<f64>| v.fixed_rows::<R>(0).into_owned();
        let (mut components, mut flipped) = (in_rows(error), 0u32);
        for (step, a) in gray_code(self.count) {
            let partners = (0..self.count).filter(|&b| b != a && flipped >> b & 1 == 1);
            let product = partners.map(|b| in_rows(&self.products[a][b])).sum::<SVector<f64, R>>();
            let change = in_rows(&self.alone[a]) + product;
            components += if flipped >> a & 1 == 1 { -change } else { change };
            flipped ^= 1 << a;
            sizes[step] = components.norm();
        }
    }
}

/// Returns the steps of the Gray code of `count` bits: the number of each step, from 1, and the bit that it
/// flips.
pub fn gray_code(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (1usize..1 << count).map(|step| (step, step.trailing_zeros() as usize))
}
