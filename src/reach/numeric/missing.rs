//! Why there is no solution.

use super::Numeric;
use super::goal::{Goal, Held};
use super::settle::Rest;
use crate::robot::Frames;

/// Descents for each question.
const POSITION_STARTS: usize = 12;
const ATTITUDE_STARTS: usize = 16;
/// How much more the position weighs when the least angle is looked for: it is met first.
const STRICT: f64 = 1e4;
/// Less than this is not missing but not found, m and rad.
const CLOSE: f64 = 1e-6;
/// Beyond so many lengths of the chain only the direction of a goal counts.
const FAR: f64 = 1e6;

/// Why there is no solution, or that there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Missing {
    None,
    /// Inside the limits the TCP stays so far away (m), whatever its attitude.
    OutOfReach {
        by: f64,
    },
    /// The position is reached, the attitude misses by an angle (rad), so far as the search saw; the
    /// joint that its limit holds back the most, None if the geometry alone does.
    Attitude {
        by: f64,
        joint: Option<usize>,
    },
    /// Neither a solution nor a reason: the least distance (m) and the angle (rad) left with it;
    /// infinite for a goal that is not finite or no rotation.
    NotConverged {
        position: f64,
        angle: f64,
    },
}

impl Numeric {
    /// How far a checked goal is out of reach, m, attitude aside; None if it is not, or if the search
    /// cannot tell.
    pub(super) fn out_of_reach(&self, goal: &Goal, frames: &mut Frames) -> Option<f64> {
        let (by, still) = self.least_distance(&Goal { attitude: Held::Any, ..*goal }, frames);
        (by > CLOSE && still).then_some(by)
    }

    /// Of a checked goal within reach that nothing was found for.
    pub(super) fn missing(&self, goal: &Goal, frames: &mut Frames) -> Missing {
        let starts = self.starts.ranked(goal, self.scale).take(ATTITUDE_STARTS);
        let rests = starts.map(|start| self.settle(goal, start, STRICT * self.scale, frames));
        let near = |rest: &Rest| rest.miss.position.norm() * self.scale < 1.0 / STRICT;
        let angle = |rest: &Rest| rest.miss.rotation.norm();
        let rests: Vec<Rest> = rests.collect();
        let best = rests.iter().filter(|rest| near(rest)).min_by(|a, b| angle(a).total_cmp(&angle(b)));
        match best {
            Some(rest) if rest.still && angle(rest) > CLOSE => {
                Missing::Attitude { by: angle(rest), joint: rest.joint }
            }
            Some(rest) => Missing::NotConverged { position: rest.miss.position.norm(), angle: angle(rest) },
            None => Missing::NotConverged { position: f64::INFINITY, angle: f64::INFINITY },
        }
    }

    /// The least distance of the TCP from a position, m, and whether the descent to it ended.
    fn least_distance(&self, goal: &Goal, frames: &mut Frames) -> (f64, bool) {
        // Twice, so that squares of huge numbers stay finite.
        let size = goal.position.amax();
        let distance = if size > 0.0 { (goal.position / size).norm() * size } else { 0.0 };
        let most = FAR / self.scale;
        let beyond = (distance - most).max(0.0);
        let position = if beyond > 0.0 { (goal.position / size).normalize() * most } else { goal.position };
        let goal = Goal { position, ..*goal };
        let mut least = (f64::INFINITY, false);
        for start in self.starts.ranked(&goal, self.scale).take(POSITION_STARTS) {
            let rest = self.settle(&goal, start, self.scale, frames);
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
