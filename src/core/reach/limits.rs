//! Joint limits, checked on the sines and cosines of joint angles if the coupling of the joints allows it.
//!
//! Angles that differ by whole turns count as equal.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::{Chain, Posture};
use crate::units::wrapped;
use std::f64::consts::PI;

/// Tolerance of the limit of a revolute joint, applied to the cosine of the angle from the middle of the
/// range.
///
/// This tolerance ensures that rounding does not reject a posture exactly at its limit.
const COSINE_TOLERANCE: f64 = 1e-12;

/// Tolerance of the limit of a prismatic joint, m.
const SLIDE_TOLERANCE: f64 = 1e-9;

/// Index of the joint that exceeds its limit the most, and the amount of this excess in `by` (rad or m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitViolation {
    pub joint: usize,
    pub by: f64,
}

/// Allowed range of the coordinate of one actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ActuatorRange {
    pub kind: JointKind,
    /// Cosine and sine of the joint angle theta at coordinate 0.
    pub zero: (f64, f64),
    /// Cosine and sine of the middle of the range.
    middle: (f64, f64),
    /// Axial offset r at coordinate 0, m.
    r: f64,
    /// Middle of the range of the actuator coordinate, rad or m.
    pub centre: f64,
    /// Half width of the range, rad or m.
    half: f64,
    /// Cosine of the half width of the range of a revolute joint; -2 if every angle is allowed.
    pub cos_half: f64,
}

/// Joint limits of a chain, checked on sines and cosines where possible.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Limits {
    pub(super) ranges: Vec<ActuatorRange>,
    /// Number of joints up to the last joint that has a limit.
    limited: usize,
    coupling: Vec<Vec<f64>>,
    /// Coupling factors that are not 0, as (index of the driven joint, index of the driving joint, factor).
    ///
    /// None if a factor is not a whole number from -8 to 8, or couples a prismatic joint.
    pub(super) whole: Option<Vec<(usize, usize, i32)>>,
}

impl Limits {
    /// Prepares the limits of a chain.
    ///
    /// # Errors
    /// Returns the reason if the sines and cosines of a posture do not determine whether the posture keeps
    /// the limits.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let turns_more = |j: usize| {
            let link = &chain.links[j];
            link.kind == JointKind::Revolute && (link.limits.1 - link.limits.0) / 2.0 > PI
        };
        let turning = |i: usize| chain.links[i].kind == JointKind::Revolute;
        let geared = |i: usize, j: usize| {
            let factor = chain.coupling[i][j];
            factor.fract() != 0.0 || factor != 0.0 && !turning(i)
        };
        let n = chain.axes();
        if (0..n).any(|j| turns_more(j) && (j + 1..n).any(|i| geared(i, j))) {
            return Err(
                "a joint that can turn more than once drives a prismatic joint, or drives another joint \
                        by a factor that is not a whole number"
                    .into(),
            );
        }
        let below = |i: usize| (0..i).map(move |j| (i, j));
        let factors = (0..n).flat_map(below).map(|(i, j)| (i, j, chain.coupling[i][j]));
        let used: Vec<_> = factors.filter(|f| f.2 != 0.0).collect();
        let is_whole =
            |&(i, j, f): &(usize, usize, f64)| turning(i) && turning(j) && f.fract() == 0.0 && f.abs() <= 8.0;
        let whole = used.iter().all(is_whole);
        let whole = whole.then(|| used.iter().map(|&(i, j, f)| (i, j, f as i32)).collect());
        let ranges: Vec<ActuatorRange> = chain.links.iter().map(range).collect();
        let limited = ranges.iter().rposition(|range| range.cos_half > -2.0).map_or(0, |last| last + 1);
        Ok(Self { ranges, limited, coupling: chain.coupling.clone(), whole })
    }

    /// Returns a measure of how far a posture exceeds its joint limits; 0 within the limits.
    ///
    /// The measure is a sum over the joints that exceed a limit. A prismatic joint adds the distance to its
    /// limit, m. A revolute joint adds the cosine at its limit minus the cosine at the posture. The angles of
    /// these two cosines are measured from the middle of the range.
    #[inline]
    pub fn excess(&self, posture: &Posture) -> f64 {
        let Some(whole) = &self.whole else {
            let (q, _) = self.joints(posture);
            return self.ranges.iter().zip(q).map(|(range, q)| range.missed(q)).sum();
        };
        self.excess_of(self.ranges.len(), whole, posture)
    }

    /// Returns the measure of [`Self::excess`] for all joints except the last.
    ///
    /// Returns 0 if the limits cannot be checked on sines and cosines.
    #[inline]
    pub fn excess_before_last(&self, posture: &Posture) -> f64 {
        match &self.whole {
            Some(whole) => self.excess_of(self.ranges.len().saturating_sub(1), whole, posture),
            None => 0.0,
        }
    }

    /// Returns the limits that a posture exceeds, as bits: bit 2 k for the lower limit of joint k, and bit
    /// 2 k + 1 for its upper limit.
    ///
    /// Returns 0 if the limits cannot be checked on sines and cosines.
    pub fn exceeded(&self, posture: &Posture) -> u32 {
        let mut exceeded = 0;
        if let Some(whole) = &self.whole {
            self.each_excess(self.ranges.len(), whole, posture, |joint, excess, is_above| {
                exceeded |= u32::from(excess > 0.0) << (2 * joint + usize::from(is_above));
            });
        }
        exceeded
    }

    /// Returns the excess of the first `joints` joints; `whole` holds the coupling factors.
    #[inline]
    fn excess_of(&self, joints: usize, whole: &[(usize, usize, i32)], posture: &Posture) -> f64 {
        let mut sum = 0.0;
        self.each_excess(joints, whole, posture, |_, excess, _| sum += excess);
        sum
    }

    /// Calls `found` with each of the first `joints` joints, its excess, and whether its coordinate is above
    /// the middle of its range. Joints after the last joint with a limit are left out.
    #[inline]
    fn each_excess(
        &self,
        joints: usize,
        whole: &[(usize, usize, i32)],
        posture: &Posture,
        mut found: impl FnMut(usize, f64, bool),
    ) {
        let mut actuators = [(1.0, 0.0); MAX_JOINTS];
        for (i, range) in self.ranges[..joints.min(self.limited)].iter().enumerate() {
            if range.kind == JointKind::Prismatic {
                let q = posture.r[i] - range.r;
                found(i, range.missed(q), q > range.centre);
                continue;
            }
            let mut z = times_conjugate((posture.cos[i], posture.sin[i]), range.zero);
            for &(_, j, factor) in whole.iter().filter(|w| w.0 == i) {
                let other = actuators[j];
                let other = if factor > 0 { other } else { (other.0, -other.1) };
                for _ in 0..factor.abs() {
                    z = times_conjugate(z, other);
                }
            }
            actuators[i] = z;
            let excess = (range.cos_half - z.0 * range.middle.0 - z.1 * range.middle.1).max(0.0);
            found(i, excess, z.1 * range.middle.0 > z.0 * range.middle.1);
        }
    }

    /// Returns the actuator coordinates of a posture and the joint that is farthest outside its limits.
    ///
    /// Each coordinate is in the turn nearest to the middle of its range. If [`Self::excess`] is 0, no limit
    /// is violated, and the returned joint is the joint nearest to its limit.
    pub fn joints(&self, posture: &Posture) -> (JointVector, LimitViolation) {
        let mut q = [0.0; MAX_JOINTS];
        let mut worst = LimitViolation { joint: 0, by: f64::NEG_INFINITY };
        for (joint, range) in self.ranges.iter().enumerate() {
            let others: f64 = (0..joint).map(|j| self.coupling[joint][j] * q[j]).sum();
            let from_middle = match range.kind {
                JointKind::Revolute => {
                    let z = times_conjugate((posture.cos[joint], posture.sin[joint]), range.zero);
                    wrapped(z.1.atan2(z.0) - others - range.centre)
                }
                JointKind::Prismatic => posture.r[joint] - range.r - others - range.centre,
            };
            q[joint] = range.centre + from_middle;
            let by = from_middle.abs() - range.half;
            if range.cos_half > -2.0 && by > worst.by {
                worst = LimitViolation { joint, by };
            }
        }
        (q, worst)
    }
}

impl ActuatorRange {
    /// Returns the amount that an actuator coordinate `q` (rad or m) adds to [`Limits::excess`].
    fn missed(&self, q: f64) -> f64 {
        match self.kind {
            JointKind::Revolute => (self.cos_half - (q - self.centre).cos()).max(0.0),
            JointKind::Prismatic => {
                let by = (q - self.centre).abs() - self.half;
                if by > SLIDE_TOLERANCE { by } else { 0.0 }
            }
        }
    }
}

fn range(link: &crate::robot::Link) -> ActuatorRange {
    let (lo, hi) = link.limits;
    let (centre, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
    let whole_turn = link.kind == JointKind::Revolute && half >= PI;
    ActuatorRange {
        kind: link.kind,
        zero: cos_sin(link.theta),
        middle: cos_sin(centre),
        r: link.r,
        centre,
        half,
        cos_half: if whole_turn { -2.0 } else { half.min(PI).cos() - COSINE_TOLERANCE },
    }
}

fn cos_sin(angle: f64) -> (f64, f64) {
    (angle.cos(), angle.sin())
}

/// Returns the cosine and sine of the difference of two angles, `a` minus `b`.
fn times_conjugate(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 + a.1 * b.1, a.1 * b.0 - a.0 * b.1)
}
