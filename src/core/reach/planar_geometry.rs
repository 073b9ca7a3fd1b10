//! Geometry of a planar arm as plain data, for code that solves many targets at once.

use super::Inverse;
use super::closed_form::planar;
use super::limit_cones::LimitCone;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::pose::Pose;

/// Geometry and joint limits of a planar arm with four axes.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarGeometry {
    /// Sign of the twist alpha_1 of link 1: +1 for +90 degrees, -1 for -90 degrees.
    pub side: f64,
    /// Height of the shoulder above the origin of D-H frame 0, m.
    pub r1: f64,
    /// Lengths l_1, l_2 and l_3 of the first three links, m.
    pub l: [f64; 3],
    /// Signed distance along axis 2 from the base axis to the vertical plane in which the TCP moves, m.
    pub lateral: f64,
    /// Joint limits of the four axes.
    pub cones: [LimitCone; Self::AXES],
    /// Pose of the base frame in D-H frame 0; None if the frames are the same.
    pub to_zero: Option<Pose>,
}

impl PlanarGeometry {
    /// Number of axes of the arm.
    pub const AXES: usize = 4;
    /// Largest excess over 1 at which a cosine still counts as 1.
    ///
    /// Without this tolerance, rounding could reject a target that the arm reaches when it is stretched.
    pub const STRETCHED: f64 = planar::STRETCHED;
}

impl Inverse {
    /// Returns the geometry of a planar arm with four axes.
    ///
    /// Returns None for other arms. Also returns None if cones of unit vectors ([`LimitCone`]) cannot
    /// represent the joint limits.
    pub fn planar_geometry(&self) -> Option<PlanarGeometry> {
        let ChainSolver::Planar(arm) = &self.solver else { return None };
        let cones = self.limits.as_ref()?.cones()?.try_into().ok()?;
        let to_zero = self.to_zero;
        let planar::PlanarArm { side, r1, l, lateral, .. } = *arm;
        (!arm.rolls()).then_some(PlanarGeometry { side, r1, l, lateral, cones, to_zero })
    }
}

impl ToolAttitudes {
    /// Returns whether the tool attitude must be checked at every posture of an arm without a roll axis.
    ///
    /// The check is needed if the attitude requires a spin. It is also needed if the attitude requires a
    /// fixed azimuth of a tool that is not vertical.
    pub fn is_judged_by_posture(&self) -> bool {
        self.set.is_checked(false)
    }
}
