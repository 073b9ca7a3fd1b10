//! Coordinates that a task leaves free: the redundant joint, and a free spin of the tool.
//!
//! The inverse kinematics solves sampled values of these coordinates. A branch index can also hold the values
//! between the samples, in small equal steps. A search can therefore improve a posture along these
//! coordinates.

use super::attitude_set::SpinTurn;
use super::branch::{
    SPIN_STEPS, attitude_of, sample_of, spin_step_of, with_attitude, with_sample, with_spin_step,
    without_spin_step,
};
use super::held_joint::HeldJoint;
use super::inverse::Inverse;
use super::numeric_branches::CONTINUED;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::pose::Pose;
use crate::robot::Posture;
use nalgebra::{Matrix3, Vector3};

/// Bits of a branch index that hold the number of the solution.
const SOLUTION_BITS: u64 = 15;

/// Coordinate that a task leaves free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RedundantCoordinate {
    /// Coordinate of the redundant joint.
    Joint,
    /// Rotation of the tool about its axis, if the attitude leaves it free.
    Spin,
}

/// Position of a branch on or between the samples of its redundant coordinates.
///
/// Two branches with the same `family` differ only in their redundant coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamplePosition {
    pub family: u64,
    /// Value of the redundant joint; neighbouring samples differ by 1.
    redundant: f64,
    /// Spin; neighbouring samples differ by 1.
    spin: f64,
    /// Number of sampled spins of a full turn; 0 if the spin is not free.
    spins: f64,
}

impl SamplePosition {
    /// Returns whether two positions have the same family, and are at most one sample apart in each
    /// coordinate.
    pub fn is_beside(&self, other: &Self) -> bool {
        let turn = (self.spin - other.spin).abs();
        let spin = if self.spins > 0.0 { turn.min(self.spins - turn) } else { turn };
        self.family == other.family && (self.redundant - other.redundant).abs() <= 1.0 && spin <= 1.0
    }
}

impl Inverse {
    /// Returns whether [`Self::moved`] can change a coordinate of the branches of this arm.
    pub fn is_redundant(&self, coordinate: RedundantCoordinate, attitudes: &ToolAttitudes) -> bool {
        match (coordinate, &self.solver) {
            (RedundantCoordinate::Joint, ChainSolver::Redundant(joint)) => !joint.is_fixed(),
            (RedundantCoordinate::Spin, ChainSolver::Pose(_) | ChainSolver::Redundant(_)) => {
                attitudes.set.spin_is_free
            }
            _ => false,
        }
    }

    /// Returns whether the last joint alone rotates the tool about its axis in every posture that the inverse
    /// kinematics finds.
    pub fn spins_by_last_joint(&self) -> bool {
        self.last_joint.is_some()
    }

    /// Returns the index of the branch after a motion along a redundant coordinate.
    ///
    /// The motion is `share` times the distance between neighbouring samples of the coordinate. The motion is
    /// rounded to whole steps of a lattice. Between neighbouring samples, the lattice has
    /// `HeldJoint::SAMPLE_STEP` equal steps for the redundant joint, and `SPIN_STEPS` equal steps for the
    /// spin.
    ///
    /// Returns None if the coordinate is not redundant ([`Self::is_redundant`]), or if the new value lies
    /// outside the range of the redundant joint.
    pub fn moved(
        &self,
        branch: u64,
        coordinate: RedundantCoordinate,
        share: f64,
        attitudes: &ToolAttitudes,
    ) -> Option<u64> {
        if !self.is_redundant(coordinate, attitudes) {
            return None;
        }
        match coordinate {
            RedundantCoordinate::Joint => {
                let number =
                    f64::from(sample_of(branch)) + (share * f64::from(HeldJoint::SAMPLE_STEP)).round();
                let is_inside = (0.0..=f64::from(HeldJoint::LATTICE)).contains(&number);
                is_inside.then(|| with_sample(branch, number as u32))
            }
            RedundantCoordinate::Spin => {
                let (set, attitude) = (&attitudes.set, self.attitude_of(branch));
                let (first, spin) = set.spin_index(attitude);
                let steps = set.spins.len() as u64 * SPIN_STEPS;
                let by = ((share * SPIN_STEPS as f64).round() as i64).rem_euclid(steps as i64) as u64;
                let to = (spin as u64 * SPIN_STEPS + spin_step_of(branch) + by) % steps;
                let attitude = set.with_spin(first, (to / SPIN_STEPS) as usize);
                Some(with_spin_step(self.with_attitude(branch, attitude), to % SPIN_STEPS))
            }
        }
    }

    /// Returns the index of the branch halfway between two branches of the same family
    /// ([`SamplePosition::family`]). If the spin is free, the result has the spin in the middle of the
    /// shorter arc between the two spins.
    pub fn between(&self, from: u64, to: u64, attitudes: &ToolAttitudes) -> u64 {
        let [a, b] = [from, to].map(|branch| self.sample_position(branch, attitudes));
        let turn = b.spin - a.spin;
        let spin = if a.spins > 0.0 { turn - a.spins * (turn / a.spins).round() } else { 0.0 };
        let halves = [
            (RedundantCoordinate::Joint, (b.redundant - a.redundant) / 2.0),
            (RedundantCoordinate::Spin, spin / 2.0),
        ];
        halves.into_iter().fold(from, |branch, (coordinate, share)| {
            self.moved(branch, coordinate, share, attitudes).unwrap_or(branch)
        })
    }

    /// Returns the position of a branch on or between the samples of its redundant coordinates.
    pub fn sample_position(&self, branch: u64, attitudes: &ToolAttitudes) -> SamplePosition {
        let (set, attitude) = (&attitudes.set, self.attitude_of(branch));
        let (mut family, mut position) = (without_spin_step(branch), (0.0, 0.0, 0.0));
        if self.is_redundant(RedundantCoordinate::Spin, attitudes) {
            let (first, spin) = set.spin_index(attitude);
            family = self.with_attitude(family, first);
            let step = spin_step_of(branch) as f64 / SPIN_STEPS as f64;
            (position.1, position.2) = (spin as f64 + step, set.spins.len() as f64);
        }
        if self.is_redundant(RedundantCoordinate::Joint, attitudes) {
            family = with_sample(family, 0);
            position.0 = f64::from(sample_of(branch)) / f64::from(HeldJoint::SAMPLE_STEP);
        }
        let (redundant, spin, spins) = position;
        SamplePosition { family, redundant, spin, spins }
    }

    /// Returns whether the spin of a branch lies between two sampled spins.
    pub(super) fn is_between_spins(&self, branch: u64) -> bool {
        let has_steps = matches!(&self.solver, ChainSolver::Pose(_) | ChainSolver::Redundant(_));
        has_steps && branch != CONTINUED && spin_step_of(branch) != 0
    }

    /// Returns the posture of a branch whose spin lies between two sampled spins.
    ///
    /// # Errors
    /// If no solution has this index, returns the distance, m, by which the target is out of reach, or a
    /// lower bound of it; 0 if other solutions exist.
    pub(super) fn posture_between_spins(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        wanted: u64,
    ) -> Result<Posture, f64> {
        let mut found = None;
        let by = self.solve_at(target, attitudes, wanted, &mut |solution, posture| {
            if u64::from(solution) == wanted & SOLUTION_BITS {
                found = Some(*posture);
            }
        });
        found.ok_or(by)
    }

    /// Calls `found` with the number and the posture of each solution that has the attitude, the spin and the
    /// value of the redundant joint of the branch index `branch`. The joint limits are ignored.
    ///
    /// Returns the distance, m, by which the target is out of reach, or a lower bound of it; 0 if a solution
    /// exists. Planar arms and the numeric solver are not supported.
    pub(super) fn solve_at(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        branch: u64,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let (set, attitude) = (&attitudes.set, self.attitude_of(branch));
        let Some(turn) = set.spin_turns.get(attitude) else { return 0.0 };
        let step = set.spin_step() * spin_step_of(branch) as f64 / SPIN_STEPS as f64;
        let (sin, cos) = step.sin_cos();
        let further = SpinTurn { first: turn.first, cos, sin };
        let flange = match self.last_joint {
            Some(_) => self.flange(turn.first, target, attitudes),
            None => self.turned_flange(attitude, &further, target, attitudes),
        };
        let mut turned = |solution: u8, posture: &Posture| match &self.last_joint {
            Some(joint) => found(solution, &joint.turned(&joint.turned(posture, turn), &further)),
            None => found(solution, posture),
        };
        match &self.solver {
            ChainSolver::Pose(solver) => solver.solve(&flange, &mut self.scratch(), &mut turned),
            ChainSolver::Redundant(joint) => {
                self.solve_held_flange(&joint.sample(sample_of(branch)), &flange, &mut turned)
            }
            ChainSolver::Planar(_) | ChainSolver::Numeric(_) => f64::INFINITY,
        }
    }

    /// Returns the pose of the last D-H frame in frame 0 when the tool is at `target` in attitude `k`, after
    /// a further rotation of the tool about its axis.
    fn turned_flange(
        &self,
        k: usize,
        turn: &SpinTurn,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Pose {
        let about_axis = Matrix3::new(turn.cos, -turn.sin, 0.0, turn.sin, turn.cos, 0.0, 0.0, 0.0, 1.0);
        self.flange_of(&(attitudes.set.columns_at(k, target) * about_axis), target)
    }

    /// Returns the attitude index that a branch index of this arm holds.
    pub(super) fn attitude_of(&self, branch: u64) -> usize {
        match &self.solver {
            ChainSolver::Redundant(_) => attitude_of(branch),
            // Without a redundant joint, all bits from the fifth to the spin step hold the attitude index.
            _ => (without_spin_step(branch) >> 4) as usize,
        }
    }

    /// Returns a branch index of this arm with its attitude index replaced by `attitude`.
    pub(super) fn with_attitude(&self, branch: u64, attitude: usize) -> u64 {
        match &self.solver {
            ChainSolver::Redundant(_) => with_attitude(branch, attitude),
            _ => with_spin_step(branch & 15 | (attitude as u64) << 4, spin_step_of(branch)),
        }
    }
}
