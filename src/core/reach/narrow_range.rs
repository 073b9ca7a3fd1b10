//! Search for postures in narrow ranges of a redundant coordinate, between two neighbouring samples.
//!
//! A solution of the inverse kinematics may be usable only in a range that contains no sample. The samples on
//! both sides of such a range are then prevented by different barriers: two joint limits, or a joint limit
//! and the end of the reach. Bisection between the two barriers finds the range.

use super::branch::with_sample;
use super::held_joint::HeldJoint;
use super::inverse::Inverse;
use super::redundant_coordinate::RedundantCoordinate;
use super::tool_attitudes::ToolAttitudes;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Number of solutions that a branch index distinguishes.
const SOLUTIONS: usize = 16;

/// Number of equal parts into which bisection divides the distance between two samples.
const PARTS: usize = 32;

/// What prevents a solution at one value of the redundant coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Barrier {
    /// The target is out of reach.
    Reach,
    /// Joint limits, as the bits of [`Limits::exceeded`]; 0 if the posture is usable.
    ///
    /// [`Limits::exceeded`]: super::limits::Limits::exceeded
    Limits(u32),
}

impl Barrier {
    const NONE: Self = Self::Limits(0);

    /// Returns whether the two barriers have nothing in common.
    fn differs(self, other: Self) -> bool {
        match (self, other) {
            (Self::Limits(a), Self::Limits(b)) => a & b == 0,
            (Self::Reach, Self::Reach) => false,
            _ => true,
        }
    }
}

/// Line of samples of a redundant coordinate. All its branches have the same attitude, except for the spin if
/// the spin is the coordinate.
struct SampleLine<'a> {
    inverse: &'a Inverse,
    target: &'a Vector3<f64>,
    attitudes: &'a ToolAttitudes,
    coordinate: RedundantCoordinate,
    /// Branch index of solution 0 at the first sample.
    first: u64,
}

impl Inverse {
    /// Searches between the samples of a redundant coordinate for narrow ranges with usable branches. Calls
    /// `found` with the index of one usable branch in each range.
    ///
    /// The coordinate is the redundant joint. If the arm has none, the coordinate is a free spin that several
    /// joints produce together. Ranges that are narrower than a thirty-second of the distance between two
    /// samples may be missed. Arms whose branches do not keep their indices are not searched.
    pub fn visit_narrow_ranges(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        mut found: impl FnMut(u64),
    ) {
        let set = &attitudes.set;
        let spins_freely =
            !self.spins_by_last_joint() && self.is_redundant(RedundantCoordinate::Spin, attitudes);
        let (coordinate, intervals, is_closed) = if self.is_redundant(RedundantCoordinate::Joint, attitudes) {
            (RedundantCoordinate::Joint, HeldJoint::SAMPLES - 1, false)
        } else if spins_freely {
            (RedundantCoordinate::Spin, set.spins.len(), true)
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
        let mut interval =
            SampleInterval { start: 0, known: 0, barriers: [[Barrier::Reach; SOLUTIONS]; PARTS + 1] };
        let mut before = self.barriers(0.0);
        for k in 1..=intervals {
            let after = self.barriers(k as f64);
            (interval.start, interval.known) = (k - 1, 0);
            for solution in 0..SOLUTIONS {
                let ends = (before[solution], after[solution]);
                if ends.0.differs(ends.1) && ends.0 != Barrier::NONE && ends.1 != Barrier::NONE {
                    interval.bisect(self, solution, ends, found);
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
        Barrier::Limits(self.inverse.limits.as_ref().map_or(0, |limits| limits.exceeded(posture)))
    }
}

/// Interval between two neighbouring samples, with the barriers that are already known inside it.
struct SampleInterval {
    /// Number of the sample at which the interval starts.
    start: usize,
    /// Bit k is set if `barriers[k]` is known.
    known: u64,
    /// Barriers of all solutions at the start plus k / [`PARTS`].
    barriers: [[Barrier; SOLUTIONS]; PARTS + 1],
}

impl SampleInterval {
    /// Searches for a usable branch of one solution by bisection between the barriers `ends`.
    fn bisect(
        &mut self,
        line: &SampleLine<'_>,
        solution: usize,
        ends: (Barrier, Barrier),
        found: &mut impl FnMut(u64),
    ) {
        let (mut low, mut high) = (0, PARTS);
        while high - low > 1 {
            let middle = (low + high) / 2;
            let position = self.start as f64 + middle as f64 / PARTS as f64;
            if self.known >> middle & 1 == 0 {
                self.barriers[middle] = line.barriers(position);
                self.known |= 1 << middle;
            }
            let barrier = self.barriers[middle][solution];
            match (barrier.differs(ends.0), barrier.differs(ends.1)) {
                _ if barrier == Barrier::NONE => {
                    line.branch(position).into_iter().for_each(|branch| found(branch | solution as u64));
                    return;
                }
                (false, true) => low = middle,
                (true, false) => high = middle,
                _ => return,
            }
        }
    }
}
