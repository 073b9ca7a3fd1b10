//! Lower bound of the value of a reading at a posture: a weighted sum of the effects of small motions in the
//! chain.
//!
//! Let `g_k` be the effect of motion k, c a posture and e the error vector. The reading gives directions
//! `eta_k` such that at c the value is equal to `sum eta_k . g_k`. At every other posture, the value is not
//! less than this sum:
//!
//! ```text
//! signed        u = e / |e|:  |e| >= u . e
//! worst-case    s is the corner of the tolerance box that is worst at c, and e(s) is the error at s.
//!               At every posture, the value is at least |e(s)|, and |e(s)| >= u . e(s).
//! statistical   e ~ N(mu, S):  a mean enlarges each quantity, so mu = 0 gives a lower bound.
//!               G has the effects as columns, S = G G^T and A = d(quantity^2)/dS at c:
//!               quantity >= <A G_c, G> / quantity_c  (rms: A = 1)
//! ```
//!
//! The sum leaves out elastic errors, because their size changes with the posture. For a signed sample,
//! `task` subtracts an upper bound of their contribution. In the other readings, the non-elastic errors alone
//! give a lower bound. An additional independent source never reduces the error at the worst corner of the
//! tolerance box. An additional independent source also never reduces the spread of a distribution with mean
//! zero. If sources are correlated, only the part of the non-elastic errors that is independent of the
//! elastic errors counts.
//!
//! Means of measured errors are also ignored, and the bound remains valid. The largest error of a tolerance
//! box about a mean is at least that of the box about 0. The reason is that a mean cannot reduce the errors
//! at both of two opposite corners. A mean also enlarges each statistic.
//!
//! If the quantity is the mean of |e|, this bound is the tangent of a convex function of the effects.
//! Percentiles have a bound for senses of up to three rows (weighted components). The bound of a percentile
//! assumes that the squared percentile is a convex function of the covariance S. We know no proof of this
//! assumption. The file tests/maths/proof.rs tests this assumption for 95 % and 99 %, and
//! [`super::Proof::in_words`] states it.

use super::WhyNot;
use super::first_joint::{FirstJoint, isotropy};
use super::last_joint::{LastJoint, ToolAxisRange};
use super::linear_effects::Effect;
use super::rigid_factors::rigid_factors;
use crate::cell::{Model, Quantity, Reading, Row};
use crate::kinematic_error::ScrewMotion;
use crate::reading::norm::NormDistribution;
use crate::reading::zonotope::{ZonotopeScratch, farthest_1, farthest_2, farthest_3, farthest_6};
use crate::reading::{ErrorEvaluator, MAX_SOURCES};
use nalgebra::{DMatrix, Matrix3, Vector2, Vector3, Vector6};

/// Largest number of rows (weighted components) of a sense for which mean, percentiles and worst case can
/// have a bound.
///
/// For a sense with more rows, only three values can have a bound: the RMS, the error of the signed sample,
/// and the worst case in the linear model.
const MAX_ROWS_OF_PERCENTILE: usize = 3;
/// Step of a numeric derivative with respect to an eigenvalue of the covariance, as a share of the trace.
const DERIVATIVE_STEP: f64 = 1e-3;
/// Upper bound of the relative error of a numeric derivative with respect to an eigenvalue of the covariance.
const DERIVATIVE_ERROR: f64 = 1e-5;

/// Weights (eta, zeta) of the effect of one motion.
///
/// The vector eta multiplies the displacement of the measured point, and zeta multiplies the rotation.
pub(super) type Weight = (Vector3<f64>, Vector3<f64>);

/// Lower bound of a value as a sum of the weighted effects of motions, and a constant (m or rad).
pub(super) struct ValueSum {
    /// Weight of the effect of each motion.
    pub weights: Vec<Weight>,
    pub constant: f64,
}

/// Independent random factors of the errors. Each factor is a list of pairs (index of an error source, value
/// of this source at one standard deviation of the factor).
#[derive(Debug, Clone)]
pub(super) struct RandomFactors {
    list: Vec<Vec<(usize, f64)>>,
    /// Number of factors at the end of the list that stand for the excess in one direction. The bound
    /// multiplies the terms of these factors by the [`isotropy`]. See [`super::first_joint`].
    excess: usize,
}

/// Way in which a reading combines the effects of all error sources into one value.
#[derive(Debug, Clone)]
pub(super) enum EffectSum {
    /// Signed sample, with the value of every error source.
    Sample(Vec<f64>),
    /// Worst case, with the half width of the tolerance of every error source.
    Box(Vec<f64>),
    /// Statistic of independent random factors.
    Random(RandomFactors, Quantity),
}

impl EffectSum {
    /// Returns the way in which the reading of `evaluator` combines effects into a value, for a sense with
    /// `rows` rows (weighted components).
    ///
    /// # Errors
    /// Returns the reason if the value has no lower bound in this reading.
    pub fn new(evaluator: &ErrorEvaluator, rows: usize) -> Result<Self, WhyNot> {
        let list = &evaluator.sources.list;
        match evaluator.reading {
            Reading::Signed => Ok(Self::Sample(evaluator.sources.signed())),
            Reading::WorstCase if rows > MAX_ROWS_OF_PERCENTILE && evaluator.model != Model::Linear => {
                Err(WhyNot::ManyRows)
            }
            Reading::WorstCase => Ok(Self::Box(list.iter().map(|s| s.plus_minus).collect())),
            Reading::Statistical => {
                let exact = evaluator.quantity == Quantity::Rms;
                if evaluator.quantity == Quantity::Yield {
                    return Err(WhyNot::Share);
                }
                if !exact && list.iter().any(|s| s.spread.is_some() && s.kurtosis != 0.0) {
                    return Err(WhyNot::NotNormal);
                }
                if !exact && rows > MAX_ROWS_OF_PERCENTILE {
                    return Err(WhyNot::ManyRows);
                }
                let alone = list.iter().enumerate().filter(|(_, s)| s.spread.is_some());
                let mut factors: Vec<_> = alone.map(|(k, s)| vec![(k, s.deviation)]).collect();
                factors.extend(rigid_factors(&evaluator.sources));
                Ok(Self::Random(RandomFactors { list: factors, excess: 0 }, evaluator.quantity))
            }
        }
    }

    /// Adds the motions that stand for errors before the first joint.
    pub fn add_first_joint(&mut self, first: &FirstJoint) {
        if let Self::Random(factors, _) = self {
            let motions = first.motions.iter().zip(&first.deviations);
            factors.list.extend(motions.map(|(motion, deviation)| vec![(motion.source, *deviation)]));
            factors.excess = first.excess;
        }
    }

    /// Returns the lower bound of the value of the reading as a sum over the effects of all motions. Returns
    /// None if this value is zero at the posture of `effects`.
    ///
    /// At the posture of `effects`, the sum is equal to the value, except for the error margin of
    /// [`tangent`]. At other postures, the sum is not greater than the value.
    ///
    /// If `last` holds the errors after the last joint, `motions` must not contain these errors. The bound
    /// then holds for every rotation of the tool about its axis.
    pub fn weights(
        &self,
        rows: &[Row],
        motions: &[ScrewMotion],
        effects: &[Effect],
        last: Option<(&LastJoint, ToolAxisRange)>,
    ) -> Option<ValueSum> {
        let mut columns = [Vector6::zeros(); MAX_SOURCES];
        for (motion, effect) in motions.iter().zip(effects) {
            for (r, row) in rows.iter().enumerate() {
                let moved = if row.turns { &effect.w } else { &effect.g };
                columns[motion.source][r] += motion.factor * row.direction.dot(moved);
            }
        }
        let mut sums = [Vector6::zeros(); MAX_SOURCES];
        let constant = match self {
            Self::Sample(values) => towards(&columns, values, &mut sums).map(|_| 0.0),
            Self::Box(widths) => {
                let unit = towards(&columns, &corner(&columns, widths, rows.len()), &mut sums)?;
                let direction: Vector3<f64> =
                    rows.iter().enumerate().map(|(r, row)| row.direction * unit[r]).sum();
                Some(last.map_or(0.0, |(last, tool)| last.least_width(&direction, &tool)))
            }
            Self::Random(factors, quantity) => spread(&columns, factors, *quantity, rows, last, &mut sums),
        }?;
        let of = |motion: &ScrewMotion| {
            let (mut eta, mut zeta) = (Vector3::zeros(), Vector3::zeros());
            for (r, row) in rows.iter().enumerate() {
                let size = motion.factor * sums[motion.source][r];
                *(if row.turns { &mut zeta } else { &mut eta }) += row.direction * size;
            }
            // A translation rotates nothing.
            (eta, if motion.turns { zeta } else { Vector3::zeros() })
        };
        Some(ValueSum { weights: motions.iter().map(of).collect(), constant })
    }
}

/// Writes to `out` the vectors `a_k u` of the lower bound `sum a_k u . e_k` of `|sum a_k e_k|`.
///
/// Here `e_k` is the effect of error source k (`columns`), and `a_k` is the value of this source (`values`).
/// Returns the unit vector u, which points along `sum a_k e_k`. Returns None if this sum is zero.
fn towards(columns: &[Vector6<f64>], values: &[f64], out: &mut [Vector6<f64>]) -> Option<Vector6<f64>> {
    let sum: Vector6<f64> = columns.iter().zip(values).map(|(c, v)| c * *v).sum();
    let unit = sum.try_normalize(f64::MIN_POSITIVE)?;
    out.iter_mut().zip(values).for_each(|(out, v)| *out = unit * *v);
    Some(unit)
}

/// Returns the values of the error sources at the corner of the tolerance box that has the largest linear
/// error.
fn corner(columns: &[Vector6<f64>], widths: &[f64], rows: usize) -> Vec<f64> {
    let scaled: Vec<Vector6<f64>> = columns.iter().zip(widths).map(|(c, w)| c * *w).collect();
    let mut signs = vec![1.0; widths.len()];
    let mut scratch = ZonotopeScratch::default();
    match rows {
        0 | 1 => farthest_1(&scaled.iter().map(|c| c[0]).collect::<Vec<_>>(), &mut signs),
        2 => {
            let flat: Vec<_> = scaled.iter().map(|c| Vector2::new(c[0], c[1])).collect();
            farthest_2(&flat, &mut scratch, &mut signs)
        }
        3 => {
            let flat: Vec<_> = scaled.iter().map(|c| Vector3::new(c[0], c[1], c[2])).collect();
            farthest_3(&flat, &mut scratch, &mut signs)
        }
        _ => farthest_6(&scaled, &mut scratch, &mut signs),
    };
    signs.iter().zip(widths).map(|(s, w)| s * w).collect()
}

/// Writes to `out`, for each error source, the vector that weights its effect in the lower bound of a
/// statistic. Returns the constant part of this bound.
///
/// The symbols are:
///
/// - `e_f`: effect of one standard deviation of the random factor f (in `factors`) on the error;
/// - `v_kf`: value of source k at one standard deviation of factor f;
/// - A: the identity matrix for the RMS; otherwise the [`tangent`] at the covariance of the error;
/// - `i_f`: the [`isotropy`] of A for the last [`RandomFactors::excess`] factors, 1 for all other factors;
/// - h: the least contribution to `<A, S>` from the errors after the last joint ([`LastJoint::least_form`]),
///   or 0;
/// - s: the square root of h plus the sum of `i_f e_f . A e_f` over all factors.
///
/// The vector of source k is the sum of `v_kf i_f A e_f / s` over all factors, and the constant is h / s.
/// Returns None if s is 0.
fn spread(
    columns: &[Vector6<f64>],
    factors: &RandomFactors,
    quantity: Quantity,
    rows: &[Row],
    last: Option<(&LastJoint, ToolAxisRange)>,
    out: &mut [Vector6<f64>],
) -> Option<f64> {
    let count = rows.len();
    let effect =
        |factor: &Vec<(usize, f64)>| factor.iter().map(|&(k, v)| columns[k] * v).sum::<Vector6<f64>>();
    let effects: Vec<Vector6<f64>> = factors.list.iter().map(effect).collect();
    let apply: DMatrix<f64> = match quantity {
        Quantity::Rms => DMatrix::identity(count, count),
        _ => {
            let entry = |i: usize, j: usize| effects.iter().map(|e| e[i] * e[j]).sum::<f64>();
            let mut covariance = Matrix3::zeros();
            (0..count).for_each(|i| (0..count).for_each(|j| covariance[(i, j)] = entry(i, j)));
            if let Some((last, tool)) = &last {
                let added = last.covariance(&in_space(rows, |i, j| covariance[(i, j)]), tool);
                let entry = |i: usize, j: usize| rows[i].direction.dot(&(added * rows[j].direction));
                (0..count).for_each(|i| (0..count).for_each(|j| covariance[(i, j)] += entry(i, j)));
            }
            let a = tangent(&covariance, count, quantity)?;
            DMatrix::from_fn(count, count, |i, j| a[(i, j)])
        }
    };
    let form = in_space(rows, |i, j| apply[(i, j)]);
    let (behind, isotropy) =
        (last.map_or(0.0, |(last, tool)| last.least_form(&form, &tool)), isotropy(&form));
    let first = effects.len() - factors.excess;
    let applied = |(f, e): (usize, &Vector6<f64>)| {
        let mut sum = Vector6::zeros();
        (0..count).for_each(|i| sum[i] = (0..count).map(|j| apply[(i, j)] * e[j]).sum());
        if f < first { sum } else { sum * isotropy }
    };
    let square = behind + effects.iter().enumerate().map(|(f, e)| e.dot(&applied((f, e)))).sum::<f64>();
    if square < f64::MIN_POSITIVE {
        return None;
    }
    for (factor, effect) in factors.list.iter().zip(effects.iter().enumerate()) {
        let a = applied(effect) / square.sqrt();
        factor.iter().for_each(|&(k, v)| out[k] += a * v);
    }
    Some(behind / square.sqrt())
}

/// Converts a quadratic form of the rows of a sense to a form of displacements in the base frame. `entry`
/// returns the entries of the form of the rows.
fn in_space(rows: &[Row], entry: impl Fn(usize, usize) -> f64) -> Matrix3<f64> {
    let pairs = (0..rows.len()).flat_map(|i| (0..rows.len()).map(move |j| (i, j)));
    pairs.map(|(i, j)| rows[i].direction * rows[j].direction.transpose() * entry(i, j)).sum()
}

/// Returns the derivative A of `quantity(S)^2` with respect to the covariance matrix S, at S = `covariance`.
/// `rows` is the number of error components in S.
///
/// `quantity(S)` is the quantity of `|e|` for a normally distributed error vector e with mean zero and
/// covariance S. Returns None if `covariance` is zero. A is slightly reduced, because the numeric derivatives
/// have small errors.
///
/// Let `<A, S>` be the sum of the products of corresponding entries. For the RMS, `<A, S> <= quantity(S)^2`
/// holds for every S. For a percentile, this inequality holds for every S if the squared percentile is a
/// convex function of S. We know of no proof of this convexity. For the mean, the inequality does not hold
/// for every S.
pub fn tangent(covariance: &Matrix3<f64>, rows: usize, quantity: Quantity) -> Option<Matrix3<f64>> {
    let trace = covariance.trace();
    if trace < f64::MIN_POSITIVE {
        return None;
    }
    let eigen = (covariance / trace).symmetric_eigen();
    // Unused rows appear as zero eigenvalues with separate axes.
    let used: Vec<usize> =
        (0..3).filter(|&k| eigen.eigenvectors.column(k).iter().skip(rows).all(|v| v.abs() < 0.5)).collect();
    let sizes: Vec<f64> = used.iter().map(|&k| eigen.eigenvalues[k].max(0.0)).collect();
    let value = square(&sizes, quantity);
    let slope = |k: usize| {
        let at = |by: f64| {
            let mut moved = sizes.clone();
            moved[k] += by;
            square(&moved, quantity)
        };
        match sizes[k] > 2.0 * DERIVATIVE_STEP {
            true => (at(DERIVATIVE_STEP) - at(-DERIVATIVE_STEP)) / (2.0 * DERIVATIVE_STEP),
            // The difference is one-sided, with second-order accuracy, because eigenvalues must not become
            // negative.
            false => {
                (4.0 * at(DERIVATIVE_STEP) - 3.0 * value - at(2.0 * DERIVATIVE_STEP))
                    / (2.0 * DERIVATIVE_STEP)
            }
        }
    };
    let slopes: Vec<f64> = (0..sizes.len()).map(|k| slope(k).max(0.0)).collect();
    // The value is a homogeneous function of degree 1, so by Euler's theorem it must equal the sum of slope
    // times size.
    let given: f64 = slopes.iter().zip(&sizes).map(|(a, l)| a * l).sum();
    let scale = (1.0 - DERIVATIVE_ERROR) * value / given.max(f64::MIN_POSITIVE);
    let mut a = Matrix3::zeros();
    for (&k, slope) in used.iter().zip(slopes) {
        let axis = eigen.eigenvectors.column(k);
        a += axis * axis.transpose() * (slope * scale.min(1.0));
    }
    Some(a)
}

/// Returns the square of `quantity` of `|e|`. The error vector e is normally distributed, with mean zero and
/// these variances.
fn square(variances: &[f64], quantity: Quantity) -> f64 {
    let mut columns = [Vector6::zeros(); 3];
    variances.iter().enumerate().for_each(|(k, l)| columns[k][k] = l.max(0.0).sqrt());
    let norm = NormDistribution::new(variances.len(), &columns[..variances.len()], &[], &Vector6::zeros());
    let value = match quantity {
        Quantity::Rms => norm.rms(),
        Quantity::Mean => norm.mean(),
        Quantity::P99 => norm.quantile(0.99),
        Quantity::P95 | Quantity::Yield => norm.quantile(0.95),
    };
    value * value
}
