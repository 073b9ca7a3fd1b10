//! What a posture is worth, from below: a sum of effects in fixed directions that no posture of the
//! operation undercuts, whatever its reading.
//!
//! At any posture c the reading gives directions `eta_k` so that its value is `sum eta_k . g_k` there and
//! at least that everywhere else:
//!
//! ```text
//! signed        u = e / |e|:  |e| >= u . e
//! worst-case    the farthest corner s at c is one of the corners everywhere
//! statistical   |e| ~ N(mu, S):  a mean makes each quantity larger, so that mu = 0 is below; with
//!               A = d(quantity^2)/dS at c:  quantity^2 >= <A, S>  (rms: A = 1, equality)
//! ```
//!
//! For the mean of |e| that is the tangent of a convex function of the effects. For the percentiles it
//! says that their squares are convex in the covariance of up to three rows: no proof is known to us,
//! tests/it/proof.rs tries it of 95 % and 99 %, and [`super::Proof::in_words`] says that it was assumed.

use super::WhyNot;
use super::columns::Effect;
use super::screws::Motion;
use crate::cell::{Model, Quantity, Reading, Row};
use crate::reading::norm::NormDistribution;
use crate::reading::zonotope::{ZonotopeScratch, farthest_1, farthest_2, farthest_3, farthest_6};
use crate::reading::{ErrorEvaluator, MAX_SOURCES};
use nalgebra::{DMatrix, Matrix3, Vector2, Vector3, Vector6};

/// Percentiles are known in so many rows.
const FEW_ROWS: usize = 3;
/// Differences of a numeric derivative, as a share of the trace, and what they may be off.
const STEP: f64 = 1e-3;
const ROUGH: f64 = 1e-5;

/// Directions of one motion: of what it does to the point, and of its turn.
pub(super) type Weight = (Vector3<f64>, Vector3<f64>);

/// How effects add up to a value.
#[derive(Debug, Clone)]
pub(super) enum Sum {
    /// Signed values of the sources.
    Sample(Vec<f64>),
    /// Half widths of the sources.
    Box(Vec<f64>),
    /// Independent factors as (source, at one standard deviation), and what of them counts.
    Random(Vec<Vec<(usize, f64)>>, Quantity),
}

impl Sum {
    /// # Errors
    /// Why the reading has no bound here.
    pub fn new(gauge: &ErrorEvaluator, rows: usize) -> Result<Self, WhyNot> {
        let list = &gauge.sources.list;
        match gauge.reading {
            Reading::Signed => Ok(Self::Sample(gauge.sources.signed())),
            Reading::WorstCase if rows > FEW_ROWS && gauge.model != Model::Linear => Err(WhyNot::ManyRows),
            Reading::WorstCase => Ok(Self::Box(list.iter().map(|s| s.plus_minus).collect())),
            Reading::Statistical => {
                let exact = gauge.quantity == Quantity::Rms;
                if gauge.quantity == Quantity::Yield {
                    return Err(WhyNot::Share);
                }
                if !exact && list.iter().any(|s| s.spread.is_some() && s.kurtosis != 0.0) {
                    return Err(WhyNot::NotNormal);
                }
                if !exact && rows > FEW_ROWS {
                    return Err(WhyNot::ManyRows);
                }
                let alone = list.iter().enumerate().filter(|(_, s)| s.spread.is_some());
                let mut factors: Vec<_> = alone.map(|(k, s)| vec![(k, s.deviation)]).collect();
                factors.extend(gauge.sources.factors.iter().cloned());
                Ok(Self::Random(factors, gauge.quantity))
            }
        }
    }

    /// Directions at a posture; None where the value is zero.
    pub fn weights(&self, rows: &[Row], motions: &[Motion], effects: &[Effect]) -> Option<Vec<Weight>> {
        let mut columns = [Vector6::zeros(); MAX_SOURCES];
        for (motion, effect) in motions.iter().zip(effects) {
            for (r, row) in rows.iter().enumerate() {
                let moved = if row.turns { &effect.w } else { &effect.g };
                columns[motion.source][r] += motion.factor * row.direction.dot(moved);
            }
        }
        let mut sums = [Vector6::zeros(); MAX_SOURCES];
        match self {
            Self::Sample(values) => towards(&columns, values, &mut sums),
            Self::Box(widths) => towards(&columns, &corner(&columns, widths, rows.len()), &mut sums),
            Self::Random(factors, quantity) => spread(&columns, factors, *quantity, rows.len(), &mut sums),
        }?;
        let of = |motion: &Motion| {
            let (mut eta, mut zeta) = (Vector3::zeros(), Vector3::zeros());
            for (r, row) in rows.iter().enumerate() {
                let size = motion.factor * sums[motion.source][r];
                *(if row.turns { &mut zeta } else { &mut eta }) += row.direction * size;
            }
            // A slide turns nothing.
            (eta, if motion.turns { zeta } else { Vector3::zeros() })
        };
        Some(motions.iter().map(of).collect())
    }
}

/// Of `|sum a_k e_k|`.
fn towards(columns: &[Vector6<f64>], values: &[f64], out: &mut [Vector6<f64>]) -> Option<()> {
    let sum: Vector6<f64> = columns.iter().zip(values).map(|(c, v)| c * *v).sum();
    let unit = sum.try_normalize(f64::MIN_POSITIVE)?;
    out.iter_mut().zip(values).for_each(|(out, v)| *out = unit * *v);
    Some(())
}

/// The farthest corner as signed values.
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

/// Of a statistic: `A e_f / value`, carried back to the sources.
fn spread(
    columns: &[Vector6<f64>],
    factors: &[Vec<(usize, f64)>],
    quantity: Quantity,
    rows: usize,
    out: &mut [Vector6<f64>],
) -> Option<()> {
    let effect =
        |factor: &Vec<(usize, f64)>| factor.iter().map(|&(k, v)| columns[k] * v).sum::<Vector6<f64>>();
    let effects: Vec<Vector6<f64>> = factors.iter().map(effect).collect();
    let apply: DMatrix<f64> = match quantity {
        Quantity::Rms => DMatrix::identity(rows, rows),
        _ => {
            let entry = |i: usize, j: usize| effects.iter().map(|e| e[i] * e[j]).sum::<f64>();
            let mut covariance = Matrix3::zeros();
            (0..rows).for_each(|i| (0..rows).for_each(|j| covariance[(i, j)] = entry(i, j)));
            let a = tangent(&covariance, rows, quantity)?;
            DMatrix::from_fn(rows, rows, |i, j| a[(i, j)])
        }
    };
    let applied = |e: &Vector6<f64>| {
        let mut sum = Vector6::zeros();
        (0..rows).for_each(|i| sum[i] = (0..rows).map(|j| apply[(i, j)] * e[j]).sum());
        sum
    };
    let square: f64 = effects.iter().map(|e| e.dot(&applied(e))).sum();
    if square < f64::MIN_POSITIVE {
        return None;
    }
    for (factor, effect) in factors.iter().zip(&effects) {
        let a = applied(effect) / square.sqrt();
        factor.iter().for_each(|&(k, v)| out[k] += a * v);
    }
    Some(())
}

/// A with `<A, S> <= quantity(S)^2` for every covariance S of `rows` rows, and equal at the one given but
/// for the rounding of its numeric derivatives, which is taken off. None where nothing varies.
pub fn tangent(covariance: &Matrix3<f64>, rows: usize, quantity: Quantity) -> Option<Matrix3<f64>> {
    let trace = covariance.trace();
    if trace < f64::MIN_POSITIVE {
        return None;
    }
    let eigen = (covariance / trace).symmetric_eigen();
    // Rows that are not there come out as zeros with an axis of their own.
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
        match sizes[k] > 2.0 * STEP {
            true => (at(STEP) - at(-STEP)) / (2.0 * STEP),
            // At the edge: of second order, from one side.
            false => (4.0 * at(STEP) - 3.0 * value - at(2.0 * STEP)) / (2.0 * STEP),
        }
    };
    let slopes: Vec<f64> = (0..sizes.len()).map(|k| slope(k).max(0.0)).collect();
    // Homogeneous of the first degree: what the slopes give must be the value.
    let given: f64 = slopes.iter().zip(&sizes).map(|(a, l)| a * l).sum();
    let scale = (1.0 - ROUGH) * value / given.max(f64::MIN_POSITIVE);
    let mut a = Matrix3::zeros();
    for (&k, slope) in used.iter().zip(slopes) {
        let axis = eigen.eigenvectors.column(k);
        a += axis * axis.transpose() * (slope * scale.min(1.0));
    }
    Some(a)
}

/// The squared quantity of a centred normal vector with these variances.
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
