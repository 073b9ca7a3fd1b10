//! Full descent from one start posture to a local minimum of the cost, even if the goal is out of reach.

use super::Numeric;
use super::goal::{AttitudeGoal, TcpGoal, TwistError};
use super::jacobian::{add_curvature, jacobian, normal_equations};
use super::quadratic_program::exact_step;
use super::step::NormalMatrix;
use crate::cell::JointVector;
use crate::robot::Frames;

/// Largest number of steps of one descent.
const MAX_STEPS: usize = 100;
/// Largest step of a revolute joint, rad. For a prismatic joint, the limit is this multiple of the length of
/// the chain.
const MAX_STRIDE: f64 = 0.7;
/// Damping of the first step, as a share of the largest diagonal entry of the Hessian.
const FIRST_DAMPING: f64 = 1e-3;
/// Factor applied to the damping after a step that lowers the cost.
const DAMPING_DECREASE: f64 = 0.2;
/// Factor applied to the damping after a step that does not lower the cost.
const DAMPING_INCREASE: f64 = 5.0;
/// Largest damping, at which no joint moves any more.
///
/// The value is a multiple of the largest diagonal entry of the Hessian, or of the cost if the cost is
/// larger.
const MAX_DAMPING: f64 = 1e10;
/// Least damping after a step that lowers the cost.
const MIN_DAMPING: f64 = 1e-15;
/// Least share of the cost that a step must remove; a smaller gain ends the descent.
const MIN_GAIN: f64 = 1e-13;

/// Posture and state in which a descent ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct RestingPoint {
    pub q: JointVector,
    pub miss: TwistError,
    /// Joint whose limit restricts the descent the most; None if no limit restricts it.
    pub joint: Option<usize>,
    /// Whether the descent converged; false if the steps ran out.
    pub still: bool,
}

/// Quadratic model of the cost at a posture.
///
/// The cost is `|e|^2 / 2` for the twist e to the goal. A step d of the joints changes the cost by about
/// `d^T H d / 2 - b . d`. Here H is the Hessian and -b the gradient.
struct Linearization {
    miss: TwistError,
    cost: f64,
    h: NormalMatrix,
    b: JointVector,
}

/// State of a descent between two steps.
struct Descent<'a> {
    solver: &'a Numeric,
    goal: &'a TcpGoal,
    /// Factor that multiplies lengths in the cost, 1/m.
    scale: f64,
    frames: &'a mut Frames,
    damping: f64,
}

impl Numeric {
    /// Minimizes the cost by the Levenberg-Marquardt method within the limits.
    ///
    /// The factor `scale` (1/m) multiplies lengths in the cost. A quadratic program computes each step, and
    /// every accepted step lowers the cost. For a goal without attitude, the method uses the exact Hessian.
    /// The method then converges quadratically even if the goal is out of reach.
    pub(super) fn descend_to_rest(
        &self,
        goal: &TcpGoal,
        start: &JointVector,
        scale: f64,
        frames: &mut Frames,
    ) -> RestingPoint {
        let mut descent = Descent { solver: self, goal, scale, frames, damping: 0.0 };
        let mut q = self.joints.kept(start);
        let mut here = descent.local(&q);
        descent.damping = FIRST_DAMPING * here.stiffness();
        let mut still = here.miss.is_reached();
        for _ in 0..MAX_STEPS {
            if still {
                break;
            }
            match descent.downhill(&q, &here) {
                Some((better, there)) => {
                    still = there.miss.is_reached() || here.cost - there.cost < MIN_GAIN * here.cost;
                    (q, here) = (better, there);
                }
                None => still = true,
            }
        }
        RestingPoint { q: self.joints.kept(&q), miss: here.miss, joint: self.joints.held(&q, &here.b), still }
    }
}

impl Descent<'_> {
    /// Returns the quadratic model of the cost at the joint coordinates `q`.
    fn local(&mut self, q: &JointVector) -> Linearization {
        let chain = &self.solver.chain;
        chain.place(&chain.posture(q), self.frames);
        let miss = self.goal.miss(&self.frames.tcp, &chain.tool_axis);
        let columns = jacobian(chain, self.frames);
        let (mut h, b) = normal_equations(chain.axes(), &columns, &miss, self.scale);
        if self.goal.attitude == AttitudeGoal::Any {
            add_curvature(chain, self.frames, &miss, self.scale, &mut h);
        }
        Linearization { miss, cost: miss.cost(self.scale), h, b }
    }

    /// Returns the joint coordinates after a step that lowers the cost, and the quadratic model at these
    /// coordinates. Returns None if no step lowers the cost.
    ///
    /// The damping is increased until the step lowers the cost.
    fn downhill(&mut self, q: &JointVector, here: &Linearization) -> Option<(JointVector, Linearization)> {
        let (n, joints, length) = (self.solver.chain.axes(), &self.solver.joints, 1.0 / self.solver.scale);
        let bounds = joints.bounds(q, MAX_STRIDE, length);
        let most = MAX_DAMPING * here.stiffness().max(here.cost);
        while self.damping <= most {
            let mut h = here.h;
            joints.damp(&mut h, self.damping, self.solver.scale);
            let step = exact_step(n, &h, &here.b, &bounds);
            let found = step.and_then(|step| self.better(&joints.moved(q, &step), here));
            if found.is_some() {
                self.damping = (self.damping * DAMPING_DECREASE).max(MIN_DAMPING);
                return found;
            }
            self.damping = self.damping.max(MIN_DAMPING) * DAMPING_INCREASE;
        }
        None
    }

    fn better(&mut self, q: &JointVector, here: &Linearization) -> Option<(JointVector, Linearization)> {
        let there = self.local(q);
        (there.cost < here.cost).then_some((*q, there))
    }
}

impl Linearization {
    /// Returns the largest absolute diagonal entry of the Hessian.
    fn stiffness(&self) -> f64 {
        self.h.iter().enumerate().map(|(i, row)| row[i].abs()).fold(0.0, f64::max)
    }
}
