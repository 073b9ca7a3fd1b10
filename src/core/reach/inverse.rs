//! Inverse kinematics of any chain, with all attitudes of an operation, joint limits and redundancy
//! resolution.
//!
//! The solver is a closed form if the chain has one. Otherwise the solver scans one joint, refines the closed
//! form of a similar chain, eliminates variables, or iterates numerically.

use super::branch::{Branch, Cost, Gap, Reach};
use super::fixed_elevation::fixed_elevation;
use super::limits::Limits;
use super::numeric::Numeric;
use super::solver::ChainSolver;
use super::spin_joint::SpinJoint;
use super::tool_attitudes::ToolAttitudes;
use crate::cell::{Attitude, JointVector, MAX_JOINTS, tool_columns};
use crate::pose::Pose;
use crate::robot::{Chain, Posture};
use nalgebra::{Matrix3, Vector3};

/// Inverse kinematics of one arm.
///
/// The lowest bits of a branch index hold the number of the solution, and the bits above hold the index of
/// the attitude. For a redundant arm, the bits from 16 on hold the value of the redundant joint. This value
/// is a number of small equal steps from the lower end of the range. The bits from 40 on hold the rotation
/// from a sampled free spin towards the next one, in small equal steps ([`Self::moved`]).
#[derive(Debug, Clone)]
pub struct Inverse {
    pub(super) chain: Chain,
    pub(super) solver: ChainSolver,
    /// Joint limits; None if the sines and cosines of a posture do not determine whether it keeps the limits.
    ///
    /// If this field is None, the numeric solver solves the chain within the limits.
    pub(super) limits: Option<Limits>,
    /// Pose of the base frame in D-H frame 0; None if the two frames coincide.
    pub(super) to_zero: Option<Pose>,
    /// Pose of the last D-H frame in the frame of the TCP.
    to_flange: Pose,
    /// Matrix with the rows r, a x r and a, in the frame of the TCP.
    ///
    /// The vector a is the tool axis, and r is the reference axis of the tool.
    pub(super) tool_rows: Matrix3<f64>,
    /// Elevation of the tool axis, rad, if it is the same in every posture; otherwise None.
    pub(super) fixed_elevation: Option<f64>,
    pub(super) template: Posture,
    /// Last joint, if it alone rotates the tool about the tool axis; None if other joints must move, too.
    pub(super) last_joint: Option<SpinJoint>,
    /// Numeric solver that [`Inverse::continued`] uses. None if `solver` is numeric itself, or finds the
    /// posture at a neighbouring target by its branch index.
    pub(super) follower: Option<Box<Numeric>>,
}

impl Inverse {
    /// Prepares the inverse kinematics of a chain.
    pub fn new(chain: &Chain) -> Self {
        let limits = Limits::new(chain);
        let solver = ChainSolver::new(chain, limits.is_ok());
        let last_joint = SpinJoint::new(chain).filter(|_| solver.solves_last_joint());
        Self {
            to_zero: (chain.mount != Pose::identity()).then(|| chain.mount.inverse()),
            to_flange: chain.tool.inverse(),
            tool_rows: tool_columns(&chain.tool_axis).transpose(),
            fixed_elevation: fixed_elevation(chain),
            template: chain.zero_posture(),
            chain: chain.clone(),
            limits: limits.ok(),
            follower: solver.follower(chain),
            solver,
            last_joint,
        }
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        self.solver.family()
    }

    /// Returns the inverse kinematics with the redundant joint fixed at its coordinate in `q`.
    ///
    /// An arm without a redundant joint is returned unchanged.
    pub fn held_at(&self, q: &JointVector) -> Self {
        let mut inverse = self.clone();
        if let ChainSolver::Redundant(joint) = &mut inverse.solver {
            joint.hold(q);
        }
        inverse
    }

    /// Returns the chain that this inverse kinematics solves.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Returns the elevation of the tool axis (rad) if it is the same in every posture; otherwise None.
    pub fn fixed_elevation(&self) -> Option<f64> {
        self.fixed_elevation
    }

    /// Returns the class of the solver according to its computing time per target.
    pub fn cost(&self) -> Cost {
        match &self.solver {
            ChainSolver::Planar(_) => Cost::Low,
            ChainSolver::Pose(solver) if solver.is_closed_form() => Cost::Middle,
            ChainSolver::Pose(_) | ChainSolver::Redundant(_) => Cost::High,
            ChainSolver::Numeric(_) => Cost::Numeric,
        }
    }

    /// Returns the allowed tool attitudes over a surface rotated by `yaw` (rad) in the base frame.
    pub fn tool_attitudes(&self, attitude: &Attitude, yaw: f64) -> ToolAttitudes {
        let mut attitudes = ToolAttitudes::default();
        self.set_attitudes(&mut attitudes, attitude, yaw);
        attitudes
    }

    /// Writes the result of [`Self::tool_attitudes`] into `attitudes`, and reuses the memory of `attitudes`.
    pub fn set_attitudes(&self, attitudes: &mut ToolAttitudes, attitude: &Attitude, yaw: f64) {
        let ToolAttitudes { set, planar } = attitudes;
        set.update(attitude, yaw, self.fixed_elevation);
        match &self.solver {
            ChainSolver::Planar(arm) => arm.attitudes(set, planar),
            _ => {
                set.update_columns(attitude, yaw);
                set.update_spin_turns(self.last_joint.is_some());
            }
        }
    }

    /// Returns a posture that a caller passes to [`Self::visit`] as working memory. The posture holds the
    /// constant D-H values of the chain.
    pub fn scratch(&self) -> Posture {
        self.template
    }

    /// Calls `found` with every branch that stays within the joint limits and meets the required attitude.
    ///
    /// Returns the [`Gap`] of the target: its distance from a usable posture.
    ///
    /// `target` is the position of the TCP in the base frame, m. Closed forms allocate no memory, because a
    /// search calls this function for every node.
    #[inline]
    pub fn visit(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        scratch: &mut Posture,
        mut found: impl FnMut(u64, &Posture),
    ) -> Gap {
        let mut least = f64::INFINITY;
        let mut judge = |index: u64, posture: &Posture| {
            let excess = self.excess(posture, target, attitudes);
            least = least.min(excess);
            if excess == 0.0 {
                found(index, posture);
            }
        };
        let reach = match &self.solver {
            ChainSolver::Numeric(_) => return self.visit_numeric(target, attitudes, found),
            ChainSolver::Redundant(joint) => {
                return self.visit_redundant(joint, target, attitudes, &mut found);
            }
            _ => self.solve(target, attitudes, scratch, &mut judge),
        };
        Gap { reach, limits: if reach > 0.0 { 0.0 } else { least } }
    }

    /// Returns whether any branch stays within the joint limits and meets the required attitude.
    ///
    /// If the solver solves for a complete pose of the flange, the search stops at the first attitude with a
    /// usable branch. For a redundant arm, the search stops at the first sampled joint value with a usable
    /// branch. Joint values between the samples are not tried.
    pub fn reaches(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes, scratch: &mut Posture) -> bool {
        let usable = |posture: &Posture| self.excess(posture, target, attitudes) == 0.0;
        match &self.solver {
            ChainSolver::Planar(_) => {
                let mut any = false;
                self.solve(target, attitudes, scratch, &mut |_, posture: &Posture| {
                    any = any || usable(posture)
                });
                any
            }
            ChainSolver::Pose(_) => attitudes.set.solved().any(|first| {
                let mut any = false;
                let mut judge = |_: u64, posture: &Posture| any = any || usable(posture);
                self.solve_spins(first, target, attitudes, scratch, &mut judge);
                any
            }),
            ChainSolver::Redundant(joint) => joint.samples().any(|sample| {
                let mut any = false;
                let mut judge = |_: u64, posture: &Posture| any = any || usable(posture);
                self.solve_held(&sample, target, attitudes, &mut judge);
                any
            }),
            ChainSolver::Numeric(numeric) => {
                self.goals(target, attitudes).iter().any(|goal| numeric.one(goal).is_some())
            }
        }
    }

    /// Returns every branch with its joint coordinates, including branches outside the joint limits.
    ///
    /// The numeric solver finds only branches within the limits.
    pub fn branches(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> Reach {
        let mut all = Vec::new();
        let mut keep =
            |index: u64, posture: &Posture| all.push(self.branch(index, posture, target, attitudes));
        let by = match &self.solver {
            ChainSolver::Numeric(_) => return self.numeric_branches(target, attitudes),
            ChainSolver::Redundant(joint) => {
                for sample in joint.samples() {
                    self.solve_held(&sample, target, attitudes, &mut keep);
                }
                if all.iter().any(Branch::is_usable) {
                    0.0
                } else {
                    // Usable branches may lie between the sampled values.
                    let mut keep = |index: u64, posture: &Posture| {
                        all.push(self.branch(index, posture, target, attitudes));
                    };
                    self.visit_redundant(joint, target, attitudes, &mut keep).reach
                }
            }
            _ => self.solve(target, attitudes, &mut self.scratch(), &mut keep),
        };
        if self.last_joint.is_some() {
            // All spins of one solution were found together. A stable sort orders the branches by attitude.
            all.sort_by_key(|branch| branch.index >> 4);
        }
        match &self.follower {
            Some(_) if all.is_empty() && !self.keeps_branches() => self.reason(target, attitudes),
            _ if all.is_empty() => Reach::OutOfReach { by },
            _ => Reach::Branches(all),
        }
    }

    /// Returns the branch with the index `index` and the posture `posture`.
    ///
    /// For the numeric solver, [`Self::branch_at`] must be called instead.
    pub fn branch(
        &self,
        index: u64,
        posture: &Posture,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Branch {
        let off = self.off(posture, target, attitudes);
        let (joints, violation) = match &self.limits {
            Some(limits) => {
                let (joints, violation) = limits.joints(posture);
                // `excess` decides here as in `visit`, so that both functions agree on a posture near its
                // limit.
                (joints, if limits.excess(posture) == 0.0 { None } else { Some(violation) })
            }
            None => ([0.0; MAX_JOINTS], None),
        };
        Branch { index, joints, posture: *posture, violation, off }
    }

    /// Returns a measure of how far a posture violates the joint limits and the required attitude; 0 if it
    /// violates neither.
    #[inline]
    pub(super) fn excess(&self, posture: &Posture, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> f64 {
        let limits = self.limits.as_ref().map_or(0.0, |limits| limits.excess(posture));
        limits + self.off(posture, target, attitudes)
    }

    /// Returns the part of the attitude error that exceeds the tolerance, rad.
    ///
    /// The result is 0 for an arm that can choose the attitude.
    #[inline]
    fn off(&self, posture: &Posture, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> f64 {
        let rolls = match &self.solver {
            ChainSolver::Planar(arm) => arm.rolls(),
            _ => return 0.0,
        };
        if !attitudes.set.is_checked(rolls) {
            return 0.0;
        }
        let columns = self.chain.forward(posture).rotation * self.tool_rows.transpose();
        attitudes.set.off(&columns, target, rolls)
    }

    /// Solves the geometry without joint limits, for all attitudes, and calls `found` with every branch.
    ///
    /// Returns the distance of the target from the nearest reachable point, m; 0 if a branch exists.
    #[inline]
    pub(super) fn solve(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        posture: &mut Posture,
        found: &mut impl FnMut(u64, &Posture),
    ) -> f64 {
        match &self.solver {
            ChainSolver::Planar(arm) => {
                arm.solve(&self.in_frame_0(target), attitudes, attitudes.set.spins.len(), posture, found)
            }
            ChainSolver::Pose(_) => attitudes
                .set
                .solved()
                .map(|first| self.solve_spins(first, target, attitudes, posture, found))
                .fold(f64::INFINITY, f64::min),
            ChainSolver::Redundant(_) | ChainSolver::Numeric(_) => f64::INFINITY,
        }
    }

    /// Converts a point (m) from the base frame of a planar arm to D-H frame 0.
    pub(super) fn in_frame_0(&self, target: &Vector3<f64>) -> Vector3<f64> {
        self.to_zero.as_ref().map_or(*target, |pose| pose.transform(target))
    }

    /// Solves attitude `first` of an arm with a solver of whole poses (`ChainSolver::Pose`). Also derives the
    /// attitudes that follow from attitude `first` by a rotation of the last joint.
    ///
    /// Returns the distance of the target from the nearest reachable point, m.
    #[inline]
    pub(super) fn solve_spins(
        &self,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        posture: &mut Posture,
        found: &mut impl FnMut(u64, &Posture),
    ) -> f64 {
        let ChainSolver::Pose(solver) = &self.solver else { return f64::INFINITY };
        let flange = self.flange(first, target, attitudes);
        solver.solve(&flange, posture, &mut |branch, posture| {
            self.spin(first, attitudes, posture, &mut |k, posture| {
                found((k as u64) << 4 | u64::from(branch), posture);
            });
        })
    }

    /// Calls `found` with the posture of the solved attitude `first`. Also calls it with every posture that
    /// follows by a rotation of the last joint.
    #[inline]
    pub(super) fn spin(
        &self,
        first: usize,
        attitudes: &ToolAttitudes,
        posture: &Posture,
        found: &mut impl FnMut(usize, &Posture),
    ) {
        let Some(joint) = &self.last_joint else { return found(first, posture) };
        for (k, turn) in attitudes.set.spun(first) {
            found(k, &joint.turned(posture, &turn));
        }
    }

    /// Returns the pose of the last D-H frame in frame 0 when the tool is at `target` in attitude `k`.
    #[inline]
    pub(super) fn flange(&self, k: usize, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> Pose {
        self.flange_of(&attitudes.set.columns_at(k, target), target)
    }

    /// Returns the pose of the last D-H frame in frame 0 when the tool is at `target`. `columns` is the
    /// rotation matrix of the tool in the base frame ([`tool_columns`]).
    #[inline]
    pub(super) fn flange_of(&self, columns: &Matrix3<f64>, target: &Vector3<f64>) -> Pose {
        let rotation = columns * self.tool_rows;
        let flange = Pose { rotation, translation: *target } * self.to_flange;
        match &self.to_zero {
            Some(to_zero) => *to_zero * flange,
            None => flange,
        }
    }
}
