//! Solvers for a given pose of the last D-H frame.
//!
//! The chain belongs to a known family, nearly belongs to one, or has six revolute axes in any position.

use super::exact_solver::ExactSolver;
use super::general_six_axes::GeneralSixAxes;
use super::refined_solver::RefinedSolver;
use crate::pose::Pose;
use crate::reach::Shell;
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// Inverse kinematics for a given pose of the last D-H frame.
#[derive(Debug, Clone)]
pub(super) enum PoseSolver {
    /// Solver of the family to which the chain belongs.
    Exact(ExactSolver),
    /// Solver of a family that the chain resembles, followed by Newton's method on the chain.
    Refined(Box<RefinedSolver>),
    /// Solver of any six revolute axes.
    General(Box<GeneralSixAxes>),
}

impl PoseSolver {
    /// Returns the closed-form solver of a chain; None if no closed form reproduces the sampled poses of the
    /// chain.
    pub fn closed_form(chain: &Chain) -> Option<Self> {
        ExactSolver::closed_form(chain).map(Self::Exact)
    }

    /// Returns a solver that scans one joint of the chain; None if no scan reproduces the sampled poses of
    /// the chain.
    ///
    /// The scan takes about twenty times as long as a closed form.
    pub fn scanning(chain: &Chain) -> Option<Self> {
        ExactSolver::scanning(chain).map(Self::Exact)
    }

    /// Returns the solver of a chain that nearly has a closed form, such as a calibrated arm; otherwise None.
    ///
    /// The solver takes about ten times as long as the closed form.
    pub fn refined(chain: &Chain) -> Option<Self> {
        RefinedSolver::new(chain).map(|solver| Self::Refined(Box::new(solver)))
    }

    /// Returns the solver of any six revolute axes; None for other chains.
    ///
    /// The solver takes about fifty times as long as a closed form.
    pub fn general(chain: &Chain) -> Option<Self> {
        GeneralSixAxes::new(chain).ok().map(|solver| Self::General(Box::new(solver)))
    }

    /// Returns whether this is the solver of a SCARA.
    pub fn is_scara(&self) -> bool {
        matches!(self, Self::Exact(ExactSolver::Scara(_)))
    }

    /// Returns whether the solver is a closed form of the chain, which takes about a microsecond per pose.
    pub fn is_closed_form(&self) -> bool {
        matches!(self, Self::Exact(solver) if solver.keeps_branches())
    }

    /// Returns whether a branch keeps its index while the pose moves, except at singular postures.
    pub fn keeps_branches(&self) -> bool {
        match self {
            Self::Exact(solver) => solver.keeps_branches(),
            Self::Refined(_) => true,
            Self::General(_) => false,
        }
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Exact(solver) => solver.family(),
            Self::Refined(solver) => solver.family(),
            Self::General(_) => "six general axes (elimination)",
        }
    }

    /// Returns a phrase that names the family of a redundant arm. This solver solves all joints of the arm
    /// except the redundant joint.
    ///
    /// The redundant joint is the first joint if `first_is_free` is true, otherwise the last joint.
    pub fn redundant_family(&self, first_is_free: bool) -> &'static str {
        match self {
            Self::Exact(solver) => solver.redundant_family(first_is_free),
            Self::Refined(solver) => solver.redundant_family(first_is_free),
            Self::General(_) => "six general axes, one redundant joint (elimination)",
        }
    }

    /// Returns a faster variant of the solver. For a target out of reach, [`Self::solve`] of the variant
    /// returns only a lower bound in place of the distance.
    pub fn fast(&self) -> Self {
        match self {
            Self::Exact(solver) => Self::Exact(solver.fast()),
            Self::Refined(solver) => Self::Refined(Box::new(solver.fast())),
            Self::General(_) => self.clone(),
        }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns. The bound is much cheaper to
    /// compute than a solution.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        match self {
            Self::Exact(solver) => solver.bound(flange),
            Self::Refined(solver) => solver.bound(flange),
            Self::General(_) => 0.0,
        }
    }

    /// Returns the point (m) whose distance from its reachable positions is the result of [`Self::solve`];
    /// None if the point is not known. The point moves with `flange`, or against it if the solver uses the
    /// reversed chain.
    pub fn centre(&self, flange: &Pose) -> Option<Vector3<f64>> {
        match self {
            Self::Exact(solver) => solver.centre(flange),
            Self::Refined(_) | Self::General(_) => None,
        }
    }

    /// Returns a shell that contains every reachable position of the point that [`Self::centre`] returns;
    /// None if no shell is known.
    pub fn shell(&self) -> Option<Shell> {
        match self {
            Self::Exact(solver) => solver.shell(),
            Self::Refined(_) | Self::General(_) => None,
        }
    }

    /// Calls `found` with every solution for the pose `flange` of the last D-H frame in frame 0.
    ///
    /// Returns the distance by which the target is out of reach, m; 0 if there is a solution. The distance is
    /// infinite for a SCARA that cannot reach the orientation.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        match self {
            Self::Exact(solver) => solver.solve(flange, posture, found),
            Self::Refined(solver) => solver.solve(flange, posture, found),
            Self::General(solver) => solver.solve(flange, posture, found),
        }
    }
}
