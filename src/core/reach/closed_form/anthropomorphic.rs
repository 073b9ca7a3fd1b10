//! Closed form of the first three joints of most industrial arms: a yaw, then two parallel axes
//! perpendicular to the yaw axis. The arm may have offsets along its axes and between them.
//!
//! M. Brandstoetter, A. Angerer, M. Hofbaur, "An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist", 2014.

use super::subproblems::{ALIGNED, Angle, BOUNDARY, TwoLinks, difference};
use crate::cell::JointKind;
use crate::robot::{Link, Posture};
use nalgebra::Vector3;

/// Closed form of the joints up to the wrist centre; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct Anthropomorphic {
    /// Sine of alpha_1, the D-H twist between axes 1 and 2: 1 or -1.
    side: f64,
    /// Cosine of alpha_2, the D-H twist between axes 2 and 3: 1 or -1.
    flip: f64,
    r1: f64,
    l1: f64,
    /// Coordinate y of the wrist centre in frame 0 rotated by theta_1 about its z axis.
    lateral: f64,
    links: TwoLinks,
    /// Cosine and sine of the angle from axis x of frame 2 to the wrist centre at theta_3 = 0.
    ///
    /// The angle is positive about axis 2, and its vertex is on axis 3.
    forearm: Angle,
}

impl Anthropomorphic {
    /// Returns the closed form of the first three D-H rows; None if the arm is of another kind.
    ///
    /// `tip` is the wrist centre, m, in frame 2 rotated by theta_3 about its z axis.
    pub fn new([a, b, c]: &[Link; 3], tip: &Vector3<f64>) -> Option<Self> {
        let turning = [a, b, c].iter().all(|l| l.kind == JointKind::Revolute);
        let forearm = tip.x.hypot(tip.y);
        let lengths = b.l.abs() > 1e-6 && forearm > 1e-6;
        if !turning || !lengths || a.cos_alpha.abs() > 1e-15 || b.sin_alpha.abs() > 1e-15 {
            return None;
        }
        let (side, flip) = (a.sin_alpha.signum(), b.cos_alpha.signum());
        Some(Self {
            side,
            flip,
            r1: a.r,
            l1: a.l,
            lateral: -side * (b.r + flip * tip.z),
            links: TwoLinks::new(b.l, forearm),
            forearm: (tip.x / forearm, flip * tip.y / forearm),
        })
    }

    /// Calls `found` with every solution (branch index, theta_1 to theta_3) for the wrist centre `p`.
    ///
    /// `p` is in frame 0, m. Bit 0 of the branch index tells the two elbow solutions apart. Bit 1 is set if
    /// the arm leans back over its base. If the wrist centre lies on axis 1, theta_1 is free and becomes 0.
    ///
    /// Returns the distance from `p` to the nearest reachable point, m; 0 if there is a solution.
    #[inline]
    pub fn solve(
        &self,
        p: &Vector3<f64>,
        posture: &mut Posture,
        found: &mut impl FnMut(u8, &mut Posture),
    ) -> f64 {
        let radius2 = p.x * p.x + p.y * p.y;
        let along2 = radius2 - self.lateral * self.lateral;
        let on_axis = radius2 < ALIGNED * ALIGNED;
        let mut any = false;
        if along2 >= 0.0 || self.lateral.abs() - radius2.sqrt() < BOUNDARY {
            let along2 = along2.max(0.0);
            let per = 1.0 / (radius2 * (along2 + self.lateral * self.lateral)).sqrt();
            let along = along2.sqrt();
            for (back, s) in [(0, along), (2, -along)] {
                let elbows = self.links.solve(s - self.l1, self.side * (p.z - self.r1));
                let (false, Ok(elbows)) = (on_axis && back > 0, elbows) else { continue };
                any = true;
                (posture.cos[0], posture.sin[0]) = match on_axis {
                    true => (1.0, 0.0),
                    false => ((p.x * s + p.y * self.lateral) * per, (p.y * s - p.x * self.lateral) * per),
                };
                for (elbow, (second, third)) in (0..).zip(elbows) {
                    let third = difference(third, self.forearm);
                    (posture.cos[1], posture.sin[1]) = second;
                    (posture.cos[2], posture.sin[2]) = (third.0, self.flip * third.1);
                    found(back | elbow, posture);
                }
            }
        }
        if any { 0.0 } else { self.missing(radius2.sqrt(), self.side * (p.z - self.r1)) }
    }

    /// Returns the distance (m) from a target to the nearest point that the arm reaches.
    ///
    /// `radius` is the distance of the target from axis 1. `height` is the height of the target above the
    /// origin of frame 1, negated if alpha_1 is -90 degrees.
    ///
    /// The function alternates between two steps, and each of them shortens the distance. The first step
    /// finds the nearest point in the plane of the arm for a fixed yaw. The second step finds the best yaw
    /// for that point.
    fn missing(&self, radius: f64, height: f64) -> f64 {
        const MAX_STEPS: usize = 100;
        let (least, most) = self.links.range();
        let mut missing = f64::INFINITY;
        for start in [radius, -radius] {
            let (mut s, mut by) = (start, f64::INFINITY);
            for _ in 0..MAX_STEPS {
                let turned = if s == 0.0 { 0.0 } else { radius * s / s.hypot(self.lateral) };
                let x = turned - self.l1;
                let d = x.hypot(height);
                let (x, y) = if d > 0.0 { (x / d, height / d) } else { (1.0, 0.0) };
                let reached = d.clamp(least, most);
                let (next, up) = (self.l1 + x * reached, y * reached);
                by = (next.hypot(self.lateral) - radius).hypot(up - height);
                if (next - s).abs() < 1e-11 {
                    break;
                }
                s = next;
            }
            missing = missing.min(by);
        }
        missing
    }
}
