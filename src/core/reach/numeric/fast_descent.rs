//! Fast descent from one start posture to the goal, abandoned as soon as it stalls.

use super::Numeric;
use super::goal::TcpGoal;
use super::jacobian::{jacobian, normal_equations};
use super::step::bounded_step;
use crate::cell::JointVector;
use crate::robot::Frames;

/// Largest number of steps of one descent.
const MAX_STEPS: usize = 40;
/// Number of steps within which the cost must fall by the factor [`MIN_GAIN`].
const PATIENCE: usize = 6;
/// Least factor by which the cost must fall in [`PATIENCE`] steps.
const MIN_GAIN: f64 = 2.0;
/// Largest step of a revolute joint, rad. For a prismatic joint, the limit is this multiple of the length of
/// the chain.
const MAX_STRIDE: f64 = 1.0;
/// Ratio of the damping to the cost.
const DAMPING: f64 = 0.1;
/// Least damping of a chain that is not redundant.
///
/// The damping is small, so that the descent can take large steps near a singular posture.
const MIN_DAMPING: f64 = 1e-15;
/// Damping added if the Hessian is singular up to rounding, and for every redundant chain.
const SINGULAR_DAMPING: f64 = 1e-12;
/// Factor of the term that pulls a redundant chain towards the middle of its joint ranges.
///
/// The factor is multiplied by the damping and by the smaller of the cost and 1.
const PULL: f64 = 0.1;

impl Numeric {
    /// Solves for a goal by damped Gauss-Newton steps within the limits. Returns None if the descent stalls
    /// or needs more than [`MAX_STEPS`] steps.
    ///
    /// The damping is proportional to the cost `|e|^2 / 2`, where e is the twist from the TCP to the goal. No
    /// step has to be rejected, and the convergence remains quadratic (T. Sugihara 2011,
    /// doi:10.1109/TRO.2011.2148230).
    pub(super) fn descend_fast(
        &self,
        goal: &TcpGoal,
        start: &JointVector,
        frames: &mut Frames,
    ) -> Option<JointVector> {
        let n = self.chain.axes();
        let (mut q, mut past) = (*start, [f64::INFINITY; PATIENCE]);
        for round in 0..MAX_STEPS {
            self.chain.place(&self.chain.posture(&q), frames);
            let miss = goal.miss(&frames.tcp, &self.chain.tool_axis);
            if miss.is_reached() {
                return Some(self.joints.kept(&q));
            }
            let cost = miss.cost(self.scale);
            let before = std::mem::replace(&mut past[round % PATIENCE], cost);
            if cost * MIN_GAIN > before {
                return None;
            }
            let columns = jacobian(&self.chain, frames);
            let (mut h, mut b) = normal_equations(n, &columns, &miss, self.scale);
            let redundant = goal.rows() < n;
            let damping = DAMPING * cost + if redundant { SINGULAR_DAMPING } else { MIN_DAMPING };
            self.joints.damp(&mut h, damping, self.scale);
            if redundant {
                // Damping alone pulls the step towards 0. This term pulls the joints towards the middle of
                // their ranges. The null-space motion of the joints follows this pull alone.
                self.joints.pull(&mut b, &q, damping * PULL * cost.min(1.0), self.scale);
            }
            let bounds = self.joints.bounds(&q, MAX_STRIDE, 1.0 / self.scale);
            let step = bounded_step(n, &h, &b, &bounds).or_else(|| {
                self.joints.damp(&mut h, SINGULAR_DAMPING, self.scale);
                bounded_step(n, &h, &b, &bounds)
            });
            q = self.joints.moved(&q, &step?);
        }
        None
    }
}
