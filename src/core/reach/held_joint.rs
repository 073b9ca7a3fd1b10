//! Redundant arms whose first or last joint is held constant while a [`PoseSolver`] solves the other joints.

use super::pose_solver::PoseSolver;
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Length, m, by which a target must be outside the shell of a solver, so that it is certainly out of reach.
const SHELL_MARGIN: f64 = 1e-6;

/// Relative allowance for rounding errors of [`HeldJoint::travel`].
const ROUNDING: f64 = 1e-9;

/// Redundancy resolution of one arm. The redundant joint is held at sampled values, and a closed form or a
/// refined closed form solves the other joints.
#[derive(Debug, Clone)]
pub(super) struct HeldJoint {
    /// Solver of the other joints.
    pub solver: PoseSolver,
    /// Faster variant of `solver`, which returns lower bounds of distances in place of the distances.
    pub fast: PoseSolver,
    /// Posture of the other joints with their constant D-H values. Callers copy it as working memory.
    pub template: Posture,
    link: Link,
    /// Distance between the origins of the last two D-H frames of the chain without the redundant joint, m.
    lead: f64,
    /// Distance between the origins of the first two D-H frames of the chain without the redundant joint, m.
    foot: f64,
    /// Whether the redundant joint is the first joint of the arm; otherwise it is the last joint.
    first: bool,
    axes: usize,
    /// Least and greatest coordinate of the redundant joint, rad or m.
    range: (f64, f64),
}

/// One value of the redundant joint.
#[derive(Clone, Copy)]
pub(super) struct HeldSample<'a> {
    pub joint: &'a HeldJoint,
    /// Lattice number of the value, which becomes part of the branch index.
    ///
    /// [`HeldJoint::LATTICE`] describes the lattice.
    pub number: u32,
    /// Coordinate of the redundant joint, rad or m.
    pub value: f64,
}

impl HeldJoint {
    /// Number of sampled values of the redundant joint.
    pub const SAMPLES: usize = 13;

    /// Number of lattice steps between neighbouring samples.
    pub const SAMPLE_STEP: u32 = 1 << 20;

    /// Number of equal steps (the lattice) into which the range of the redundant joint is divided.
    ///
    /// A step is 0.00003 degrees for a joint with a range of 360 degrees, and 0.16 micrometres for a track of
    /// 2 m.
    pub const LATTICE: u32 = (Self::SAMPLES as u32 - 1) * Self::SAMPLE_STEP;

    /// Prepares the redundancy resolution of a chain with its first joint held constant, or its last joint if
    /// `first` is false.
    ///
    /// Returns None for fewer than four joints, for a redundant joint that is coupled to another joint, or if
    /// `solver` cannot solve the other joints.
    pub fn new(chain: &Chain, first: bool, solver: fn(&Chain) -> Option<PoseSolver>) -> Option<Self> {
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
        let (solver, template) = (solver(&rest)?, rest.zero_posture());
        let length = |link: Option<&Link>| link.map_or(0.0, |link| link.l.hypot(link.r));
        let (lead, foot) = (length(rest.links.last()), length(rest.links.first()));
        let fast = solver.fast();
        let range = within_one_turn(&link);
        Some(Self { solver, fast, template, link, lead, foot, first, axes: n, range })
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        self.solver.redundant_family(self.first)
    }

    /// Returns whether the redundant joint is the first joint of the arm; otherwise it is the last joint.
    pub fn is_first(&self) -> bool {
        self.first
    }

    /// Returns the index of the redundant joint.
    pub fn index(&self) -> usize {
        if self.first { 0 } else { self.axes - 1 }
    }

    /// Fixes the redundant joint at its coordinate in `q`.
    pub fn hold(&mut self, q: &JointVector) {
        self.range = (q[self.index()], q[self.index()]);
    }

    /// Returns whether the redundant joint has only one value.
    pub fn is_fixed(&self) -> bool {
        self.range.0 == self.range.1
    }

    /// Returns the value of the redundant joint with the lattice number `number`.
    pub fn sample(&self, number: u32) -> HeldSample<'_> {
        let (lo, hi) = self.range;
        let value = lo + (hi - lo) * (f64::from(number) / f64::from(Self::LATTICE));
        HeldSample { joint: self, number, value }
    }

    /// Returns the sampled values of the redundant joint.
    pub fn samples(&self) -> impl Iterator<Item = HeldSample<'_>> {
        let count = if self.is_fixed() { 1 } else { Self::SAMPLES as u32 };
        (0..count).map(|k| self.sample(k * Self::SAMPLE_STEP))
    }

    /// Returns the D-H values (cos theta, sin theta, r) of the redundant joint, and the inverse transform of
    /// its link.
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
    /// `inverse` is the inverse transform of the link of the redundant joint.
    pub fn rest_of(&self, flange: &Pose, inverse: &Pose) -> Pose {
        if self.first { *inverse * *flange } else { *flange * *inverse }
    }

    /// Writes the posture of the whole arm into `whole`.
    ///
    /// `held` contains the D-H values (cos theta, sin theta, r) of the redundant joint. `rest` contains the
    /// D-H values of the other joints.
    pub fn join(&self, rest: &Posture, held: &(f64, f64, f64), whole: &mut Posture) {
        let (at, from) = if self.first { (0, 1) } else { (self.axes - 1, 0) };
        for k in 0..self.axes - 1 {
            (whole.cos[from + k], whole.sin[from + k], whole.r[from + k]) =
                (rest.cos[k], rest.sin[k], rest.r[k]);
        }
        (whole.cos[at], whole.sin[at], whole.r[at]) = *held;
    }

    /// Returns the distance (m) of the pose `flange` of the last D-H frame from the reachable poses, with the
    /// redundant joint held at one value.
    pub fn distance(&self, sample: &HeldSample<'_>, flange: &Pose) -> f64 {
        let rest = self.rest_of(flange, &self.at(sample.value).1);
        self.solver.solve(&rest, &mut self.template.clone(), &mut |_, _| ())
    }

    /// Returns an upper bound (m) of the motion of a point when the redundant joint moves by one lattice
    /// step.
    ///
    /// The solver of the other joints measures the distance of this point from the reachable points. The
    /// point is the wrist centre, relative to the first of the other joints. If the solver uses the reversed
    /// chain, the point is the shoulder centre, relative to the last of the other joints. The bound holds for
    /// both points.
    ///
    /// `flange` is the pose of the last D-H frame in frame 0.
    pub fn most_travel(&self, flange: &Pose) -> f64 {
        let step = (self.range.1 - self.range.0) / f64::from(Self::LATTICE);
        let (own, reach) = (self.link.l.hypot(self.link.r), flange.translation.norm());
        match (self.link.kind, self.first) {
            (JointKind::Prismatic, _) => step,
            (JointKind::Revolute, true) => step * (reach + self.lead).max(own + self.foot),
            (JointKind::Revolute, false) => step * (own + self.lead.max(reach + self.foot)),
        }
    }

    /// Returns an upper bound like [`Self::most_travel`]. The bound is exact for a revolute redundant joint
    /// if [`PoseSolver::centre`] returns the point. The joint then moves the point on a circle.
    pub fn travel(&self, flange: &Pose) -> f64 {
        let most = self.most_travel(flange);
        let opposite = [0.0, PI].map(|value| self.solver.centre(&self.rest_of(flange, &self.at(value).1)));
        match (self.link.kind, opposite) {
            (JointKind::Revolute, [Some(a), Some(b)]) => {
                let step = (self.range.1 - self.range.0) / f64::from(Self::LATTICE);
                most.min((1.0 + ROUNDING) * step * (a - b).norm() / 2.0)
            }
            _ => most,
        }
    }

    /// Returns whether the target is certainly out of reach at every value of the redundant joint.
    ///
    /// Let D be the squared distance of the point [`PoseSolver::centre`] from the centre of the
    /// [shell](PoseSolver::shell). As a function of the redundant joint's coordinate, D is a sinusoid
    /// (revolute joint) or a parabola (prismatic joint). Three values of D determine its range. `flange` is
    /// the pose of the last D-H frame in frame 0.
    pub fn never_reaches(&self, flange: &Pose) -> bool {
        let Some(shell) = self.solver.shell() else { return false };
        let (lo, hi) = self.range;
        let values = match self.link.kind {
            JointKind::Revolute => [0.0, FRAC_PI_2, PI],
            JointKind::Prismatic => [lo, (lo + hi) / 2.0, hi],
        };
        let squared = values.map(|value| {
            let centre = self.solver.centre(&self.rest_of(flange, &self.at(value).1))?;
            Some((centre - shell.centre).norm_squared())
        });
        let [Some(a), Some(b), Some(c)] = squared else { return false };
        let (least, most) = match self.link.kind {
            JointKind::Revolute => {
                let (middle, cosine) = ((a + c) / 2.0, (a - c) / 2.0);
                let amplitude = cosine.hypot(b - middle);
                (middle - amplitude, middle + amplitude)
            }
            JointKind::Prismatic => {
                // A unit of travel moves the point by a unit, so the parabola has the leading coefficient 1.
                let (half, slope) = ((hi - lo) / 2.0, (c - a) / 2.0);
                let vertex = if slope.abs() < 2.0 * half * half {
                    b - slope * slope / (4.0 * half * half)
                } else {
                    a.min(c)
                };
                (vertex, a.max(c))
            }
        };
        shell.gap(least.max(0.0).sqrt(), most.max(0.0).sqrt()) > SHELL_MARGIN
    }

    /// Returns a distance, m, that limits the search between the samples of the redundant joint.
    ///
    /// A target counts as out of reach if it is farther than this distance from the reachable points of every
    /// sample.
    pub fn sample_reach(&self) -> f64 {
        let step = (self.range.1 - self.range.0) / (Self::SAMPLES - 1) as f64;
        match self.link.kind {
            JointKind::Prismatic => step,
            JointKind::Revolute => step * self.link.l.hypot(self.link.r).max(0.1),
        }
    }
}

/// Returns the range of a joint (rad or m).
///
/// A range of more than one turn is reduced to the turn in its middle, because the other coordinates repeat
/// the same postures.
fn within_one_turn(link: &Link) -> (f64, f64) {
    let (least, greatest) = link.limits;
    let middle = (least + greatest) / 2.0;
    match link.kind {
        JointKind::Revolute if greatest - least > TAU => (middle - PI, middle + PI),
        _ => link.limits,
    }
}
