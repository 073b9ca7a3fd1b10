//! Search for postures in narrow ranges of a free coordinate, between two neighbouring samples.
//!
//! A solution of the inverse kinematics may be usable only in a range that contains no sample. The samples on
//! both sides of such a range are then prevented by different barriers: two joint limits, or a joint limit
//! and the end of the reach. Bisection between the two barriers finds the range.

use super::branch::with_sample;
use super::free_coordinate::FreeCoordinate;
use super::held_joint::HeldJoint;
use super::inverse::Inverse;
use super::tool_attitudes::ToolAttitudes;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Number of solutions that a branch index distinguishes.
const SOLUTIONS: usize = 16;

/// Number of bisections between two samples.
const BISECTIONS: usize = 6;

/// What prevents a solution at one value of the free coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Barrier {
    /// The target is out of reach.
    Reach,
    /// A joint exceeds its limit.
    Limit { joint: usize, is_above: bool },
    /// Nothing: the posture is usable.
    None,
}

/// Line of samples of a free coordinate. All its branches have the same attitude, except for the spin if the
/// spin is the free coordinate.
struct SampleLine<'a> {
    inverse: &'a Inverse,
    target: &'a Vector3<f64>,
    attitudes: &'a ToolAttitudes,
    coordinate: FreeCoordinate,
    /// Branch index of solution 0 at the first sample.
    first: u64,
}

impl Inverse {
    /// Calls `found` with a usable branch in each narrow range of a free coordinate that contains no sample.
    ///
    /// The coordinate is the redundant joint, or else a free spin by several joints. Ranges that are narrower
    /// than a sixty-fourth of the distance between two samples may be missed. Arms whose branches do not keep
    /// their indices are not searched.
    pub fn visit_narrow_ranges(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        mut found: impl FnMut(u64),
    ) {
        let set = &attitudes.set;
        let spins_freely = !self.spins_by_last_joint() && self.is_free(FreeCoordinate::Spin, attitudes);
        let (coordinate, intervals, is_closed) = if self.is_free(FreeCoordinate::RedundantJoint, attitudes) {
            (FreeCoordinate::RedundantJoint, HeldJoint::SAMPLES - 1, false)
        } else if spins_freely {
            (FreeCoordinate::Spin, set.spins.len(), true)
        } else {
            return;
        };
        if !self.keeps_branches() {
            return;
        }
        let is_line = |first: &usize| !is_closed || set.spin_index(*first).1 == 0;
        for first in set.solved().filter(is_line) {
            let first = with_sample((first as u64) << 4, 0);
            SampleLine { inverse: self, target, attitudes, coordinate, first }.visit(intervals, &mut found);
        }
    }
}

impl SampleLine<'_> {
    /// Searches between the neighbouring samples of the line.
    fn visit(&self, intervals: usize, found: &mut impl FnMut(u64)) {
        let mut before = self.barriers(0.0);
        for k in 1..=intervals {
            let after = self.barriers(k as f64);
            for solution in 0..SOLUTIONS {
                let ends = (before[solution], after[solution]);
                if ends.0 != ends.1 && ends.0 != Barrier::None && ends.1 != Barrier::None {
                    found_between(self, k, solution, ends, found);
                }
            }
            before = after;
        }
    }

    /// Returns the branch index of solution 0 at a position on the line; neighbouring samples are 1 apart.
    fn branch(&self, position: f64) -> Option<u64> {
        self.inverse.moved(self.first, self.coordinate, position, self.attitudes)
    }

    /// Returns what prevents each solution at a position on the line.
    fn barriers(&self, position: f64) -> [Barrier; SOLUTIONS] {
        let mut barriers = [Barrier::Reach; SOLUTIONS];
        if let Some(branch) = self.branch(position) {
            self.inverse.solve_at(self.target, self.attitudes, branch, &mut |solution, posture| {
                barriers[usize::from(solution) % SOLUTIONS] = self.barrier(posture);
            });
        }
        barriers
    }

    fn barrier(&self, posture: &Posture) -> Barrier {
        match &self.inverse.limits {
            Some(limits) if limits.excess(posture) > 0.0 => {
                let (joints, worst) = limits.joints(posture);
                let is_above = joints[worst.joint] > limits.ranges[worst.joint].centre;
                Barrier::Limit { joint: worst.joint, is_above }
            }
            _ => Barrier::None,
        }
    }
}

/// Searches for a usable branch between the samples `k - 1` and `k` of a line, by bisection between the
/// barriers `ends`.
fn found_between(
    line: &SampleLine<'_>,
    k: usize,
    solution: usize,
    ends: (Barrier, Barrier),
    found: &mut impl FnMut(u64),
) {
    let (mut low, mut high) = (k as f64 - 1.0, k as f64);
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        match line.barriers(middle)[solution] {
            Barrier::None => {
                if let Some(branch) = line.branch(middle) {
                    found(branch | solution as u64);
                }
                return;
            }
            barrier if barrier == ends.0 => low = middle,
            barrier if barrier == ends.1 => high = middle,
            _ => return,
        }
    }
}
