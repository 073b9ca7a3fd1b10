//! Numeric inverse kinematics by damped least squares, for every serial chain without a closed form.
//!
//! The chains have 3 to 8 revolute or prismatic joints, coupled or not, with limits.
//!
//! Damped Gauss-Newton steps within the limits reduce the twist from the TCP to the goal (`fast_descent`).
//! The descents start from a fixed set of postures; the posture with its TCP nearest to the goal comes first
//! (`starts`). A descent that stalls is abandoned after a few steps, because another start is cheaper. If all
//! descents fail, a few full descents follow, which continue as long as the cost falls (`full_descent`). The
//! cost is half the squared length of the twist. A quadratic program computes each step of a full descent
//! (`quadratic_program`). Full descents also explain why there is no solution (`shortfall`). The result
//! depends neither on chance nor on an earlier call.

mod distinct;
mod fast_descent;
mod full_descent;
mod goal;
mod jacobian;
mod joint_ranges;
mod quadratic_program;
mod shortfall;
mod starts;
mod step;

pub use distinct::NumericSolution;
pub use goal::{AttitudeGoal, TcpGoal, least_turn, rotation_vector};
pub(super) use jacobian::dh_jacobian;
pub use jacobian::jacobian;
pub use shortfall::{PoseMiss, Shortfall};

use crate::cell::{JointKind, JointVector};
use crate::robot::{Chain, Frames};
use distinct::DistinctSolutions;
use joint_ranges::JointRanges;
use starts::{STARTS, Starts};

/// Number of full descents that follow when all fast descents have failed.
const FULL_DESCENTS: usize = 12;

/// Number of fast descents that miss a goal before the solver checks whether the goal is out of reach.
const STARTS_BEFORE_REACH: usize = 48;

/// Numeric solver of one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Numeric {
    chain: Chain,
    joints: JointRanges,
    /// Factor that multiplies lengths in the cost, 1/m. A position error equal to the length of the chain
    /// counts as much as an orientation error of 1 rad.
    scale: f64,
    starts: Starts,
}

impl Numeric {
    /// Prepares the numeric solver of a chain.
    pub fn new(chain: &Chain) -> Self {
        let joints = JointRanges::new(chain);
        let searched: Vec<_> = joints.ranges().iter().map(|range| range.searched()).collect();
        let length = reach(chain);
        let scale = if length > 0.0 { 1.0 / length } else { 1.0 };
        Self { chain: chain.clone(), scale, starts: Starts::new(chain, &searched), joints }
    }

    /// Returns one solution within the limits: the solution of the first descent that finds one.
    ///
    /// This solution is one of the solutions that [`Self::all`] collects. The result is None if and only if
    /// `all` collects no solution.
    pub fn one(&self, goal: &TcpGoal) -> Option<JointVector> {
        let goal = goal.checked().filter(|goal| self.spans(goal))?;
        let mut frames = Frames::default();
        for (tried, (_, start)) in self.starts.ranked(&goal, self.scale).enumerate() {
            if tried == STARTS_BEFORE_REACH && self.out_of_reach(&goal, &mut frames).is_some() {
                return None;
            }
            if let Some(found) = self.descend_fast(&goal, start, &mut frames) {
                return Some(found);
            }
        }
        self.solve_fully(&goal, &mut frames).map(|found| found.joints)
    }

    /// Writes to `out` the distinct solutions within the limits, in sorted order. If there are none, returns
    /// the reason.
    ///
    /// Coordinates of a joint that differ by whole turns may give the same link poses. `out` then
    /// holds the coordinate nearest to the middle of the joint's range.
    ///
    /// A redundant chain has a continuum of solutions. In this case, `out` holds solutions spread over the
    /// continuum.
    pub fn all(&self, goal: &TcpGoal, out: &mut Vec<NumericSolution>) -> Shortfall {
        out.clear();
        let Some(goal) = goal.checked() else {
            return Shortfall::NotConverged { position: f64::INFINITY, angle: f64::INFINITY };
        };
        let mut frames = Frames::default();
        let mut distinct = DistinctSolutions::new(&self.joints, goal.rows());
        let mut is_known_in_reach = false;
        if self.spans(&goal) {
            for (tried, (number, start)) in self.starts.ranked(&goal, self.scale).enumerate() {
                if tried == STARTS_BEFORE_REACH && distinct.found.is_empty() {
                    // Most goals that so many descents miss are out of reach. A few full descents show
                    // whether this goal is out of reach.
                    if let Some(by) = self.out_of_reach(&goal, &mut frames) {
                        return Shortfall::OutOfReach { by };
                    }
                    is_known_in_reach = true;
                }
                distinct.take(number, self.descend_fast(&goal, start, &mut frames));
                if distinct.is_done() {
                    break;
                }
            }
        }
        if distinct.found.is_empty() {
            let by = if is_known_in_reach { None } else { self.out_of_reach(&goal, &mut frames) };
            if let Some(by) = by {
                return Shortfall::OutOfReach { by };
            }
            if let Some(found) = self.solve_fully(&goal, &mut frames) {
                distinct.take(found.start, Some(found.joints));
            }
        }
        distinct.into_sorted(out);
        if out.is_empty() { self.missing(&goal, &mut frames) } else { Shortfall::None }
    }

    /// Repeats the descent that led to a solution of [`Self::all`]. Returns this solution; None if the
    /// descent fails.
    ///
    /// `start` is the field [`NumericSolution::start`] of this solution.
    pub fn again(&self, goal: &TcpGoal, start: usize) -> Option<JointVector> {
        let goal = goal.checked()?;
        let mut frames = Frames::default();
        match start.checked_sub(STARTS) {
            None => self.descend_fast(&goal, self.starts.get(start)?, &mut frames),
            Some(start) => {
                let rest = self.descend_to_rest(&goal, self.starts.get(start)?, self.scale, &mut frames);
                rest.miss.is_reached().then_some(rest.q)
            }
        }
    }

    /// Returns the solution that a descent from `start` finds; None if the descent finds no solution.
    pub fn from(&self, goal: &TcpGoal, start: &JointVector) -> Option<JointVector> {
        let goal = goal.checked().filter(|goal| self.spans(goal))?;
        let mut frames = Frames::default();
        let start = self.joints.kept(start);
        self.descend_fast(&goal, &start, &mut frames).or_else(|| {
            let rest = self.descend_to_rest(&goal, &start, self.scale, &mut frames);
            rest.miss.is_reached().then_some(rest.q)
        })
    }

    /// Returns the solution that a descent from `start` finds. The joint whose index is `held` does not move.
    ///
    /// # Errors
    /// Returns the remaining errors of position and orientation if the descent finds no solution.
    pub fn following(
        &self,
        goal: &TcpGoal,
        start: &JointVector,
        held: Option<usize>,
    ) -> Result<JointVector, PoseMiss> {
        self.following_within(self.joints.holding(held, start), goal, start)
    }

    /// Returns the solution of [`Self::following`] for an arm whose joints may exceed their limits.
    ///
    /// # Errors
    /// Returns the remaining errors of position and orientation if the descent finds no solution.
    pub fn following_beyond_limits(
        &self,
        goal: &TcpGoal,
        start: &JointVector,
        held: Option<usize>,
    ) -> Result<JointVector, PoseMiss> {
        self.following_within(self.joints.widened().holding(held, start), goal, start)
    }

    /// Returns the solution that a descent from `start` finds within the ranges `joints`.
    ///
    /// # Errors
    /// Returns the remaining errors of position and orientation if the descent finds no solution.
    fn following_within(
        &self,
        joints: JointRanges,
        goal: &TcpGoal,
        start: &JointVector,
    ) -> Result<JointVector, PoseMiss> {
        let goal = goal.checked().ok_or(PoseMiss::UNTRIED)?;
        let solver = Self { chain: self.chain.clone(), joints, scale: self.scale, starts: Starts::default() };
        let (start, mut frames) = (solver.joints.kept(start), Frames::default());
        if let Some(found) = solver.descend_fast(&goal, &start, &mut frames) {
            return Ok(found);
        }
        let rest = solver.descend_to_rest(&goal, &start, self.scale, &mut frames);
        match rest.miss.is_reached() {
            true => Ok(rest.q),
            false => Err(PoseMiss { position: rest.miss.position.norm(), angle: rest.miss.rotation.norm() }),
        }
    }

    /// Returns a solution by full descents for a goal that every fast descent has missed; None if there is no
    /// solution.
    fn solve_fully(&self, goal: &TcpGoal, frames: &mut Frames) -> Option<NumericSolution> {
        let mut starts = self.starts.ranked(goal, self.scale).take(FULL_DESCENTS);
        starts.find_map(|(number, start)| {
            let rest = self.descend_to_rest(goal, start, self.scale, frames);
            let solution = NumericSolution { start: STARTS + number, joints: rest.q };
            rest.miss.is_reached().then_some(solution)
        })
    }

    /// Returns whether the chain is long enough to reach the position of the goal.
    fn spans(&self, goal: &TcpGoal) -> bool {
        (goal.position - self.chain.mount.translation).norm() * self.scale <= 1.0 + 1e-9
    }
}

/// Returns an upper bound of the distance of the TCP from the mount of the chain, m.
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
