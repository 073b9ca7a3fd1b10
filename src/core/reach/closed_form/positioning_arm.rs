//! Solver of the first three joints, which put a point of axis 4 at a target.

use super::anthropomorphic::Anthropomorphic;
use super::three_joints::ThreeJoints;
use crate::reach::Shell;
use crate::robot::{Link, Posture};
use nalgebra::Vector3;

/// Solver of the first three joints, which put a point of axis 4 at a target; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) enum PositioningArm {
    Anthropomorphic(Anthropomorphic),
    Any(Box<ThreeJoints>),
}

impl PositioningArm {
    /// Number of branch indices: every index from [`Self::solve`] is below this number.
    pub const BRANCHES: usize = 8;

    /// Returns the solver for the point on axis 4 at a distance `r4` (m) from the origin of frame 3.
    ///
    /// # Errors
    /// Fails if the joints cannot move the point in all directions, or if their geometry is nearly
    /// degenerate. The message states which of these is true.
    pub fn new(links: &[Link; 3], r4: f64) -> Result<Self, String> {
        let last = &links[2];
        let tip = Vector3::new(last.l, -r4 * last.sin_alpha, last.r + r4 * last.cos_alpha);
        Ok(match Anthropomorphic::new(links, &tip) {
            Some(arm) => Self::Anthropomorphic(arm),
            None => Self::Any(Box::new(ThreeJoints::new(links, r4)?)),
        })
    }

    /// Returns a faster variant of the solver. For a target out of reach, [`Self::solve`] of the variant
    /// returns only a lower bound in place of the distance. At the boundary of the reach, rounding may hide a
    /// solution from the variant.
    pub fn fast(&self) -> Self {
        let mut fast = self.clone();
        match &mut fast {
            Self::Any(arm) => arm.fast = true,
            Self::Anthropomorphic(arm) => arm.fast = true,
        }
        fast
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns for a target in frame 0.
    #[inline]
    pub fn bound(&self, p: &Vector3<f64>) -> f64 {
        match self {
            Self::Any(arm) => arm.bound(p),
            Self::Anthropomorphic(arm) => arm.bound(p),
        }
    }

    /// Returns a shell in frame 0 that contains all reachable points; None if a joint is prismatic.
    pub fn shell(&self) -> Option<Shell> {
        match self {
            Self::Any(arm) => arm.shell(),
            Self::Anthropomorphic(arm) => Some(arm.shell()),
        }
    }

    /// Calls `found` with every solution (branch index, theta_1 to theta_3) for the target `p` in frame 0, m.
    ///
    /// Returns the distance from `p` to the nearest reachable point, m; 0 if there is a solution.
    #[inline]
    pub fn solve(
        &self,
        p: &Vector3<f64>,
        posture: &mut Posture,
        found: &mut impl FnMut(u8, &mut Posture),
    ) -> f64 {
        match self {
            Self::Anthropomorphic(arm) => arm.solve(p, posture, found),
            Self::Any(arm) => arm.solve(p, posture, found),
        }
    }
}
