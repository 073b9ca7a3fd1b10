//! Closed form of three arbitrary joints, revolute or prismatic, that must put a point at a target.
//!
//! Joint 3 moves the point on a circle or on a line. In the frame of joint 2, the coordinates of the point
//! are linear in (1, cos theta_3, sin theta_3) or in (1, r_3). Joints 1 and 2 cannot change certain
//! quantities, such as distances from a revolute axis and heights along it. These quantities give one
//! equation of at most the fourth degree for joint 3 (Pieper 1968). The value of joint 3 then
//! determines joint 2. Joints 2 and 3 together determine joint 1. Newton's method refines and checks each
//! solution.

use super::pieper::{PointForms, PointTarget};
use super::quartic::{Quadratic, real_roots, value};
use super::reach_section::ReachSection;
use super::subproblems::{ALIGNED, Angle, BOUNDARY};
use super::three_joint_point::{ThreeJointPoint, ThreeJointState};
use crate::cell::JointKind::{Prismatic, Revolute};
use crate::reach::Shell;
use crate::robot::{Link, Posture};
use nalgebra::Vector3;
use std::sync::Arc;

/// Largest distance of an accepted solution from its target, m.
const ACCURACY: f64 = 1e-10;

/// Closed form of three joints that put a point at a target; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct ThreeJoints {
    /// Whether [`Self::solve`] returns a lower bound, not the actual distance, for a target out of reach.
    pub fast: bool,
    forms: PointForms,
    r1: f64,
    point: ThreeJointPoint,
    /// Table of lower bounds of the distance from a target to the reachable points.
    ///
    /// The field is None if a joint is prismatic.
    section: Option<Arc<ReachSection>>,
    /// Shell that contains all reachable points; None if a joint is prismatic.
    shell: Option<Shell>,
}

/// Solution for joint 3: `a` is cos theta_3, and `b` is sin theta_3. For a prismatic joint, `a` is r_3, and
/// `b` is 0.
#[derive(Clone, Copy)]
struct Third {
    a: f64,
    b: f64,
    /// Whether the polynomial of Pieper's equation increases at the solution.
    rising: bool,
}

/// Smallest value, m, that [`ThreeJoints::solve`] returns for an unreachable target if `fast` is set.
const LEAST_BOUND: f64 = 1e-12;

impl ThreeJoints {
    /// Returns the closed form for the point on axis 4 at a distance `r4` (m) from the origin of frame 3.
    ///
    /// # Errors
    /// Fails if the joints cannot move the point in all directions, or if their geometry is nearly
    /// degenerate. The message states which of these is true.
    pub fn new(links: &[Link; 3], r4: f64) -> Result<Self, String> {
        let mut arm = Self {
            forms: PointForms::new(links, r4),
            r1: links[0].r,
            point: ThreeJointPoint { links: *links, r4 },
            section: None,
            shell: None,
            fast: false,
        };
        arm.check()?;
        if arm.point.turns_only() {
            arm.section = Some(Arc::new(ReachSection::new(&arm.point)));
            arm.shell = Some(arm.new_shell());
        }
        Ok(arm)
    }

    /// Checks that the joints can move the point in all directions, and that their geometry is not nearly
    /// degenerate.
    fn check(&self) -> Result<(), String> {
        let small = |x: f64| x != 0.0 && x.abs() < 1e-6;
        let (ca, sa) = self.forms.twist1;
        if small(self.forms.l1) || small(ca) || small(sa) {
            return Err("l_1, sin alpha_1 or cos alpha_1 is nearly, but not exactly, 0".into());
        }
        if !self.point.moves_in_space() {
            return Err(
                "in every posture, there is a direction in which the first three joints cannot move the wrist centre".into(),
            );
        }
        Ok(())
    }

    /// Calls `found` with every solution for the first three joints that puts the point at `p`.
    ///
    /// `p` is in frame 0, m. Bit 0 of the branch index distinguishes the two solutions for joint 2. Bit 1 is
    /// set if the polynomial of Pieper's equation increases at the solution for joint 3. If two roots of this
    /// equation have the same bit 1, bit 2 is set for the second of the two. The roots are in ascending order
    /// of theta_3 from -180 degrees, or of r_3 if joint 3 is prismatic. The index of a solution in continuous
    /// motion changes only at a singularity or at theta_3 = 180 degrees.
    ///
    /// If the point lies on the axis of a joint, the angle theta of that joint is 0.
    ///
    /// Returns the distance from `p` to the nearest reachable point, m; 0 if there is a solution. If `fast`
    /// is set, the function returns a lower bound of the distance.
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
        if self.fast {
            return self.bound(p).max(LEAST_BOUND);
        }
        let (missing, joints) = self.nearest(p);
        if missing > ACCURACY {
            return missing;
        }
        // At the boundary of the reach, rounding may hide a root.
        self.write(&joints, posture);
        found(0, posture);
        0.0
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns for a target in frame 0.
    pub fn bound(&self, p: &Vector3<f64>) -> f64 {
        let by_section = self.section.as_ref().map_or(0.0, |section| section.bound(p));
        let by_shell = self.shell.map_or(0.0, |shell| {
            let distance = (p - shell.centre).norm();
            shell.gap(distance, distance) - BOUNDARY
        });
        by_section.max(by_shell)
    }

    /// Returns a shell in frame 0 that contains all reachable points; None if a joint is prismatic.
    pub fn shell(&self) -> Option<Shell> {
        self.shell
    }

    /// Computes [`Self::shell`] for three revolute joints.
    ///
    /// The squared distance of the point from the origin of frame 1 is a sinusoid of theta_3. The origin of
    /// frame 1 moves on a circle about axis 1 with the radius `l_1`.
    fn new_shell(&self) -> Shell {
        let (form, z) = &self.forms.distance2;
        let (middle, amplitude) = (form[0] + z[0] * z[0], form[1].hypot(form[2]));
        let [least, most] = [middle - amplitude, middle + amplitude].map(|square| square.max(0.0).sqrt());
        let aside = self.forms.l1.abs();
        Shell {
            centre: Vector3::new(0.0, 0.0, self.r1),
            inner: (least - aside).max(0.0),
            outer: most + aside,
        }
    }

    /// Returns the least distance of the point from `p` (m), and the D-H variables that give this distance.
    fn nearest(&self, p: &Vector3<f64>) -> (f64, ThreeJointState) {
        let Some(section) = &self.section else { return self.point.nearest(p) };
        let approached = section.starts(&self.point, p).map(|mut joints| {
            self.point.aim(p, &mut joints);
            self.point.approached(p, joints)
        });
        approached.reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or_else(|| self.point.nearest(p))
    }

    fn write(&self, joints: &ThreeJointState, posture: &mut Posture) {
        for j in 0..3 {
            (posture.cos[j], posture.sin[j]) = joints.theta[j];
            if self.forms.kinds[j] == Prismatic {
                posture.r[j] = joints.r[j];
            }
        }
    }

    fn target(&self, p: &Vector3<f64>) -> PointTarget {
        let height = p.z - self.r1;
        let distance2 = p.x * p.x + p.y * p.y + height * height - self.forms.l1 * self.forms.l1;
        let (c, s) = self.forms.zero[0];
        PointTarget { p: *p, height, distance2, x: c * p.x + s * p.y, y: c * p.y - s * p.x }
    }

    /// Returns the solutions for joint 3 and their number.
    ///
    /// The solutions are in ascending order of theta_3 from -180 degrees, or of r_3 if joint 3 is prismatic.
    fn thirds(&self, target: &PointTarget) -> ([Third; 4], usize) {
        let origin = if self.forms.kinds[2] == Revolute { self.origin(target) } else { (1.0, 0.0) };
        let path = self.forms.path(origin);
        let equation = self.forms.equation(target, &path);
        let mut thirds = [Third { a: 0.0, b: 0.0, rising: false }; 4];
        let roots = real_roots(&equation);
        let slope = [equation[1], 2.0 * equation[2], 3.0 * equation[3], 4.0 * equation[4], 0.0];
        for (third, &t) in thirds.iter_mut().zip(roots.all()) {
            let at = |q: &Quadratic| q[0] + t * (q[1] + t * q[2]);
            let (a, b) = (at(&path.a) / at(&path.one), at(&path.b) / at(&path.one));
            *third = Third { a, b, rising: value(&slope, t) > 0.0 };
        }
        let count = roots.all().len();
        // This key increases with the angle from -180 to 180 degrees.
        let order = |t: &Third| match self.forms.kinds[2] {
            Revolute => (1.0 - t.a).copysign(t.b),
            Prismatic => t.a,
        };
        thirds[..count].sort_unstable_by(|s, t| order(s).total_cmp(&order(t)));
        (thirds, count)
    }

    /// Returns the angle from which theta_3 is measured in Pieper's equation.
    ///
    /// The unknown of the equation is the tangent of half the angle between theta_3 and this origin. The
    /// tangent is infinite at the angle opposite to the origin, so this angle must not be a root. Among six
    /// candidates, the function chooses the origin for which the polynomial is farthest from 0 at the
    /// opposite angle.
    fn origin(&self, target: &PointTarget) -> Angle {
        let p = self.forms.equation(target, &self.forms.path((1.0, 0.0)));
        let (ca, sa) = self.forms.twist1;
        let quartic = match (self.forms.kinds[0], self.forms.kinds[1]) {
            (Revolute, Revolute) => self.forms.l1 != 0.0 && sa != 0.0,
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

    /// Returns up to two solutions (theta_2, r_2) for joint 2, and their number.
    fn seconds(&self, target: &PointTarget, third: &Third) -> ([(Angle, f64); 2], usize) {
        let at = |f: &Quadratic| f[0] + f[1] * third.a + f[2] * third.b;
        let (u, v, h) = (at(&self.forms.u), at(&self.forms.v), at(&self.forms.h));
        let ((ca, sa), (c2, s2)) = (self.forms.twist1, self.forms.zero[1]);
        let size2 = u * u + v * v;
        if self.forms.kinds[1] == Prismatic {
            let (x, y) = (c2 * u - s2 * v, s2 * u + c2 * v);
            let slide = |height: f64| (self.forms.zero[1], height - h);
            return match (self.forms.kinds[0], ca == 0.0) {
                (Prismatic, _) => ([slide((ca * y - target.y) / sa); 2], 1),
                (Revolute, false) => ([slide((target.height - sa * y) / ca); 2], 1),
                (Revolute, true) => {
                    let root = (target.distance2 - size2 - 2.0 * self.forms.l1 * x).max(0.0).sqrt();
                    ([slide(-root), slide(root)], 2)
                }
            };
        }
        let r2 = self.point.links[1].r;
        // Known coordinates x and y of the point in frame 1.
        let (x, y) = match self.forms.kinds[0] {
            Prismatic => (Some(target.x - self.forms.l1), (ca != 0.0).then(|| (target.y + sa * h) / ca)),
            Revolute => {
                let far = size2 + h * h;
                let x = (self.forms.l1 != 0.0).then(|| (target.distance2 - far) / (2.0 * self.forms.l1));
                (x, (sa != 0.0).then(|| (target.height - ca * h) / sa))
            }
        };
        let (angles, count) = from_plane((u, v), x, y);
        (angles.map(|theta| (theta, r2)), count)
    }

    /// Returns the D-H variables of all three joints. A revolute joint 1 rotates the point to the heading of
    /// the target. A prismatic joint 1 moves the point to the height of the target.
    fn joints(&self, target: &PointTarget, third: &Third, theta2: Angle, r2: f64) -> ThreeJointState {
        let links = &self.point.links;
        let (theta3, r3) = match self.forms.kinds[2] {
            Revolute => ((third.a, third.b), links[2].r),
            Prismatic => ((links[2].theta.cos(), links[2].theta.sin()), third.a),
        };
        let mut joints =
            ThreeJointState { theta: [self.forms.zero[0], theta2, theta3], r: [self.r1, r2, r3] };
        self.point.aim(&target.p, &mut joints);
        joints
    }
}

/// Returns an array of two rotations, and the number of valid rotations: 0 to 2. A rotation turns the vector
/// (u, v) so that its coordinates become `x` and `y`.
///
/// A coordinate that is None is not prescribed.
///
/// Rounding may make `x` and `y` contradict each other; Newton's method later corrects the result.
fn from_plane((u, v): Angle, x: Option<f64>, y: Option<f64>) -> ([Angle; 2], usize) {
    let norm = |x: f64, y: f64| (x * x + y * y).sqrt();
    let size = norm(u, v);
    if size < ALIGNED {
        return ([(1.0, 0.0); 2], 1);
    }
    let turn = |x: f64, y: f64| {
        let per = 1.0 / (size * norm(x, y));
        if per.is_finite() { ((u * x + v * y) * per, (u * y - v * x) * per) } else { (1.0, 0.0) }
    };
    // A double root for joint 3 is accurate only to the square root of the rounding error.
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
