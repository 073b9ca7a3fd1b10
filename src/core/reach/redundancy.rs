//! Redundancy resolution: one joint is held at sampled values while the other joints are solved.
//!
//! If no sample has a usable posture, values between samples are searched.

use super::branch::{Gap, with_attitude};
use super::held_joint::{HeldJoint, HeldSample};
use super::inverse::Inverse;
use super::tool_attitudes::ToolAttitudes;
use crate::pose::Pose;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Number of lattice steps between the values of the held joint that the search between samples scans.
const SCAN_STEP: u32 = HeldJoint::SAMPLE_STEP / 7;

/// Number of values that the scan tries.
const SCAN: usize = (HeldJoint::LATTICE / SCAN_STEP) as usize + 1;

/// Violation of limits (rad, m or cosine) above which no usable posture is expected one step of the scan away.
const HOPELESS: f64 = 0.5;

/// Number of times that the search for a reached value divides an interval.
const MAX_PARTS: usize = 100;

/// Smaller part of an interval that is divided by the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// One attitude of the tool at one target, for an arm with a held joint.
#[derive(Clone, Copy)]
struct HeldTarget<'a> {
    inverse: &'a Inverse,
    joint: &'a HeldJoint,
    target: &'a Vector3<f64>,
    attitudes: &'a ToolAttitudes,
    /// Number of the attitude, one of those that are solved.
    first: usize,
}

impl Inverse {
    /// Solves the inverse kinematics for all attitudes, with the redundant joint held at one value.
    pub(super) fn solve_held(
        &self,
        sample: &HeldSample<'_>,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) {
        for first in attitudes.set.solved() {
            self.solve_held_spins(sample, first, target, attitudes, found);
        }
    }

    /// Solves attitude `first`, and the attitudes that follow from it by a rotation of the last joint, with the
    /// redundant joint held at one value.
    ///
    /// Returns the distance by which the target is out of reach, m, or a lower bound of it; 0 if there is a solution.
    pub(super) fn solve_held_spins(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> f64 {
        self.solve_held_one(sample, first, target, attitudes, &mut |index, posture| {
            self.spin(first, attitudes, posture, &mut |k, posture| found(with_attitude(index, k), posture));
        })
    }

    /// Solves attitude `first` with the redundant joint held at one value.
    ///
    /// Returns the distance by which the target is out of reach, m, or a lower bound of it; 0 if there is a solution.
    pub(super) fn solve_held_one(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> f64 {
        let joint = sample.joint;
        let (held, inverse) = joint.at(sample.value);
        let flange = joint.rest_of(&self.flange(first, target, attitudes), &inverse);
        let bound = joint.fast.bound(&flange);
        if bound > 0.0 {
            return bound;
        }
        let (mut part, mut posture) = (joint.template, self.template);
        joint.fast.solve(&flange, &mut part, &mut |branch, part| {
            joint.join(part, &held, &mut posture);
            found(sample.number << 16 | (first as u32) << 4 | u32::from(branch), &posture);
        })
    }

    /// Calls `found` with the usable branches of a redundant arm, and returns the [`Gap`] of the target.
    ///
    /// The redundant joint is held at sampled values. If no sample has a usable branch, values between the
    /// samples are searched.
    pub(super) fn visit_redundant(
        &self,
        joint: &HeldJoint,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
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

    /// Returns the least distance of a target from the reach, m, over all samples and attitudes.
    ///
    /// The distance is computed only where its lower bound can still be the least.
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

    /// Returns the distance by which the target is out of reach, m, with the redundant joint held at one value.
    pub(super) fn held_distance(
        &self,
        sample: &HeldSample<'_>,
        first: usize,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
    ) -> f64 {
        let (joint, rest) = (sample.joint, self.rest(sample, first, target, attitudes));
        joint.solver.solve(&rest, &mut joint.template.clone(), &mut |_, _| ())
    }

    /// Returns the pose that the joints other than the held one must reach.
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
    /// Calls `found` with the usable branches at one value of the held joint.
    ///
    /// Returns the [`Gap`] of the target at this value, whose distance may be a lower bound, and whether a usable
    /// branch exists.
    fn gap(&self, sample: &HeldSample<'_>, found: &mut dyn FnMut(u32, &Posture)) -> (Gap, bool) {
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

    /// Calls `found` like [`Self::gap`], and returns the same, but never a lower bound of a distance below `near` (m).
    fn gap_near(
        &self,
        sample: &HeldSample<'_>,
        near: f64,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> (Gap, bool) {
        let (gap, usable) = self.gap(sample, found);
        if gap.reach == 0.0 || gap.reach >= near {
            return (gap, usable);
        }
        let reach = self.inverse.held_distance(sample, self.first, self.target, self.attitudes);
        (Gap { reach, ..gap }, usable)
    }

    /// Searches values between the samples of the held joint for usable postures.
    ///
    /// A finer scan covers the whole range of the held joint. A golden-section search narrows the interval around
    /// every value whose [`Gap`] is not larger than those of its neighbours. Returns the least gap found, and whether
    /// it found a usable posture.
    fn search_between(&self, found: &mut dyn FnMut(u32, &Posture)) -> (Gap, bool) {
        let flange = self.inverse.flange(self.first, self.target, self.attitudes);
        let near = self.joint.most_travel(&flange) * f64::from(SCAN_STEP);
        let (mut gaps, mut any) = ([Gap::ALL; SCAN], false);
        for (k, gap) in (0..).zip(&mut gaps) {
            let usable;
            (*gap, usable) = self.gap_near(&self.joint.sample(SCAN_STEP * k), near, found);
            any |= usable;
        }
        let mut least = Gap::ALL;
        for k in 0..SCAN {
            let higher = |other: usize| !gaps[other].is_less(&gaps[k]);
            let is_far = gaps[k].reach > near || gaps[k].limits > HOPELESS;
            if any || is_far || k > 0 && !higher(k - 1) || k + 1 < SCAN && !higher(k + 1) {
                continue;
            }
            let (gap, usable) = self.search_around(SCAN_STEP * k as u32, gaps[k], found);
            any |= usable;
            least = if gap.is_less(&least) { gap } else { least };
        }
        (least, any)
    }

    /// Searches the lattice values around the number `best` for one with a usable posture, towards the least [`Gap`].
    ///
    /// `least` is the gap at `best`, and smaller than those one step of the scan away.
    fn search_around(&self, best: u32, least: Gap, found: &mut dyn FnMut(u32, &Posture)) -> (Gap, bool) {
        let interval = (best.saturating_sub(SCAN_STEP), (best + SCAN_STEP).min(HeldJoint::LATTICE));
        let (best, least) = match least.reach > 0.0 {
            true => self.nearest_reached(interval, (best, least), &mut *found),
            false => (best, least),
        };
        match (least.reach, least.limits) {
            (0.0, 0.0) => (least, true),
            (0.0, _) => self.golden_section(interval, (best, least), found),
            _ => (least, false),
        }
    }

    /// Searches an interval of lattice numbers for one at which the target is in reach; returns the number with the
    /// least gap, and this gap.
    ///
    /// The distance from the reach is a Lipschitz function of the held joint's value. Parts of the interval whose ends
    /// are too far out of reach are left out (Piyavskii 1972).
    fn nearest_reached(
        &self,
        (lo, hi): (u32, u32),
        mut least: (u32, Gap),
        found: &mut dyn FnMut(u32, &Posture),
    ) -> (u32, Gap) {
        let flange = self.inverse.flange(self.first, self.target, self.attitudes);
        let most = self.joint.most_travel(&flange);
        let mut gap_at = |number: u32| self.gap_near(&self.joint.sample(number), f64::INFINITY, &mut *found).0;
        let mut parts = [(0, Gap::ALL, 0, Gap::ALL); MAX_PARTS + 3];
        let mut count = 2;
        parts[0] = (lo, gap_at(lo), least.0, least.1);
        parts[1] = (least.0, least.1, hi, gap_at(hi));
        for _ in 0..MAX_PARTS {
            if count == 0 || least.1.reach == 0.0 {
                break;
            }
            // The part that could come nearest is divided.
            let bound = |p: &(u32, Gap, u32, Gap)| p.1.reach + p.3.reach - most * f64::from(p.2 - p.0);
            let Some(k) = (0..count).min_by(|&a, &b| bound(&parts[a]).total_cmp(&bound(&parts[b]))) else { break };
            let (from, before, to, after) = parts[k];
            count -= 1;
            parts[k] = parts[count];
            if bound(&(from, before, to, after)) > 0.0 || to - from < 2 {
                continue;
            }
            let middle = from + (to - from) / 2;
            let gap = gap_at(middle);
            if gap.is_less(&least.1) {
                least = (middle, gap);
            }
            parts[count] = (from, before, middle, gap);
            parts[count + 1] = (middle, gap, to, after);
            count += 2;
        }
        least
    }

    /// Searches an interval of lattice numbers for one with a usable posture, by the golden section towards the least
    /// [`Gap`].
    ///
    /// `best` lies inside the interval, and `least` is the gap there.
    fn golden_section(
        &self,
        (mut lo, mut hi): (u32, u32),
        (mut best, mut least): (u32, Gap),
        found: &mut dyn FnMut(u32, &Posture),
    ) -> (Gap, bool) {
        while hi - lo > 2 {
            // The larger part of the interval is divided.
            let up = hi - best >= best - lo;
            let by = ((f64::from(if up { hi - best } else { best - lo }) * GOLDEN) as u32).max(1);
            let number = if up { best + by } else { best - by };
            let (gap, usable) = self.gap_near(&self.joint.sample(number), f64::INFINITY, found);
            if usable {
                return (gap, true);
            }
            match (gap.is_less(&least), up) {
                (true, true) => (lo, best, least) = (best, number, gap),
                (true, false) => (hi, best, least) = (best, number, gap),
                (false, true) => hi = number,
                (false, false) => lo = number,
            }
        }
        (least, false)
    }
}
