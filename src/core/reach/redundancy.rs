//! Redundancy resolution: one joint is held at sampled values while the other joints are solved.
//!
//! If no sample has a usable posture, values between samples are tried.

use super::branch::{Gap, with_attitude};
use super::held_joint::{HeldJoint, HeldSample};
use super::inverse::Inverse;
use super::tool_attitudes::ToolAttitudes;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Number of times that an interval of the redundant joint's coordinate is refined.
///
/// The interval is around a sample at which the [`Gap`] is not larger than at the neighbouring samples.
const REFINEMENTS: usize = 5;

/// Number of values of the held joint that each refinement tries inside its interval.
const INNER_VALUES: usize = 11;

/// Largest distance (m) by which a target may be out of reach at the best tried value of the held joint. Up
/// to this distance, the numeric solver is tried.
///
/// The values of the held joint that reach the target may lie between two neighbouring samples.
const GRAZING: f64 = 0.01;

impl Inverse {
    /// Solves the inverse kinematics for all attitudes, with the redundant joint held at one value.
    ///
    /// Returns the distance by which the target is out of reach, m; 0 if there is a solution.
    pub(super) fn solve_held(
        &self,
        sample: &HeldSample<'_>,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> f64 {
        attitudes
            .set
            .solved()
            .map(|first| {
                self.solve_held_one(sample, first, target, attitudes, &mut |index, posture| {
                    self.spin(first, attitudes, posture, &mut |k, posture| {
                        found(with_attitude(index, k), posture);
                    });
                })
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Solves attitude `first` with the redundant joint held at one value.
    ///
    /// Returns the distance by which the target is out of reach, m; 0 if there is a solution.
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
        let (mut part, mut posture) = (joint.template, self.template);
        let flange = joint.rest_of(&self.flange(first, target, attitudes), &inverse);
        sample.solver.solve(&flange, &mut part, &mut |branch, part| {
            joint.join(part, &held, &mut posture);
            found((sample.number as u32) << 16 | (first as u32) << 4 | u32::from(branch), &posture);
        })
    }

    /// Calls `found` with the usable branches of a redundant arm, and returns the [`Gap`] of the target.
    ///
    /// The redundant joint is held at sampled values. If no sample has a usable branch, values between the
    /// samples are searched. If these fail, too, and the distance out of reach is at most [`GRAZING`], the
    /// numeric solver is tried.
    pub(super) fn visit_redundant(
        &self,
        joint: &HeldJoint,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> Gap {
        if let Some(fast) = &joint.fast {
            let mut any = false;
            for sample in joint.samples(fast) {
                let mut keep = |index: u32, posture: &Posture| {
                    if self.excess(posture, target, attitudes) == 0.0 {
                        any = true;
                        found(index, posture);
                    }
                };
                self.solve_held(&sample, target, attitudes, &mut keep);
            }
            if any {
                return Gap { reach: 0.0, limits: 0.0 };
            }
        }
        let mut gap_at = |sample: &HeldSample<'_>| self.gap_at(sample, target, attitudes, &mut *found);
        let mut any = false;
        let gaps: [Gap; HeldJoint::SAMPLES] = std::array::from_fn(|k| {
            let (gap, usable) = gap_at(&joint.sample(&joint.solver, k));
            any |= usable;
            gap
        });
        let least = (0..gaps.len()).fold(0, |least, k| if gaps[k].is_less(&gaps[least]) { k } else { least });
        if any || gaps[least].reach > joint.sample_reach() {
            return gaps[least];
        }
        let best = match search_between(joint, &gaps, gaps[least], gap_at) {
            Ok(found) => return found,
            Err(best) => best,
        };
        if best.reach > GRAZING {
            return best;
        }
        // At the edge of the reach, the usable values of the held joint may all lie between two samples. The
        // numeric solver finds such values.
        for (k, goal) in self.goals(target, attitudes).iter().enumerate() {
            if let Some(q) = joint.numeric.one(goal) {
                let posture = self.chain.posture(&q);
                if self.excess(&posture, target, attitudes) == 0.0 {
                    found(((2 * gaps.len()) << 16 | k) as u32, &posture);
                    return Gap { reach: 0.0, limits: 0.0 };
                }
            }
        }
        best
    }

    /// Calls `found` with the usable branches at one value of the held joint.
    ///
    /// Returns the [`Gap`] of the target at this value, and whether a usable branch exists.
    fn gap_at(
        &self,
        sample: &HeldSample<'_>,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        found: &mut dyn FnMut(u32, &Posture),
    ) -> (Gap, bool) {
        let (mut limits, mut usable) = (f64::INFINITY, false);
        let reach = self.solve_held(sample, target, attitudes, &mut |index, posture| {
            let excess = self.excess(posture, target, attitudes);
            limits = limits.min(excess);
            if excess == 0.0 {
                usable = true;
                found(index, posture);
            }
        });
        (Gap { reach, limits: if reach > 0.0 { 0.0 } else { limits } }, usable)
    }
}

/// Searches values between the samples of the held joint for a usable posture.
///
/// The search covers the interval around every sample whose [`Gap`] is not larger than those of its
/// neighbours. If [`HeldJoint::fast`] is not None, the gap is too expensive to compute at many values. The
/// function then searches nothing and returns `best`, the least gap of the samples, as the error.
///
/// # Errors
/// Returns the least gap if no searched value has a usable posture.
fn search_between<'a>(
    joint: &'a HeldJoint,
    gaps: &[Gap; HeldJoint::SAMPLES],
    mut best: Gap,
    mut gap_at: impl FnMut(&HeldSample<'a>) -> (Gap, bool),
) -> Result<Gap, Gap> {
    let last = gaps.len() - 1;
    for k in 0..gaps.len() {
        let higher = |other: usize| !gaps[other].is_less(&gaps[k]);
        if joint.fast.is_none() && (k == 0 || higher(k - 1)) && (k == last || higher(k + 1)) {
            let (mut lo, mut hi) = (joint.values[k.saturating_sub(1)], joint.values[(k + 1).min(last)]);
            for _ in 0..REFINEMENTS {
                let (step, mut nearest) = ((hi - lo) / (INNER_VALUES + 1) as f64, (Gap::ALL, lo));
                for inner in 1..=INNER_VALUES {
                    let value = lo + step * inner as f64;
                    let number = gaps.len() + k;
                    let (gap, usable) = gap_at(&HeldSample { joint, solver: &joint.solver, number, value });
                    if usable {
                        return Ok(gap);
                    }
                    nearest = if gap.is_less(&nearest.0) { (gap, value) } else { nearest };
                }
                best = if nearest.0.is_less(&best) { nearest.0 } else { best };
                (lo, hi) = (nearest.1 - step, nearest.1 + step);
            }
        }
    }
    Err(best)
}
