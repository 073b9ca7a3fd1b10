//! Lower bounds of the worst case at a posture. A bound takes much less computing time than the worst case.
//!
//! The local search for the nonlinear worst case starts at the worst corner of the linear model and at the
//! opposite corner. So the worst case that it finds is at least the larger of the errors at these two
//! corners. Let the error at a corner be L + E + O. Here L is the linear term, E the sum of all other terms
//! of even order, and O the sum of all other terms of odd order. The opposite corner has the error -L + E -
//! O. The larger of the two errors is at least `|L + O|`, and `|L + O| >= |L| - |O|`. The worst linear error
//! is at least the linear error at any corner. Sums of rotations and displacements bound `|O|`.

use super::corner::ToleranceCorner;
use super::corner_model::CornerModel;
use super::corner_search::both;
use super::error_sources::is_behind;
use super::flip_prediction::ProductBounds;
use super::spin_bound::rotating_parts;
use super::spun_worst_case::{ROUNDING, SpunWorstCase};
use super::work_context::WorkContext;
use super::zonotope::far_vertex;
use super::{ErrorEvaluator, EvaluatorScratch, SenseRows};
use crate::cell::{Model, Reading};
use crate::robot::Frames;
use nalgebra::Vector6;

impl ErrorEvaluator {
    /// Returns whether [`Self::value`] is a worst case, and [`Self::rough_worst`] takes much less computing
    /// time. The linear worst case in one or two rows takes hardly more time than its bound.
    pub fn has_worst_bounds(&self) -> bool {
        let is_slow = self.model != Model::Linear || self.sense.rows().len() > 2;
        self.reading == Reading::WorstCase && is_slow
    }

    /// Returns whether [`Self::corner_worst`] takes much less computing time than [`Self::value`].
    pub fn has_sharp_worst_bound(&self) -> bool {
        self.reading == Reading::WorstCase && self.model != Model::Linear
    }

    /// Returns a lower bound of the worst case at a posture, in little computing time.
    pub fn rough_worst(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let Some(lost) = self.lost_products(&measure, context, frames, memory) else { return 0.0 };
        let n = self.set_columns(&measure, memory);
        (far_vertex(&memory.columns[..n], measure.rows()).norm() * (1.0 - ROUNDING) - lost).max(0.0)
    }

    /// Prepares the lower bounds of the worst case at a posture, as a function of the rotation of the
    /// tool, and returns them.
    ///
    /// The spin bound of the evaluator must be [`super::spin_bound::SpinBound::WorstCase`].
    pub(super) fn spun_worst_case<'m>(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &'m mut EvaluatorScratch,
    ) -> &'m SpunWorstCase {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let lost = self.lost_products(&measure, context, frames, memory).unwrap_or(f64::INFINITY);
        let EvaluatorScratch { effects, columns, spun, .. } = memory;
        let (axes, axis) = (self.chain.axes(), frames.tcp.rotation * self.chain.tool_axis);
        let sources = || self.sources.list.iter().zip(&effects.columns);
        let mut n = 0;
        for (source, effect) in sources().filter(|(source, _)| !is_behind(source.parameter, axes)) {
            columns[n] = measure.column(&(*effect * source.plus_minus));
            n += 1;
        }
        let rotating = sources().filter(|(source, _)| is_behind(source.parameter, axes));
        let rotating = rotating.map(|(s, effect)| rotating_parts(&(*effect * s.plus_minus), &axis, &measure));
        spun.set(measure.rows(), &columns[..n], rotating, lost);
        spun
    }

    /// Returns a lower bound of the worst case by a nonlinear model at a posture. The function evaluates this
    /// model at a corner with a large linear error and at the opposite corner. The local search for the worst
    /// case starts at these two corners, too. The bound is the larger of the two errors.
    pub fn corner_worst(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let n = self.set_columns(&measure, memory);
        let EvaluatorScratch { expansion, columns, walk, .. } = memory;
        let corner = self.far_corner(&columns[..n], measure.rows());
        let mut model =
            CornerModel::new(self, measure, (context, frames), expansion, None, walk.as_deref_mut());
        both(corner, n).map(|corner| model.size(corner)).into_iter().fold(0.0, f64::max)
    }

    /// Returns a corner with a large linear error.
    pub(super) fn far_corner(&self, columns: &[Vector6<f64>], rows: usize) -> ToleranceCorner {
        let sum = far_vertex(columns, rows);
        let bits = columns.iter().enumerate().map(|(k, c)| u128::from(c.dot(&sum) < 0.0) << k);
        let corner = ToleranceCorner { negative: bits.fold(0, |set, bit| set | bit) };
        if self.is_reversed(corner) { corner.opposite(columns.len()) } else { corner }
    }

    /// Returns the worst case by the linear model at a posture, or an upper bound of it.
    pub fn linear_worst(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let (linear, _) = self.linear_corner(&measure, memory);
        linear.upper.max(linear.value)
    }

    /// Returns the worst case by a nonlinear model at a posture, and true. If this worst case exceeds `enough`
    /// (m or rad), the function may return a lower bound above `enough` and false, in less computing time.
    pub fn searched_worst(
        &self,
        context: &WorkContext,
        frames: &Frames,
        enough: f64,
        memory: &mut EvaluatorScratch,
    ) -> (f64, bool) {
        self.prepare_effects(context, frames, memory);
        let (found, is_complete) = self.worst_found(&self.sense, context, frames, enough, memory);
        (found.by_model, is_complete)
    }

    /// Returns an upper bound of the amount by which products of errors can make the worst case smaller than
    /// the linear worst case. Returns None if no bound is known.
    fn lost_products(
        &self,
        measure: &SenseRows,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Option<f64> {
        let products = self.products(measure, context, frames, memory)?;
        // With means, the search starts at one corner of the tolerance box. With more than three rows, the
        // corner may not be the worst by the linear model.
        let is_even_lost = self.mean.is_some() || measure.rows() > 3;
        Some(if is_even_lost { products.all } else { products.odd })
    }

    /// Returns upper bounds of the products of errors; None if no bounds are known. The bounds are 0 for the
    /// linear model.
    pub(super) fn products(
        &self,
        measure: &SenseRows,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Option<ProductBounds> {
        if self.model == Model::Linear {
            return Some(ProductBounds::default());
        }
        let EvaluatorScratch { expansion, flips, .. } = memory;
        let flips = flips.as_mut()?;
        let (work, tip) = (&context.site.work, &frames.tcp.translation);
        flips.set_posture(&self.sources, expansion, measure, work, tip).then(|| flips.products())
    }
}
