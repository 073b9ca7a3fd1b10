//! One constraint along one direction of the error. A one-dimensional search finds the single multiplier of
//! this constraint.

use super::cone_cut::ConeCut;
use super::lagrangian::charged;
use crate::cell::ToleranceCost;
use nalgebra::Vector6;

/// Largest number of Newton steps to find the multiplier.
const MAX_STEPS: usize = 80;
/// Half width of the bracket in which the logarithm of the multiplier is sought.
const WIDEST: f64 = 60.0;
/// Longest step of the multiplier's logarithm.
const LONGEST: f64 = 3.0;
/// The steps of a quick bound end when their relative gain is below this value.
const QUICK_GAIN: f64 = 1e-4;
/// Two values count as equal up to this difference. Rounding errors can be as large.
const SAME: f64 = 1e-13;

/// One constraint along one direction of the error: `constant + sum_k (linear_k u_k + squares_k u_k^2) <= 1`.
/// An empty list `linear` or `squares` counts as a list of zeros.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LimitRow {
    pub linear: Vec<f64>,
    pub squares: Vec<f64>,
    pub constant: f64,
}

impl LimitRow {
    /// Returns the constraint that a cut gives along a direction of its error. The direction matters only for
    /// a cut with several axes.
    pub(super) fn along(cut: &ConeCut, direction: &Vector6<f64>) -> Self {
        match cut {
            ConeCut::Row { columns, constant } => {
                Self { linear: columns.clone(), constant: *constant, ..Self::default() }
            }
            ConeCut::Vertex { columns, constant, .. } => Self {
                linear: columns.iter().map(|c| c.dot(direction)).collect(),
                constant: constant.dot(direction),
                ..Self::default()
            },
            ConeCut::Ellipsoid { roots, constant } => Self {
                squares: roots.iter().map(|root| root * root).collect(),
                constant: constant * constant,
                ..Self::default()
            },
        }
    }

    /// Resets the row to `count` coefficients of 0 and the constant 0.
    pub(super) fn clear(&mut self, count: usize) {
        for list in [&mut self.linear, &mut self.squares] {
            list.clear();
            list.resize(count, 0.0);
        }
        self.constant = 0.0;
    }

    fn at(&self, k: usize) -> (f64, f64) {
        let of = |list: &[f64]| list.get(k).copied().unwrap_or(0.0);
        (of(&self.linear), of(&self.squares))
    }

    /// Returns the left side of the constraint with every scale at one end of its range. The function `end`
    /// returns this end.
    pub(super) fn sum(&self, costs: &[ToleranceCost], end: fn(&ToleranceCost) -> f64) -> f64 {
        let of = |(k, cost): (usize, &ToleranceCost)| {
            let ((a, w), u) = (self.at(k), end(cost));
            (a + w * u) * u
        };
        self.constant + costs.iter().enumerate().map(of).sum::<f64>()
    }

    /// Returns the value of the constraint minus its limit, and the derivative of this difference. The scales
    /// minimize the Lagrangian at the given multiplier ([`Self::multiplier`]). The derivative is with respect
    /// to the logarithm of the multiplier.
    fn excess(&self, costs: &[ToleranceCost], p: &[f64], q: &[f64], multiplier: f64) -> (f64, f64) {
        let (mut sum, mut slope) = (self.constant - 1.0, 0.0);
        for (k, cost) in costs.iter().enumerate() {
            let (a, w) = self.at(k);
            let found = charged(cost, p[k] + multiplier * a, q[k] + multiplier * w);
            let u = found.scale;
            let by_scale = a + 2.0 * w * u;
            sum += (a + w * u) * u;
            slope -= by_scale * by_scale / found.curvature;
        }
        (sum, slope * multiplier)
    }

    /// Returns a lower bound of the cost from a few Newton steps. The steps update `x`, the logarithm of the
    /// multiplier. The function writes to `scales` the scales that minimize the Lagrangian at the last
    /// multiplier.
    pub(super) fn quick_bound(
        &self,
        costs: &[ToleranceCost],
        x: &mut f64,
        steps: usize,
        scales: &mut Vec<f64>,
    ) -> f64 {
        let mut bound = f64::NEG_INFINITY;
        for _ in 0..steps {
            let multiplier = x.exp();
            let (mut sum, mut slope, mut least) = (self.constant - 1.0, 0.0, 0.0);
            scales.clear();
            for (k, cost) in costs.iter().enumerate() {
                let (a, w) = self.at(k);
                let found = charged(cost, multiplier * a, multiplier * w);
                let by_scale = a + 2.0 * w * found.scale;
                sum += (a + w * found.scale) * found.scale;
                slope -= by_scale * by_scale / found.curvature;
                least += found.least;
                scales.push(found.scale);
            }
            let now = least - multiplier * (1.0 - self.constant);
            if now - bound <= QUICK_GAIN * now.abs() {
                return bound.max(now);
            }
            bound = now;
            let step = if slope < 0.0 { -sum / (slope * multiplier) } else { sum.signum() };
            *x += step.clamp(-LONGEST, LONGEST);
        }
        bound
    }

    /// Returns the least multiplier with which this constraint holds at the scales that minimize the
    /// Lagrangian. Newton's method within a bracket finds the multiplier.
    ///
    /// The Lagrangian is `sum_k (c_k(u_k) + p_k u_k + q_k u_k^2) + multiplier * (left - 1)`. Here `c_k` is
    /// the cost of the scale `u_k`, and `left` is the left side of this constraint. The arguments `p` and `q`
    /// hold the coefficients `p_k` and `q_k`, which come from other constraints.
    pub fn multiplier(&self, costs: &[ToleranceCost], p: &[f64], q: &[f64]) -> f64 {
        if self.excess(costs, p, q, 0.0).0 <= 0.0 {
            return 0.0;
        }
        // For reciprocal costs without bounds, the multiplier is about equal to the cost.
        let mut x = costs.iter().map(|c| c.cost(1.0).abs()).sum::<f64>().max(1e-12).ln();
        let (mut low, mut high) = (x - WIDEST, x + WIDEST);
        for _ in 0..MAX_STEPS {
            let (excess, slope) = self.excess(costs, p, q, x.exp());
            if excess.abs() <= SAME {
                break;
            }
            if excess > 0.0 {
                low = x
            } else {
                high = x
            }
            let step = if slope < 0.0 { (-excess / slope).clamp(-LONGEST, LONGEST) } else { f64::INFINITY };
            let next = x + step;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - x).abs() <= SAME {
                break;
            }
            x = next;
        }
        x.exp()
    }

    /// Returns a lower bound of the cost of any set of scales that satisfies the constraint.
    pub fn least_cost(&self, costs: &[ToleranceCost]) -> f64 {
        let zeros = vec![0.0; costs.len()];
        let multiplier = self.multiplier(costs, &zeros, &zeros);
        let of = |(k, cost): (usize, &ToleranceCost)| {
            let (a, w) = self.at(k);
            charged(cost, multiplier * a, multiplier * w).least
        };
        costs.iter().enumerate().map(of).sum::<f64>() - multiplier * (1.0 - self.constant)
    }
}
