//! Inverse kinematics of chains with a special geometry: closed forms, and scans of one joint.
//!
//! A solver is tested on sampled postures of the chain before it is used.

use super::closed_form::offset_wrist::OffsetWrist;
use super::closed_form::scara::Scara;
use super::closed_form::spherical_wrist::SphericalWrist;
use super::closed_form::three_parallel::ThreeParallel;
use crate::pose::Pose;
use crate::reach::Shell;
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// Number of sampled postures on which a solver is tested.
const TRIALS: usize = 16;

/// Largest number of sampled postures for which a scan may find no solution.
///
/// A scan can miss two solutions that nearly coincide.
const MAX_MISSED_BY_SCAN: usize = 1;

/// Largest error of a solution at a sampled posture.
///
/// The limit applies to the translation (m) and to the rotation matrix (Frobenius norm of the difference).
const MAX_ERROR: f64 = 1e-9;

/// Inverse kinematics for a given pose of the last D-H frame, by a closed form or by a scan of one joint.
#[derive(Debug, Clone)]
pub(super) enum ExactSolver {
    Scara(Scara),
    SphericalWrist(Box<SphericalWrist>),
    ThreeParallel(Box<ThreeParallel>),
    OffsetWrist(Box<OffsetWrist>),
}

impl ExactSolver {
    /// Returns the closed-form solver of a chain; None if no closed form reproduces the sampled poses of the
    /// chain.
    pub fn closed_form(chain: &Chain) -> Option<Self> {
        let scara = || Scara::new(chain).ok().map(Self::Scara);
        let wrist = || SphericalWrist::new(chain).ok().map(|arm| Self::SphericalWrist(Box::new(arm)));
        let parallel = || ThreeParallel::new(chain).ok().map(|arm| Self::ThreeParallel(Box::new(arm)));
        let found = scara().or_else(wrist).or_else(parallel)?;
        found.is_exact(chain, 0).then_some(found)
    }

    /// Returns a solver that scans one joint of the chain; None if no scan reproduces the sampled poses of
    /// the chain.
    ///
    /// The scan takes about twenty times as long as a closed form.
    pub fn scanning(chain: &Chain) -> Option<Self> {
        let found = Self::OffsetWrist(Box::new(OffsetWrist::new(chain).ok()?));
        found.is_exact(chain, MAX_MISSED_BY_SCAN).then_some(found)
    }

    /// Returns whether a branch keeps its index while the pose moves, except at singular postures.
    pub fn keeps_branches(&self) -> bool {
        !matches!(self, Self::OffsetWrist(_))
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Scara(_) => "SCARA (closed form)",
            Self::SphericalWrist(_) => "six axes with three that meet in a point (closed form)",
            Self::ThreeParallel(_) => "six axes with three parallel ones (closed form)",
            Self::OffsetWrist(arm) if arm.is_reversed() => "six axes, offset shoulder (scan of joint 1)",
            Self::OffsetWrist(_) => "six axes, offset wrist (scan of joint 6)",
        }
    }

    /// Returns a phrase that names the family of a redundant arm. This solver solves all joints of the arm
    /// except the redundant joint.
    ///
    /// The redundant joint is the first joint if `first_is_free` is true, otherwise the last joint.
    pub fn redundant_family(&self, first_is_free: bool) -> &'static str {
        match (self, first_is_free) {
            (Self::SphericalWrist(_), true) => "spherical wrist, redundant first joint (closed form)",
            (Self::SphericalWrist(_), false) => "spherical shoulder, redundant last joint (closed form)",
            (Self::ThreeParallel(_), true) => "three parallel axes, redundant first joint (closed form)",
            (Self::ThreeParallel(_), false) => "three parallel axes, redundant last joint (closed form)",
            (Self::Scara(_), _) => "SCARA, one redundant joint (closed form)",
            (Self::OffsetWrist(_), _) => "offset wrist, one redundant joint (scan)",
        }
    }

    /// Returns a faster variant of the solver. For a target out of reach, [`Self::solve`] of the variant
    /// returns only a lower bound in place of the distance.
    pub fn fast(&self) -> Self {
        match self {
            Self::SphericalWrist(arm) => Self::SphericalWrist(Box::new(arm.fast())),
            Self::Scara(_) | Self::ThreeParallel(_) | Self::OffsetWrist(_) => self.clone(),
        }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns. The bound is much cheaper to
    /// compute than a solution.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        match self {
            Self::SphericalWrist(arm) => arm.bound(flange),
            Self::Scara(_) | Self::ThreeParallel(_) | Self::OffsetWrist(_) => 0.0,
        }
    }

    /// Returns a shell that contains every reachable position of the point that [`Self::centre`] returns;
    /// None if no shell is known.
    pub fn shell(&self) -> Option<Shell> {
        match self {
            Self::SphericalWrist(arm) => arm.shell(),
            Self::Scara(_) | Self::ThreeParallel(_) | Self::OffsetWrist(_) => None,
        }
    }

    /// Returns the point (m) whose distance from its reachable positions is the result of [`Self::solve`];
    /// None if the point is not known.
    pub fn centre(&self, flange: &Pose) -> Option<Vector3<f64>> {
        match self {
            Self::SphericalWrist(arm) => Some(arm.centre(flange)),
            Self::Scara(_) | Self::ThreeParallel(_) | Self::OffsetWrist(_) => None,
        }
    }

    /// Calls `found` with every solution for the pose `flange` of the last D-H frame in frame 0.
    ///
    /// Returns the distance by which the target is out of reach, m; 0 if there is a solution. The distance is
    /// infinite for a SCARA that cannot reach the orientation.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        match self {
            Self::Scara(arm) if arm.can_hold(flange) => arm.solve(flange, posture, found),
            Self::Scara(_) => f64::INFINITY,
            Self::SphericalWrist(arm) => arm.solve(flange, posture, found),
            Self::ThreeParallel(arm) => arm.solve(flange, posture, found),
            Self::OffsetWrist(arm) => arm.solve(flange, posture, found),
        }
    }

    /// Returns whether the solver reproduces the poses of the last D-H frame at sampled postures. The solver
    /// may find no solution for up to `misses` of these postures.
    fn is_exact(&self, chain: &Chain, misses: usize) -> bool {
        let mut scratch = chain.zero_posture();
        let (mut missed, mut off): (usize, f64) = (0, 0.0);
        for k in 0..TRIALS {
            let posture = chain.posture(&chain.halton_sample(k));
            let wanted = flange_of(chain, &posture);
            let mut count = 0;
            self.solve(&wanted, &mut scratch, &mut |_, found| {
                let flange = flange_of(chain, found);
                let apart = (flange.translation - wanted.translation).norm();
                off = off.max(apart).max((flange.rotation - wanted.rotation).norm());
                count += 1;
            });
            missed += usize::from(count == 0);
        }
        missed <= misses && off < MAX_ERROR
    }
}

/// Returns the pose of the last D-H frame in frame 0.
fn flange_of(chain: &Chain, posture: &Posture) -> Pose {
    chain.mount.inverse() * chain.frames(posture).links[chain.axes()]
}
