//! From one start down to where nothing gets better, reached or not.

use super::Numeric;
use super::goal::{Goal, Held, Miss};
use super::jacobian::{add_curvature, jacobian, normal_equations};
use super::program::exact_step;
use super::step::{Bounds, Matrix, bounded_step};
use crate::cell::JointVector;
use crate::robot::Frames;

/// Steps at most.
const ROUNDS: usize = 100;
/// Largest step of a joint, rad.
const STRIDE: f64 = 0.7;
/// First damping as a share of the largest diagonal entry of H; by what it falls and grows; the share at
/// which nothing moves any more.
const DAMPING: f64 = 1e-3;
const EASED: f64 = 0.2;
const TIGHTENED: f64 = 5.0;
const STUCK: f64 = 1e10;
const LEAST_DAMPING: f64 = 1e-15;
/// A step that gains less than this share of the cost is the last.
const GAIN: f64 = 1e-13;

/// Where a descent came to rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub q: JointVector,
    pub miss: Miss,
    /// The joint that its limit holds back the most.
    pub joint: Option<usize>,
    /// Whether nothing near is better: false if the steps ran out.
    pub still: bool,
}

/// One linearization: `|e|^2 / 2`, and the model `d^T H d / 2 - b . d` of its change.
struct Local {
    miss: Miss,
    cost: f64,
    h: Matrix,
    b: JointVector,
}

impl Numeric {
    /// Levenberg-Marquardt inside the limits, every step downhill; lengths by `scale` (1/m). Where the
    /// step with joints put at their bounds leads up, the quadratic program tells which of them to let
    /// go. A goal of the position alone has the exact Hessian, so that a rest of any size is met
    /// quadratically.
    pub(super) fn settle(&self, goal: &Goal, start: &JointVector, scale: f64, frames: &mut Frames) -> Rest {
        let mut q = self.joints.kept(start);
        let mut here = self.local(goal, &q, scale, frames);
        let mut damping = DAMPING * here.stiffness();
        let mut still = here.miss.is_reached();
        for _ in 0..ROUNDS {
            if still {
                break;
            }
            match self.downhill(goal, &q, &here, &mut damping, scale, frames) {
                Some((better, there)) => {
                    still = there.miss.is_reached() || here.cost - there.cost < GAIN * here.cost;
                    (q, here) = (better, there);
                }
                None => still = true,
            }
        }
        Rest { q: self.joints.kept(&q), miss: here.miss, joint: self.joints.held(&q, &here.b), still }
    }

    /// The goal linearized at q.
    fn local(&self, goal: &Goal, q: &JointVector, scale: f64, frames: &mut Frames) -> Local {
        self.chain.place(&self.chain.posture(q), frames);
        let miss = goal.miss(&frames.tcp, &self.chain.tool_axis);
        let columns = jacobian(&self.chain, frames);
        let (mut h, b) = normal_equations(self.chain.axes(), &columns, &miss, scale);
        if goal.attitude == Held::Any {
            add_curvature(&self.chain, frames, &miss, scale, &mut h);
        }
        Local { miss, cost: miss.cost(scale), h, b }
    }

    /// A step that lowers the cost, damped as much as that needs; None if none does.
    fn downhill(
        &self,
        goal: &Goal,
        q: &JointVector,
        here: &Local,
        damping: &mut f64,
        scale: f64,
        frames: &mut Frames,
    ) -> Option<(JointVector, Local)> {
        let n = self.chain.axes();
        let bounds = self.joints.bounds(q, STRIDE, 1.0 / self.scale);
        let most = STUCK * here.stiffness().max(here.cost);
        let mut better = |step: Option<JointVector>| {
            let q = self.joints.moved(q, &step?);
            let there = self.local(goal, &q, scale, frames);
            (there.cost < here.cost).then_some((q, there))
        };
        let mut tried = false;
        while *damping <= most {
            let mut h = here.h;
            self.joints.damp(&mut h, *damping, self.scale);
            let step = bounded_step(n, &h, &here.b, &bounds);
            let blocked = step.is_some_and(|step| at_bound(n, &step, &bounds));
            let found = better(step).or_else(|| {
                let first = blocked && !std::mem::replace(&mut tried, true);
                first.then(|| better(exact_step(n, &h, &here.b, &bounds))).flatten()
            });
            if found.is_some() {
                *damping = (*damping * EASED).max(LEAST_DAMPING);
                return found;
            }
            *damping = damping.max(LEAST_DAMPING) * TIGHTENED;
        }
        None
    }
}

impl Local {
    /// The largest diagonal entry of H.
    fn stiffness(&self) -> f64 {
        self.h.iter().enumerate().map(|(i, row)| row[i].abs()).fold(0.0, f64::max)
    }
}

fn at_bound(n: usize, step: &JointVector, bounds: &Bounds) -> bool {
    step.iter().zip(bounds).take(n).any(|(d, (lo, hi))| d <= lo || d >= hi)
}
