//! Spin families: the postures of one solution that differ only by the rotation of the tool about its axis.
//!
//! If the last joint alone rotates the tool about its axis, all other joints have the same coordinates within
//! a family. Every quantity that depends only on these joints is computed once per family.

use super::closed_form::planar;
use super::inverse::Inverse;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Result of a visit to the spin families of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FamilyReach {
    /// The families contain every usable branch. For a redundant arm, they contain every usable branch at the
    /// sampled values of the redundant joint. If the families of a redundant arm contain no usable branch, no
    /// value of the redundant joint has a usable branch.
    Complete,
    /// No sampled value of the redundant joint has a usable branch. Usable branches may exist between the
    /// sampled values ([`Inverse::visit_between_samples`]).
    OnlyBetweenSamples {
        /// Whether the target is within reach at a sampled value when the joint limits are ignored.
        is_solved: bool,
    },
}

impl Inverse {
    /// Returns whether [`Self::visit_families`] supports this arm and these attitudes.
    ///
    /// A spin family is a set of postures that differ only by the rotation of the tool about its axis.
    ///
    /// A planar arm qualifies only if it can roll its tool and the attitude has no tolerance. If the tool is
    /// tilted within a tolerance, the roll angle between two members of a family is not the difference of
    /// their spins.
    pub fn has_spin_families(&self, attitudes: &ToolAttitudes) -> bool {
        match &self.solver {
            ChainSolver::Planar(arm) => arm.rolls() && attitudes.set.tolerance == 0.0,
            ChainSolver::Pose(_) | ChainSolver::Redundant(_) => true,
            ChainSolver::Numeric(_) => false,
        }
    }

    /// Calls `found` with the first member of each spin family ([`Self::has_spin_families`]). A family is
    /// skipped if a joint other than the last exceeds its limit in the first member.
    ///
    /// The limit of the last joint is not checked here; [`Self::members`] checks it. The first argument of
    /// `found` is the branch index of the first member.
    ///
    /// The numeric solver has no families.
    pub fn visit_families(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        scratch: &mut Posture,
        mut found: impl FnMut(u64, &Posture),
    ) -> FamilyReach {
        let set = &attitudes.set;
        let keeps =
            |p: &Posture| self.limits.as_ref().is_none_or(|limits| limits.excess_before_last(p) == 0.0);
        match &self.solver {
            ChainSolver::Planar(arm) => {
                arm.solve(
                    &self.in_frame_0(target),
                    attitudes,
                    1,
                    scratch,
                    &mut |index, posture: &Posture| {
                        if keeps(posture) {
                            found(index, posture);
                        }
                    },
                );
                FamilyReach::Complete
            }
            ChainSolver::Pose(solver) => {
                for first in set.solved() {
                    let flange = self.flange(first, target, attitudes);
                    solver.solve(&flange, scratch, &mut |branch, posture| {
                        if keeps(posture) {
                            found((first as u64) << 4 | u64::from(branch), posture);
                        }
                    });
                }
                FamilyReach::Complete
            }
            ChainSolver::Redundant(joint) => {
                let never = |first: usize| joint.never_reaches(&self.flange(first, target, attitudes));
                if set.solved().all(never) {
                    return FamilyReach::Complete;
                }
                let (mut is_reached, mut is_solved) = (false, false);
                for sample in joint.samples() {
                    for first in set.solved() {
                        let mut keep = |index: u64, posture: &Posture| {
                            if keeps(posture) {
                                is_reached = is_reached || self.any_usable(first, posture, target, attitudes);
                                found(index, posture);
                            }
                        };
                        is_solved |= self.solve_held_one(&sample, first, target, attitudes, &mut keep) == 0.0;
                    }
                }
                if is_reached { FamilyReach::Complete } else { FamilyReach::OnlyBetweenSamples { is_solved } }
            }
            ChainSolver::Numeric(_) => FamilyReach::Complete,
        }
    }

    /// Calls `found` with every usable member of one spin family ([`Self::has_spin_families`]). A member is
    /// usable if it stays within the joint limits and meets the required attitude.
    ///
    /// The tuple identifies the family by the branch index and the posture of its first member.
    /// [`Self::visit_families`] gives both.
    pub fn members(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        scratch: &mut Posture,
        (first, posture): (u64, &Posture),
        mut found: impl FnMut(u64, &Posture),
    ) {
        let mut judge = |index: u64, posture: &Posture| {
            if self.excess(posture, target, attitudes) == 0.0 {
                found(index, posture);
            }
        };
        match &self.solver {
            ChainSolver::Planar(arm) => {
                *scratch = *posture;
                let spins = 0..attitudes.set.spins.len();
                arm.spun(&self.in_frame_0(target), attitudes, spins, (first, scratch), judge);
            }
            ChainSolver::Pose(_) | ChainSolver::Redundant(_) => {
                self.spin(self.attitude_of(first), attitudes, posture, &mut |k, posture| {
                    judge(self.with_attitude(first, k), posture);
                });
            }
            ChainSolver::Numeric(_) => {}
        }
    }

    /// Returns the branch index and the posture of the first usable member of a spin family
    /// ([`Self::members`]). The tuple holds the branch index of any member, and the posture of the first
    /// member. Returns None if no member is usable.
    pub fn first_member(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        family: (u64, &Posture),
    ) -> Option<(u64, Posture)> {
        self.member_from(0, target, attitudes, family)
    }

    /// Returns the first usable member of a spin family after the member with the branch index `branch`.
    /// `first` is the posture of the first member.
    pub fn next_member(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        (branch, first): (u64, &Posture),
    ) -> Option<(u64, Posture)> {
        let spin = match &self.solver {
            ChainSolver::Planar(_) => planar::spin_of(branch),
            _ => attitudes.set.spin_index(self.attitude_of(branch)).1,
        };
        self.member_from(spin + 1, target, attitudes, (branch, first))
    }

    /// Returns the first usable member of a spin family whose spin has at least the index `spin`.
    fn member_from(
        &self,
        spin: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        (branch, first): (u64, &Posture),
    ) -> Option<(u64, Posture)> {
        (spin..attitudes.set.spins.len()).find_map(|spin| {
            let branch = self.member_branch(attitudes, branch, spin)?;
            let member = self.member(target, attitudes, branch, first)?;
            (self.excess(&member, target, attitudes) == 0.0).then_some((branch, member))
        })
    }

    /// Returns the branch index of the member with the given spin (an index), in the family of the branch
    /// `branch`. Returns None if the family has no such member.
    pub fn member_branch(&self, attitudes: &ToolAttitudes, branch: u64, spin: usize) -> Option<u64> {
        if let ChainSolver::Planar(_) = &self.solver {
            return Some(planar::with_spin(branch, spin));
        }
        let set = &attitudes.set;
        let solved = |k: usize| set.spin_turns.get(k).map(|turn| turn.first);
        let attitude = self.attitude_of(branch);
        let k = set.with_spin(set.spin_index(attitude).0, spin);
        (solved(k)? == solved(attitude)?).then(|| self.with_attitude(branch, k))
    }

    /// Returns the posture of one member of a spin family. `branch` is the branch index of this member, and
    /// `first` is the posture of the first member. Returns None if the family has no such member.
    pub fn member(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        branch: u64,
        first: &Posture,
    ) -> Option<Posture> {
        match &self.solver {
            ChainSolver::Pose(_) | ChainSolver::Redundant(_) => {
                let turn = attitudes.set.spin_turns.get(self.attitude_of(branch))?;
                Some(self.last_joint.as_ref().map_or(*first, |joint| joint.turned(first, turn)))
            }
            ChainSolver::Planar(arm) => {
                let (mut posture, mut member) = (*first, None);
                let spin = planar::spin_of(branch);
                let of_family = (branch, &mut posture);
                arm.spun(&self.in_frame_0(target), attitudes, spin..spin + 1, of_family, |_, posture| {
                    member = Some(*posture);
                });
                member
            }
            ChainSolver::Numeric(_) => self.posture(target, attitudes, branch),
        }
    }

    /// Returns whether any member of the spin family of `posture` stays within the joint limits and meets the
    /// required attitude.
    fn any_usable(
        &self,
        first: usize,
        posture: &Posture,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> bool {
        let mut any = false;
        self.spin(first, attitudes, posture, &mut |_, posture| {
            any = any || self.excess(posture, target, attitudes) == 0.0;
        });
        any
    }
}
