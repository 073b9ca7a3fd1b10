//! The paper's arm in closed form: a base yaw, then three parallel axes that move the tool in a
//! vertical plane.
//!
//! With `s` the signed distance in that plane (front > 0, back < 0) and phi the angle of the last
//! link, the wrist lies at `u = s - l_1 - U(phi)`, `v = z - r_1 - V(phi)`; the law of cosines gives
//! two elbows, and theta_4 = phi - theta_2 - theta_3. The tool bending angle (elevation) leaves two
//! phi, pointing away from the base axis or towards it; they are one if the tool is vertical. So a
//! target has up to 2 x 2 x 2 branches. Only square roots are taken: no angle is formed until a
//! branch is reported.

use super::limits::{LimitViolation, Limits};
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// Rounding must not lose the stretched arm, nor the one in the vertical plane of the base axis:
/// cosines up to 1 plus this count as 1.
const STRETCHED: f64 = 1e-12;

/// The arm; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarArm {
    /// +1 if alpha_1 is +90 degrees, -1 if it is -90.
    side: f64,
    r1: f64,
    l: [f64; 3],
    /// Distance of the tool from the vertical plane through the base axis.
    lateral: f64,
    /// theta_1 (cos, sin) in the middle of the range of joint 1.
    middle_yaw: (f64, f64),
    /// TCP and direction of the tool axis (cos, sin) in the plane, in the frame turned by theta_4.
    tool: (f64, f64),
    axis: (f64, f64),
    limits: Limits,
    /// Carries the fixed axial offsets.
    template: Posture,
}

/// How the tool is held at an operation: one entry per phi.
#[derive(Debug, Clone, PartialEq)]
pub struct Approach {
    ways: Vec<Way>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Way {
    cos_phi: f64,
    sin_phi: f64,
    /// TCP from the wrist, in the plane.
    u: f64,
    v: f64,
}

/// What a target misses: metres to the nearest reachable circle (0 if a branch exists) and, if
/// branches exist, the least excess over their joint limits (0 if one keeps them).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    pub reach: f64,
    pub limits: f64,
}

/// One posture that puts the TCP where it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Bit 0: elbow, bit 1: the arm leans back over the base, bit 2: the tool points against the
    /// direction of theta_1 (and not along it).
    pub index: u8,
    pub joints: JointVector,
    pub posture: Posture,
    /// None inside the joint limits.
    pub violation: Option<LimitViolation>,
}

/// The answer for one target.
#[derive(Debug, Clone, PartialEq)]
pub enum Reach {
    /// No posture at all; so many metres are missing.
    OutOfReach { by: f64 },
    /// Every branch, inside its limits or not.
    Branches(Vec<Branch>),
}

impl PlanarArm {
    /// Recognizes the arm in a chain.
    ///
    /// # Errors
    /// Why the chain is not of this family.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let [a, b, c, d] = chain.links[..] else {
            return Err(format!("it has {} axes, not 4", chain.axes()));
        };
        if chain.links.iter().any(|l| l.kind != JointKind::Revolute) {
            return Err("it has a prismatic joint".into());
        }
        if a.cos_alpha.abs() > 1e-12 {
            return Err("the second axis is not perpendicular to the first (alpha_1 is not +-90)".into());
        }
        if [b, c].iter().any(|l| l.sin_alpha.abs() > 1e-12 || l.cos_alpha < 0.0) {
            return Err("axes 2, 3 and 4 are not parallel (alpha_2 and alpha_3 are not 0)".into());
        }
        if b.l.abs() < 1e-6 || c.l.abs() < 1e-6 {
            return Err("an arm link has no length (l_2 or l_3 is 0)".into());
        }
        if chain.mount != Pose::identity() {
            return Err("the first axis is not that of the base (its mount is turned or moved)".into());
        }
        let turned = |v: &Vector3<f64>| {
            Vector3::new(v.x, d.cos_alpha * v.y - d.sin_alpha * v.z, d.sin_alpha * v.y + d.cos_alpha * v.z)
        };
        let half_turn = std::f64::consts::PI;
        let turns = |j: usize| (chain.links[j].limits.1 - chain.links[j].limits.0) / 2.0 > half_turn;
        let geared = |j: usize| (j + 1..4).any(|i| chain.coupling[i][j].fract() != 0.0);
        if (0..4).any(|j| turns(j) && geared(j)) {
            return Err("a joint that turns more than a whole turn drives another by a fraction".into());
        }
        let axis = turned(&(chain.tool.rotation * chain.tool_axis));
        if axis.z.abs() > 1e-9 {
            return Err("the tool axis does not lie in the plane of the arm".into());
        }
        let middle_yaw = (a.theta + (a.limits.0 + a.limits.1) / 2.0).sin_cos();
        let tip = turned(&chain.tool.translation) + Vector3::new(d.l, 0.0, d.r);
        Ok(Self {
            side: a.sin_alpha.signum(),
            r1: a.r,
            l: [a.l, b.l, c.l],
            lateral: b.r + c.r + tip.z,
            middle_yaw: (middle_yaw.1, middle_yaw.0),
            tool: (tip.x, tip.y),
            axis: (axis.x, axis.y),
            limits: Limits::new(chain),
            template: chain.posture(&[0.0; crate::cell::MAX_JOINTS]),
        })
    }

    /// The ways to hold the tool at an elevation of `bend` (rad).
    pub fn approach(&self, bend: f64) -> Approach {
        let (sin_bend, cos_bend) = bend.sin_cos();
        let vertical = cos_bend.abs() < 1e-12;
        let outward = if vertical { vec![0.0] } else { vec![cos_bend, -cos_bend] };
        let (ax, ay) = self.axis;
        let way = |cos_psi: f64| {
            // psi is the angle of the tool axis, phi = psi - atan2(ay, ax) that of the last link.
            let sin_psi = self.side * if vertical { sin_bend.signum() } else { sin_bend };
            let (cos_phi, sin_phi) = (cos_psi * ax + sin_psi * ay, sin_psi * ax - cos_psi * ay);
            let (x, y) = self.tool;
            Way { cos_phi, sin_phi, u: x * cos_phi - y * sin_phi, v: x * sin_phi + y * cos_phi }
        };
        Approach { ways: outward.into_iter().map(way).collect() }
    }

    /// A posture to hand to [`Self::visit`] again and again.
    pub fn scratch(&self) -> Posture {
        self.template
    }

    /// Calls `found` with every branch inside the joint limits; says what is missing otherwise.
    /// `target` is the TCP in the base frame, m. This is the node loop: it does not allocate.
    #[inline]
    pub fn visit(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        scratch: &mut Posture,
        mut found: impl FnMut(u8, &Posture),
    ) -> Gap {
        let mut limits = f64::INFINITY;
        let reach = self.solve(target, approach, scratch, |index, posture| {
            let excess = self.limits.excess(posture);
            limits = limits.min(excess);
            if excess == 0.0 {
                found(index, posture);
            }
        });
        Gap { reach, limits: if reach > 0.0 { 0.0 } else { limits } }
    }

    /// Every branch with its joint coordinates, those outside the limits too.
    pub fn branches(&self, target: &Vector3<f64>, approach: &Approach) -> Reach {
        let mut all = Vec::new();
        let by = self.solve(target, approach, &mut self.scratch(), |index, posture| {
            let (joints, violation) = self.limits.joints(posture);
            // One judge for search and map: the sum in `excess`.
            let violation = if self.limits.excess(posture) == 0.0 { None } else { Some(violation) };
            all.push(Branch { index, joints, posture: *posture, violation });
        });
        if all.is_empty() { Reach::OutOfReach { by } } else { Reach::Branches(all) }
    }

    /// Actuator coordinates of a posture.
    pub fn joints(&self, posture: &Posture) -> JointVector {
        self.limits.joints(posture).0
    }

    /// The geometry alone; returns how many metres the nearest branch misses (0: there is one).
    #[inline]
    fn solve(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        posture: &mut Posture,
        mut found: impl FnMut(u8, &Posture),
    ) -> f64 {
        let lateral = self.side * self.lateral;
        let radius2 = target.x * target.x + target.y * target.y;
        let along2 = radius2 - lateral * lateral;
        if along2 < -STRETCHED * radius2 {
            return lateral.abs() - radius2.sqrt();
        }
        let along = along2.max(0.0).sqrt();
        let [l1, l2, l3] = self.l;
        let mut missing = f64::INFINITY;
        for (w, way) in approach.ways.iter().enumerate() {
            let v = self.side * (target.z - self.r1) - way.v;
            for (back, s) in [(0, along), (2, -along)] {
                let u = s - l1 - way.u;
                let d2 = u * u + v * v;
                let cos3 = (d2 - l2 * l2 - l3 * l3) / (2.0 * l2 * l3);
                if cos3.abs() > 1.0 + STRETCHED {
                    let d = d2.sqrt();
                    missing = missing.min((d - (l2.abs() + l3.abs())).max((l2.abs() - l3.abs()).abs() - d));
                    continue;
                }
                missing = 0.0;
                let cos3 = cos3.clamp(-1.0, 1.0);
                // Heron's form, and k1 likewise: a folded arm of equal links keeps its digits.
                let (long, short) = ((l2 + l3) * (l2 + l3) - d2, d2 - (l2 - l3) * (l2 - l3));
                let sin3 = (long * short).max(0.0).sqrt() / (2.0 * l2 * l3).abs();
                let k1 = (d2 + l2 * l2 - l3 * l3) / (2.0 * l2);
                (posture.cos[0], posture.sin[0]) = self.base_yaw(target, s, lateral, radius2);
                for (elbow, sin3) in [(0, -sin3), (1, sin3)] {
                    let k2 = l3 * sin3;
                    let (cos2, sin2) =
                        if d2 > 0.0 { ((k1 * u + k2 * v) / d2, (k1 * v - k2 * u) / d2) } else { (1.0, 0.0) };
                    let (c23, s23) = (cos2 * cos3 - sin2 * sin3, sin2 * cos3 + cos2 * sin3);
                    (posture.cos[1], posture.sin[1]) = (cos2, sin2);
                    (posture.cos[2], posture.sin[2]) = (cos3, sin3);
                    posture.cos[3] = way.cos_phi * c23 + way.sin_phi * s23;
                    posture.sin[3] = way.sin_phi * c23 - way.cos_phi * s23;
                    found((w as u8) << 2 | back | elbow, posture);
                }
            }
        }
        missing.max(0.0)
    }

    /// Cosine and sine of theta_1 that turns (s, -lateral) to the target. On the base axis every
    /// yaw does; the middle of the range is taken.
    #[inline]
    fn base_yaw(&self, target: &Vector3<f64>, s: f64, lateral: f64, radius2: f64) -> (f64, f64) {
        if radius2 < 1e-24 {
            return self.middle_yaw;
        }
        ((target.x * s - target.y * lateral) / radius2, (target.y * s + target.x * lateral) / radius2)
    }
}
