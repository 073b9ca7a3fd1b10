//! From one start down to where nothing gets better, reached or not.

use super::Numeric;
use super::goal::{Goal, Held, Miss};
use super::jacobian::{add_curvature, jacobian, normal_equations};
use super::program::exact_step;
use super::step::{Matrix, bounded_step, holds_too_much};
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
/// Quadratic programs of one descent at most: they cost a hundred times a step.
const PROGRAMS: usize = 4;
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

/// A descent on its way.
struct Descent<'a> {
    solver: &'a Numeric,
    goal: &'a Goal,
    /// Of lengths, 1/m.
    scale: f64,
    frames: &'a mut Frames,
    damping: f64,
    /// Quadratic programs that may still be solved.
    programs: usize,
}

impl Numeric {
    /// Levenberg-Marquardt inside the limits, every step downhill; lengths by `scale` (1/m). Where a
    /// step leads up and holds a joint at a bound that it should leave, the quadratic program is
    /// solved. A goal of the position alone has the exact Hessian, so that a rest of any size is met
    /// quadratically.
    pub(super) fn settle(&self, goal: &Goal, start: &JointVector, scale: f64, frames: &mut Frames) -> Rest {
        let mut descent = Descent { solver: self, goal, scale, frames, damping: 0.0, programs: PROGRAMS };
        let mut q = self.joints.kept(start);
        let mut here = descent.local(&q);
        descent.damping = DAMPING * here.stiffness();
        let mut still = here.miss.is_reached();
        for _ in 0..ROUNDS {
            if still {
                break;
            }
            match descent.downhill(&q, &here) {
                Some((better, there)) => {
                    still = there.miss.is_reached() || here.cost - there.cost < GAIN * here.cost;
                    (q, here) = (better, there);
                }
                None => still = true,
            }
        }
        Rest { q: self.joints.kept(&q), miss: here.miss, joint: self.joints.held(&q, &here.b), still }
    }
}

impl Descent<'_> {
    /// The goal linearized at q.
    fn local(&mut self, q: &JointVector) -> Local {
        let chain = &self.solver.chain;
        chain.place(&chain.posture(q), self.frames);
        let miss = self.goal.miss(&self.frames.tcp, &chain.tool_axis);
        let columns = jacobian(chain, self.frames);
        let (mut h, b) = normal_equations(chain.axes(), &columns, &miss, self.scale);
        if self.goal.attitude == Held::Any {
            add_curvature(chain, self.frames, &miss, self.scale, &mut h);
        }
        Local { miss, cost: miss.cost(self.scale), h, b }
    }

    /// A step that lowers the cost, damped as much as that needs; None if none does.
    fn downhill(&mut self, q: &JointVector, here: &Local) -> Option<(JointVector, Local)> {
        let (n, joints, length) = (self.solver.chain.axes(), &self.solver.joints, 1.0 / self.solver.scale);
        let bounds = joints.bounds(q, STRIDE, length);
        let most = STUCK * here.stiffness().max(here.cost);
        // A harder damping needs no second program: its step is shorter and meets fewer bounds.
        let mut exact = self.programs > 0;
        while self.damping <= most {
            let mut h = here.h;
            joints.damp(&mut h, self.damping, self.solver.scale);
            let step = bounded_step(n, &h, &here.b, &bounds);
            let mut found = step.and_then(|step| self.better(&joints.moved(q, &step), here));
            let improvable = |step: &JointVector| holds_too_much(n, &h, &here.b, &bounds, step);
            if found.is_none() && exact && step.as_ref().is_some_and(improvable) {
                exact = false;
                self.programs -= 1;
                let step = exact_step(n, &h, &here.b, &bounds);
                found = step.and_then(|step| self.better(&joints.moved(q, &step), here));
            }
            if found.is_some() {
                self.damping = (self.damping * EASED).max(LEAST_DAMPING);
                return found;
            }
            self.damping = self.damping.max(LEAST_DAMPING) * TIGHTENED;
        }
        None
    }

    fn better(&mut self, q: &JointVector, here: &Local) -> Option<(JointVector, Local)> {
        let there = self.local(q);
        (there.cost < here.cost).then_some((*q, there))
    }
}

impl Local {
    /// The largest diagonal entry of H.
    fn stiffness(&self) -> f64 {
        self.h.iter().enumerate().map(|(i, row)| row[i].abs()).fold(0.0, f64::max)
    }
}
