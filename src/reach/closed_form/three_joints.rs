//! Any first three joints, turning or sliding, that must put a point of the third link somewhere.
//!
//! Joint 3 moves the point on a circle or on a line; in the frame of joint 2 its coordinates are
//! linear in (1, cos theta_3, sin theta_3) or (1, r_3). What joints 1 and 2 cannot change (distances
//! from their axes, heights along them) gives one equation of at most the fourth degree (Pieper 1968);
//! joints 2 and 1 follow. Newton's method on the point itself polishes each solution and decides.

use super::pieper::combined;
use super::quartic::{Quadratic, real_roots, value};
use super::subproblems::{ALIGNED, Angle};
use crate::cell::JointKind::{self, Prismatic, Revolute};
use crate::reach::nearest::{Joints, Point};
use crate::robot::{Link, Posture};
use nalgebra::Vector3;

/// A solution misses its point by no more, m.
const ACCURACY: f64 = 1e-10;

/// The joints; lengths in m. A form is a triple of factors of 1 and of cos theta_3 and sin theta_3, or
/// of 1 and of r_3 (and a zero).
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct ThreeJoints {
    /// Whether what is missing is not worth its cost: a hundred times that of the solutions.
    pub hasty: bool,
    pub kinds: [JointKind; 3],
    /// (cos, sin) of alpha_1, and of theta_1 and theta_2 at coordinate 0.
    pub twist1: Angle,
    pub zero: [Angle; 2],
    pub l1: f64,
    r1: f64,
    /// The point in frame 1, turned back by theta_2: x, y, and z less a free r_2.
    pub u: Quadratic,
    pub v: Quadratic,
    pub h: Quadratic,
    /// Square of the distance from the origin of frame 1: a form, and a form to be squared.
    pub distance2: (Quadratic, Quadratic),
    point: Point,
}

/// The place of the point as joint 2 needs it.
pub(in crate::reach) struct Target {
    pub p: Vector3<f64>,
    /// Height above the origin of frame 1 along axis 1, and the square of the distance from it, less
    /// l_1 squared; for a sliding joint 1 x and y in the frame turned by theta_1.
    pub height: f64,
    pub distance2: f64,
    pub x: f64,
    pub y: f64,
}

/// Where joint 3 may stand: a = cos theta_3 or r_3, b = sin theta_3.
#[derive(Clone, Copy)]
struct Third {
    a: f64,
    b: f64,
    rising: bool,
}

/// What is missing if nobody wants to know, m.
const UNKNOWN: f64 = 1e-6;

impl ThreeJoints {
    /// `r4`: the point on axis 4, m from the origin of frame 3.
    ///
    /// # Errors
    /// Why the joints cannot put the point anywhere, or not well.
    pub fn new(links: &[Link; 3], r4: f64) -> Result<Self, String> {
        let [a, b, c] = links;
        let kinds = [a.kind, b.kind, c.kind];
        let (across, axial) = (-r4 * c.sin_alpha, r4 * c.cos_alpha);
        let (s3, c3) = c.theta.sin_cos();
        let (x, y, z) = match c.kind {
            Revolute => ([0.0, c.l, -across], [0.0, across, c.l], [c.r + axial, 0.0, 0.0]),
            Prismatic => {
                ([c.l * c3 - across * s3, 0.0, 0.0], [c.l * s3 + across * c3, 0.0, 0.0], [axial, 1.0, 0.0])
            }
        };
        let r2 = if b.kind == Revolute { b.r } else { 0.0 };
        let u = [x[0] + b.l, x[1], x[2]];
        let v = combined(b.cos_alpha, &y, -b.sin_alpha, &z, 0.0);
        let h = combined(b.sin_alpha, &y, b.cos_alpha, &z, r2);
        let constant = c.l * c.l + across * across - b.l * b.l - r2 * r2;
        let form = combined(2.0 * b.l, &u, 2.0 * r2, &h, constant);
        let zero = [a, b].map(|l| (l.theta.cos(), l.theta.sin()));
        let arm = Self {
            kinds,
            twist1: (a.cos_alpha, a.sin_alpha),
            zero,
            l1: a.l,
            r1: a.r,
            u,
            v,
            h,
            distance2: (form, z),
            point: Point { links: *links, r4 },
            hasty: false,
        };
        arm.check().map(|()| arm)
    }

    /// Whether the point can be put anywhere in space.
    fn check(&self) -> Result<(), String> {
        let small = |x: f64| x != 0.0 && x.abs() < 1e-6;
        let (ca, sa) = self.twist1;
        if small(self.l1) || small(ca) || small(sa) {
            return Err("l_1 or alpha_1 is nearly, but not exactly, a special case".into());
        }
        if !self.point.moves_in_space() {
            return Err("the first three joints cannot put the wrist centre anywhere in space".into());
        }
        Ok(())
    }

    /// Writes the first three joints, for every way to put the point at `p` (m, frame 0). Bit 0: which
    /// of two postures of joint 2; bit 1: whether Pieper's equation rises at the solution for joint 3,
    /// bit 2: which of these, from -180 degrees or the lowest on. Neighbours keep their number up to a
    /// singularity or to theta_3 = 180 degrees. Joints on whose axis the point lies are at
    /// theta = 0. Returns the distance of `p` from what is in reach, m.
    pub fn solve(
        &self,
        p: &Vector3<f64>,
        posture: &mut Posture,
        found: &mut impl FnMut(u8, &mut Posture),
    ) -> f64 {
        let target = self.target(p);
        let (thirds, count) = self.thirds(&target);
        let (mut any, mut seen) = (false, [0; 2]);
        for third in &thirds[..count] {
            let rising = usize::from(third.rising);
            let name = (rising as u8) << 1 | seen[rising] << 2;
            seen[rising] += 1;
            let (seconds, count) = self.seconds(&target, third);
            for (k, &(theta2, r2)) in (0..).zip(&seconds[..count]) {
                let mut joints = self.joints(&target, third, theta2, r2);
                if self.point.polish(p, &mut joints) > ACCURACY {
                    continue;
                }
                any = true;
                self.write(&joints, posture);
                found(name | k, posture);
            }
        }
        if any {
            return 0.0;
        }
        if self.hasty {
            return UNKNOWN;
        }
        let (missing, joints) = self.point.nearest(p);
        if missing > ACCURACY {
            return missing;
        }
        // At the boundary rounding may hide a root that is there.
        self.write(&joints, posture);
        found(0, posture);
        0.0
    }

    fn write(&self, joints: &Joints, posture: &mut Posture) {
        for j in 0..3 {
            (posture.cos[j], posture.sin[j]) = joints.theta[j];
            if self.kinds[j] == Prismatic {
                posture.r[j] = joints.r[j];
            }
        }
    }

    fn target(&self, p: &Vector3<f64>) -> Target {
        let height = p.z - self.r1;
        let distance2 = p.x * p.x + p.y * p.y + height * height - self.l1 * self.l1;
        let (c, s) = self.zero[0];
        Target { p: *p, height, distance2, x: c * p.x + s * p.y, y: c * p.y - s * p.x }
    }

    /// Where joint 3 may stand, in ascending order from -180 degrees or the lowest.
    fn thirds(&self, target: &Target) -> ([Third; 4], usize) {
        let origin = if self.kinds[2] == Revolute { self.origin(target) } else { (1.0, 0.0) };
        let path = self.path(origin);
        let equation = self.equation(target, &path);
        let mut thirds = [Third { a: 0.0, b: 0.0, rising: false }; 4];
        let roots = real_roots(&equation);
        let slope = [equation[1], 2.0 * equation[2], 3.0 * equation[3], 4.0 * equation[4], 0.0];
        for (third, &t) in thirds.iter_mut().zip(roots.all()) {
            let at = |q: &Quadratic| q[0] + t * (q[1] + t * q[2]);
            let (a, b) = (at(&path.a) / at(&path.one), at(&path.b) / at(&path.one));
            *third = Third { a, b, rising: value(&slope, t) > 0.0 };
        }
        let count = roots.all().len();
        // Grows with the angle from -180 to 180 degrees.
        let order = |t: &Third| match self.kinds[2] {
            Revolute => (1.0 - t.a).copysign(t.b),
            Prismatic => t.a,
        };
        thirds[..count].sort_unstable_by(|s, t| order(s).total_cmp(&order(t)));
        (thirds, count)
    }

    /// The angle from which theta_3 is measured: no root may be where the tangent of the half angle is
    /// infinite, so opposite to the largest value of the equation.
    fn origin(&self, target: &Target) -> Angle {
        let p = self.equation(target, &self.path((1.0, 0.0)));
        let (ca, sa) = self.twist1;
        let quartic = match (self.kinds[0], self.kinds[1]) {
            (Revolute, Revolute) => self.l1 != 0.0 && sa != 0.0,
            (Prismatic, Prismatic) => false,
            _ => ca != 0.0,
        };
        let (mut most, power) = if quartic { (p[4].abs(), 2) } else { (p[2].abs(), 1) };
        let (mut origin, h) = ((1.0, 0.0), std::f64::consts::FRAC_1_SQRT_2);
        for (c, s) in [(1.0, 0.0), (h, h), (h, -h), (0.0, 1.0), (0.0, -1.0)] {
            let size = value(&p, s / (1.0 + c)).abs() * (0.5 * (1.0 + c)).powi(power);
            if size > most {
                (most, origin) = (size, (-c, -s));
            }
        }
        origin
    }

    /// Where joint 2 may stand (theta, r), up to two.
    fn seconds(&self, target: &Target, third: &Third) -> ([(Angle, f64); 2], usize) {
        let at = |f: &Quadratic| f[0] + f[1] * third.a + f[2] * third.b;
        let (u, v, h) = (at(&self.u), at(&self.v), at(&self.h));
        let ((ca, sa), (c2, s2)) = (self.twist1, self.zero[1]);
        let size2 = u * u + v * v;
        if self.kinds[1] == Prismatic {
            let (x, y) = (c2 * u - s2 * v, s2 * u + c2 * v);
            let slide = |height: f64| (self.zero[1], height - h);
            return match (self.kinds[0], ca == 0.0) {
                (Prismatic, _) => ([slide((ca * y - target.y) / sa); 2], 1),
                (Revolute, false) => ([slide((target.height - sa * y) / ca); 2], 1),
                (Revolute, true) => {
                    let root = (target.distance2 - size2 - 2.0 * self.l1 * x).max(0.0).sqrt();
                    ([slide(-root), slide(root)], 2)
                }
            };
        }
        let r2 = self.point.links[1].r;
        // x and y of the point in frame 1, as far as they are known.
        let (x, y) = match self.kinds[0] {
            Prismatic => (Some(target.x - self.l1), (ca != 0.0).then(|| (target.y + sa * h) / ca)),
            Revolute => {
                let far = size2 + h * h;
                let x = (self.l1 != 0.0).then(|| (target.distance2 - far) / (2.0 * self.l1));
                (x, (sa != 0.0).then(|| (target.height - ca * h) / sa))
            }
        };
        let (angles, count) = from_plane((u, v), x, y);
        (angles.map(|theta| (theta, r2)), count)
    }

    /// The joints, joint 1 such that the point lies in the right direction or at the right height.
    fn joints(&self, target: &Target, third: &Third, theta2: Angle, r2: f64) -> Joints {
        let links = &self.point.links;
        let (theta3, r3) = match self.kinds[2] {
            Revolute => ((third.a, third.b), links[2].r),
            Prismatic => ((links[2].theta.cos(), links[2].theta.sin()), third.a),
        };
        let mut joints = Joints { theta: [self.zero[0], theta2, theta3], r: [self.r1, r2, r3] };
        self.point.aim(&target.p, &mut joints);
        joints
    }
}

/// The turns of (u, v) to x, to y or to both; what contradicts by rounding is left to the polish.
fn from_plane((u, v): Angle, x: Option<f64>, y: Option<f64>) -> ([Angle; 2], usize) {
    let size = u.hypot(v);
    if size < ALIGNED {
        return ([(1.0, 0.0); 2], 1);
    }
    let turn = |x: f64, y: f64| {
        let per = 1.0 / (size * x.hypot(y));
        if per.is_finite() { ((u * x + v * y) * per, (u * y - v * x) * per) } else { (1.0, 0.0) }
    };
    // A double root of the third joint is known to the root of the rounding only.
    let other = |known: f64| {
        let rest = size * size - known * known;
        (rest > -1e-6 * size * size).then(|| rest.max(0.0).sqrt())
    };
    match (x, y) {
        (Some(x), Some(y)) => ([turn(x, y); 2], 1),
        (Some(x), None) => other(x).map_or(([(1.0, 0.0); 2], 0), |y| ([turn(x, -y), turn(x, y)], 2)),
        (None, Some(y)) => other(y).map_or(([(1.0, 0.0); 2], 0), |x| ([turn(-x, y), turn(x, y)], 2)),
        (None, None) => ([(1.0, 0.0); 2], 0),
    }
}
