//! Inverse kinematics of any chain: the closed form of its family, or else the numeric one; with all
//! attitudes of an operation, joint limits, and the choice that a redundant arm leaves.

use super::hold::Hold;
use super::kernel::{Kernel, Locked};
use super::limits::{LimitViolation, Limits};
use super::numeric::{Goal, Held, Missing};
use super::planar::{Way, template};
use crate::cell::{Attitude, JointVector, MAX_JOINTS, tool_columns};
use crate::pose::Pose;
use crate::robot::{Chain, Posture};
use nalgebra::{Matrix3, Vector3};

/// An interval in which a redundant joint might still find a posture is cut into finer and finer parts.
const ROUNDS: usize = 5;
const INSIDE: usize = 11;

/// A target nearer to reach than this may be in reach somewhere between, m.
const GRAZING: f64 = 0.01;

/// An arm made ready.
#[derive(Debug, Clone)]
pub struct Inverse {
    pub(super) chain: Chain,
    pub(super) kernel: Kernel,
    /// None of a chain whose limits a posture alone cannot tell: the numeric way keeps them itself.
    limits: Option<Limits>,
    /// From the base to frame 0; None if they are one.
    to_zero: Option<Pose>,
    /// From the TCP to the last D-H frame.
    to_flange: Pose,
    /// Rows r, a x r, a of the tool in its own frame.
    tool_rows: Matrix3<f64>,
    /// The elevation that the arm keeps by its build, rad.
    pub(super) kept: Option<f64>,
    template: Posture,
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

    /// Whether there is no closed form: a target costs a thousand times as much.
    pub fn is_numeric(&self) -> bool {
        matches!(self.kernel, Kernel::Numeric(_))
    }

    /// Whether a target costs more than the closed form of the planar arm.
    pub fn is_dear(&self) -> bool {
        !matches!(self.kernel, Kernel::Planar(_))
    }

    /// The ways to hold the tool over a surface turned by `yaw` (rad) in the base frame.
    pub fn approach(&self, attitude: &Attitude, yaw: f64) -> Approach {
        let mut approach = Approach::default();
        self.set(&mut approach, attitude, yaw);
        approach
    }

    /// [`Self::approach`] into memory that is kept.
    pub fn set(&self, approach: &mut Approach, attitude: &Attitude, yaw: f64) {
        approach.hold.set(attitude, yaw, self.kept);
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
        let mut any = false;
        let mut judge = |_: u32, posture: &Posture| {
            any = any || self.excess(posture, target, approach) == 0.0;
        };
        match &self.kernel {
            Kernel::Pose(_) => (0..approach.hold.columns.len()).any(|k| {
                let mut found = false;
                self.solve_one(k, target, approach, scratch, &mut |_, posture: &Posture| {
                    found = found || self.excess(posture, target, approach) == 0.0;
                });
                found
            }),
            Kernel::Locked(locked) => locked.values.iter().enumerate().any(|(k, value)| {
                let mut found = false;
                self.solve_locked(locked, (k, *value), target, approach, &mut |_, posture: &Posture| {
                    found = found || self.excess(posture, target, approach) == 0.0;
                });
                found
            }),
            Kernel::Planar(_) => {
                self.solve(target, approach, scratch, &mut judge);
                any
            }
            Kernel::Numeric(_) => {
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
                self.solve_locked(locked, (k, locked.values[k]), target, approach, &mut keep);
            }
            _ => {
                self.visit(target, approach, &mut scratch, keep);
            }
        }
        found
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
                let gaps = each.map(|(k, v)| self.solve_locked(locked, (k, *v), target, approach, &mut keep));
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
    fn excess(&self, posture: &Posture, target: &Vector3<f64>, approach: &Approach) -> f64 {
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
    fn flange(&self, k: usize, target: &Vector3<f64>, approach: &Approach) -> Pose {
        let rotation = approach.hold.columns_at(k, target) * self.tool_rows;
        let flange = Pose { rotation, translation: *target } * self.to_flange;
        match &self.to_zero {
            Some(to_zero) => *to_zero * flange,
            None => flange,
        }
    }

    /// All attitudes with the redundant joint at one value, the k-th; returns the metres missing.
    fn solve_locked(
        &self,
        locked: &Locked,
        (k, value): (usize, f64),
        target: &Vector3<f64>,
        approach: &Approach,
        found: &mut impl FnMut(u32, &Posture),
    ) -> f64 {
        let (held, inverse) = locked.at(value);
        let (mut part, mut posture) = (locked.template, self.template);
        let mut missing = f64::INFINITY;
        for a in 0..approach.hold.columns.len() {
            let flange = locked.rest_of(&self.flange(a, target, approach), &inverse);
            let by = locked.kernel.solve(&flange, &mut part, &mut |branch, part| {
                locked.join(part, &held, &mut posture);
                found((k as u32) << 16 | (a as u32) << 4 | u32::from(branch), &posture);
            });
            missing = missing.min(by);
        }
        missing
    }

    /// [`Self::visit`] of a redundant arm: its values in turn; if none has a posture, between them.
    fn unlock(
        &self,
        locked: &Locked,
        target: &Vector3<f64>,
        approach: &Approach,
        mut found: impl FnMut(u32, &Posture),
    ) -> Gap {
        let mut gap_at = |k: usize, value: f64| {
            let (mut limits, mut usable) = (f64::INFINITY, false);
            let reach = self.solve_locked(locked, (k, value), target, approach, &mut |index, posture| {
                let excess = self.excess(posture, target, approach);
                limits = limits.min(excess);
                if excess == 0.0 {
                    usable = true;
                    found(index, posture);
                }
            });
            (Gap { reach, limits: if reach > 0.0 { 0.0 } else { limits } }, usable)
        };
        let mut any = false;
        let gaps: [Gap; Locked::STEPS] = std::array::from_fn(|k| {
            let (gap, usable) = gap_at(k, locked.values[k]);
            any |= usable;
            gap
        });
        let least = (0..gaps.len()).fold(0, |least, k| if gaps[k].is_less(&gaps[least]) { k } else { least });
        if any || gaps[least].reach > locked.near() {
            return gaps[least];
        }
        // Every dip of the gap may hide a posture.
        let (mut best, last) = (gaps[least], gaps.len() - 1);
        for k in 0..gaps.len() {
            let higher = |other: usize| !gaps[other].is_less(&gaps[k]);
            if (k == 0 || higher(k - 1)) && (k == last || higher(k + 1)) {
                let (mut lo, mut hi) = (locked.values[k.saturating_sub(1)], locked.values[(k + 1).min(last)]);
                for _ in 0..ROUNDS {
                    let (step, mut nearest) = ((hi - lo) / (INSIDE + 1) as f64, (Gap::ALL, lo));
                    for inner in 1..=INSIDE {
                        let value = lo + step * inner as f64;
                        let (gap, usable) = gap_at(gaps.len() + k, value);
                        if usable {
                            return gap;
                        }
                        nearest = if gap.is_less(&nearest.0) { (gap, value) } else { nearest };
                    }
                    best = if nearest.0.is_less(&best) { nearest.0 } else { best };
                    (lo, hi) = (nearest.1 - step, nearest.1 + step);
                }
            }
        }
        if best.reach > GRAZING {
            return best;
        }
        // A window too narrow for all that: the numeric way walks along the edge of the reach.
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            if let Some(q) = locked.numeric.one(goal) {
                let posture = self.chain.posture(&q);
                if self.excess(&posture, target, approach) == 0.0 {
                    found(((2 * gaps.len()) << 16 | k) as u32, &posture);
                    return Gap { reach: 0.0, limits: 0.0 };
                }
            }
        }
        best
    }
}

/// The numeric way: its answers keep the limits themselves.
impl Inverse {
    fn converge(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        mut found: impl FnMut(u32, &Posture),
    ) -> Gap {
        let mut joints = Vec::new();
        let mut gap = Gap::ALL;
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            let missed = match self.numeric(goal, &mut joints) {
                Missing::None => Gap { reach: 0.0, limits: 0.0 },
                Missing::OutOfReach { by } => Gap { reach: by, limits: 0.0 },
                Missing::Attitude { by, .. } => Gap { reach: 0.0, limits: by },
                Missing::NotConverged { position, angle } => Gap { reach: 0.0, limits: position + angle },
            };
            gap = if missed.is_less(&gap) { missed } else { gap };
            for (i, q) in joints.iter().enumerate() {
                found((k << 8 | i) as u32, &self.chain.posture(q));
            }
        }
        gap
    }

    fn converged(&self, target: &Vector3<f64>, approach: &Approach) -> Reach {
        let (mut all, mut joints, mut nearest) = (Vec::new(), Vec::new(), Missing::None);
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            let missed = self.numeric(goal, &mut joints);
            if matches!(nearest, Missing::None) || matches!(missed, Missing::Attitude { .. }) {
                nearest = missed;
            }
            all.extend(joints.iter().enumerate().map(|(i, q)| Branch {
                index: (k << 8 | i) as u32,
                joints: *q,
                posture: self.chain.posture(q),
                violation: None,
                off: 0.0,
            }));
        }
        match nearest {
            _ if !all.is_empty() => Reach::Branches(all),
            Missing::None => Reach::OutOfReach { by: 0.0 },
            Missing::OutOfReach { by } => Reach::OutOfReach { by },
            Missing::Attitude { by, joint } => Reach::Attitude { by, joint },
            Missing::NotConverged { position, angle } => Reach::NotConverged { position, angle },
        }
    }

    fn numeric(&self, goal: &Goal, joints: &mut Vec<JointVector>) -> Missing {
        joints.clear();
        match &self.kernel {
            Kernel::Numeric(numeric) => numeric.all(goal, joints),
            _ => Missing::None,
        }
    }

    /// What is asked of the TCP: free angles are left to the solver.
    fn goals(&self, target: &Vector3<f64>, approach: &Approach) -> Vec<Goal> {
        let hold = &approach.hold;
        let goal = |attitude| Goal { position: *target, attitude };
        if hold.spin_is_free && hold.azimuth_is_free {
            return hold.elevations.iter().map(|e| goal(Held::Elevation(*e))).collect();
        }
        // All spins have the same tool axis.
        let step = if hold.spin_is_free { hold.columns_per_azimuth() } else { 1 };
        let columns = (0..hold.columns.len()).step_by(step).map(|k| hold.columns_at(k, target));
        let held = |columns: Matrix3<f64>| match hold.spin_is_free {
            true => Held::Axis(columns.column(2).into_owned()),
            false => Held::Rotation(columns * self.tool_rows),
        };
        columns.map(|columns| goal(held(columns))).collect()
    }
}
