//! Branches of the numeric solver: each attitude becomes a goal of the TCP.
//!
//! All solutions of a goal are within the joint limits.
//!
//! If the branches of an arm do not keep their indices, the numeric solver has two more tasks. It computes
//! the posture at a neighbouring target from a given posture. It also finds the reason if the arm's own
//! solver has no solution.

use super::branch::{Branch, Gap, Reach};
use super::inverse::Inverse;
use super::numeric::{AttitudeGoal, Numeric, NumericSolution, PoseMiss, Shortfall, TcpGoal};
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use super::tool_task::best_held;
use crate::cell::JointVector;
use crate::pose::exact_sin_cos;
use crate::robot::Posture;
use nalgebra::{Matrix3, Vector3};

/// Branch index of a posture that follows from another posture by numeric continuation.
pub const CONTINUED: u64 = u64::MAX;

/// Number of bits of a branch index that hold the number of the start posture.
const START_BITS: u32 = 16;

impl Inverse {
    /// Returns whether every branch keeps its index while the target moves, except at singular postures.
    pub fn keeps_branches(&self) -> bool {
        self.solver.keeps_branches()
    }

    /// Returns whether [`Self::continued`] computes the posture at a neighbouring target. Otherwise the
    /// branch index finds this posture.
    pub fn continues_postures(&self) -> bool {
        self.numeric_solver().is_some()
    }

    /// Returns the numeric solver that computes the posture at a neighbouring target; None if the branch
    /// index finds this posture.
    pub(super) fn numeric_solver(&self) -> Option<&Numeric> {
        match &self.solver {
            ChainSolver::Numeric(numeric) => Some(numeric),
            _ => self.follower.as_deref(),
        }
    }

    /// Calls `found` with every branch of the numeric solver; returns the [`Gap`] of the target.
    pub(super) fn visit_numeric(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        mut found: impl FnMut(u64, &Posture),
    ) -> Gap {
        let mut joints = Vec::new();
        let mut gap = Gap::ALL;
        for (k, goal) in self.goals(target, attitudes).iter().enumerate() {
            let missed = match self.numeric(goal, &mut joints) {
                Shortfall::None => Gap { reach: 0.0, limits: 0.0 },
                Shortfall::OutOfReach { by } => Gap { reach: by, limits: 0.0 },
                Shortfall::Attitude { by, .. } => Gap { reach: 0.0, limits: by },
                Shortfall::NotConverged { position, angle } => Gap { reach: 0.0, limits: position + angle },
            };
            gap = if missed.is_less(&gap) { missed } else { gap };
            for solution in &joints {
                found(numeric_index(k, solution), &self.chain.posture(&solution.joints));
            }
        }
        gap
    }

    /// Returns every branch of the numeric solver, or the reason why there is none.
    pub(super) fn numeric_branches(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> Reach {
        let (mut all, mut joints, mut nearest) = (Vec::new(), Vec::new(), Shortfall::None);
        for (k, goal) in self.goals(target, attitudes).iter().enumerate() {
            let missed = self.numeric(goal, &mut joints);
            if is_nearer(&missed, &nearest) {
                nearest = missed;
            }
            all.extend(
                joints.iter().map(|found| self.numeric_branch(numeric_index(k, found), &found.joints)),
            );
        }
        match nearest {
            _ if !all.is_empty() => Reach::Branches(all),
            Shortfall::None => Reach::OutOfReach { by: 0.0 },
            Shortfall::OutOfReach { by } => Reach::OutOfReach { by },
            Shortfall::Attitude { by, joint } => Reach::Attitude { by, joint },
            Shortfall::NotConverged { position, angle } => Reach::NotConverged { position, angle },
        }
    }

    /// Returns the reason why a scan of one joint, or the elimination of `general_six_axes`, finds no branch.
    /// The numeric solver determines whether the position or only the attitude is out of reach.
    pub(super) fn reason(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> Reach {
        match self.numeric_branches(target, attitudes) {
            Reach::NotConverged { position, angle } if position.is_finite() => {
                Reach::Attitude { by: angle, joint: None }
            }
            Reach::Branches(_) => Reach::NotConverged { position: 0.0, angle: 0.0 },
            reason => reason,
        }
    }

    /// Returns the branch with index `wanted`, which the numeric solver has found before; None if no such
    /// branch exists.
    ///
    /// Only the descent that led to this branch is repeated.
    pub(super) fn numeric_branch_at(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        wanted: u64,
    ) -> Option<Branch> {
        let ChainSolver::Numeric(numeric) = &self.solver else { return None };
        let goals = self.goals(target, attitudes);
        let goal = goals.get(usize::try_from(wanted >> START_BITS).ok()?)?;
        let joints = numeric.again(goal, (wanted & ((1 << START_BITS) - 1)) as usize)?;
        Some(self.numeric_branch(wanted, &joints))
    }

    fn numeric_branch(&self, index: u64, joints: &JointVector) -> Branch {
        Branch { index, joints: *joints, posture: self.chain.posture(joints), violation: None, off: 0.0 }
    }

    /// Returns the reference azimuth of a target: a direction in the base frame, rad. If this direction
    /// rotates, all allowed attitudes at the target rotate equally.
    ///
    /// The direction leads from the base axis to the target if the azimuth of the tool is radial. Otherwise,
    /// the direction is fixed in the surface.
    pub fn heading(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> f64 {
        attitudes.set.heading(target)
    }

    /// Starts the numeric solver at the joint coordinates in `from`, and returns the branch that it finds at
    /// `target`.
    ///
    /// If the arm has six or more joints, the tool rotates by `turn` (rad) about the vertical and otherwise
    /// keeps its orientation. If the arm has seven joints, one joint does not move, as in
    /// [`Self::tool_task`]. If the arm has fewer than six joints, the result is the solution nearest to
    /// `from` among all allowed attitudes.
    ///
    /// # Errors
    /// Returns the remaining errors of position and orientation if the numeric solver finds no solution. If
    /// the arm has no such solver ([`Self::continues_postures`]), the function tries nothing, and both errors
    /// are infinite.
    pub fn continued(
        &self,
        from: &JointVector,
        turn: f64,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Result<Branch, PoseMiss> {
        let joints = self.continued_by(Numeric::following, (from, turn), target, attitudes)?;
        Ok(self.numeric_branch(CONTINUED, &joints))
    }

    /// Returns the branch of [`Self::continued`] for an arm whose joints may exceed their limits. Returns None
    /// if no solution is found, or if the arm has only a numeric solver.
    pub fn continued_beyond_limits(
        &self,
        from: &JointVector,
        turn: f64,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Option<Branch> {
        self.follower.as_ref()?;
        let follow = Numeric::following_beyond_limits;
        let joints = self.continued_by(follow, (from, turn), target, attitudes).ok()?;
        Some(self.branch(CONTINUED, &self.chain.posture(&joints), target, attitudes))
    }

    /// Returns the joint coordinates of [`Self::continued`], which `follow` computes for each goal.
    fn continued_by(
        &self,
        follow: impl Fn(&Numeric, &TcpGoal, &JointVector, Option<usize>) -> Result<JointVector, PoseMiss>,
        (from, turn): (&JointVector, f64),
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Result<JointVector, PoseMiss> {
        let Some(numeric) = self.numeric_solver() else { return Err(PoseMiss::UNTRIED) };
        let frames = self.chain.frames(&self.chain.posture(from));
        let (goals, held) = match self.chain.axes() {
            0..6 => (self.goals(target, attitudes), None),
            axes => {
                let rotation = exact_turn(turn) * frames.tcp.rotation;
                let goal = TcpGoal { position: *target, attitude: AttitudeGoal::Rotation(rotation) };
                (vec![goal], (axes == 7).then(|| best_held(&self.chain, &frames)))
            }
        };
        let (mut best, mut missed) = (None, PoseMiss::UNTRIED);
        for goal in &goals {
            match follow(numeric, goal, from, held) {
                Ok(joints) => {
                    let off = joints.iter().zip(from).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    if best.is_none_or(|(least, _)| off < least) {
                        best = Some((off, joints));
                    }
                }
                Err(miss) if miss.position + miss.angle < missed.position + missed.angle => missed = miss,
                Err(_) => {}
            }
        }
        best.map(|(_, joints)| joints).ok_or(missed)
    }

    fn numeric(&self, goal: &TcpGoal, joints: &mut Vec<NumericSolution>) -> Shortfall {
        joints.clear();
        self.numeric_solver().map_or(Shortfall::None, |numeric| numeric.all(goal, joints))
    }

    /// Returns the goals of the TCP for all attitudes.
    ///
    /// If the spin is free, the numeric solver chooses it, so a goal does not prescribe the spin. If spin and
    /// azimuth are free, a goal prescribes only the elevation. If only the azimuth is free, there is one goal
    /// per sampled azimuth.
    pub(super) fn goals(&self, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> Vec<TcpGoal> {
        let set = &attitudes.set;
        let goal = |attitude| TcpGoal { position: *target, attitude };
        if set.spin_is_free && set.azimuth_is_free {
            return set.elevations.iter().map(|e| goal(AttitudeGoal::Elevation(*e))).collect();
        }
        // If the spin is free, one goal per tool axis is enough.
        let step = if set.spin_is_free { set.columns_per_azimuth() } else { 1 };
        let columns = (0..set.columns.len()).step_by(step).map(|k| set.columns_at(k, target));
        let held = |columns: Matrix3<f64>| match set.spin_is_free {
            true => AttitudeGoal::Axis(columns.column(2).into_owned()),
            false => AttitudeGoal::Rotation(columns * self.tool_rows),
        };
        columns.map(|columns| goal(held(columns))).collect()
    }
}

/// Returns the branch index of a numeric solution. The lowest bits hold the number of the start posture, and
/// the bits above hold the number of the goal.
fn numeric_index(goal: usize, found: &NumericSolution) -> u64 {
    (goal as u64) << START_BITS | found.start as u64
}

/// Returns the matrix of a rotation by `angle` (rad) about z.
fn exact_turn(angle: f64) -> Matrix3<f64> {
    let (sin, cos) = exact_sin_cos(angle);
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// Returns whether `a` is nearer to a solution than `b`.
///
/// A missed attitude is nearest, a search that did not converge is next, and a target out of reach is
/// farthest. Within one of these three classes, the shortfall with the smaller distance or angle is nearer.
/// For a search that did not converge, the sum of distance and angle is compared.
fn is_nearer(a: &Shortfall, b: &Shortfall) -> bool {
    let key = |missing: &Shortfall| match missing {
        Shortfall::Attitude { by, .. } => (0, *by),
        Shortfall::NotConverged { position, angle } => (1, position + angle),
        Shortfall::OutOfReach { by } => (2, *by),
        Shortfall::None => (3, 0.0),
    };
    key(a) < key(b)
}
