//! Lower bounds of the worst case at a posture. A bound takes much less computing time than the worst case.
//!
//! The linear error at any corner of the tolerance box is at most the linear worst case. Leaving out a source
//! only reduces this worst case. At any corner, the error by the cell's model and the linear error differ by
//! products of two and more parameter errors. The sums of all rotations and displacements bound these
//! products. The local search for the nonlinear worst case starts at the worst corner of the linear model and
//! at the opposite corner. So the worst case that it finds is at least the larger of the errors at these two
//! corners.

use super::corner_model::CornerModel;
use super::error_sources::is_behind;
use super::work_context::WorkContext;
use super::{ErrorEvaluator, EvaluatorScratch, SenseRows};
use crate::cell::{Model, Reading};
use crate::robot::Frames;
use nalgebra::Vector6;

/// Largest rounding error of a bound, as a share of the bound.
const ROUNDING: f64 = 1e-9;
/// Largest number of corners that the search for a corner with a large linear error visits.
const MAX_STEPS: usize = 4;

impl ErrorEvaluator {
    /// Returns whether [`Self::value`] is a worst case, so that [`Self::rough_worst`] bounds it.
    pub fn has_worst_bounds(&self) -> bool {
        self.reading == Reading::WorstCase
    }

    /// Returns whether [`Self::corner_worst`] takes much less computing time than [`Self::value`].
    pub fn has_sharp_worst_bound(&self) -> bool {
        self.has_worst_bounds() && self.model != Model::Linear
    }

    /// Returns a lower bound of the worst case at a posture, in little computing time.
    ///
    /// If `turning` is true, the bound also holds after every rotation of the tool about its axis by the last
    /// joint.
    pub fn rough_worst(
        &self,
        context: &WorkContext,
        frames: &Frames,
        turning: bool,
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let Some(products) = self.largest_products(&measure, context, frames, memory) else { return 0.0 };
        let EvaluatorScratch { effects, columns, .. } = memory;
        let (mut n, axes) = (0, self.chain.axes());
        for (source, effect) in self.sources.list.iter().zip(&effects.columns) {
            if !(turning && is_behind(source.parameter, axes)) {
                columns[n] = measure.column(&(*effect * source.plus_minus));
                n += 1;
            }
        }
        if let Some((values, _)) = &self.mean {
            columns[n] = measure.column(&effects.of_sample(values));
            n += 1;
        }
        (bad_corner(&columns[..n]) * (1.0 - ROUNDING) - products).max(0.0)
    }

    /// Returns a lower bound of the worst case by a nonlinear model at a posture. The function evaluates this
    /// model at the worst corner of the linear model and at the opposite corner. The bound is the larger of
    /// the two errors.
    pub fn corner_worst(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let (_, corner) = self.linear_corner(&measure, memory);
        let EvaluatorScratch { expansion, walk, .. } = memory;
        let mut model =
            CornerModel::new(self, measure, (context, frames), expansion, None, walk.as_deref_mut());
        [corner, corner.map(|s| -s)].iter().map(|corner| model.size(corner)).fold(0.0, f64::max)
    }

    /// Returns the worst case by the linear model at a posture, or an upper bound of it.
    pub fn linear_worst(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        self.prepare_effects(context, frames, memory);
        let measure = self.measure(&self.sense, context, frames);
        let (linear, _) = self.linear_corner(&measure, memory);
        linear.upper.max(linear.value)
    }

    /// Returns a lower bound of the worst case by a nonlinear model at a posture. The returned `bool` is true
    /// if this bound is the worst case itself. A local search over the corners of the tolerance box finds the
    /// bound. This search starts only at the worst corner of the linear model and at the opposite corner.
    pub fn searched_worst(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> (f64, bool) {
        self.prepare_effects(context, frames, memory);
        let (found, is_complete) = self.worst_found(&self.sense, context, frames, false, memory);
        (found.by_model, is_complete)
    }

    /// Returns an upper bound of the products of two and more errors at any corner; None if no bound is
    /// known.
    pub(super) fn largest_products(
        &self,
        measure: &SenseRows,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Option<f64> {
        if self.model == Model::Linear {
            return Some(0.0);
        }
        let EvaluatorScratch { expansion, flips, .. } = memory;
        let flips = flips.as_mut()?;
        let (work, tip) = (&context.site.work, &frames.tcp.translation);
        flips.set_posture(&self.sources, expansion, measure, work, tip).then(|| flips.largest_products())
    }
}

/// Returns the length of the longest signed sum of all columns that the search finds. The search takes at
/// most [`MAX_STEPS`] steps of ascent. The farthest vertex of the zonotope is at least this far from the
/// origin.
fn bad_corner(columns: &[Vector6<f64>]) -> f64 {
    let mut longest = 0.0;
    let mut along = columns.iter().max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).copied();
    for _ in 0..MAX_STEPS {
        let Some(direction) = along else { break };
        let sum: Vector6<f64> = columns.iter().map(|c| if c.dot(&direction) < 0.0 { -c } else { *c }).sum();
        let length = sum.norm();
        if length <= longest {
            break;
        }
        (longest, along) = (length, Some(sum));
    }
    longest
}
