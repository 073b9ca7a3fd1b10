//! Results of the inverse kinematics: the branches of a target, or the reason why the target has none.

use super::limits::LimitViolation;
use crate::cell::JointVector;
use crate::robot::Posture;

/// Bits of a branch index that hold the attitude index for a redundant arm.
const ATTITUDE_BITS: u64 = 0xfff0;

/// Bit of a branch index at which the lattice number of the redundant joint begins (see
/// `HeldJoint::LATTICE`).
const SAMPLE_SHIFT: u32 = 16;

/// Bit of a branch index at which the spin step begins. The lattice number of the redundant joint or the
/// attitude index of another arm ends below this bit.
const SPIN_SHIFT: u32 = 40;

/// Number of steps between two neighbouring free spins.
pub(super) const SPIN_STEPS: u64 = 1 << 12;

/// Returns the attitude index that a branch index of a redundant arm holds.
pub(super) fn attitude_of(index: u64) -> usize {
    ((index & ATTITUDE_BITS) >> 4) as usize
}

/// Returns the branch index with its attitude index replaced by `attitude`.
pub(super) fn with_attitude(index: u64, attitude: usize) -> u64 {
    index & !ATTITUDE_BITS | (attitude as u64) << 4
}

/// Returns the lattice number of the redundant joint that a branch index holds.
pub(super) fn sample_of(index: u64) -> u32 {
    (without_spin_step(index) >> SAMPLE_SHIFT) as u32
}

/// Returns the branch index with the lattice number of the redundant joint replaced by `number`.
pub(super) fn with_sample(index: u64, number: u32) -> u64 {
    let others = (SPIN_STEPS - 1) << SPIN_SHIFT | ((1 << SAMPLE_SHIFT) - 1);
    index & others | u64::from(number) << SAMPLE_SHIFT
}

/// Returns the number of steps ([`SPIN_STEPS`]) by which the tool is rotated beyond its attitude.
pub(super) fn spin_step_of(index: u64) -> u64 {
    index >> SPIN_SHIFT
}

/// Returns the branch index without its spin step: the index of a sampled spin.
pub(super) fn without_spin_step(index: u64) -> u64 {
    index & ((1 << SPIN_SHIFT) - 1)
}

/// Returns the branch index with its spin step replaced by `step`, which must be below [`SPIN_STEPS`].
pub(super) fn with_spin_step(index: u64, step: u64) -> u64 {
    without_spin_step(index) | step << SPIN_SHIFT
}

/// Class of an inverse kinematics solver according to its computing time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Solver that takes tens of nanoseconds per target.
    Low,
    /// Solver that takes about a microsecond per attitude.
    Middle,
    /// Solver that is slower than [`Self::Middle`], but not numeric.
    ///
    /// The closed form of a redundant arm takes about a microsecond per attitude and sampled joint value. The
    /// refined closed form of a redundant arm takes about ten times as long.
    ///
    /// Other solvers of this class take tens of microseconds per attitude. Such a solver scans one joint,
    /// refines a closed form, or eliminates variables (`general_six_axes`).
    High,
    /// Numeric solver, which takes about a millisecond per target.
    Numeric,
}

/// Measure of how far a target is from having a usable posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Distance to the nearest reachable point, m; 0 if a branch exists.
    ///
    /// The value is infinite for a SCARA that cannot reach the orientation. The value of the numeric solver
    /// is also 0 if this solver misses only the attitude or does not converge.
    pub reach: f64,
    /// Least violation of joint limits and attitude over all branches.
    ///
    /// The violation is a sum in mixed units. A prismatic joint adds a length (m), and a revolute joint adds
    /// a difference of cosines. The attitude adds an angle (rad).
    ///
    /// The numeric solver has another measure. If the arm reaches only the position, the value is the least
    /// orientation error (rad). If the solver does not converge, the value is a sum of two errors: the
    /// position error (m) and the orientation error (rad) of the best attempt.
    ///
    /// The value is 0 if a branch keeps the joint limits and has the required attitude. The value is also 0
    /// if the target is out of reach.
    pub limits: f64,
}

impl Gap {
    /// Infinite gap: the initial value in a search for the least gap.
    pub const ALL: Self = Self { reach: f64::INFINITY, limits: f64::INFINITY };

    /// Returns whether this gap is smaller than `other`: compares `reach` first, then `limits`.
    pub fn is_less(&self, other: &Self) -> bool {
        (self.reach, self.limits) < (other.reach, other.limits)
    }
}

/// One posture that puts the TCP at the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Number that encodes the solution, the attitude and the value of a redundant joint.
    ///
    /// [`super::Inverse`] documents the bits of this number.
    pub index: u64,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    pub posture: Posture,
    /// Joint limit that is exceeded the most; None if the posture is within the limits.
    pub violation: Option<LimitViolation>,
    /// Part of the attitude error that exceeds the tolerance, rad. The value is 0 except for planar arms.
    pub off: f64,
}

impl Branch {
    /// Returns whether the branch stays within the joint limits and meets the required attitude.
    pub fn is_usable(&self) -> bool {
        self.violation.is_none() && self.off == 0.0
    }
}

/// Result of the inverse kinematics for one target.
#[derive(Debug, Clone, PartialEq)]
pub enum Reach {
    /// No posture exists; `by` is the distance from the target to the nearest reachable point, m.
    OutOfReach { by: f64 },
    /// The arm reaches the position, but not in the required attitude; `by` is the least angle error (rad).
    ///
    /// `joint` is the index of the joint whose limit prevents the attitude; None if the geometry prevents the
    /// attitude.
    Attitude { by: f64, joint: Option<usize> },
    /// The numeric solver did not converge: the errors `position` (m) and `angle` (rad) remain. A posture may
    /// still exist.
    NotConverged { position: f64, angle: f64 },
    /// All branches found, including branches that violate joint limits.
    Branches(Vec<Branch>),
}
