//! The closed form of a chain's family, found by trying; redundant arms with one joint held.

use super::Numeric;
use super::closed_form::planar::{PlanarArm, template};
use super::closed_form::scara::Scara;
use super::{SphericalWrist, ThreeParallel};
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};

/// Postures on which a closed form is tried before it is trusted, and what it may be off (m, no unit).
const TRIALS: usize = 16;
const EXACT: f64 = 1e-9;

/// The way to solve a chain.
#[derive(Debug, Clone)]
pub(super) enum Kernel {
    Planar(PlanarArm),
    Pose(PoseKernel),
    Locked(Box<Locked>),
    Numeric(Box<Numeric>),
}

/// Closed forms that take the pose of the last D-H frame.
#[derive(Debug, Clone)]
pub(super) enum PoseKernel {
    Scara(Scara),
    SphericalWrist(Box<SphericalWrist>),
    ThreeParallel(ThreeParallel),
}

/// A redundant arm: its first or last joint takes one value after the other, the rest has a closed
/// form.
#[derive(Debug, Clone)]
pub(super) struct Locked {
    pub kernel: PoseKernel,
    /// The same that does not say what is missing, if that is dear.
    pub hasty: Option<PoseKernel>,
    /// For the edge of the reach.
    pub numeric: Numeric,
    /// The rest's own scratch.
    pub template: Posture,
    link: Link,
    /// Whether it is the first joint; otherwise the last.
    first: bool,
    axes: usize,
    /// Coordinates tried.
    pub values: [f64; Self::STEPS],
}

impl Kernel {
    /// `by_posture`: whether a posture tells whether it keeps the limits.
    pub fn new(chain: &Chain, by_posture: bool) -> Self {
        if by_posture {
            if let Ok(arm) = PlanarArm::new(chain) {
                return Self::Planar(arm);
            }
            if let Some(kernel) = PoseKernel::new(chain) {
                return Self::Pose(kernel);
            }
            if let Some(locked) = [true, false].into_iter().find_map(|first| Locked::new(chain, first)) {
                return Self::Locked(Box::new(locked));
            }
        }
        Self::Numeric(Box::new(Numeric::new(chain)))
    }

    pub fn family(&self) -> &'static str {
        match self {
            Self::Planar(arm) if arm.rolls() => "base yaw, three parallel axes, roll (closed form)",
            Self::Planar(_) => "base yaw and three parallel axes (closed form)",
            Self::Pose(kernel) => kernel.family(),
            Self::Locked(locked) => match (&locked.kernel, locked.first) {
                (PoseKernel::SphericalWrist(_), true) => "spherical wrist, first joint free (closed form)",
                (PoseKernel::SphericalWrist(_), false) => "spherical joint, last joint free (closed form)",
                (PoseKernel::ThreeParallel(_), true) => "three parallel axes, first joint free (closed form)",
                (PoseKernel::ThreeParallel(_), false) => "three parallel axes, last joint free (closed form)",
                (PoseKernel::Scara(_), _) => "SCARA, one joint free (closed form)",
            },
            Self::Numeric(_) => "general chain (numeric)",
        }
    }
}

impl PoseKernel {
    /// The closed form of a chain, if there is one that gives its own postures back.
    fn new(chain: &Chain) -> Option<Self> {
        let scara = || Scara::new(chain).ok().map(Self::Scara);
        let wrist = || SphericalWrist::new(chain).ok().map(|arm| Self::SphericalWrist(Box::new(arm)));
        let parallel = || ThreeParallel::new(chain).ok().map(Self::ThreeParallel);
        let found = scara().or_else(wrist).or_else(parallel)?;
        found.is_exact(chain).then_some(found)
    }

    fn family(&self) -> &'static str {
        match self {
            Self::Scara(_) => "SCARA (closed form)",
            Self::SphericalWrist(_) => "six axes with three that meet in a point (closed form)",
            Self::ThreeParallel(_) => "six axes with three parallel ones (closed form)",
        }
    }

    /// Calls `found` with every solution for the last D-H frame at `flange` in frame 0; returns the
    /// metres missing.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut impl FnMut(u8, &Posture)) -> f64 {
        match self {
            Self::Scara(arm) if arm.can_hold(flange) => arm.solve(flange, posture, found),
            Self::Scara(_) => f64::INFINITY,
            Self::SphericalWrist(arm) => arm.solve(flange, posture, found),
            Self::ThreeParallel(arm) => arm.solve(flange, posture, found),
        }
    }

    /// Whether it finds the flange of some postures again.
    fn is_exact(&self, chain: &Chain) -> bool {
        let mut scratch = template(chain);
        (0..TRIALS).all(|k| {
            let posture = chain.posture(&chain.spread(k));
            let wanted = flange_of(chain, &posture);
            let (mut count, mut off) = (0, 0.0);
            self.solve(&wanted, &mut scratch, &mut |_, found| {
                let flange = flange_of(chain, found);
                let apart = (flange.translation - wanted.translation).norm();
                off = f64::max(off, apart.max((flange.rotation - wanted.rotation).norm()));
                count += 1;
            });
            count > 0 && off < EXACT
        })
    }
}

/// The last D-H frame in frame 0.
fn flange_of(chain: &Chain, posture: &Posture) -> Pose {
    chain.mount.inverse() * chain.frames(posture).links[chain.axes()]
}

impl Locked {
    /// Values tried of the joint that is held.
    pub const STEPS: usize = 13;

    fn new(chain: &Chain, first: bool) -> Option<Self> {
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
        let step = |k: usize| lo + (hi - lo) * k as f64 / (Self::STEPS - 1) as f64;
        let values = std::array::from_fn(step);
        let (kernel, template) = (PoseKernel::new(&rest)?, template(&rest));
        let numeric = Numeric::new(chain);
        let hasty = match &kernel {
            PoseKernel::SphericalWrist(arm) => {
                arm.hasty().map(|arm| PoseKernel::SphericalWrist(Box::new(arm)))
            }
            _ => None,
        };
        Some(Self { kernel, hasty, numeric, template, link, first, axes: n, values })
    }

    /// The kernel that finds what there is at the least cost.
    pub fn quick(&self) -> &PoseKernel {
        self.hasty.as_ref().unwrap_or(&self.kernel)
    }

    /// Tries the coordinate in `q` alone.
    pub fn hold(&mut self, q: &JointVector) {
        self.values = [q[if self.first { 0 } else { self.axes - 1 }]; Self::STEPS];
    }

    /// The held link at a coordinate: its row of the posture, and the inverse of its matrix.
    pub fn at(&self, value: f64) -> ((f64, f64, f64), Pose) {
        let (turn, slide) = match self.link.kind {
            JointKind::Revolute => (value, 0.0),
            JointKind::Prismatic => (0.0, value),
        };
        let (sin, cos) = (self.link.theta + turn).sin_cos();
        let r = self.link.r + slide;
        ((cos, sin, r), self.link.pose(cos, sin, r).inverse())
    }

    /// What is left to the rest of a flange pose.
    pub fn rest_of(&self, flange: &Pose, inverse: &Pose) -> Pose {
        if self.first { *inverse * *flange } else { *flange * *inverse }
    }

    /// The whole posture of the held row and the rest.
    pub fn join(&self, rest: &Posture, held: &(f64, f64, f64), whole: &mut Posture) {
        let (at, from) = if self.first { (0, 1) } else { (self.axes - 1, 0) };
        for k in 0..self.axes - 1 {
            (whole.cos[from + k], whole.sin[from + k], whole.r[from + k]) =
                (rest.cos[k], rest.sin[k], rest.r[k]);
        }
        (whole.cos[at], whole.sin[at], whole.r[at]) = *held;
    }

    /// A target farther from reach than this (m) at all values tried is out of reach between them.
    pub fn near(&self) -> f64 {
        let step = (self.values[Self::STEPS - 1] - self.values[0]) / (Self::STEPS - 1) as f64;
        match self.link.kind {
            JointKind::Prismatic => step,
            JointKind::Revolute => step * self.link.l.hypot(self.link.r).max(0.1),
        }
    }
}
