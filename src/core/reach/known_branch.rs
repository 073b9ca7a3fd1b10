//! Posture of a branch whose index is known, at any target.
//!
//! A branch index holds the attitude and the value of a redundant joint. Only these are solved again.

use super::branch::{Branch, attitude_of, sample_of};
use super::inverse::Inverse;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::robot::Posture;
use nalgebra::Vector3;

impl Inverse {
    /// Returns the posture of the branch whose index is `wanted`, which [`Self::visit`] has found; None if no
    /// such branch exists.
    pub fn posture(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes, wanted: u64) -> Option<Posture> {
        if self.is_between_spins(wanted) {
            return self.posture_between_spins(target, attitudes, wanted).ok();
        }
        let mut found = None;
        let mut keep = |index: u64, posture: &Posture| {
            if index == wanted {
                found = Some(*posture);
            }
        };
        let mut scratch = self.scratch();
        match &self.solver {
            // The branch index contains the attitude, so the other attitudes need not be solved again.
            ChainSolver::Pose(_) => {
                let turn = attitudes.set.spin_turns.get((wanted >> 4) as usize)?;
                self.solve_spins(turn.first, target, attitudes, &mut scratch, &mut keep);
            }
            ChainSolver::Redundant(joint) => {
                let turn = attitudes.set.spin_turns.get(attitude_of(wanted))?;
                let sample = joint.sample(sample_of(wanted));
                self.solve_held_spins(&sample, turn.first, target, attitudes, &mut keep);
            }
            ChainSolver::Numeric(_) => {
                return Some(self.numeric_branch_at(target, attitudes, wanted)?.posture);
            }
            ChainSolver::Planar(_) => {
                self.visit(target, attitudes, &mut scratch, keep);
            }
        }
        found
    }

    /// Returns the branch whose index is `wanted`, which [`Self::visit`] has found; None if no such branch
    /// exists.
    pub fn branch_at(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes, wanted: u64) -> Option<Branch> {
        if let ChainSolver::Numeric(_) = &self.solver {
            return self.numeric_branch_at(target, attitudes, wanted);
        }
        let posture = self.posture(target, attitudes, wanted)?;
        Some(self.branch(wanted, &posture, target, attitudes))
    }

    /// Returns the branch whose index is `wanted`, even if it violates joint limits. The numeric solver is
    /// not supported.
    ///
    /// # Errors
    /// If no branch has this index, returns the distance, m, by which the target is out of reach. The index
    /// encodes an attitude, and the value of a redundant joint. The distance holds for this attitude and this
    /// value. For a planar arm, the distance is the least over all attitudes. If the index of a
    /// redundant arm encodes a spin between two sampled spins, the result may be a lower bound of the
    /// distance. The distance is 0 if other branches exist, and infinite for the numeric solver.
    pub fn branch_beyond_limits(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        wanted: u64,
    ) -> Result<Branch, f64> {
        if self.is_between_spins(wanted) {
            let posture = self.posture_between_spins(target, attitudes, wanted)?;
            return Ok(self.branch(wanted, &posture, target, attitudes));
        }
        let mut found = None;
        let mut keep = |index: u64, posture: &Posture| {
            if index == wanted {
                found = Some(self.branch(index, posture, target, attitudes));
            }
        };
        let turns = &attitudes.set.spin_turns;
        let by = match &self.solver {
            ChainSolver::Pose(_) => turns.get((wanted >> 4) as usize).map_or(0.0, |turn| {
                self.solve_spins(turn.first, target, attitudes, &mut self.scratch(), &mut keep)
            }),
            ChainSolver::Redundant(joint) => turns.get(attitude_of(wanted)).map_or(0.0, |turn| {
                let sample = joint.sample(sample_of(wanted));
                let bound = self.solve_held_spins(&sample, turn.first, target, attitudes, &mut keep);
                if bound > 0.0 { self.held_distance(&sample, turn.first, target, attitudes) } else { 0.0 }
            }),
            ChainSolver::Planar(_) => self.solve(target, attitudes, &mut self.scratch(), &mut keep),
            ChainSolver::Numeric(_) => f64::INFINITY,
        };
        found.ok_or(by)
    }

    /// Returns the posture of the branch whose index is `wanted`. Returns None if no posture with this index
    /// stays within the joint limits and meets the required attitude.
    pub fn usable(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes, wanted: u64) -> Option<Posture> {
        self.posture(target, attitudes, wanted).filter(|p| self.excess(p, target, attitudes) == 0.0)
    }
}
