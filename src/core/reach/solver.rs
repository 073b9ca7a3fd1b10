//! Choice of the solver for a chain: the closed form of its family, or the numeric one.

use super::closed_form::planar::PlanarArm;
use super::held_joint::HeldJoint;
use super::numeric::Numeric;
use super::pose_solver::PoseSolver;
use crate::robot::Chain;

/// Solver of one chain.
#[derive(Debug, Clone)]
pub(super) enum ChainSolver {
    /// Arm in a vertical plane, solved for a point and an elevation.
    Planar(PlanarArm),
    /// Closed form for a whole pose.
    Pose(PoseSolver),
    /// Redundant arm: one joint held, the rest in closed form.
    Redundant(Box<HeldJoint>),
    /// Iterative solver for any other chain.
    Numeric(Box<Numeric>),
}

impl ChainSolver {
    /// Returns the solver of a chain.
    ///
    /// `limits_by_posture` says that a posture alone tells whether it keeps the joint limits. The closed
    /// forms need this.
    pub fn new(chain: &Chain, limits_by_posture: bool) -> Self {
        if limits_by_posture {
            if let Ok(arm) = PlanarArm::new(chain) {
                return Self::Planar(arm);
            }
            if let Some(solver) = PoseSolver::new(chain) {
                return Self::Pose(solver);
            }
            if let Some(joint) = [true, false].into_iter().find_map(|first| HeldJoint::new(chain, first)) {
                return Self::Redundant(Box::new(joint));
            }
        }
        Self::Numeric(Box::new(Numeric::new(chain)))
    }

    /// Returns the family of the arm in words.
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
