//! The planar arm of four axes for many nodes at once: every branch, and whether it passes a joint limit.
//!
//! The same formulas in the same order as [`super::planar`] where a rounding error could grow (the
//! stretched arm, the tool above the base axis); limits are a little wider. So no branch is missed
//! that [`Inverse::visit`] finds, and the few that it refuses are refused there.

use super::Inverse;
use super::cones::Cone;
use super::inverse::Approach;
use super::kernel::Kernel;
use super::planar::{PlanarArm, STRETCHED, Way};
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
        let Kernel::Planar(arm) = &self.kernel else { return None };
        let cones = <[Cone; AXES]>::try_from(self.limits.as_ref()?.cones()?).ok()?;
        let to_zero = self.to_zero;
        (!arm.rolls()).then(|| PlanarLanes { arm: arm.clone(), cones, to_zero })
    }
}

impl PlanarLanes {
    /// Whether the attitude asks nothing that is judged posture by posture.
    pub fn takes(&self, approach: &Approach) -> bool {
        !approach.hold.is_checked(false)
    }

    /// Calls `found` with the postures of every branch that some lane may have, as cosines and sines of
    /// the angles theta, and the lanes that surely have no posture there.
    #[inline(always)]
    pub fn visit<S: Simd>(
        &self,
        target: Level<S>,
        approach: &Approach,
        mut found: impl FnMut(&[CosSin<S>; AXES], Mask<S>),
    ) {
        let arm = &self.arm;
        let [x, y, z] = self.in_zero(target);
        let radius2 = x * x + y * y;
        let lateral = arm.side * arm.lateral;
        let along2 = radius2 - lateral * lateral;
        // On the base axis the yaw is anything: no number, which no test refuses.
        let on_axis = radius2.is_below(radius2.like(1e-24));
        let inverse2 = on_axis.choose(radius2.like(f64::NAN), radius2.reciprocal());
        let beside = (along2 + radius2 * (2.0 * STRETCHED)).is_below(radius2.like(0.0));
        let along = along2.max(0.0).sqrt();
        for way in &approach.ways {
            let v = (z - arm.r1) * arm.side - way.v;
            for s in [along, -along] {
                let yaw = [x * s - y * lateral, y * s + x * lateral].map(|c| c * inverse2);
                let yaw = (yaw[0], yaw[1]);
                let out = beside | self.cones[0].is_passed(yaw);
                if !out.is_all() {
                    self.elbows(way, (s, v), (yaw, out), &mut found);
                }
            }
        }
    }

    /// Both elbows of one way and one side of the base axis; the wrist at distance `s` and height `v`.
    #[inline(always)]
    fn elbows<S: Simd>(
        &self,
        way: &Way,
        (s, v): (Lanes<S>, Lanes<S>),
        (yaw, out): (CosSin<S>, Mask<S>),
        found: &mut impl FnMut(&[CosSin<S>; AXES], Mask<S>),
    ) {
        let [l1, l2, l3] = self.arm.l;
        let u = s - l1 - way.u;
        let d2 = u * u + v * v;
        let cos3 = (d2 - l2 * l2 - l3 * l3) * (1.0 / (2.0 * l2 * l3));
        let out = out | cos3.is_above(1.0 + 2.0 * STRETCHED) | (-cos3).is_above(1.0 + 2.0 * STRETCHED);
        if out.is_all() {
            return;
        }
        let cos3 = cos3.clamp(-1.0, 1.0);
        let (long, short) = (-(d2 - (l2 + l3) * (l2 + l3)), d2 - (l2 - l3) * (l2 - l3));
        let sin3 = (long * short).max(0.0).sqrt() * (1.0 / (2.0 * l2 * l3).abs());
        let inverse2 = d2.reciprocal();
        let k1 = (d2 + (l2 * l2 - l3 * l3)) * (1.0 / (2.0 * l2)) * inverse2;
        for sin3 in [-sin3, sin3] {
            let k2 = sin3 * l3 * inverse2;
            let two = (k1 * u + k2 * v, k1 * v - k2 * u);
            let three = (cos3, sin3);
            let (c23, s23) = (two.0 * cos3 - two.1 * sin3, two.1 * cos3 + two.0 * sin3);
            let four = (c23 * way.cos_phi + s23 * way.sin_phi, c23 * way.sin_phi - s23 * way.cos_phi);
            let turns = [yaw, two, three, four];
            let out = out | Cone::any_passed(&self.cones, &turns);
            if !out.is_all() {
                found(&turns, out);
            }
        }
    }

    /// The targets in frame 0.
    #[inline(always)]
    fn in_zero<S: Simd>(&self, Level { x, y, z }: Level<S>) -> [Lanes<S>; 3] {
        let z = x.like(z);
        let Some(Pose { rotation, translation }) = &self.to_zero else { return [x, y, z] };
        std::array::from_fn(|i| {
            x * rotation[(i, 0)] + y * rotation[(i, 1)] + z * rotation[(i, 2)] + translation[i]
        })
    }
}
