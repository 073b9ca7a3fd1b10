//! Choice of the inverse kinematics for a chain.
//!
//! Most solvers use a closed form, a scan of one joint, or a refined closed form. The other solvers are the
//! elimination of `general_six_axes`, and a numeric solver.

use super::closed_form::planar::PlanarArm;
use super::held_joint::HeldJoint;
use super::numeric::Numeric;
use super::pose_solver::PoseSolver;
use crate::cell::JointKind;
use crate::robot::Chain;

/// Inverse kinematics of one chain.
#[derive(Debug, Clone)]
pub(super) enum ChainSolver {
    /// Arm whose links move in a vertical plane, solved for a point and an elevation of the tool.
    Planar(PlanarArm),
    /// Solver for a whole pose of the last D-H frame.
    Pose(PoseSolver),
    /// Redundant arm: one joint is held constant, and a closed form or a refined closed form solves the
    /// other joints.
    Redundant(Box<HeldJoint>),
    /// Iterative solver for any other chain.
    Numeric(Box<Numeric>),
}

impl ChainSolver {
    /// Returns the solver of a chain.
    ///
    /// `limits_by_posture` is true if the joint limits can be checked from the sines and cosines of a posture
    /// alone. If this argument is false, only the numeric solver can be used.
    pub fn new(chain: &Chain, limits_by_posture: bool) -> Self {
        if limits_by_posture {
            if let Ok(arm) = PlanarArm::new(chain) {
                return Self::Planar(arm);
            }
            let pose = |solver: fn(&Chain) -> Option<PoseSolver>| solver(chain).map(Self::Pose);
            let held = |solver: fn(&Chain) -> Option<PoseSolver>| {
                let joint = [true, false].into_iter().find_map(|first| HeldJoint::new(chain, first, solver));
                joint.map(|joint| Self::Redundant(Box::new(joint)))
            };
            let found = pose(PoseSolver::closed_form)
                .or_else(|| pose(PoseSolver::scanning))
                .or_else(|| held(PoseSolver::closed_form))
                .or_else(|| pose(PoseSolver::refined))
                .or_else(|| held(PoseSolver::refined))
                .or_else(|| pose(PoseSolver::general));
            if let Some(found) = found {
                return found;
            }
        }
        Self::Numeric(Box::new(Numeric::new(chain)))
    }

    /// Returns a numeric solver that computes the posture at a neighbouring target from a given posture.
    ///
    /// The result is None if `self` is numeric itself. Otherwise there are two kinds of arms with such a
    /// solver: arms whose branches do not keep their indices, and arms with seven revolute axes. Which joint
    /// of the latter should not move depends on the posture.
    pub fn follower(&self, chain: &Chain) -> Option<Box<Numeric>> {
        let follows = match self {
            Self::Pose(_) => !self.keeps_branches(),
            Self::Redundant(_) => chain.links.iter().all(|link| link.kind == JointKind::Revolute),
            Self::Planar(_) | Self::Numeric(_) => false,
        };
        follows.then(|| Box::new(Numeric::new(chain)))
    }

    /// Returns whether every branch keeps its index while the target moves, except at singular postures.
    pub fn keeps_branches(&self) -> bool {
        match self {
            Self::Pose(solver) => solver.keeps_branches(),
            Self::Planar(_) | Self::Redundant(_) => true,
            Self::Numeric(_) => false,
        }
    }

    /// Returns whether a solver for a whole pose solves the last joint.
    pub fn solves_last_joint(&self) -> bool {
        match self {
            Self::Pose(_) => true,
            Self::Redundant(joint) => joint.is_first(),
            Self::Planar(_) | Self::Numeric(_) => false,
        }
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Planar(arm) if arm.rolls() => "base yaw, three parallel axes, roll (closed form)",
            Self::Planar(_) => "base yaw and three parallel axes (closed form)",
            Self::Pose(solver) => solver.family(),
            Self::Redundant(joint) => joint.family(),
            Self::Numeric(_) => "general chain (numeric)",
        }
    }
}
