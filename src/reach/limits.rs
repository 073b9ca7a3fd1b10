//! Joint limits with wrap-around, on sines and cosines where the coupling allows it.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::{Chain, Posture};
use crate::units::wrapped;
use std::f64::consts::PI;

/// A limit counts as kept if it is passed by less than this in the cosine of the angle from the
/// middle of the range: rounding must not refuse a posture exactly at its limit.
const TOLERANCE: f64 = 1e-12;

/// The joint whose limit is passed the most, and by how much (rad).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitViolation {
    pub joint: usize,
    pub by: f64,
}

/// The allowed arc of one actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Arc {
    /// Cosine and sine of the D-H offset theta and of the middle of the range.
    zero: (f64, f64),
    middle: (f64, f64),
    middle_angle: f64,
    /// Half the width of the range, rad, and its cosine (-2: every angle is allowed).
    half: f64,
    cos_half: f64,
}

/// The limits of a chain of revolute joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Limits {
    arcs: Vec<Arc>,
    coupling: Vec<Vec<f64>>,
    /// Below the diagonal: (row, column, factor), where every factor is a whole number.
    whole: Option<Vec<(usize, usize, i32)>>,
}

impl Limits {
    pub fn new(chain: &Chain) -> Self {
        debug_assert!(chain.links.iter().all(|l| l.kind == JointKind::Revolute));
        let arcs = chain.links.iter().map(|link| {
            let (lo, hi) = link.limits;
            let (middle_angle, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
            Arc {
                zero: cos_sin(link.theta),
                middle: cos_sin(middle_angle),
                middle_angle,
                half,
                cos_half: if half >= PI { -2.0 } else { half.cos() - TOLERANCE },
            }
        });
        let below = |i: usize| (0..i).map(move |j| (i, j));
        let factors = (0..chain.axes()).flat_map(below).map(|(i, j)| (i, j, chain.coupling[i][j]));
        let used: Vec<_> = factors.filter(|f| f.2 != 0.0).collect();
        let whole = used.iter().all(|f| f.2.fract() == 0.0 && f.2.abs() <= 8.0);
        let whole = whole.then(|| used.iter().map(|&(i, j, f)| (i, j, f as i32)).collect());
        Self { arcs: arcs.collect(), coupling: chain.coupling.clone(), whole }
    }

    /// How far outside its limits the posture is: 0 inside; otherwise the sum over the joints of
    /// what the cosine misses, a measure that grows with the distance.
    pub fn excess(&self, posture: &Posture) -> f64 {
        let Some(whole) = &self.whole else {
            let (q, _) = self.joints(posture);
            let missed = |(arc, q): (&Arc, f64)| (arc.cos_half - (q - arc.middle_angle).cos()).max(0.0);
            return self.arcs.iter().zip(q).map(missed).sum();
        };
        let mut actuators = [(1.0, 0.0); MAX_JOINTS];
        let mut excess = 0.0;
        for (i, arc) in self.arcs.iter().enumerate() {
            let mut z = times_conjugate((posture.cos[i], posture.sin[i]), arc.zero);
            for &(_, j, factor) in whole.iter().filter(|w| w.0 == i) {
                let other = actuators[j];
                let other = if factor > 0 { other } else { (other.0, -other.1) };
                for _ in 0..factor.abs() {
                    z = times_conjugate(z, other);
                }
            }
            actuators[i] = z;
            excess += (arc.cos_half - z.0 * arc.middle.0 - z.1 * arc.middle.1).max(0.0);
        }
        excess
    }

    /// Actuator coordinates of a posture, each in the turn nearest to the middle of its range, and
    /// the joint furthest past its limits, or least inside them: a violation if [`Self::excess`]
    /// is not 0.
    pub fn joints(&self, posture: &Posture) -> (JointVector, LimitViolation) {
        let mut q = [0.0; MAX_JOINTS];
        let mut worst = LimitViolation { joint: 0, by: f64::NEG_INFINITY };
        for (joint, arc) in self.arcs.iter().enumerate() {
            let z = times_conjugate((posture.cos[joint], posture.sin[joint]), arc.zero);
            let others: f64 = (0..joint).map(|j| self.coupling[joint][j] * q[j]).sum();
            let from_middle = wrapped(z.1.atan2(z.0) - others - arc.middle_angle);
            q[joint] = arc.middle_angle + from_middle;
            let by = from_middle.abs() - arc.half;
            if arc.half < PI && by > worst.by {
                worst = LimitViolation { joint, by };
            }
        }
        (q, worst)
    }
}

fn cos_sin(angle: f64) -> (f64, f64) {
    (angle.cos(), angle.sin())
}

/// `a` turned back by `b`, both as (cos, sin).
fn times_conjugate(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 + a.1 * b.1, a.1 * b.0 - a.0 * b.1)
}
