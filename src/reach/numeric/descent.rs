//! From one start down to the goal.

use super::Numeric;
use super::goal::Goal;
use super::jacobian::{jacobian, normal_equations};
use super::step::bounded_step;
use crate::cell::JointVector;
use crate::robot::Frames;

/// Steps of one descent at most.
const ROUNDS: usize = 40;
/// A descent that has not divided its cost by `GAIN` in so many steps is given up.
const PATIENCE: usize = 6;
const GAIN: f64 = 2.0;
/// Largest step of a joint, rad.
const STRIDE: f64 = 1.0;
/// Damping per cost, and the least one: a posture that is nearly singular needs its large steps.
const DAMPING: f64 = 0.1;
const LEAST_DAMPING: f64 = 1e-15;
/// What is added where H is singular to rounding, and to that of every redundant chain.
const SINGULAR: f64 = 1e-12;
/// How far a redundant chain goes towards the middle of its ranges in one step, as a share.
const PULL: f64 = 0.1;

impl Numeric {
    /// Damped Gauss-Newton with the damping proportional to the cost `|e|^2 / 2`, which needs neither
    /// trial steps nor rejections and leaves the convergence quadratic (Sugihara 2011,
    /// doi:10.1109/TRO.2011.2148230), each step within the limits.
    pub(super) fn rush(&self, goal: &Goal, start: &JointVector, frames: &mut Frames) -> Option<JointVector> {
        let n = self.chain.axes();
        let (mut q, mut past) = (*start, [f64::INFINITY; PATIENCE]);
        for round in 0..ROUNDS {
            self.chain.place(&self.chain.posture(&q), frames);
            let miss = goal.miss(&frames.tcp, &self.chain.tool_axis);
            if miss.is_reached() {
                return Some(self.joints.kept(&q));
            }
            let cost = miss.cost(self.scale);
            let before = std::mem::replace(&mut past[round % PATIENCE], cost);
            if cost * GAIN > before {
                return None;
            }
            let columns = jacobian(&self.chain, frames);
            let (mut h, mut b) = normal_equations(n, &columns, &miss, self.scale);
            let redundant = goal.rows() < n;
            let damping = DAMPING * cost + if redundant { SINGULAR } else { LEAST_DAMPING };
            self.joints.damp(&mut h, damping, self.scale);
            if redundant {
                // The damping pulls towards 0, here towards a step to the middle: what the goal does
                // not see follows it alone.
                self.joints.pull(&mut b, &q, damping * PULL * cost.min(1.0), self.scale);
            }
            let bounds = self.joints.bounds(&q, STRIDE, 1.0 / self.scale);
            let step = bounded_step(n, &h, &b, &bounds).or_else(|| {
                self.joints.damp(&mut h, SINGULAR, self.scale);
                bounded_step(n, &h, &b, &bounds)
            });
            q = self.joints.moved(&q, &step?);
        }
        None
    }
}
