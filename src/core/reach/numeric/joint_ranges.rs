//! Joint ranges for the numeric solver.

use super::step::{NormalMatrix, StepBounds};
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::Chain;
use crate::units::wrapped;
use std::f64::consts::{PI, TAU};

/// Range of the coordinate of one actuator, rad or m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointRange {
    pub lo: f64,
    pub hi: f64,
    /// Whether the joint has no limits. In this case, the range is at least one turn, and a whole turn leaves
    /// all link poses unchanged.
    pub turns: bool,
    pub kind: JointKind,
}

impl JointRange {
    /// Returns the middle of the range, rad or m.
    pub fn middle(&self) -> f64 {
        self.lo + (self.hi - self.lo) / 2.0
    }

    /// Returns the interval to search: the whole range, or one turn if the joint has no limits.
    pub fn searched(&self) -> (f64, f64) {
        if self.turns { (self.middle() - PI, self.middle() + PI) } else { (self.lo, self.hi) }
    }

    /// Returns the coordinate `q` clamped to the limits. If [`Self::turns`] is set, whole turns are first
    /// added so that `q` is nearest to the middle of the range.
    pub fn kept(&self, q: f64) -> f64 {
        let q = if self.turns { self.middle() + wrapped(q - self.middle()) } else { q };
        q.clamp(self.lo, self.hi)
    }

    /// Returns the absolute difference of two coordinates; whole turns are removed if [`Self::turns`] is set.
    pub fn apart(&self, a: f64, b: f64) -> f64 {
        if self.turns { wrapped(a - b).abs() } else { (a - b).abs() }
    }
}

/// Joint ranges of a chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointRanges(Vec<JointRange>);

impl JointRanges {
    /// Returns the joint ranges of a chain.
    pub fn new(chain: &Chain) -> Self {
        let range = |(j, link): (usize, &crate::robot::Link)| {
            let (lo, hi) = link.limits;
            // A whole turn of this joint must rotate every joint that it drives by whole turns, too.
            let drives = |i: usize| match chain.links[i].kind {
                JointKind::Revolute => chain.coupling[i][j].fract() == 0.0,
                JointKind::Prismatic => chain.coupling[i][j] == 0.0,
            };
            // Rounding of degrees may make a range of one turn slightly shorter.
            let whole = hi - lo >= TAU * (1.0 - f64::EPSILON);
            let turns = link.kind == JointKind::Revolute && whole && (j + 1..chain.axes()).all(drives);
            JointRange { lo, hi, turns, kind: link.kind }
        };
        Self(chain.links.iter().enumerate().map(range).collect())
    }

    /// Returns these ranges with the joint `held` fixed at its coordinate in `q`.
    pub fn holding(&self, held: Option<usize>, q: &JointVector) -> Self {
        let mut ranges = self.0.clone();
        if let Some((range, q)) = held.and_then(|k| Some((ranges.get_mut(k)?, q.get(k)?))) {
            *range = JointRange { lo: *q, hi: *q, turns: false, ..*range };
        }
        Self(ranges)
    }

    /// Returns these ranges, extended at both ends: by a turn for a revolute joint, and by the whole travel for
    /// a prismatic joint.
    pub fn widened(&self) -> Self {
        let widened = |range: &JointRange| {
            let by = if range.kind == JointKind::Revolute { TAU } else { range.hi - range.lo };
            JointRange { lo: range.lo - by, hi: range.hi + by, ..*range }
        };
        Self(self.0.iter().map(widened).collect())
    }

    /// Returns the range of every joint.
    pub fn ranges(&self) -> &[JointRange] {
        &self.0
    }

    /// Returns the bounds of a step from the joint coordinates `q`: the limits and the largest step.
    ///
    /// A revolute joint may move by `most` (rad), a prismatic joint by `most` times `length` (m).
    pub fn bounds(&self, q: &JointVector, most: f64, length: f64) -> StepBounds {
        let mut bounds = [(0.0, 0.0); MAX_JOINTS];
        for ((bound, range), q) in bounds.iter_mut().zip(&self.0).zip(q) {
            let most = if range.kind == JointKind::Prismatic { most * length } else { most };
            *bound =
                if range.turns { (-most, most) } else { (-most.min(q - range.lo), most.min(range.hi - q)) };
        }
        bounds
    }

    /// Returns `q` moved by a step; the result is clamped, because rounding may move it beyond a limit.
    #[inline]
    pub fn moved(&self, q: &JointVector, step: &JointVector) -> JointVector {
        let mut moved = *q;
        for (q, (d, range)) in moved.iter_mut().zip(step.iter().zip(&self.0)) {
            *q = if range.turns { *q + d } else { (*q + d).clamp(range.lo, range.hi) };
        }
        moved
    }

    /// Adds the damping to the diagonal of the matrix `h`.
    ///
    /// For a prismatic joint, a travel of `1 / scale` (the length of the chain, m) has the weight of 1 rad.
    #[inline]
    pub fn damp(&self, h: &mut NormalMatrix, damping: f64, scale: f64) {
        for (i, range) in self.0.iter().enumerate() {
            h[i][i] += if range.kind == JointKind::Prismatic { damping * scale * scale } else { damping };
        }
    }

    /// Adds to `b`, for every joint with limits, a term that pulls the joint towards the middle of its range.
    ///
    /// Prismatic joints are scaled as in [`Self::damp`].
    pub fn pull(&self, b: &mut JointVector, q: &JointVector, strength: f64, scale: f64) {
        for (i, range) in self.0.iter().enumerate().filter(|(_, range)| !range.turns) {
            let strength =
                if range.kind == JointKind::Prismatic { strength * scale * scale } else { strength };
            b[i] += strength * (range.middle() - q[i]);
        }
    }

    /// Returns the joint that the descent direction `b` pushes the most against its limit; None if no joint
    /// is pushed against a limit.
    pub fn held(&self, q: &JointVector, b: &JointVector) -> Option<usize> {
        let push = |i: usize| {
            let (range, b) = (&self.0[i], b[i]);
            if !range.turns && ((q[i] >= range.hi && b > 0.0) || (q[i] <= range.lo && b < 0.0)) {
                b.abs()
            } else {
                0.0
            }
        };
        let held = (0..self.0.len()).filter(|&i| push(i) > 0.0);
        held.max_by(|&i, &j| push(i).total_cmp(&push(j)))
    }

    /// Returns the joint coordinates `q`, each brought within its limits by [`JointRange::kept`].
    pub fn kept(&self, q: &JointVector) -> JointVector {
        let mut kept = *q;
        kept.iter_mut().zip(&self.0).for_each(|(q, range)| *q = range.kept(*q));
        kept
    }

    /// Returns the largest difference of two postures in one coordinate; see [`JointRange::apart`].
    pub fn apart(&self, a: &JointVector, b: &JointVector) -> f64 {
        let each = self.0.iter().zip(a.iter().zip(b));
        each.map(|(range, (a, b))| range.apart(*a, *b)).fold(0.0, f64::max)
    }
}
