//! Figure of one operation at one node, judged by the error model of the cell, with its linear figure.

use super::linear_figure::LinearFigure;
use crate::cell::{Parameter, Quantity, Reading};
use crate::reading::norm::NormDistribution;
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::robot::Frames;
use nalgebra::{Matrix6, Vector6};

/// Relative step of a scale in the numerical slopes of a percentile.
const STEP: f64 = 1e-4;

/// Lower limit of the variance that sets a numerical step, as a share of the largest variance. The step is
/// `STEP` times the variance. For a variance below the limit, the step is `STEP` times the limit.
const LEAST_VARIANCE: f64 = 0.01;

/// Probability above which the square of a percentile is convex in the squared scales.
///
/// Consider three normal errors of equal mean squared length. The first acts in one direction, the second in
/// two directions, and the third in three. Above this probability, the first error has the largest percentile
/// of the length.
const LEAST_CONVEX_SHARE: f64 = 0.8;

/// One operation at one node.
pub struct NodeFigure<'a> {
    pub evaluator: &'a ErrorEvaluator,
    pub context: &'a WorkContext,
    pub frames: &'a Frames,
    /// Demanded yield, 0 to 1: this share of the arms must stay within the limit. It is used only if the
    /// quantity is the yield.
    pub share: f64,
}

impl NodeFigure<'_> {
    /// Returns the error figure of the operation at the node, m or rad. In the statistical reading, the
    /// figure is the quantity, such as the RMS. In any other reading, the figure is the worst case.
    ///
    /// If the quantity is the yield, the figure is the percentile of the error at the probability
    /// [`Self::share`]. The demanded yield is reached if this percentile is within the limit.
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

    /// Returns a linear figure that approximates the judged figure `value`.
    ///
    /// The tolerances in [`Self::evaluator`] must already be multiplied by `scales`, one scale for each
    /// parameter in `free`. All other errors are fixed.
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
            _ => self.worst_case_at(free, scales, memory),
        }
    }

    /// Returns whether the figure is a percentile with a probability of at least 0.8 (a high percentile) in
    /// the statistical reading. Tests indicate that, in the linear error model, the square of such a figure
    /// is a convex function of the squared scales. This property is not proven.
    ///
    /// Consider normal errors with mean 0, and let c be the square of the percentile for a unit variance in
    /// one direction. The squared percentile of these errors lies between two convex functions of the
    /// covariance. These functions are c times the largest eigenvalue and c times the trace. The square of a
    /// mean or of a low percentile is not convex.
    pub fn is_convex(&self) -> bool {
        match (self.evaluator.reading, self.evaluator.quantity) {
            (Reading::Statistical, Quantity::P95 | Quantity::P99) => true,
            (Reading::Statistical, Quantity::Yield) => self.share >= LEAST_CONVEX_SHARE,
            _ => false,
        }
    }

    /// Returns the worst case as a linear figure. Scale 1 stands for the tolerances in [`Self::evaluator`].
    pub fn worst_case(&self, free: &[Parameter], memory: &mut EvaluatorScratch) -> LinearFigure {
        self.worst_case_at(free, &vec![1.0; free.len()], memory)
    }

    /// Returns the linear worst case of an evaluator whose tolerances are at the scales `scales`.
    fn worst_case_at(
        &self,
        free: &[Parameter],
        scales: &[f64],
        memory: &mut EvaluatorScratch,
    ) -> LinearFigure {
        let Self { evaluator, context, frames, .. } = self;
        evaluator.prepare_effects(context, frames, memory);
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

    /// Returns a root sum square that leaves out the mean error. The square of the result is `ratio` times
    /// the mean square of the deviation from the mean.
    pub fn mean_square(&self, free: &[Parameter], ratio: f64, memory: &mut EvaluatorScratch) -> LinearFigure {
        let (mut squares, of_mean, constant) = self.squares(free, memory);
        squares.iter_mut().for_each(|w| *w *= ratio);
        LinearFigure::RootSumSquare { squares, constant: ratio * (constant - of_mean) }
    }

    /// Returns a lower bound of the ratio of the squared figure to the mean square of the error.
    ///
    /// Returns None for a worst case.
    ///
    /// A percentile is high if its probability is at least 0.8, and low otherwise. Consider normal errors of
    /// equal mean square. A high percentile is least if the variance is equal in all directions. A low
    /// percentile is least if all errors lie along one line. A high percentile can be lower for a bounded
    /// error than for a normal error. The percentile of the bounded error is still at least the root mean
    /// square. If an error is bounded, the result is therefore 1 for a high percentile, and 0 for a low
    /// percentile.
    pub fn least_square_ratio(evaluator: &ErrorEvaluator, share: f64) -> Option<f64> {
        if evaluator.reading != Reading::Statistical {
            return None;
        }
        let Some(probability) = Self::probability(evaluator, share) else {
            // The mean size of a normal error in one direction is `sqrt(2 / pi)` times its standard
            // deviation.
            let of_mean = std::f64::consts::FRAC_2_PI;
            return Some(if evaluator.quantity == Quantity::Rms { 1.0 } else { of_mean });
        };
        if evaluator.sources.has_bounded() {
            return Some(if probability >= LEAST_CONVEX_SHARE { 1.0 } else { 0.0 });
        }
        let ratio = |rows: usize| {
            let unit = |r: usize| Vector6::from_fn(|k, _| if k == r { 1.0 } else { 0.0 });
            let columns: Vec<Vector6<f64>> = (0..rows).map(unit).collect();
            let law = NormDistribution::new(rows, &columns, &[], &Vector6::zeros());
            law.quantile(probability).powi(2) / rows as f64
        };
        Some((1..=evaluator.sense.rows().len()).map(ratio).fold(f64::INFINITY, f64::min) * (1.0 - 1e-9))
    }

    /// Returns the root mean square of the error as a function of the scales. The only approximation is the
    /// mean of the second-order terms, which counts as constant.
    fn root_mean_square(
        &self,
        free: &[Parameter],
        scales: &[f64],
        memory: &mut EvaluatorScratch,
    ) -> LinearFigure {
        let (mut squares, _, constant) = self.squares(free, memory);
        squares.iter_mut().zip(scales).for_each(|(w, u)| *w /= u * u);
        LinearFigure::RootSumSquare { squares, constant }
    }

    /// Returns three results. The first is the mean square that each free parameter causes at its present
    /// tolerance. The second is the square of the mean error. The third is the second result plus the mean
    /// square of all other errors.
    fn squares(&self, free: &[Parameter], memory: &mut EvaluatorScratch) -> (Vec<f64>, f64, f64) {
        let Self { evaluator, context, frames, .. } = self;
        evaluator.prepare(context, frames, memory);
        let measure = evaluator.measure(&evaluator.sense, context, frames);
        let effects = memory.effects();
        let mut squares = vec![0.0; free.len()];
        let of_mean = measure.column(&effects.mean).norm_squared();
        let mut constant = of_mean;
        for (k, source) in evaluator.sources.list.iter().enumerate().filter(|(_, s)| s.spread.is_some()) {
            let square = measure.column(&(effects.columns[k] * source.deviation)).norm_squared();
            match place(free, source.parameter) {
                Some(place) => squares[place] = square,
                None => constant += square,
            }
        }
        for factor in &evaluator.sources.factors {
            let sum: Vector6<f64> =
                factor.iter().map(|&(k, v)| measure.column(&(effects.columns[k] * v))).sum();
            constant += sum.norm_squared();
        }
        (squares, of_mean, constant)
    }

    /// Returns a root sum square that equals a percentile of normal errors at the present tolerances. At
    /// these tolerances, the root sum square and the percentile also have equal derivatives with respect to
    /// the squared scales. The function treats the mean of the errors as 0.
    ///
    /// Returns None if the quantity is not a percentile or an error is not normal.
    ///
    /// The squared percentile depends only on the eigenvalues of the covariance. The function therefore
    /// computes only one percentile per eigenvalue, whatever the number of parameters.
    pub fn normal_percentile(
        &self,
        free: &[Parameter],
        memory: &mut EvaluatorScratch,
    ) -> Option<LinearFigure> {
        let Self { evaluator, context, frames, .. } = self;
        let probability =
            Self::probability(evaluator, self.share).filter(|_| !evaluator.sources.has_bounded())?;
        evaluator.prepare_effects(context, frames, memory);
        let measure = evaluator.measure(&evaluator.sense, context, frames);
        let effects = memory.effects();
        let sources = evaluator.sources.list.iter().enumerate().filter(|(_, s)| s.spread.is_some());
        let alone = sources.map(|(k, source)| {
            (place(free, source.parameter), measure.column(&(effects.columns[k] * source.deviation)))
        });
        let factors = evaluator.sources.factors.iter().map(|factor| {
            let sum = factor.iter().map(|&(k, v)| measure.column(&(effects.columns[k] * v)));
            (None, sum.sum::<Vector6<f64>>())
        });
        let columns: Vec<(Option<usize>, Vector6<f64>)> = alone.chain(factors).collect();
        let slopes = percentile_slopes(&columns, measure.rows(), probability)?;
        let (mut squares, mut constant) = (vec![0.0; free.len()], 0.0);
        for (place, column) in &columns {
            let square = column.dot(&(slopes * column)).max(0.0);
            match place {
                Some(place) => squares[*place] = square,
                None => constant += square,
            }
        }
        Some(LinearFigure::RootSumSquare { squares, constant })
    }

    /// Returns the probability of a percentile, or `share` for the yield; None for RMS and mean.
    fn probability(evaluator: &ErrorEvaluator, share: f64) -> Option<f64> {
        match evaluator.quantity {
            Quantity::P95 => Some(0.95),
            Quantity::P99 => Some(0.99),
            Quantity::Yield => Some(share),
            Quantity::Rms | Quantity::Mean => None,
        }
    }

    /// Returns a root sum square that matches a percentile or mean in value and slopes at the present
    /// scales.
    ///
    /// Assume that all errors belong to the parameters `free` and have mean 0. The square of such a figure is
    /// then homogeneous of degree 1 in the squared scales. So the derivatives with respect to these squares,
    /// `d value^2 / d u_k^2`, describe the figure well.
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

/// Returns the derivatives of the squared percentile of `|e|` with respect to the covariance of `e`. This
/// covariance is `sum g g^T` over `columns`. Returns None if `e` is zero.
fn percentile_slopes(
    columns: &[(Option<usize>, Vector6<f64>)],
    rows: usize,
    probability: f64,
) -> Option<Matrix6<f64>> {
    let covariance: Matrix6<f64> = columns.iter().map(|(_, c)| c * c.transpose()).sum();
    let eigen = covariance.symmetric_eigen();
    let mut order: Vec<usize> = (0..6).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let variances: Vec<f64> = order.iter().take(rows).map(|&k| eigen.eigenvalues[k].max(0.0)).collect();
    let largest = *variances.first().filter(|v| **v > 0.0)?;
    let square = |variances: &[f64]| {
        let axis = |(r, v): (usize, &f64)| Vector6::from_fn(|k, _| if k == r { v.sqrt() } else { 0.0 });
        let axes: Vec<Vector6<f64>> = variances.iter().enumerate().map(axis).collect();
        NormDistribution::new(rows, &axes, &[], &Vector6::zeros()).quantile(probability).powi(2)
    };
    let present = square(&variances);
    let mut slopes = Matrix6::zeros();
    // The squared percentile is homogeneous, so the slope with respect to the largest variance follows from
    // the other slopes.
    let mut of_largest = present / largest;
    for (k, variance) in variances.iter().enumerate().skip(1) {
        let step = STEP * variance.max(LEAST_VARIANCE * largest);
        let mut moved = variances.clone();
        moved[k] += step;
        let slope = (square(&moved) - present) / step;
        of_largest -= slope * variance / largest;
        let axis = eigen.eigenvectors.column(order[k]);
        slopes += axis * axis.transpose() * slope;
    }
    let axis = eigen.eigenvectors.column(order[0]);
    Some(slopes + axis * axis.transpose() * of_largest)
}

/// Returns the index of a parameter in the list `free`; None if it is not in the list.
fn place(free: &[Parameter], parameter: Parameter) -> Option<usize> {
    free.iter().position(|p| *p == parameter)
}
