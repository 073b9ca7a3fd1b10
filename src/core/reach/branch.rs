//! Results of the inverse kinematics: branches, or the reason why there are none.

use super::limits::LimitViolation;
use crate::cell::JointVector;
use crate::robot::Posture;

/// Computing time of one target, in classes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Tens of nanoseconds.
    Low,
    /// About a microsecond per attitude.
    Middle,
    /// About a microsecond per attitude and value of the redundant joint.
    High,
    /// About a millisecond.
    Numeric,
}

/// Distance of a target from a usable posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Distance to the nearest reachable point, m; 0 if a branch exists.
    pub reach: f64,
    /// Least violation of joint limits and attitude among the branches; 0 if a branch keeps them.
    pub limits: f64,
}

impl Gap {
    /// Gap before any branch was tried.
    pub const ALL: Self = Self { reach: f64::INFINITY, limits: f64::INFINITY };

    /// Returns whether this gap is smaller. Equal distances to the reach are ranked by the limits.
    pub fn is_less(&self, other: &Self) -> bool {
        (self.reach, self.limits) < (other.reach, other.limits)
    }
}

/// One posture that puts the TCP at the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Number of the solution, the attitude and the value of a redundant joint; see [`super::Inverse`].
    pub index: u32,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    pub posture: Posture,
    /// The worst violated joint limit; None inside the limits.
    pub violation: Option<LimitViolation>,
    /// Attitude error beyond the tolerance, rad, of an arm that cannot choose the attitude.
    pub off: f64,
}

impl Branch {
    /// Returns whether the branch keeps joint limits and attitude.
    pub fn is_usable(&self) -> bool {
        self.violation.is_none() && self.off == 0.0
    }
}

/// Result of the inverse kinematics for one target.
#[derive(Debug, Clone, PartialEq)]
pub enum Reach {
    /// No posture exists; `by` is the distance to the reachable points, m.
    OutOfReach { by: f64 },
    /// The position is within reach, but the attitude misses by an angle (rad).
    ///
    /// `joint` is the joint whose limit prevents the attitude; None if the geometry does.
    Attitude { by: f64, joint: Option<usize> },
    /// The numeric solver came no nearer than this (m, rad). A posture may exist.
    NotConverged { position: f64, angle: f64 },
    /// Every branch, inside the joint limits or not.
    Branches(Vec<Branch>),
}
