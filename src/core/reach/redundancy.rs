//! Redundancy resolution: one joint is held at sampled values while the other joints are solved.
//!
//! If no sample has a usable posture, values between the samples are tried.

use super::branch::{Gap, with_attitude, with_sample};
use super::held_joint::{HeldJoint, HeldSample};
use super::inverse::Inverse;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::pose::Pose;
use crate::robot::Posture;
use nalgebra::Vector3;

/// One attitude of the tool at one target, for a redundant arm.
#[derive(Clone, Copy)]
pub(super) struct HeldTarget<'a> {
    pub inverse: &'a Inverse,
    pub joint: &'a HeldJoint,
    pub target: &'a Vector3<f64>,
    pub attitudes: &'a ToolAttitudes,
    /// Index of the attitude, which must be among the indices that [`AttitudeSet::solved`] returns.
    pub first: usize,
}

impl Inverse {
    /// Solves the inverse kinematics for all attitudes, with the redundant joint held at one value.
    pub(super) fn solve_held(
        &self,
        sample: &HeldSample<'_>,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u64, &Posture),
    ) {
        for first in attitudes.set.solved() {
            self.solve_held_spins(sample, first, target, attitudes, found);
        }
    }

    /// Solves attitude `first` with the redundant joint held at one value. Also derives the attitudes that
    /// follow from attitude `first` by a rotation of the last joint.
    ///
    /// Returns the distance by which the target is out of reach, m, or a lower bound of it; 0 if there is a
    /// solution.
    pub(super) fn solve_held_spins(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u64, &Posture),
    ) -> f64 {
        self.solve_held_one(sample, first, target, attitudes, &mut |index, posture| {
            self.spin(first, attitudes, posture, &mut |k, posture| found(with_attitude(index, k), posture));
        })
    }

    /// Solves attitude `first` with the redundant joint held at one value.
    ///
    /// Returns the distance by which the target is out of reach, m, or a lower bound of it; 0 if there is a
    /// solution.
    pub(super) fn solve_held_one(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u64, &Posture),
    ) -> f64 {
        self.solve_held_flange(sample, &self.flange(first, target, attitudes), &mut |branch, posture| {
            found(with_sample((first as u64) << 4 | u64::from(branch), sample.number), posture);
        })
    }

    /// Solves one pose of the last D-H frame in frame 0 with the redundant joint held at one value. Calls
    /// `found` with the number and the posture of every solution.
    ///
    /// Returns the distance by which the pose is out of reach, m, or a lower bound of it; 0 if there is a
    /// solution.
    pub(super) fn solve_held_flange(
        &self,
        sample: &HeldSample<'_>,
        flange: &Pose,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let joint = sample.joint;
        let (held, inverse) = joint.at(sample.value);
        let rest = joint.rest_of(flange, &inverse);
        let bound = joint.fast.bound(&rest);
        if bound > 0.0 {
            return bound;
        }
        let (mut part, mut posture) = (joint.template, self.template);
        joint.fast.solve(&rest, &mut part, &mut |branch, part| {
            joint.join(part, &held, &mut posture);
            found(branch, &posture);
        })
    }

    /// Calls `found` with the usable branches of a redundant arm, and returns the [`Gap`] of the target.
    ///
    /// The redundant joint is held at sampled values. If no sample has a usable branch, values between the
    /// samples are tried.
    pub(super) fn visit_redundant(
        &self,
        joint: &HeldJoint,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u64, &Posture),
    ) -> Gap {
        let (mut least, mut any) = (Gap::ALL, false);
        for sample in joint.samples() {
            for first in attitudes.set.solved() {
                let held = HeldTarget { inverse: self, joint, target, attitudes, first };
                let (gap, usable) = held.gap(&sample, found);
                any |= usable;
                least = if gap.is_less(&least) { gap } else { least };
            }
        }
        if any {
            return Gap { reach: 0.0, limits: 0.0 };
        }
        if least.reach > 0.0 {
            least = Gap { reach: self.least_distance(joint, target, attitudes), limits: 0.0 };
        }
        if least.reach > joint.sample_reach() {
            return least;
        }
        for first in attitudes.set.solved() {
            let held = HeldTarget { inverse: self, joint, target, attitudes, first };
            let (gap, usable) = held.search_between(found);
            any |= usable;
            least = if gap.is_less(&least) { gap } else { least };
        }
        if any { Gap { reach: 0.0, limits: 0.0 } } else { least }
    }

    /// For a redundant arm, calls `found` with the usable branches between the sampled values of the
    /// redundant joint. The caller must make sure that no sample has a usable branch.
    ///
    /// `is_solved` is true if the target is within reach at a sample when the joint limits are ignored. For
    /// an arm without a redundant joint, the function finds no branch. This function finds the same branches
    /// as [`Self::visit`], but faster, because it computes no [`Gap`].
    pub fn visit_between_samples(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        is_solved: bool,
        found: &mut dyn FnMut(u64, &Posture),
    ) {
        let ChainSolver::Redundant(joint) = &self.solver else { return };
        let reaches = |first: &usize| !joint.never_reaches(&self.flange(*first, target, attitudes));
        if !attitudes.set.solved().any(|first| reaches(&first)) {
            return;
        }
        if is_solved || self.is_within(joint.sample_reach(), joint, target, attitudes) {
            for first in attitudes.set.solved().filter(reaches) {
                HeldTarget { inverse: self, joint, target, attitudes, first }.find_between(found);
            }
        }
    }

    /// Returns whether the least distance of a target from the reachable points, over all samples and
    /// attitudes, is at most `limit` (m).
    fn is_within(
        &self,
        limit: f64,
        joint: &HeldJoint,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> bool {
        let mut scratch = joint.template;
        let mut is_near = |first: usize, sample: HeldSample<'_>| {
            let rest = self.rest(&sample, first, target, attitudes);
            joint.solver.bound(&rest) <= limit
                && joint.solver.solve(&rest, &mut scratch, &mut |_, _| ()) <= limit
        };
        attitudes.set.solved().any(|first| joint.samples().any(|sample| is_near(first, sample)))
    }

    /// Returns the least distance of a target from the reachable points, m, over all samples and attitudes.
    ///
    /// A distance is computed only if its lower bound is below the least distance so far.
    fn least_distance(&self, joint: &HeldJoint, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> f64 {
        let rest = |(first, sample): (usize, HeldSample<'_>)| self.rest(&sample, first, target, attitudes);
        let rests = || {
            let solved = attitudes.set.solved();
            solved.flat_map(|first| joint.samples().map(move |sample| (first, sample))).map(rest)
        };
        let bounds = rests().map(|rest| (joint.solver.bound(&rest), rest));
        let Some((_, likely)) = bounds.min_by(|a, b| a.0.total_cmp(&b.0)) else { return f64::INFINITY };
        let (mut scratch, mut least) = (joint.template, f64::INFINITY);
        for rest in std::iter::once(likely).chain(rests()) {
            if joint.solver.bound(&rest) < least {
                least = least.min(joint.solver.solve(&rest, &mut scratch, &mut |_, _| ()));
            }
        }
        least
    }

    /// Returns the distance by which the target is out of reach, m, with the redundant joint held at one
    /// value.
    pub(super) fn held_distance(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> f64 {
        sample.joint.distance(sample, &self.flange(first, target, attitudes))
    }

    /// Returns the pose that the joints other than the redundant joint must reach.
    fn rest(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> Pose {
        sample.joint.rest_of(&self.flange(first, target, attitudes), &sample.joint.at(sample.value).1)
    }
}

impl HeldTarget<'_> {
    /// Calls `found` with the usable branches at one value of the redundant joint.
    ///
    /// Returns the [`Gap`] of the target at this value, and whether a usable branch exists. The distance in
    /// the gap may be a lower bound.
    pub fn gap(&self, sample: &HeldSample<'_>, found: &mut dyn FnMut(u64, &Posture)) -> (Gap, bool) {
        let Self { inverse, target, attitudes, first, .. } = *self;
        let (mut limits, mut usable) = (f64::INFINITY, false);
        let reach = inverse.solve_held_spins(sample, first, target, attitudes, &mut |index, posture| {
            let excess = inverse.excess(posture, target, attitudes);
            limits = limits.min(excess);
            if excess == 0.0 {
                usable = true;
                found(index, posture);
            }
        });
        (Gap { reach, limits: if reach > 0.0 { 0.0 } else { limits } }, usable)
    }
}
