//! The coordinates that are cut into boxes: of joints with parallel axes the sum of their angles.
//!
//! A sum turns one link and shifts what is behind it, so that a planar arm falls apart into links that
//! do not know of each other and the elevation of its tool is a coordinate. With `y` the coordinates,
//! `theta = D y` and the actuators are `q = q_0 + G y`, each between its limits.

use super::screws::{Screws, Values};
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::Chain;
use std::f64::consts::PI;

/// Sine below which axes count as parallel: far above rounding, far below any slack.
const PARALLEL: f64 = 1e-12;
/// Limits are kept within this by the inverse kinematics (an angle whose cosine may be off by 1e-12, a
/// slide by 1e-9 m).
const AT_LIMIT: f64 = 2e-6;

pub(super) type Matrix = [[f64; MAX_JOINTS]; MAX_JOINTS];

#[derive(Debug, Clone)]
pub(super) struct Coordinates {
    pub count: usize,
    /// `theta = D y`.
    pub to_theta: Matrix,
    /// Limits: `low <= row . y <= high`.
    pub limits: Vec<(Values, f64, f64)>,
    /// The box of all postures.
    pub low: Values,
    pub high: Values,
    /// Of link k (after k joints) the coordinates that turn it, as bits.
    pub turning: [u8; MAX_JOINTS + 1],
    /// By how much the joint angles change together with a coordinate.
    pub angles: Values,
}

/// The posture in the middle of the limits, from which `theta` counts.
pub(super) fn middle(chain: &Chain) -> JointVector {
    let mut q = [0.0; MAX_JOINTS];
    q.iter_mut().zip(&chain.links).for_each(|(q, link)| *q = (link.limits.0 + link.limits.1) / 2.0);
    q
}

impl Coordinates {
    /// `held`: joints that change nothing, by index; they stay in the middle.
    pub fn new(chain: &Chain, screws: &Screws, held: &[bool; MAX_JOINTS]) -> Self {
        let count = chain.axes();
        let (mut to_theta, mut turning) = ([[0.0; MAX_JOINTS]; MAX_JOINTS], [0; MAX_JOINTS + 1]);
        let revolute = |i: &usize| screws.kinds[*i] == JointKind::Revolute;
        let parallel = |i: usize, j: usize| screws.axes[i].cross(&screws.axes[j]).norm() < PARALLEL;
        // Whether an angle is counted about the axis of the first of its run, or against it.
        let mut sign = [1.0; MAX_JOINTS];
        for i in 0..count {
            if !revolute(&i) {
                to_theta[i][i] = 1.0;
                continue;
            }
            if let Some(before) = (0..i).rev().find(revolute).filter(|&b| parallel(b, i)) {
                sign[i] = sign[before] * screws.axes[before].dot(&screws.axes[i]).signum();
                to_theta[i][before] = -sign[i];
            }
            to_theta[i][i] = sign[i];
            let next = (i + 1..count).find(revolute).filter(|&next| parallel(i, next));
            (i + 1..=next.unwrap_or(count)).for_each(|link| turning[link] |= 1 << i);
        }
        let mut angles = [0.0; MAX_JOINTS];
        for (k, sum) in angles.iter_mut().enumerate() {
            *sum = (0..count).filter(revolute).map(|i| to_theta[i][k].abs()).sum();
        }
        let mut this = Self {
            count,
            to_theta,
            limits: Vec::new(),
            low: [0.0; MAX_JOINTS],
            high: [0.0; MAX_JOINTS],
            turning,
            angles,
        };
        this.set_limits(chain, held);
        this
    }

    /// Rows of `q = q_0 + G y`, with `G = C^-1 D` and C the coupling, and the box around all of them.
    fn set_limits(&mut self, chain: &Chain, held: &[bool; MAX_JOINTS]) {
        let mut half = [0.0; MAX_JOINTS];
        let mut rows = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        // y = D^-1 C q: angles of a run add up, with their signs.
        let mut from_actuators = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        for i in 0..self.count {
            half[i] = if held[i] { 0.0 } else { half_range(chain, i) };
            let mut row = self.to_theta[i];
            let mut back = [0.0; MAX_JOINTS];
            for j in 0..=i {
                back[j] = chain.coupling[i][j];
                if j < i {
                    for k in 0..self.count {
                        row[k] -= chain.coupling[i][j] * rows[j][k];
                    }
                }
            }
            for k in (0..i).filter(|&k| self.to_theta[i][k] != 0.0) {
                for j in 0..self.count {
                    back[j] -= self.to_theta[i][k] * from_actuators[k][j];
                }
            }
            from_actuators[i] = back.map(|v| v / self.to_theta[i][i]);
            rows[i] = row;
            self.limits.push((row, -half[i], half[i]));
        }
        for (i, row) in from_actuators.iter().enumerate() {
            let reach: f64 = row.iter().zip(half).map(|(f, h)| f.abs() * h).sum();
            (self.low[i], self.high[i]) = (-reach, reach);
        }
    }

    pub fn theta(&self, y: &Values) -> Values {
        let mut theta = [0.0; MAX_JOINTS];
        for (theta, row) in theta.iter_mut().zip(&self.to_theta).take(self.count) {
            *theta = row.iter().zip(y).map(|(d, y)| d * y).sum();
        }
        theta
    }

    /// The actuators at coordinates, before `q_0` is added.
    pub fn actuators(&self, y: &Values) -> Values {
        let mut q = [0.0; MAX_JOINTS];
        for (q, (row, ..)) in q.iter_mut().zip(&self.limits) {
            *q = row.iter().zip(y).map(|(g, y)| g * y).sum();
        }
        q
    }

    /// Turns derivatives by theta into those by the coordinates: `D^T g` and `D^T H D`.
    pub fn derivatives(&self, gradient: &Values, hessian: &Matrix) -> (Values, Matrix) {
        let n = self.count;
        let (mut g, mut half, mut h) =
            ([0.0; MAX_JOINTS], [[0.0; MAX_JOINTS]; MAX_JOINTS], [[0.0; MAX_JOINTS]; MAX_JOINTS]);
        for i in 0..n {
            for k in (0..=i).filter(|&k| self.to_theta[i][k] != 0.0) {
                let d = self.to_theta[i][k];
                g[k] += d * gradient[i];
                (0..n).for_each(|j| half[k][j] += d * hessian[i.min(j)][i.max(j)]);
            }
        }
        for (i, row) in half.iter().enumerate().take(n) {
            for (d, value) in self.to_theta.iter().zip(row).take(n) {
                (0..n).for_each(|k| h[i][k] += d[k] * value);
            }
        }
        (g, h)
    }
}

/// Half the range of an actuator. A whole turn is enough where all that follows it turns by whole
/// numbers: the same posture comes back.
fn half_range(chain: &Chain, joint: usize) -> f64 {
    let link = &chain.links[joint];
    let half = (link.limits.1 - link.limits.0) / 2.0 + AT_LIMIT;
    let comes_back = |i: usize| {
        let factor = chain.coupling[i][joint];
        factor.fract() == 0.0 && (factor == 0.0 || chain.links[i].kind == JointKind::Revolute)
    };
    let turns = link.kind == JointKind::Revolute && (joint..chain.axes()).all(comes_back);
    if turns { half.min(PI) } else { half }
}
