//! Reason why a goal has no solution: out of reach, attitude missed, or not converged.

use super::Numeric;
use super::full_descent::RestingPoint;
use super::goal::{AttitudeGoal, TcpGoal};
use crate::robot::Frames;

/// Number of descents that minimize the distance of the TCP from the position of the goal.
const POSITION_STARTS: usize = 12;
/// Number of descents that minimize the orientation error at the position of the goal.
const ATTITUDE_STARTS: usize = 16;
/// Factor of the position error when the orientation error is minimized.
///
/// The factor is large, so a descent reaches the position of the goal before it reduces the orientation
/// error.
const POSITION_WEIGHT: f64 = 1e4;
/// Least position error (m) or orientation error (rad) that counts as the reason for a missing solution.
const MIN_SHORTFALL: f64 = 1e-6;
/// Largest distance of a goal from the base, as a multiple of the length of the chain. A farther goal is
/// replaced by the point at this distance in the same direction.
const MAX_CHAIN_LENGTHS: f64 = 1e6;

/// Reason why the numeric solver has no solution for a goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortfall {
    /// There is at least one solution.
    None,
    /// Within the limits, the least distance of the TCP from the goal in any attitude is `by` (m).
    OutOfReach { by: f64 },
    /// The position is reached, but not the attitude; `by` is the least orientation error found (rad).
    ///
    /// `joint` is the index of the joint whose limit restricts the attitude the most; None if no limit
    /// restricts it.
    Attitude { by: f64, joint: Option<usize> },
    /// The search found neither a solution nor a reason why there is none.
    ///
    /// `position` (m) and `angle` (rad) are the errors of the best attempt. Both errors are infinite if the
    /// goal is not valid, or if no attempt came near the position of the goal.
    NotConverged { position: f64, angle: f64 },
}

/// Errors of the best attempt to reach a goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseMiss {
    /// Position error, m.
    pub position: f64,
    /// Orientation error, rad.
    pub angle: f64,
}

impl PoseMiss {
    /// Value for a goal that was not tried.
    pub const UNTRIED: Self = Self { position: f64::INFINITY, angle: f64::INFINITY };
}

impl Numeric {
    /// Returns the distance, m, by which a goal is out of reach in any attitude. The goal must be a result of
    /// [`TcpGoal::checked`].
    ///
    /// Returns None if the goal is within reach. Also returns None if the descent that came nearest to the
    /// goal did not converge.
    pub(super) fn out_of_reach(&self, goal: &TcpGoal, frames: &mut Frames) -> Option<f64> {
        let (by, still) = self.least_distance(&TcpGoal { attitude: AttitudeGoal::Any, ..*goal }, frames);
        (by > MIN_SHORTFALL && still).then_some(by)
    }

    /// Returns the reason why a goal has no solution although its position is within reach. The goal must be
    /// a result of [`TcpGoal::checked`].
    pub(super) fn missing(&self, goal: &TcpGoal, frames: &mut Frames) -> Shortfall {
        let starts = self.starts.ranked(goal, self.scale).take(ATTITUDE_STARTS);
        let rests =
            starts.map(|(_, start)| self.descend_to_rest(goal, start, POSITION_WEIGHT * self.scale, frames));
        let near = |rest: &RestingPoint| rest.miss.position.norm() * self.scale < 1.0 / POSITION_WEIGHT;
        let angle = |rest: &RestingPoint| rest.miss.rotation.norm();
        let rests: Vec<RestingPoint> = rests.collect();
        let best = rests.iter().filter(|rest| near(rest)).min_by(|a, b| angle(a).total_cmp(&angle(b)));
        match best {
            Some(rest) if rest.still && angle(rest) > MIN_SHORTFALL => {
                Shortfall::Attitude { by: angle(rest), joint: rest.joint }
            }
            Some(rest) => Shortfall::NotConverged { position: rest.miss.position.norm(), angle: angle(rest) },
            None => Shortfall::NotConverged { position: f64::INFINITY, angle: f64::INFINITY },
        }
    }

    /// Returns the least distance between the TCP and the goal, m, that the descents find. Also returns
    /// whether the descent with this distance converged.
    fn least_distance(&self, goal: &TcpGoal, frames: &mut Frames) -> (f64, bool) {
        // Scaling before the norm keeps the squares of huge numbers finite.
        let size = goal.position.amax();
        let distance = if size > 0.0 { (goal.position / size).norm() * size } else { 0.0 };
        let most = MAX_CHAIN_LENGTHS / self.scale;
        let beyond = (distance - most).max(0.0);
        let position = if beyond > 0.0 { (goal.position / size).normalize() * most } else { goal.position };
        let goal = TcpGoal { position, ..*goal };
        let mut least = (f64::INFINITY, false);
        for (_, start) in self.starts.ranked(&goal, self.scale).take(POSITION_STARTS) {
            let rest = self.descend_to_rest(&goal, start, self.scale, frames);
            let by = rest.miss.position.norm();
            if by < least.0 {
                least = (by, rest.still);
            }
            if rest.miss.is_reached() {
                break;
            }
        }
        (least.0 + beyond, least.1)
    }
}
