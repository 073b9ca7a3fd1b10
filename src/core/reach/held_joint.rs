//! A redundant arm with its first or last joint held: a closed form solves the rest.

use super::numeric::Numeric;
use super::pose_solver::PoseSolver;
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};

/// Redundancy resolution of one arm: one joint takes sampled values, the other joints have a closed form.
#[derive(Debug, Clone)]
pub(super) struct HeldJoint {
    /// Closed form of the other joints.
    pub solver: PoseSolver,
    /// Variant of `solver` that does not compute the distance to an unreachable target; None if computing it
    /// is cheap.
    pub fast: Option<PoseSolver>,
    /// Numeric solver for targets at the edge of the reach.
    pub numeric: Numeric,
    /// Posture of the other joints, used as scratch memory.
    pub template: Posture,
    link: Link,
    /// Whether the held joint is the first one; otherwise it is the last.
    first: bool,
    axes: usize,
    /// Sampled coordinates of the held joint, rad or m.
    pub values: [f64; Self::SAMPLES],
}

/// One value of the held joint, and the closed form that solves the rest.
pub(super) struct HeldSample<'a> {
    pub joint: &'a HeldJoint,
    pub solver: &'a PoseSolver,
    /// Number of the sample, which becomes part of the branch index.
    pub number: usize,
    /// Coordinate, rad or m.
    pub value: f64,
}

impl HeldJoint {
    /// Number of sampled values.
    pub const SAMPLES: usize = 13;

    /// Prepares a chain with its first or last joint held; None if the rest has no closed form.
    pub fn new(chain: &Chain, first: bool) -> Option<Self> {
        let n = chain.axes();
        let held = if first { 0 } else { n.checked_sub(1)? };
        let drives = |i: usize, j: usize| i != j && chain.coupling[i][j] != 0.0;
        if n < 4 || (0..n).any(|k| drives(held, k) || drives(k, held)) {
            return None;
        }
        let mut rest = chain.clone();
        rest.mount = Pose::identity();
        rest.links.remove(held);
        rest.coupling.remove(held);
        for row in &mut rest.coupling {
            row.remove(held);
        }
        let link = chain.links[held];
        let (lo, hi) = link.limits;
        let value = |k: usize| lo + (hi - lo) * k as f64 / (Self::SAMPLES - 1) as f64;
        let values = std::array::from_fn(value);
        let (solver, template) = (PoseSolver::new(&rest)?, rest.zero_posture());
        let (fast, numeric) = (solver.fast(), Numeric::new(chain));
        Some(Self { solver, fast, numeric, template, link, first, axes: n, values })
    }

    /// Returns the family of the arm in words.
    pub fn family(&self) -> &'static str {
        match (&self.solver, self.first) {
            (PoseSolver::SphericalWrist(_), true) => "spherical wrist, first joint free (closed form)",
            (PoseSolver::SphericalWrist(_), false) => "spherical shoulder, last joint free (closed form)",
            (PoseSolver::ThreeParallel(_), true) => "three parallel axes, first joint free (closed form)",
            (PoseSolver::ThreeParallel(_), false) => "three parallel axes, last joint free (closed form)",
            (PoseSolver::Scara(_), _) => "SCARA, one joint free (closed form)",
        }
    }

    /// Returns the solver that finds all branches at the least cost.
    pub fn fastest(&self) -> &PoseSolver {
        self.fast.as_ref().unwrap_or(&self.solver)
    }

    /// Restricts the held joint to its coordinate in `q`.
    pub fn hold(&mut self, q: &JointVector) {
        self.values = [q[if self.first { 0 } else { self.axes - 1 }]; Self::SAMPLES];
    }

    /// Returns sample `number` of the held joint.
    pub fn sample<'a>(&'a self, solver: &'a PoseSolver, number: usize) -> HeldSample<'a> {
        HeldSample { joint: self, solver, number, value: self.values[number] }
    }

    /// Returns all samples of the held joint.
    pub fn samples<'a>(&'a self, solver: &'a PoseSolver) -> impl Iterator<Item = HeldSample<'a>> {
        (0..Self::SAMPLES).map(move |number| self.sample(solver, number))
    }

    /// Returns the held link at a coordinate: its row of the posture, and the inverse of its transform.
    pub fn at(&self, value: f64) -> ((f64, f64, f64), Pose) {
        let (turn, slide) = match self.link.kind {
            JointKind::Revolute => (value, 0.0),
            JointKind::Prismatic => (0.0, value),
        };
        let (sin, cos) = (self.link.theta + turn).sin_cos();
        let r = self.link.r + slide;
        ((cos, sin, r), self.link.pose(cos, sin, r).inverse())
    }

    /// Returns the part of a flange pose that the other joints must reach.
    pub fn rest_of(&self, flange: &Pose, inverse: &Pose) -> Pose {
        if self.first { *inverse * *flange } else { *flange * *inverse }
    }

    /// Writes the posture of the whole arm from the rows of the other joints and the held row.
    pub fn join(&self, rest: &Posture, held: &(f64, f64, f64), whole: &mut Posture) {
        let (at, from) = if self.first { (0, 1) } else { (self.axes - 1, 0) };
        for k in 0..self.axes - 1 {
            (whole.cos[from + k], whole.sin[from + k], whole.r[from + k]) =
                (rest.cos[k], rest.sin[k], rest.r[k]);
        }
        (whole.cos[at], whole.sin[at], whole.r[at]) = *held;
    }

    /// Returns a distance to the reach, m, above which the values between the samples need not be searched.
    ///
    /// A target that is farther from the reach at every sample counts as out of reach.
    pub fn sample_reach(&self) -> f64 {
        let step = (self.values[Self::SAMPLES - 1] - self.values[0]) / (Self::SAMPLES - 1) as f64;
        match self.link.kind {
            JointKind::Prismatic => step,
            JointKind::Revolute => step * self.link.l.hypot(self.link.r).max(0.1),
        }
    }
}
