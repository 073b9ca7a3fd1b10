//! The planar arm of four axes for many nodes at once: every branch, and whether it passes a joint limit.
//!
//! The same formulas in the same order as [`super::closed_form::planar`] where a rounding error could grow (the
//! stretched arm, the tool above the base axis); limits are a little wider. So no branch is missed
//! that [`Inverse::visit`] finds, and the few that it refuses are refused there.

use super::Inverse;
use super::closed_form::planar::{PlanarArm, STRETCHED};
use super::cones::Cone;
use super::solver::Solver;
use super::tool_attitudes::{PlanarAttitude, ToolAttitudes};
use crate::lanes::{CosSin, Lanes, Mask, Simd};
use crate::pose::Pose;

/// Axes of the arm.
const AXES: usize = 4;

/// An arm made ready.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarLanes {
    arm: PlanarArm,
    cones: [Cone; AXES],
    to_zero: Option<Pose>,
}

/// Targets at one height, base frame, m.
pub struct Level<S: Simd> {
    pub x: Lanes<S>,
    pub y: Lanes<S>,
    pub z: f64,
}

impl Inverse {
    /// None of an arm that is not planar with four axes, or whose limits are not judged by sines and
    /// cosines.
    pub fn lanes(&self) -> Option<PlanarLanes> {
        let Solver::Planar(arm) = &self.solver else { return None };
        let cones = <[Cone; AXES]>::try_from(self.limits.as_ref()?.cones()?).ok()?;
        let to_zero = self.to_zero;
        (!arm.rolls()).then(|| PlanarLanes { arm: arm.clone(), cones, to_zero })
    }
}

/// Targets in frame 0.
pub struct Targets<S: Simd> {
    x: Lanes<S>,
    y: Lanes<S>,
    z: Lanes<S>,
    /// Distance in front of the base axis, in the plane of the arm.
    along: Lanes<S>,
    /// 1 / (x^2 + y^2).
    inverse2: Lanes<S>,
    /// Nearer to the base axis than the tool can come.
    beside: Mask<S>,
}

/// The wrist for one way to hold the tool on one side of the base axis.
pub struct Wrist<S: Simd> {
    yaw: CosSin<S>,
    /// From the shoulder, in the plane of the arm, over the square of its distance.
    u: Lanes<S>,
    v: Lanes<S>,
    k1: Lanes<S>,
    cos3: Lanes<S>,
    /// Of the elbow up.
    sin3: Lanes<S>,
    phi: (f64, f64),
    out: Mask<S>,
}

// No closures here: they would not be compiled for the lanes.
impl PlanarLanes {
    /// Whether the attitude asks nothing that is judged posture by posture.
    pub fn takes(&self, approach: &ToolAttitudes) -> bool {
        !approach.set.is_checked(false)
    }

    #[inline(always)]
    pub fn targets<S: Simd>(&self, level: &Level<S>) -> Targets<S> {
        let [x, y, z] = self.in_zero(level);
        let radius2 = x * x + y * y;
        let lateral = self.arm.lateral;
        let along2 = radius2 - lateral * lateral;
        // On the base axis the yaw is anything: no number, which no test refuses.
        let on_axis = radius2.is_below(radius2.like(1e-24));
        let inverse2 = on_axis.choose(radius2.like(f64::NAN), radius2.reciprocal());
        let beside = (along2 + radius2 * (2.0 * STRETCHED)).is_below(radius2.like(0.0));
        Targets { x, y, z, along: along2.max(0.0).sqrt(), inverse2, beside }
    }

    /// None where no lane has a posture.
    #[inline(always)]
    pub fn wrist<S: Simd>(&self, at: &Targets<S>, way: &PlanarAttitude, back: bool) -> Option<Wrist<S>> {
        let (arm, [l1, l2, l3]) = (&self.arm, self.arm.l);
        let (s, lateral) = (if back { -at.along } else { at.along }, arm.side * arm.lateral);
        let yaw = ((at.x * s - at.y * lateral) * at.inverse2, (at.y * s + at.x * lateral) * at.inverse2);
        let out = at.beside | self.cones[0].is_passed(yaw);
        let (u, v) = (s - l1 - way.u, (at.z - arm.r1) * arm.side - way.v);
        let d2 = u * u + v * v;
        let cos3 = (d2 - l2 * l2 - l3 * l3) * (1.0 / (2.0 * l2 * l3));
        let out = out | cos3.is_above(1.0 + 2.0 * STRETCHED) | (-cos3).is_above(1.0 + 2.0 * STRETCHED);
        if out.is_all() {
            return None;
        }
        let (long, short) = (-(d2 - (l2 + l3) * (l2 + l3)), d2 - (l2 - l3) * (l2 - l3));
        let sin3 = (long * short).max(0.0).sqrt() * (1.0 / (2.0 * l2 * l3).abs());
        let inverse2 = d2.reciprocal();
        let k1 = (d2 + (l2 * l2 - l3 * l3)) * (1.0 / (2.0 * l2));
        let cos3 = cos3.clamp(-1.0, 1.0);
        let phi = (way.cos_phi, way.sin_phi);
        Some(Wrist { yaw, u: u * inverse2, v: v * inverse2, k1, cos3, sin3, phi, out })
    }

    /// Cosines and sines of the angles theta of one elbow, and where there surely is no such posture.
    #[inline(always)]
    pub fn branch<S: Simd>(&self, wrist: &Wrist<S>, up: bool) -> ([CosSin<S>; AXES], Mask<S>) {
        let Wrist { yaw, u, v, k1, cos3, phi, .. } = *wrist;
        let sin3 = if up { wrist.sin3 } else { -wrist.sin3 };
        let k2 = sin3 * self.arm.l[2];
        let two = (k1 * u + k2 * v, k1 * v - k2 * u);
        let (c23, s23) = (two.0 * cos3 - two.1 * sin3, two.1 * cos3 + two.0 * sin3);
        let four = (c23 * phi.0 + s23 * phi.1, c23 * phi.1 - s23 * phi.0);
        let turns = [yaw, two, (cos3, sin3), four];
        (turns, Cone::any_passed(&self.cones, &turns, wrist.out))
    }

    #[inline(always)]
    fn in_zero<S: Simd>(&self, Level { x, y, z }: &Level<S>) -> [Lanes<S>; 3] {
        let (x, y, z) = (*x, *y, x.like(*z));
        let Some(Pose { rotation: r, translation: t }) = &self.to_zero else { return [x, y, z] };
        [
            x * r[(0, 0)] + y * r[(0, 1)] + z * r[(0, 2)] + t.x,
            x * r[(1, 0)] + y * r[(1, 1)] + z * r[(1, 2)] + t.y,
            x * r[(2, 0)] + y * r[(2, 1)] + z * r[(2, 2)] + t.z,
        ]
    }
}
