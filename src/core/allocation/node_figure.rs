//! Figure of one operation at one node, judged by the error model of the cell, with its linear figure.

use super::linear_figure::LinearFigure;
use crate::cell::{Parameter, Quantity, Reading};
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::robot::Frames;
use nalgebra::Vector6;

/// Relative step of a scale in the numerical slopes of a percentile.
const STEP: f64 = 1e-4;

/// Probability above which the square of a percentile is convex in the squared scales.
///
/// A normal error in one direction has a larger percentile than one of equal variance in two or three directions
/// above this probability.
const LEAST_CONVEX_SHARE: f64 = 0.8;

/// One operation at one node.
pub struct NodeFigure<'a> {
    pub evaluator: &'a ErrorEvaluator,
    pub context: &'a WorkContext,
    pub frames: &'a Frames,
    /// Yield that is demanded, 0 to 1, if the quantity is the yield: the limit must hold for this share.
    pub share: f64,
}

impl NodeFigure<'_> {
    /// Returns the figure of the reading, m or rad. Any reading but the statistical one counts as worst case.
    ///
    /// For the yield, this is the percentile that the limit must not be below.
    pub fn value(&self, memory: &mut EvaluatorScratch) -> f64 {
        self.value_of(self.evaluator, memory)
    }

    fn value_of(&self, evaluator: &ErrorEvaluator, memory: &mut EvaluatorScratch) -> f64 {
        let Self { context, frames, .. } = self;
        match (evaluator.reading, evaluator.quantity) {
            (Reading::Statistical, Quantity::Yield) => {
                evaluator.prepare(context, frames, memory);
                evaluator.norm(&evaluator.sense, context, frames, memory).quantile(self.share)
            }
            (Reading::Statistical, _) => evaluator.value(context, frames, memory),
            _ => {
                evaluator.prepare(context, frames, memory);
                evaluator.worst(&evaluator.sense, context, frames, memory).by_model
            }
        }
    }

    /// Returns a linear figure near the judged figure `value`.
    ///
    /// The evaluator has the tolerances at the scales `scales` of the parameters `free`. Other errors are fixed.
    pub fn linear(
        &self,
        free: &[Parameter],
        scales: &[f64],
        value: f64,
        memory: &mut EvaluatorScratch,
    ) -> LinearFigure {
        match (self.evaluator.reading, self.evaluator.quantity) {
            (Reading::Statistical, Quantity::Rms) => self.root_mean_square(free, scales, memory),
            (Reading::Statistical, _) => self.percentile(free, scales, value, memory),
            _ => self.worst_case(free, scales, memory),
        }
    }

    /// Returns whether the squared figure is a convex function of the squared scales, but for nonlinear effects.
    ///
    /// The square of a high percentile is: it lies between the trace and the largest eigenvalue of the
    /// covariance, times a factor. That of a mean or of a low percentile is not.
    pub fn is_convex(&self) -> bool {
        match (self.evaluator.reading, self.evaluator.quantity) {
            (Reading::Statistical, Quantity::P95 | Quantity::P99) => true,
            (Reading::Statistical, Quantity::Yield) => self.share >= LEAST_CONVEX_SHARE,
            _ => false,
        }
    }

    /// Returns the linear worst case.
    fn worst_case(&self, free: &[Parameter], scales: &[f64], memory: &mut EvaluatorScratch) -> LinearFigure {
        let Self { evaluator, context, frames, .. } = self;
        evaluator.prepare(context, frames, memory);
        let measure = evaluator.measure(&evaluator.sense, context, frames);
        let (mut generators, mut fixed) = (vec![Vector6::zeros(); free.len()], Vec::new());
        for (k, source) in evaluator.sources.list.iter().enumerate() {
            let column = measure.column(&(memory.effects().columns[k] * source.plus_minus));
            match place(free, source.parameter) {
                Some(place) => generators[place] = column / scales[place],
                None => fixed.push(column),
            }
        }
        if let Some(means) = evaluator.sources.means() {
            fixed.push(measure.column(&memory.effects().of_sample(&means)));
        }
        LinearFigure::WorstCase { rows: measure.rows(), generators, fixed }
    }

    /// Returns the root mean square, which is exact but for the mean of second-order terms.
    fn root_mean_square(
        &self,
        free: &[Parameter],
        scales: &[f64],
        memory: &mut EvaluatorScratch,
    ) -> LinearFigure {
        let Self { evaluator, context, frames, .. } = self;
        evaluator.prepare(context, frames, memory);
        let measure = evaluator.measure(&evaluator.sense, context, frames);
        let effects = memory.effects();
        let mut squares = vec![0.0; free.len()];
        let mut constant = measure.column(&effects.mean).norm_squared();
        for (k, source) in evaluator.sources.list.iter().enumerate().filter(|(_, s)| s.spread.is_some()) {
            let square = measure.column(&(effects.columns[k] * source.deviation)).norm_squared();
            match place(free, source.parameter) {
                Some(place) => squares[place] = square / (scales[place] * scales[place]),
                None => constant += square,
            }
        }
        for factor in &evaluator.sources.factors {
            let sum: Vector6<f64> =
                factor.iter().map(|&(k, v)| measure.column(&(effects.columns[k] * v))).sum();
            constant += sum.norm_squared();
        }
        LinearFigure::RootSumSquare { squares, constant }
    }

    /// Returns the root sum square with the value and the slopes of a percentile or mean at the present scales.
    ///
    /// The square of such a figure is homogeneous of degree 1 in the squares of the scales, if all errors are
    /// free and have no mean. So the slopes by these squares, `d value^2 / d u_k^2`, describe it well.
    fn percentile(
        &self,
        free: &[Parameter],
        scales: &[f64],
        value: f64,
        memory: &mut EvaluatorScratch,
    ) -> LinearFigure {
        let mut moved = self.evaluator.clone();
        let mut squares = vec![0.0; free.len()];
        for (k, source) in self.evaluator.sources.list.iter().enumerate() {
            let Some(place) = place(free, source.parameter) else { continue };
            moved.sources.scale(k, 1.0 + STEP);
            let larger = self.value_of(&moved, memory);
            moved.sources.clone_from(&self.evaluator.sources);
            let slope = (larger - value) * (larger + value) / (STEP * (2.0 + STEP));
            squares[place] = slope.max(0.0) / (scales[place] * scales[place]);
        }
        let sum: f64 = squares.iter().zip(scales).map(|(w, u)| w * u * u).sum();
        LinearFigure::RootSumSquare { squares, constant: (value * value - sum).max(0.0) }
    }
}

/// Returns the index of a parameter among the free ones.
fn place(free: &[Parameter], parameter: Parameter) -> Option<usize> {
    free.iter().position(|p| *p == parameter)
}
