//! Corner of the tolerance box at which an operation has the largest error in a sense.

use super::corner::ToleranceCorner;
use super::corner_model::CornerModel;
use super::corner_search::by_model;
use super::evaluator::{ErrorEvaluator, EvaluatorScratch};
use super::work_context::WorkContext;
use super::worst_case::{WorstCase, farthest};
use super::zonotope::{Farthest, ZonotopeScratch};
use super::{Effects, MAX_SOURCES, SenseRows};
use crate::cell::{Model, Sense};
use crate::robot::Frames;
use nalgebra::Vector6;

impl ErrorEvaluator {
    /// Returns the largest size of the error in a [`Sense`] over the tolerance box, at a posture. Call
    /// [`Self::prepare_effects`] first.
    pub fn worst(
        &self,
        sense: &Sense,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> WorstCase {
        self.worst_found(sense, context, frames, f64::INFINITY, memory).0
    }

    /// Returns the largest size of the error that the local search finds, and whether this search is
    /// complete. Call [`Self::prepare_effects`] first.
    ///
    /// The search ends at an error above `enough`, m or rad. The result of an incomplete search is a lower
    /// bound of the result of a complete search.
    pub(super) fn worst_found(
        &self,
        sense: &Sense,
        context: &WorkContext,
        frames: &Frames,
        enough: f64,
        memory: &mut EvaluatorScratch,
    ) -> (WorstCase, bool) {
        let measure = self.measure(sense, context, frames);
        let n = self.sources.list.len();
        let of_mean = usize::from(self.mean.is_some());
        let (linear, corner) = self.linear_corner(&measure, memory);
        if self.model == Model::Linear {
            let exact = linear.upper <= linear.value;
            let linear = linear.upper.max(linear.value);
            let corner = ToleranceCorner::of_signs(&corner[..n]);
            return (WorstCase { linear, exact, by_model: linear, corner }, true);
        }
        let quadratic = self.quadratic(&memory.effects);
        let EvaluatorScratch { expansion, effects, columns, scratch, flips, walk, .. } = memory;
        let (flips, walk) = (flips.as_deref_mut(), walk.as_deref_mut());
        let mut model = CornerModel::new(self, measure, (context, frames), expansion, flips, walk);
        let columns = &columns[..n + of_mean];
        let corners =
            [ToleranceCorner::of_signs(&corner[..columns.len()]), self.far_corner(columns, measure.rows())];
        let largest = || self.largest(effects, scratch);
        let (mut worst, is_complete) =
            by_model(columns, &linear, quadratic, corners, &mut model, largest, enough);
        worst.corner = self.of_sources(worst.corner);
        (worst, is_complete)
    }

    /// Converts a corner of the local search to a corner of the sources. The local search treats the mean
    /// error as an additional source, which also has a sign. If this sign is -1, the function reverses all
    /// signs.
    pub(super) fn of_sources(&self, corner: ToleranceCorner) -> ToleranceCorner {
        let n = self.sources.list.len();
        if self.is_reversed(corner) { corner.opposite(n) } else { corner }.of_first(n)
    }

    /// Returns whether all signs of a corner must be reversed, so that the mean gets the sign +1.
    ///
    /// The linear error has the same size if all signs are reversed, including the sign of the mean. So the
    /// search for the worst corner treats the mean as an additional source whose sign is free. This sign is
    /// stored after the signs of the sources.
    pub(super) fn is_reversed(&self, corner: ToleranceCorner) -> bool {
        self.mean.is_some() && corner.sign(self.sources.list.len()) < 0.0
    }

    /// Returns two corners of the tolerance box.
    ///
    /// By the linear model, the TCP has the largest displacement at the first corner, and the largest
    /// rotation at the second corner.
    fn largest(&self, effects: &Effects, scratch: &mut ZonotopeScratch) -> [ToleranceCorner; 2] {
        let mut columns = [Vector6::zeros(); MAX_SOURCES];
        [false, true].map(|turns| {
            for (k, source) in self.sources.list.iter().enumerate() {
                let effect = &effects.columns[k];
                let v = if turns { effect.rotation } else { effect.position } * source.plus_minus;
                columns[k] = Vector6::new(v.x, v.y, v.z, 0.0, 0.0, 0.0);
            }
            let mut corner = [1.0; MAX_SOURCES];
            let n = self.sources.list.len();
            farthest(&columns[..n], 3, scratch, &mut corner[..n]);
            ToleranceCorner::of_signs(&corner[..n])
        })
    }

    /// Returns an estimate of the size of the second-order terms of the TCP error.
    ///
    /// Each source at its tolerance rotates and displaces the TCP. The estimate is the root sum square of the
    /// rotations times the root sum square of the displacements.
    fn quadratic(&self, effects: &Effects) -> f64 {
        let pairs = self.sources.list.iter().zip(&effects.columns);
        let (turn, shift) = pairs.fold((0.0, 0.0), |(turn, shift), (source, effect)| {
            let largest = source.plus_minus + source.mean.abs();
            let [w, d] = [effect.rotation, effect.position].map(|v| v.norm_squared() * largest.powi(2));
            (turn + w, shift + d)
        });
        (turn * shift).sqrt()
    }

    /// Returns the largest linear error over the tolerance box, and the corner at which it occurs. One sign
    /// per source describes the corner. Call [`Self::prepare`] first.
    pub fn linear_corner(
        &self,
        measure: &SenseRows,
        memory: &mut EvaluatorScratch,
    ) -> (Farthest, [f64; MAX_SOURCES]) {
        let mut corner = [0.0; MAX_SOURCES];
        let n = self.set_columns(measure, memory);
        let found = farthest(&memory.columns[..n], measure.rows(), &mut memory.scratch, &mut corner[..n]);
        if self.is_reversed(ToleranceCorner::of_signs(&corner[..n])) {
            corner.iter_mut().for_each(|sign| *sign = -*sign);
        }
        (found, corner)
    }

    /// Sets the columns: the linear effect of each source at its tolerance along the rows of a sense. With
    /// means, the linear effect of all means together is one more column. Returns the number of columns. Call
    /// [`Self::prepare_effects`] first.
    pub(super) fn set_columns(&self, measure: &SenseRows, memory: &mut EvaluatorScratch) -> usize {
        let EvaluatorScratch { effects, columns, .. } = memory;
        let n = self.sources.list.len();
        for ((column, source), effect) in columns.iter_mut().zip(&self.sources.list).zip(&effects.columns) {
            *column = measure.column(&(*effect * source.plus_minus));
        }
        let Some((values, _)) = &self.mean else { return n };
        columns[n] = measure.column(&effects.of_sample(values));
        n + 1
    }

    /// Writes the values of the sources at a corner of the tolerance box.
    pub fn corner(&self, corner: ToleranceCorner, values: &mut [f64]) {
        for (k, (value, source)) in values.iter_mut().zip(&self.sources.list).enumerate() {
            *value = source.at(corner.sign(k));
        }
    }
}
