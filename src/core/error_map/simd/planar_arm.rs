//! Inverse kinematics of the planar arm with four axes, in SIMD lanes: every branch, and whether the branch
//! exceeds a joint limit.
//!
//! Where rounding errors could grow, the formulas and their order are the same as in
//! `reach::closed_form::planar`. Rounding errors could grow if the arm is nearly stretched, or if the target
//! is near the base axis. This module widens the joint limits a little. It therefore finds every branch that
//! [`Inverse::visit`](crate::reach::Inverse::visit) finds.

use super::lanes::{CosSin, Lanes, Mask};
use super::limits::{any_passed, is_passed};
use crate::pose::Pose;
use crate::reach::{Inverse, PlanarAttitude, PlanarGeometry};
use pulp::Simd;

const STRETCHED: f64 = PlanarGeometry::STRETCHED;

/// Planar arm with four axes, solved for several targets at once.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarLanes {
    arm: PlanarGeometry,
}

/// Targets at one height, in the base frame, m.
pub struct Level<S: Simd> {
    pub x: Lanes<S>,
    pub y: Lanes<S>,
    pub z: f64,
}

/// Targets in D-H frame 0, which precedes the first joint, m.
pub struct TargetLanes<S: Simd> {
    x: Lanes<S>,
    y: Lanes<S>,
    z: Lanes<S>,
    /// Distance of the target from the base axis, measured parallel to the plane of the arm, m.
    along: Lanes<S>,
    /// Reciprocal of the squared distance of the target from the base axis, 1/m^2.
    inverse2: Lanes<S>,
    /// Lanes whose target is so near to the base axis that the tool cannot reach it.
    beside: Mask<S>,
}

/// Wrist positions for one attitude of the tool. The arm reaches either forwards or backwards in all lanes.
pub struct WristLanes<S: Simd> {
    yaw: CosSin<S>,
    /// Component of `w / |w|^2` perpendicular to the base axis, 1/m. The vector `w` leads from the shoulder
    /// to the wrist.
    u: Lanes<S>,
    /// Component of `w / |w|^2` along the base axis, 1/m. The vector `w` leads from the shoulder to the
    /// wrist.
    v: Lanes<S>,
    k1: Lanes<S>,
    cos3: Lanes<S>,
    /// Sine of the third joint angle with the elbow up.
    sin3: Lanes<S>,
    phi: (f64, f64),
    out: Mask<S>,
}

impl PlanarLanes {
    /// Prepares an arm; None if the arm is not planar with four axes.
    pub fn new(inverse: &Inverse) -> Option<Self> {
        inverse.planar_geometry().map(|arm| Self { arm })
    }
}

// The compiler would not use SIMD instructions inside closures, so these functions contain no closures.
impl PlanarLanes {
    /// Transforms targets from the base frame to D-H frame 0, which precedes the first joint.
    #[inline(always)]
    pub fn targets<S: Simd>(&self, level: &Level<S>) -> TargetLanes<S> {
        let [x, y, z] = self.in_zero(level);
        let radius2 = x * x + y * y;
        let lateral = self.arm.lateral;
        let along2 = radius2 - lateral * lateral;
        // On the base axis, every yaw is a solution. NaN represents an arbitrary yaw here, because no test
        // refuses NaN.
        let on_axis = radius2.is_below(radius2.like(1e-24));
        let inverse2 = on_axis.choose(radius2.like(f64::NAN), radius2.reciprocal());
        let beside = (along2 + radius2 * (2.0 * STRETCHED)).is_below(radius2.like(0.0));
        TargetLanes { x, y, z, along: along2.max(0.0).sqrt(), inverse2, beside }
    }

    /// Computes the position of the wrist for every target. Returns None if no lane has a posture.
    #[inline(always)]
    pub fn wrist<S: Simd>(
        &self,
        at: &TargetLanes<S>,
        attitude: &PlanarAttitude,
        back: bool,
    ) -> Option<WristLanes<S>> {
        let (arm, [l1, l2, l3]) = (&self.arm, self.arm.l);
        let (s, lateral) = (if back { -at.along } else { at.along }, arm.side * arm.lateral);
        let yaw = ((at.x * s - at.y * lateral) * at.inverse2, (at.y * s + at.x * lateral) * at.inverse2);
        let out = at.beside | is_passed(&arm.cones[0], yaw);
        let (u, v) = (s - l1 - attitude.u, (at.z - arm.r1) * arm.side - attitude.v);
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
        let phi = (attitude.cos_phi, attitude.sin_phi);
        Some(WristLanes { yaw, u: u * inverse2, v: v * inverse2, k1, cos3, sin3, phi, out })
    }

    /// Solves for the joint angles with the elbow up or down.
    ///
    /// Returns the cosine and sine of each joint angle, and the lanes that surely have no posture.
    #[inline(always)]
    pub fn branch<S: Simd>(
        &self,
        wrist: &WristLanes<S>,
        up: bool,
    ) -> ([CosSin<S>; PlanarGeometry::AXES], Mask<S>) {
        let WristLanes { yaw, u, v, k1, cos3, phi, .. } = *wrist;
        let sin3 = if up { wrist.sin3 } else { -wrist.sin3 };
        let k2 = sin3 * self.arm.l[2];
        let two = (k1 * u + k2 * v, k1 * v - k2 * u);
        let (c23, s23) = (two.0 * cos3 - two.1 * sin3, two.1 * cos3 + two.0 * sin3);
        let four = (c23 * phi.0 + s23 * phi.1, c23 * phi.1 - s23 * phi.0);
        let turns = [yaw, two, (cos3, sin3), four];
        (turns, any_passed(&self.arm.cones, &turns, wrist.out))
    }

    #[inline(always)]
    fn in_zero<S: Simd>(&self, Level { x, y, z }: &Level<S>) -> [Lanes<S>; 3] {
        let (x, y, z) = (*x, *y, x.like(*z));
        let Some(Pose { rotation: r, translation: t }) = &self.arm.to_zero else { return [x, y, z] };
        [
            x * r[(0, 0)] + y * r[(0, 1)] + z * r[(0, 2)] + t.x,
            x * r[(1, 0)] + y * r[(1, 1)] + z * r[(1, 2)] + t.y,
            x * r[(2, 0)] + y * r[(2, 1)] + z * r[(2, 2)] + t.z,
        ]
    }
}
