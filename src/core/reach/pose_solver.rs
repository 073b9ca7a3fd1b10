//! Solvers for a pose of the last D-H frame: of a chain of a known family, or of one that is nearly so.

use super::exact_solver::ExactSolver;
use super::refined_solver::RefinedSolver;
use crate::pose::Pose;
use crate::robot::{Chain, Posture};

/// Inverse kinematics for a given pose of the last D-H frame.
#[derive(Debug, Clone)]
pub(super) enum PoseSolver {
    /// Solver of the family of the chain.
    Exact(ExactSolver),
    /// Solver of a family that the chain resembles, followed by Newton's method on the chain.
    Refined(Box<RefinedSolver>),
}

impl PoseSolver {
    /// Returns the closed form of a chain, if there is one that reproduces sampled poses of the chain.
    pub fn closed_form(chain: &Chain) -> Option<Self> {
        ExactSolver::closed_form(chain).map(Self::Exact)
    }

    /// Returns the solver of a chain that scans one joint, if there is one that reproduces sampled poses of
    /// the chain. It takes about twenty times as long as a closed form.
    pub fn scanning(chain: &Chain) -> Option<Self> {
        ExactSolver::scanning(chain).map(Self::Exact)
    }

    /// Returns the solver of a chain that nearly has a closed form, as a calibrated arm does. It takes about
    /// fifty times as long as the closed form.
    pub fn refined(chain: &Chain) -> Option<Self> {
        let solver = Self::refined_closed_form(chain);
        solver.or_else(|| Some(Self::Refined(Box::new(RefinedSolver::scanning(chain)?))))
    }

    /// Returns what [`Self::refined`] returns, but no solver that scans a joint.
    pub fn refined_closed_form(chain: &Chain) -> Option<Self> {
        Some(Self::Refined(Box::new(RefinedSolver::closed_form(chain)?)))
    }

    /// Returns whether the solver is that of a SCARA.
    pub fn is_scara(&self) -> bool {
        matches!(self, Self::Exact(ExactSolver::Scara(_)))
    }

    /// Returns whether the solver is a closed form of the chain, which takes about a microsecond per pose.
    pub fn is_closed_form(&self) -> bool {
        matches!(self, Self::Exact(solver) if solver.keeps_branches())
    }

    /// Returns whether the branch index of a posture is kept while the pose moves, except at singular
    /// postures.
    pub fn keeps_branches(&self) -> bool {
        match self {
            Self::Exact(solver) => solver.keeps_branches(),
            Self::Refined(solver) => solver.keeps_branches(),
        }
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Exact(solver) => solver.family(),
            Self::Refined(solver) => solver.family(),
        }
    }

    /// Returns a phrase that names the family of an arm with one more joint: its first joint if
    /// `first_is_free`, otherwise its last joint.
    pub fn redundant_family(&self, first_is_free: bool) -> &'static str {
        match self {
            Self::Exact(solver) => solver.redundant_family(first_is_free),
            Self::Refined(solver) => solver.redundant_family(first_is_free),
        }
    }

    /// Returns a variant of the solver that computes only a lower bound of the distance by which a target is
    /// out of reach.
    pub fn fast(&self) -> Self {
        match self {
            Self::Exact(solver) => Self::Exact(solver.fast()),
            Self::Refined(solver) => Self::Refined(Box::new(solver.fast())),
        }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns. Computing the bound is much
    /// cheaper than a solution.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        match self {
            Self::Exact(solver) => solver.bound(flange),
            Self::Refined(solver) => solver.bound(flange),
        }
    }

    /// Calls `found` with every solution for the pose `flange` of the last D-H frame in frame 0.
    ///
    /// Returns the distance by which the target is out of reach, m. It is infinite for a SCARA that cannot
    /// hold the orientation.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        match self {
            Self::Exact(solver) => solver.solve(flange, posture, found),
            Self::Refined(solver) => solver.solve(flange, posture, found),
        }
    }
}
