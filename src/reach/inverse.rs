//! Inverse kinematics of any chain: the closed form of its family, or else the numeric one; with all
//! attitudes of an operation, joint limits, and the choice that a redundant arm leaves.

use super::closed_form::planar::{Way, template};
use super::hold::Hold;
use super::kernel::Kernel;
use super::limits::{LimitViolation, Limits};
use crate::cell::{Attitude, JointVector, MAX_JOINTS, tool_columns};
use crate::pose::Pose;
use crate::robot::{Chain, Posture};
use nalgebra::{Matrix3, Vector3};

/// An arm made ready.
#[derive(Debug, Clone)]
pub struct Inverse {
    pub(super) chain: Chain,
    pub(super) kernel: Kernel,
    /// None of a chain whose limits a posture alone cannot tell: the numeric way keeps them itself.
    pub(super) limits: Option<Limits>,
    /// From the base to frame 0; None if they are one.
    pub(super) to_zero: Option<Pose>,
    /// From the TCP to the last D-H frame.
    to_flange: Pose,
    /// Rows r, a x r, a of the tool in its own frame.
    pub(super) tool_rows: Matrix3<f64>,
    /// The elevation that the arm keeps by its build, rad.
    pub(super) kept: Option<f64>,
    pub(super) template: Posture,
}

/// What a target costs: some ten nanoseconds, a microsecond for every attitude, the same for every value
/// of a redundant joint, a millisecond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    Low,
    Middle,
    High,
    Numeric,
}

/// An operation's attitudes, ready for this arm over one surface. Kept from layout to layout.
#[derive(Debug, Clone, Default)]
pub struct Approach {
    pub(super) hold: Hold,
    pub(super) ways: Vec<Way>,
}

/// What a target misses: metres to the nearest reachable point (0 if a branch exists) and, if
/// branches exist, the least excess over their joint limits and attitudes (0 if one keeps them).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    pub reach: f64,
    pub limits: f64,
}

impl Gap {
    /// Nothing was tried yet.
    pub const ALL: Self = Self { reach: f64::INFINITY, limits: f64::INFINITY };

    pub fn is_less(&self, other: &Self) -> bool {
        (self.reach, self.limits) < (other.reach, other.limits)
    }
}

/// One posture that puts the TCP where it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Which of the kernel's solutions, attitudes and values of a redundant joint; see [`Inverse`].
    pub index: u32,
    pub joints: JointVector,
    pub posture: Posture,
    /// None inside the joint limits.
    pub violation: Option<LimitViolation>,
    /// By how much an attitude that the arm cannot choose is off, beyond its tolerance; rad.
    pub off: f64,
}

impl Branch {
    pub fn is_usable(&self) -> bool {
        self.violation.is_none() && self.off == 0.0
    }
}

/// The answer for one target.
#[derive(Debug, Clone, PartialEq)]
pub enum Reach {
    /// No posture at all; so many metres are missing.
    OutOfReach { by: f64 },
    /// In reach, but so much of the attitude is missing (rad); the joint that stands at its limit.
    Attitude { by: f64, joint: Option<usize> },
    /// The numeric way came no nearer than this (m, rad): there may be a posture.
    NotConverged { position: f64, angle: f64 },
    /// Every branch, inside its limits or not.
    Branches(Vec<Branch>),
}

impl Approach {
    /// The ways to hold the tool of a planar arm.
    pub fn ways(&self) -> &[Way] {
        &self.ways
    }
}

impl Inverse {
    pub fn new(chain: &Chain) -> Self {
        let limits = Limits::new(chain);
        let kernel = Kernel::new(chain, limits.is_ok());
        Self {
            to_zero: (chain.mount != Pose::identity()).then(|| chain.mount.inverse()),
            to_flange: chain.tool.inverse(),
            tool_rows: tool_columns(&chain.tool_axis).transpose(),
            kept: super::kept_elevation(chain),
            template: template(chain),
            chain: chain.clone(),
            limits: limits.ok(),
            kernel,
        }
    }

    /// The family of the arm in words.
    pub fn family(&self) -> &'static str {
        self.kernel.family()
    }

    /// The same arm with its redundant joint, if it has one that is held, at the coordinate in `q` alone.
    pub fn held_at(&self, q: &JointVector) -> Self {
        let mut held = self.clone();
        if let Kernel::Locked(locked) = &mut held.kernel {
            locked.hold(q);
        }
        held
    }

    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The elevation (rad) that the tool axis has in every posture, if there is one.
    pub fn kept_elevation(&self) -> Option<f64> {
        self.kept
    }

    /// What a target costs.
    pub fn cost(&self) -> Cost {
        match &self.kernel {
            Kernel::Planar(_) => Cost::Low,
            Kernel::Pose(_) => Cost::Middle,
            Kernel::Locked(_) => Cost::High,
            Kernel::Numeric(_) => Cost::Numeric,
        }
    }

    /// The ways to hold the tool over a surface turned by `yaw` (rad) in the base frame.
    pub fn approach(&self, attitude: &Attitude, yaw: f64) -> Approach {
        let mut approach = Approach::default();
        self.set(&mut approach, attitude, yaw);
        approach
    }

    /// [`Self::approach`] into memory that is kept.
    pub fn set(&self, approach: &mut Approach, attitude: &Attitude, yaw: f64) {
        let poses = !matches!(self.kernel, Kernel::Planar(_));
        approach.hold.set(attitude, yaw, self.kept, poses);
        if let Kernel::Planar(arm) = &self.kernel {
            arm.ways(&approach.hold, &mut approach.ways);
        }
    }

    /// A posture to hand to [`Self::visit`] again and again.
    pub fn scratch(&self) -> Posture {
        self.template
    }

    /// Calls `found` with every branch inside the joint limits; says what is missing otherwise.
    /// `target` is the TCP in the base frame, m. This is the node loop: closed forms do not allocate.
    #[inline]
    pub fn visit(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        scratch: &mut Posture,
        mut found: impl FnMut(u32, &Posture),
    ) -> Gap {
        let mut least = f64::INFINITY;
        let mut judge = |index: u32, posture: &Posture| {
            let excess = self.excess(posture, target, approach);
            least = least.min(excess);
            if excess == 0.0 {
                found(index, posture);
            }
        };
        let reach = match &self.kernel {
            Kernel::Numeric(_) => return self.converge(target, approach, found),
            Kernel::Locked(locked) => return self.unlock(locked, target, approach, found),
            _ => self.solve(target, approach, scratch, &mut judge),
        };
        Gap { reach, limits: if reach > 0.0 { 0.0 } else { least } }
    }

    /// Whether a branch keeps the joint limits, asked until the first is found; a redundant joint stands
    /// at the values tried, not between them.
    pub fn reaches(&self, target: &Vector3<f64>, approach: &Approach, scratch: &mut Posture) -> bool {
        let usable = |posture: &Posture| self.excess(posture, target, approach) == 0.0;
        match &self.kernel {
            Kernel::Planar(_) => {
                let mut any = false;
                self.solve(target, approach, scratch, &mut |_, posture: &Posture| {
                    any = any || usable(posture)
                });
                any
            }
            Kernel::Pose(_) => (0..approach.hold.columns.len()).any(|k| {
                let mut any = false;
                let mut judge = |_: u32, posture: &Posture| any = any || usable(posture);
                self.solve_one(k, target, approach, scratch, &mut judge);
                any
            }),
            Kernel::Locked(locked) => locked.values.iter().enumerate().any(|(k, value)| {
                let mut any = false;
                let mut judge = |_: u32, posture: &Posture| any = any || usable(posture);
                self.solve_locked((locked, locked.quick()), (k, *value), target, approach, &mut judge);
                any
            }),
            Kernel::Numeric(_) => {
                let mut any = false;
                self.converge(target, approach, |_, _| any = true);
                any
            }
        }
    }

    /// The posture of one branch that [`Self::visit`] has found.
    pub fn posture(&self, target: &Vector3<f64>, approach: &Approach, wanted: u32) -> Option<Posture> {
        let mut found = None;
        let mut keep = |index: u32, posture: &Posture| {
            if index == wanted {
                found = Some(*posture);
            }
        };
        let mut scratch = self.scratch();
        match &self.kernel {
            // The attitude is known by the index: the others need not be solved again.
            Kernel::Pose(_) => {
                let k = (wanted >> 4) as usize;
                self.solve_one(k, target, approach, &mut scratch, &mut keep);
            }
            Kernel::Locked(locked) if ((wanted >> 16) as usize) < locked.values.len() => {
                let k = (wanted >> 16) as usize;
                self.solve_locked(
                    (locked, locked.quick()),
                    (k, locked.values[k]),
                    target,
                    approach,
                    &mut keep,
                );
            }
            _ => {
                self.visit(target, approach, &mut scratch, keep);
            }
        }
        found
    }

    /// One branch that [`Self::visit`] has found, with its joint coordinates.
    pub fn branch_at(&self, target: &Vector3<f64>, approach: &Approach, wanted: u32) -> Option<Branch> {
        if let Kernel::Numeric(_) = &self.kernel {
            let Reach::Branches(all) = self.converged(target, approach) else { return None };
            return all.into_iter().find(|branch| branch.index == wanted);
        }
        let posture = self.posture(target, approach, wanted)?;
        Some(self.branch(wanted, &posture, target, approach))
    }

    /// The same of a branch that may have been lost: None if it has no posture, or one that passes a limit.
    pub fn usable(&self, target: &Vector3<f64>, approach: &Approach, wanted: u32) -> Option<Posture> {
        self.posture(target, approach, wanted).filter(|p| self.excess(p, target, approach) == 0.0)
    }

    /// Every branch with its joint coordinates, those outside the limits too.
    pub fn branches(&self, target: &Vector3<f64>, approach: &Approach) -> Reach {
        let mut all = Vec::new();
        let mut keep =
            |index: u32, posture: &Posture| all.push(self.branch(index, posture, target, approach));
        let by = match &self.kernel {
            Kernel::Numeric(_) => return self.converged(target, approach),
            Kernel::Locked(locked) => {
                let each = locked.values.iter().enumerate();
                let gaps = each.map(|(k, v)| {
                    self.solve_locked((locked, locked.quick()), (k, *v), target, approach, &mut keep)
                });
                let by = gaps.fold(f64::INFINITY, f64::min);
                if all.iter().any(Branch::is_usable) {
                    by
                } else {
                    // Between the values that are tried.
                    let keep = |index, posture: &Posture| {
                        all.push(self.branch(index, posture, target, approach));
                    };
                    self.unlock(locked, target, approach, keep).reach
                }
            }
            _ => self.solve(target, approach, &mut self.scratch(), &mut keep),
        };
        if all.is_empty() { Reach::OutOfReach { by } } else { Reach::Branches(all) }
    }

    fn branch(&self, index: u32, posture: &Posture, target: &Vector3<f64>, approach: &Approach) -> Branch {
        let off = self.off(posture, target, approach);
        let (joints, violation) = match &self.limits {
            Some(limits) => {
                let (joints, violation) = limits.joints(posture);
                // One judge for search and map: the sum in `excess`.
                (joints, if limits.excess(posture) == 0.0 { None } else { Some(violation) })
            }
            None => ([0.0; MAX_JOINTS], None),
        };
        Branch { index, joints, posture: *posture, violation, off }
    }

    /// What a posture has too much of: joint limits, and attitude that the arm cannot choose.
    #[inline]
    pub(super) fn excess(&self, posture: &Posture, target: &Vector3<f64>, approach: &Approach) -> f64 {
        let limits = self.limits.as_ref().map_or(0.0, |limits| limits.excess(posture));
        limits + self.off(posture, target, approach)
    }

    #[inline]
    fn off(&self, posture: &Posture, target: &Vector3<f64>, approach: &Approach) -> f64 {
        let rolls = match &self.kernel {
            Kernel::Planar(arm) => arm.rolls(),
            _ => return 0.0,
        };
        if !approach.hold.is_checked(rolls) {
            return 0.0;
        }
        let columns = self.chain.forward(posture).rotation * self.tool_rows.transpose();
        approach.hold.off(&columns, target, rolls)
    }

    /// The geometry alone; returns how many metres the nearest branch misses (0: there is one).
    #[inline]
    fn solve(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        posture: &mut Posture,
        found: &mut impl FnMut(u32, &Posture),
    ) -> f64 {
        match &self.kernel {
            Kernel::Planar(arm) => {
                let moved = self.to_zero.as_ref().map(|pose| pose.transform(target));
                arm.solve(moved.as_ref().unwrap_or(target), (&approach.hold, &approach.ways), posture, found)
            }
            Kernel::Pose(_) => (0..approach.hold.columns.len())
                .map(|k| self.solve_one(k, target, approach, posture, found))
                .fold(f64::INFINITY, f64::min),
            Kernel::Locked(_) | Kernel::Numeric(_) => f64::INFINITY,
        }
    }

    /// One attitude of an arm that takes whole poses.
    #[inline]
    fn solve_one(
        &self,
        k: usize,
        target: &Vector3<f64>,
        approach: &Approach,
        posture: &mut Posture,
        found: &mut impl FnMut(u32, &Posture),
    ) -> f64 {
        let Kernel::Pose(kernel) = &self.kernel else { return f64::INFINITY };
        let flange = self.flange(k, target, approach);
        kernel.solve(&flange, posture, &mut |branch, posture| {
            found((k as u32) << 4 | u32::from(branch), posture)
        })
    }

    /// The last D-H frame in frame 0 with the tool at a target in its k-th attitude.
    #[inline]
    pub(super) fn flange(&self, k: usize, target: &Vector3<f64>, approach: &Approach) -> Pose {
        let rotation = approach.hold.columns_at(k, target) * self.tool_rows;
        let flange = Pose { rotation, translation: *target } * self.to_flange;
        match &self.to_zero {
            Some(to_zero) => *to_zero * flange,
            None => flange,
        }
    }
}
