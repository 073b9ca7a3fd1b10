//! Inverse kinematics by numbers, for every serial chain that has no closed form: 3 to 8 joints that
//! turn or slide, coupled or not, with limits.
//!
//! The twist from the TCP to the goal is made zero by damped Gauss-Newton steps that stay inside the
//! limits (`descent`), from one of a fixed set of starts after the other, the nearest to the goal
//! first (`starts`). A descent that stalls is given up after a few steps: another start is cheaper.
//! Only if all have failed, descents that go on as long as anything gets better (`settle`), with a
//! quadratic program where limits are in the way (`program`), try again and tell what is missing
//! (`missing`). Nothing here depends on chance or on an earlier call.

mod descent;
mod distinct;
mod goal;
mod jacobian;
mod joints;
mod missing;
mod program;
mod settle;
mod starts;
mod step;

pub use goal::{Goal, Held, least_turn, rotation_vector};
pub use jacobian::jacobian;
pub use missing::Missing;

use crate::cell::{JointKind, JointVector};
use crate::robot::{Chain, Frames};
use distinct::Distinct;
use joints::Joints;
use starts::Starts;

/// Slow descents after all fast ones have failed.
const SECOND: usize = 12;

/// The solver, made ready for a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Numeric {
    chain: Chain,
    joints: Joints,
    /// One over the length of the chain, 1/m: a turn of 1 rad weighs as much as its length.
    scale: f64,
    starts: Starts,
}

impl Numeric {
    pub fn new(chain: &Chain) -> Self {
        let joints = Joints::new(chain);
        let searched: Vec<_> = joints.ranges().iter().map(|range| range.searched()).collect();
        let length = reach(chain);
        let scale = if length > 0.0 { 1.0 / length } else { 1.0 };
        Self { chain: chain.clone(), scale, starts: Starts::new(chain, &searched), joints }
    }

    /// One solution inside the limits: the first that the starts lead to. With [`Self::all`] it is
    /// one of those, and there is one exactly if there are any.
    pub fn one(&self, goal: &Goal) -> Option<JointVector> {
        let goal = goal.checked().filter(|goal| self.spans(goal))?;
        let mut frames = Frames::default();
        let mut starts = self.starts.ranked(&goal, self.scale);
        let found = starts.find_map(|start| self.rush(&goal, start, &mut frames));
        found.or_else(|| match self.out_of_reach(&goal, &mut frames) {
            Some(_) => None,
            None => self.second(&goal, &mut frames),
        })
    }

    /// The distinct solutions inside the limits that the starts lead to, sorted, and what is missing
    /// if there are none. A joint whose limits leave a choice of turns is in the one nearest to the
    /// middle. If more joints than the goal needs leave a continuum, `out` has some points spread over it.
    pub fn all(&self, goal: &Goal, out: &mut Vec<JointVector>) -> Missing {
        out.clear();
        let Some(goal) = goal.checked() else {
            return Missing::NotConverged { position: f64::INFINITY, angle: f64::INFINITY };
        };
        let mut frames = Frames::default();
        let mut distinct = Distinct::new(&self.joints, goal.rows());
        if self.spans(&goal) {
            for start in self.starts.ranked(&goal, self.scale) {
                distinct.take(self.rush(&goal, start, &mut frames));
                if distinct.is_done() {
                    break;
                }
            }
        }
        if distinct.found.is_empty() {
            if let Some(by) = self.out_of_reach(&goal, &mut frames) {
                return Missing::OutOfReach { by };
            }
            distinct.take(self.second(&goal, &mut frames));
        }
        distinct.into_sorted(out);
        if out.is_empty() { self.missing(&goal, &mut frames) } else { Missing::None }
    }

    /// The solution that the descent from `start` leads to.
    pub fn from(&self, goal: &Goal, start: &JointVector) -> Option<JointVector> {
        let goal = goal.checked().filter(|goal| self.spans(goal))?;
        let mut frames = Frames::default();
        let start = self.joints.kept(start);
        self.rush(&goal, &start, &mut frames).or_else(|| {
            let rest = self.settle(&goal, &start, self.scale, &mut frames);
            rest.miss.is_reached().then_some(rest.q)
        })
    }

    /// The slow way, for a goal that every fast descent has missed.
    fn second(&self, goal: &Goal, frames: &mut Frames) -> Option<JointVector> {
        let mut starts = self.starts.ranked(goal, self.scale).take(SECOND);
        starts.find_map(|start| {
            let rest = self.settle(goal, start, self.scale, frames);
            rest.miss.is_reached().then_some(rest.q)
        })
    }

    /// Whether the chain is long enough at all.
    fn spans(&self, goal: &Goal) -> bool {
        goal.position.norm() * self.scale <= 1.0 + 1e-9
    }
}

/// How far the TCP can be from the base at most, m.
fn reach(chain: &Chain) -> f64 {
    let links = chain.links.iter().enumerate().map(|(i, link)| {
        let farthest = |j: usize| chain.links[j].limits.0.abs().max(chain.links[j].limits.1.abs());
        let travel = match link.kind {
            JointKind::Revolute => 0.0,
            JointKind::Prismatic => (0..=i).map(|j| chain.coupling[i][j].abs() * farthest(j)).sum(),
        };
        link.l.hypot(link.r.abs() + travel)
    });
    links.sum::<f64>() + chain.tool.translation.norm()
}
