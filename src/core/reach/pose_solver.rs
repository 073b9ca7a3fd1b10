//! Solvers for a pose of the last D-H frame: of a chain of a known family, of one that nearly belongs to a
//! family, or of any six revolute axes.

use super::exact_solver::ExactSolver;
use super::general_six_axes::GeneralSixAxes;
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
    /// Solver of any six revolute axes.
    General(Box<GeneralSixAxes>),
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

    /// Returns the solver of a chain that nearly has a closed form, as a calibrated arm does. It takes about ten
    /// times as long as the closed form.
    pub fn refined(chain: &Chain) -> Option<Self> {
        RefinedSolver::new(chain).map(|solver| Self::Refined(Box::new(solver)))
    }

    /// Returns the solver of any six revolute axes. It takes about fifty times as long as a closed form.
    pub fn general(chain: &Chain) -> Option<Self> {
        GeneralSixAxes::new(chain).ok().map(|solver| Self::General(Box::new(solver)))
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

    /// Returns a phrase that names the family of an arm with one more joint: its first joint if
    /// `first_is_free`, otherwise its last joint.
    pub fn redundant_family(&self, first_is_free: bool) -> &'static str {
        match self {
            Self::Exact(solver) => solver.redundant_family(first_is_free),
            Self::Refined(solver) => solver.redundant_family(first_is_free),
            Self::General(_) => "six general axes, one joint free (elimination)",
        }
    }

    /// Returns a variant of the solver that computes only a lower bound of the distance by which a target is
    /// out of reach.
    pub fn fast(&self) -> Self {
        match self {
            Self::Exact(solver) => Self::Exact(solver.fast()),
            Self::Refined(solver) => Self::Refined(Box::new(solver.fast())),
            Self::General(_) => self.clone(),
        }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns. Computing the bound is much
    /// cheaper than a solution.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        match self {
            Self::Exact(solver) => solver.bound(flange),
            Self::Refined(solver) => solver.bound(flange),
            Self::General(_) => 0.0,
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
            Self::General(solver) => solver.solve(flange, posture, found),
        }
    }
}
