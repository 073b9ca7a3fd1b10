//! Six-axis arms with parallel axes 2, 3 and 4 and intersecting axes 5 and 6, such as the arms of Universal
//! Robots.
//!
//! K. P. Hawkins, "Analytic inverse kinematics for the Universal Robots UR-5/UR-10 arms", 2013. IK-Geo (A.
//! J. Elias, J. T. Wen, 2022) calls the family "three parallel and two intersecting axes".
//!
//! The wrist centre is the point where axes 5 and 6 meet. The coordinate of this point along axis 2 is
//! fixed, which gives theta_1. The angle between axes 2 and 6 gives theta_5. The direction of axis 2 in the
//! flange frame gives theta_6. Links 2 and 3, which move in a plane, then give theta_2, theta_3 and
//! theta_4.

use super::subproblems::{ALIGNED, Angle, BOUNDARY, Twists, TwoLinks, before_twist, difference};
use crate::cell::JointKind;
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;

/// Closed form of an arm with three parallel axes; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct ThreeParallel {
    first: Link,
    /// Directions of axes 3 and 4 relative to axis 2, each 1 or -1: cos alpha_2, and cos alpha_2 times cos
    /// alpha_3.
    sense: (f64, f64),
    /// Coordinate of the wrist centre along axis 2, measured from the origin of frame 1.
    along: f64,
    links: TwoLinks,
    l4: f64,
    r5: f64,
    twists: Twists,
    twist6: Angle,
    /// Wrist centre in the last D-H frame.
    centre: Vector3<f64>,
}

/// One solution for theta_1, and the term that it adds to the branch index: 0 or 4 (bit 2).
#[derive(Clone, Copy)]
struct Yaw {
    bit: u8,
    theta: Angle,
}

/// Quantities that follow from theta_1; vectors are in frame 0.
struct ShoulderSide {
    bit: u8,
    theta: Angle,
    /// Axis x of frame 1, normal to axis 2.
    x: Vector3<f64>,
    /// Axis y of frame 1, normal to axis 2.
    y: Vector3<f64>,
    /// Direction of axis 2, which is axis z of frame 1.
    z: Vector3<f64>,
    /// Wrist centre relative to the origin of frame 1.
    centre: Vector3<f64>,
}

/// Quantities that follow from theta_5 and theta_6; vectors are in frame 0.
struct WristAngles {
    theta5: Angle,
    theta6: Angle,
    x4: Vector3<f64>,
    /// Vector from the wrist centre to the point where axis 4 meets its common normal with axis 5.
    elbow: Vector3<f64>,
}

impl ThreeParallel {
    /// Returns the closed form of an arm with three parallel axes.
    ///
    /// # Errors
    /// Returns the reason if the chain does not belong to this family.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let [a, b, c, d, e, f] = chain.links[..] else {
            return Err(format!("the chain has {} axes, not 6", chain.axes()));
        };
        if chain.links.iter().any(|l| l.kind != JointKind::Revolute) {
            return Err("the chain has a prismatic joint".into());
        }
        if [b, c].iter().any(|l| l.sin_alpha.abs() > 1e-15) {
            return Err("axes 2, 3 and 4 are not exactly parallel (alpha_2, alpha_3)".into());
        }
        if [a, d, e].iter().any(|l| l.sin_alpha.abs() < 1e-6) {
            return Err("axes 1 and 2, 4 and 5, or 5 and 6 are parallel (alpha_1, alpha_4 or alpha_5)".into());
        }
        if b.l.abs() < 1e-6 || c.l.abs() < 1e-6 {
            return Err("the length of an arm link is 0 (l_2 or l_3)".into());
        }
        if e.l.abs() > 1e-12 {
            return Err("axes 5 and 6 do not intersect (l_5 is not 0)".into());
        }
        let sense = (b.cos_alpha.signum(), b.cos_alpha.signum() * c.cos_alpha.signum());
        let angle = |l: &Link| (l.cos_alpha, l.sin_alpha);
        Ok(Self {
            first: a,
            sense,
            along: b.r + sense.0 * c.r + sense.1 * (d.r + e.r * d.cos_alpha),
            links: TwoLinks::new(b.l, c.l),
            l4: d.l,
            r5: e.r,
            twists: Twists::new(angle(&d), angle(&e)),
            twist6: angle(&f),
            centre: -Vector3::new(f.l, f.r * f.sin_alpha, f.r * f.cos_alpha),
        })
    }

    /// Calls `found` with every posture that puts the last D-H frame at `flange`; joint limits are ignored.
    ///
    /// `flange` is a pose in frame 0, without the tool. `posture` is working memory. Before the call, it must
    /// hold the constant D-H values of the chain, such as r of a revolute joint. The function overwrites the
    /// joint coordinates.
    ///
    /// Bit 0 of the branch index distinguishes the two elbow solutions. Bit 1 is set if sin theta_5 < 0. Bit
    /// 2 distinguishes the two solutions for theta_1.
    ///
    /// If axis 6 is parallel to axis 2, theta_6 is free and bit 1 is 0. The solver sets theta_6 to 0 if the
    /// arm then reaches the target. Otherwise, the solver chooses theta_6 so that the distance between axes 2
    /// and 4 is in the middle of its possible range.
    ///
    /// If the wrist centre is on axis 1 and the arm has no offset along axis 2, theta_1 is free. In that
    /// case, bit 2 is 0, and a scan sets theta_1 to the first angle with a solution.
    ///
    /// Returns the distance (m) by which the wrist centre is out of reach. The equation for theta_1 has no
    /// solution if the wrist centre is too near to axis 1. In this case, the distance is measured along axis
    /// 2. Otherwise the distance is measured in the plane of the arm, normal to axis 2. A distance of 0 does
    /// not always mean that a solution exists. If alpha_4 or alpha_5 is not a right angle, axes 4 to 6 cannot
    /// reach every orientation.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        let (p, a) = (flange.transform(&self.centre), &self.first);
        // The unknown theta_1 solves x sin theta_1 - y cos theta_1 = lateral.
        let lateral = (self.along - a.cos_alpha * (p.z - a.r)) / a.sin_alpha;
        let radius2 = p.x * p.x + p.y * p.y;
        let across2 = radius2 - lateral * lateral;
        if across2 < 0.0 && lateral.abs() - radius2.sqrt() > BOUNDARY {
            return (lateral.abs() - radius2.sqrt()) * a.sin_alpha.abs();
        }
        let axes = before_twist(&flange.rotation, self.twist6);
        if radius2 < ALIGNED * ALIGNED {
            return self.any_yaw(&p, &axes, posture, found);
        }
        let across2 = across2.max(0.0);
        let (across, per) = (across2.sqrt(), 1.0 / (radius2 * (across2 + lateral * lateral)).sqrt());
        let mut missing = f64::INFINITY;
        for (bit, t) in [(0, across), (4, -across)] {
            let theta = ((p.x * t - p.y * lateral) * per, (p.y * t + p.x * lateral) * per);
            missing = missing.min(self.side(Yaw { bit, theta }, &p, &axes, posture, found));
        }
        if missing.is_finite() { missing } else { 0.0 }
    }

    /// Solves for a wrist centre on axis 1 by a scan of theta_1, which is free. Returns the distance (m) by
    /// which the wrist centre is out of reach.
    #[cold]
    fn any_yaw(
        &self,
        p: &Vector3<f64>,
        axes: &[Vector3<f64>; 3],
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        const TURNS: usize = 64;
        let angle = |turn: f64| (turn.cos(), turn.sin());
        let mut yaw = |turn: f64| self.side(Yaw { bit: 0, theta: angle(turn) }, p, axes, posture, found);
        let mut step = std::f64::consts::TAU / TURNS as f64;
        let (mut least, mut best) = (f64::INFINITY, 0.0);
        for k in 0..TURNS {
            let missing = yaw(k as f64 * step);
            if missing == 0.0 {
                return 0.0;
            }
            if missing < least {
                (least, best) = (missing, k as f64 * step);
            }
        }
        // Solutions may lie between the scanned angles.
        for _ in 0..30 {
            step *= 0.5;
            for turn in [best - step, best + step] {
                let missing = yaw(turn);
                if missing == 0.0 {
                    return 0.0;
                }
                if missing < least {
                    (least, best) = (missing, turn);
                }
            }
        }
        if least.is_finite() { least } else { 0.0 }
    }

    /// Solves for joints 2 to 6 at a given theta_1. Returns the distance (m) by which the target is out of
    /// reach in the plane of the arm. The distance is infinite if axes 4 to 6 cannot reach the orientation.
    #[inline]
    fn side(
        &self,
        Yaw { bit, theta }: Yaw,
        p: &Vector3<f64>,
        [x6, y6, z6]: &[Vector3<f64>; 3],
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let (a, (c, s)) = (&self.first, theta);
        let (ca, sa) = (a.cos_alpha, a.sin_alpha);
        let side = ShoulderSide {
            bit,
            theta,
            x: Vector3::new(c, s, 0.0),
            y: Vector3::new(-s * ca, c * ca, sa),
            z: Vector3::new(s * sa, -c * sa, ca),
            centre: Vector3::new(p.x - a.l * c, p.y - a.l * s, p.z - a.r),
        };
        // Direction of axis 4 (axis z or -z of frame 1), in the axes of frame 6 before its twist alpha_6.
        let w = [x6, y6, z6].map(|axis| self.sense.1 * axis.dot(&side.z));
        let across2 = w[0] * w[0] + w[1] * w[1];
        let Some((cos5, sin5)) = self.twists.turn(w[2], across2) else { return f64::INFINITY };
        let ((cd, sd), (ce, se)) = (self.twists.first, self.twists.second);
        // Before the rotation by theta_6, axis 4 has the components x = +-u and y = v.
        let (u, v) = (sd * sin5, ce * sd * cos5 + se * cd);
        let size2 = u * u + v * v;
        if across2.min(size2) < ALIGNED * ALIGNED {
            return self.in_line(&side, [x6, y6, z6], (cos5, sin5), posture, found);
        }
        let per = 1.0 / (size2 * across2).sqrt();
        let mut missing = f64::INFINITY;
        for (flipped, sin5, u) in [(0, sin5, u), (2, -sin5, -u)] {
            // Rz(theta_6) w = (u, v).
            let theta6 = ((w[0] * u + w[1] * v) * per, (w[0] * v - w[1] * u) * per);
            let wrist = self.wrist([x6, y6, z6], (cos5, sin5), theta6);
            missing = missing.min(self.plane(flipped, &side, &wrist, posture, found));
        }
        missing
    }

    /// Returns theta_5 and theta_6, and the quantities that follow from these angles.
    #[inline]
    fn wrist(&self, [x6, y6, z6]: [&Vector3<f64>; 3], theta5: Angle, theta6: Angle) -> WristAngles {
        let (ce, se) = self.twists.second;
        let (x5, y5) = (x6 * theta6.0 - y6 * theta6.1, x6 * theta6.1 + y6 * theta6.0);
        let x4 = x5 * theta5.0 - (y5 * ce - z6 * se) * theta5.1;
        let axis5 = y5 * se + z6 * ce;
        WristAngles { theta5, theta6, x4, elbow: -(axis5 * self.r5 + x4 * self.l4) }
    }

    /// Solves for theta_2 to theta_4 in the plane of the arm. Returns the distance (m) by which the target
    /// is out of reach.
    #[inline]
    fn plane(
        &self,
        flipped: u8,
        side: &ShoulderSide,
        wrist: &WristAngles,
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let o3 = side.centre + wrist.elbow;
        let elbows = match self.links.solve(side.x.dot(&o3), side.y.dot(&o3)) {
            Ok(elbows) => elbows,
            Err(missing) => return missing,
        };
        let whole = (side.x.dot(&wrist.x4), side.y.dot(&wrist.x4));
        (posture.cos[0], posture.sin[0]) = side.theta;
        (posture.cos[4], posture.sin[4]) = wrist.theta5;
        (posture.cos[5], posture.sin[5]) = wrist.theta6;
        for (elbow, (second, third)) in (0..).zip(elbows) {
            let fourth = difference(difference(whole, second), third);
            (posture.cos[1], posture.sin[1]) = second;
            (posture.cos[2], posture.sin[2]) = (third.0, self.sense.0 * third.1);
            (posture.cos[3], posture.sin[3]) = (fourth.0, self.sense.1 * fourth.1);
            found(side.bit | flipped | elbow, posture);
        }
        0.0
    }

    /// Solves for a target with axis 6 parallel to axis 2. In this case, theta_6 is free and rotates axis 4
    /// about the wrist centre. Returns the distance (m) by which the target is out of reach.
    #[cold]
    fn in_line(
        &self,
        side: &ShoulderSide,
        axes: [&Vector3<f64>; 3],
        theta5: Angle,
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let wrist = self.wrist(axes, theta5, (1.0, 0.0));
        let missing = self.plane(0, side, &wrist, posture, found);
        if missing == 0.0 {
            return 0.0;
        }
        let in_plane = |v: &Vector3<f64>| (side.x.dot(v), side.y.dot(v));
        let (centre, elbow) = (in_plane(&side.centre), in_plane(&wrist.elbow));
        let (far, near) = (centre.0.hypot(centre.1), elbow.0.hypot(elbow.1));
        if far < ALIGNED || near < ALIGNED {
            return missing;
        }
        let (least, most) = self.links.range();
        let (lo, hi) = (least.max((far - near).abs()), most.min(far + near));
        if lo > hi + BOUNDARY {
            return lo - hi;
        }
        // Law of cosines, with the distance between axes 2 and 4 in the middle of its possible range.
        let d = (lo + hi) / 2.0;
        let cos = ((d * d - far * far - near * near) / (2.0 * far * near)).clamp(-1.0, 1.0);
        let unit = |v: (f64, f64), size: f64| (v.0 / size, v.1 / size);
        let (from, to) = (unit(elbow, near), unit(centre, far));
        let bend = difference((cos, (1.0 - cos * cos).sqrt()), difference(from, to));
        let theta6 = (bend.0, -bend.1 * side.z.dot(axes[2]).signum());
        self.plane(0, side, &self.wrist(axes, theta5, theta6), posture, found)
    }
}
