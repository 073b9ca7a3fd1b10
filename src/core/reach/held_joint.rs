//! Redundant arms whose first or last joint is held at a value: a closed form solves the other joints.

use super::numeric::Numeric;
use super::pose_solver::PoseSolver;
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};

/// Redundancy resolution of one arm: one joint is held at sampled values, a closed form solves the others.
#[derive(Debug, Clone)]
pub(super) struct HeldJoint {
    /// Closed form that solves the joints that are not held.
    pub solver: PoseSolver,
    /// Variant of `solver` that does not compute how far a target is out of reach; None if this distance is
    /// cheap to compute.
    pub fast: Option<PoseSolver>,
    /// Numeric solver of the whole arm, for targets at the edge of the reach.
    pub numeric: Numeric,
    /// Posture of the joints that are not held, copied as scratch memory.
    pub template: Posture,
    link: Link,
    /// Whether the held joint is the first joint of the arm; otherwise it is the last.
    first: bool,
    axes: usize,
    /// Sampled coordinates of the held joint, rad or m.
    pub values: [f64; Self::SAMPLES],
}

/// One value of the held joint, and the closed form that solves the other joints.
pub(super) struct HeldSample<'a> {
    pub joint: &'a HeldJoint,
    pub solver: &'a PoseSolver,
    /// Number of the sample, which becomes part of the branch index.
    pub number: usize,
    /// Coordinate of the held joint, rad or m.
    pub value: f64,
}

impl HeldJoint {
    /// Number of sampled values of the held joint.
    pub const SAMPLES: usize = 13;

    /// Prepares a chain with its first or last joint held; None if no closed form solves the other joints.
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

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match (&self.solver, self.first) {
            (PoseSolver::SphericalWrist(_), true) => "spherical wrist, first joint free (closed form)",
            (PoseSolver::SphericalWrist(_), false) => "spherical shoulder, last joint free (closed form)",
            (PoseSolver::ThreeParallel(_), true) => "three parallel axes, first joint free (closed form)",
            (PoseSolver::ThreeParallel(_), false) => "three parallel axes, last joint free (closed form)",
            (PoseSolver::Scara(_), _) => "SCARA, one joint free (closed form)",
        }
    }

    /// Returns the fastest solver that finds all branches.
    pub fn fastest(&self) -> &PoseSolver {
        self.fast.as_ref().unwrap_or(&self.solver)
    }

    /// Returns whether the held joint is the first joint of the arm; otherwise it is the last.
    pub fn is_first(&self) -> bool {
        self.first
    }

    /// Returns the index of the held joint.
    pub fn index(&self) -> usize {
        if self.first { 0 } else { self.axes - 1 }
    }

    /// Sets all samples of the held joint to its coordinate in `q`.
    pub fn hold(&mut self, q: &JointVector) {
        self.values = [q[self.index()]; Self::SAMPLES];
    }

    /// Returns sample `number` of the held joint, to be solved by `solver`.
    pub fn sample<'a>(&'a self, solver: &'a PoseSolver, number: usize) -> HeldSample<'a> {
        HeldSample { joint: self, solver, number, value: self.values[number] }
    }

    /// Returns all samples of the held joint, to be solved by `solver`.
    pub fn samples<'a>(&'a self, solver: &'a PoseSolver) -> impl Iterator<Item = HeldSample<'a>> {
        (0..Self::SAMPLES).map(move |number| self.sample(solver, number))
    }

    /// Returns the D-H values (cos theta, sin theta, r) of the held joint, and the inverse transform of its
    /// link.
    ///
    /// `value` is the coordinate of the joint, rad or m; r is in m.
    pub fn at(&self, value: f64) -> ((f64, f64, f64), Pose) {
        let (turn, slide) = match self.link.kind {
            JointKind::Revolute => (value, 0.0),
            JointKind::Prismatic => (0.0, value),
        };
        let (sin, cos) = (self.link.theta + turn).sin_cos();
        let r = self.link.r + slide;
        ((cos, sin, r), self.link.pose(cos, sin, r).inverse())
    }

    /// Returns the pose that the other joints must reach, so that the last D-H frame is at `flange`.
    ///
    /// `inverse` is the inverse transform of the held link.
    pub fn rest_of(&self, flange: &Pose, inverse: &Pose) -> Pose {
        if self.first { *inverse * *flange } else { *flange * *inverse }
    }

    /// Writes the posture of the whole arm into `whole`. `rest` holds the D-H values of the joints that are
    /// not held. `held` holds the D-H values (cos theta, sin theta, r) of the held joint.
    pub fn join(&self, rest: &Posture, held: &(f64, f64, f64), whole: &mut Posture) {
        let (at, from) = if self.first { (0, 1) } else { (self.axes - 1, 0) };
        for k in 0..self.axes - 1 {
            (whole.cos[from + k], whole.sin[from + k], whole.r[from + k]) =
                (rest.cos[k], rest.sin[k], rest.r[k]);
        }
        (whole.cos[at], whole.sin[at], whole.r[at]) = *held;
    }

    /// Returns a distance, m, that limits the search between the samples of the held joint.
    ///
    /// A target counts as out of reach if it is farther than this distance from the reachable points of every
    /// sample.
    pub fn sample_reach(&self) -> f64 {
        let step = (self.values[Self::SAMPLES - 1] - self.values[0]) / (Self::SAMPLES - 1) as f64;
        match self.link.kind {
            JointKind::Prismatic => step,
            JointKind::Revolute => step * self.link.l.hypot(self.link.r).max(0.1),
        }
    }
}
