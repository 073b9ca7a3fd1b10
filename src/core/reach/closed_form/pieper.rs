//! Pieper's equation for three arbitrary joints that put a point at a target. The unknown of the equation is
//! the coordinate of joint 3.
//!
//! D. L. Pieper, "The Kinematics of Manipulators under Computer Control", thesis, Stanford 1968.

use super::quartic::{Polynomial, Quadratic, combined, product};
use super::subproblems::Angle;
use crate::cell::JointKind::{self, Prismatic, Revolute};
use crate::robot::Link;
use nalgebra::Vector3;

/// Coordinates of the point that three joints move, as linear forms in the variable of joint 3; lengths in m.
///
/// A form has three coefficients. For a revolute joint 3, the coefficients multiply 1, cos theta_3 and sin
/// theta_3. For a prismatic joint 3, the first two multiply 1 and the D-H offset r_3, and the third is 0.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct PointForms {
    pub kinds: [JointKind; 3],
    /// Cosine and sine of alpha_1, the D-H twist between axes 1 and 2.
    pub twist1: Angle,
    /// Cosine and sine of theta_1 and of theta_2 at joint coordinate 0.
    pub zero: [Angle; 2],
    pub l1: f64,
    /// Coordinate x of the point in a rotated frame: frame 1 after the rotation by theta_2 about z.
    pub u: Quadratic,
    /// Coordinate y of the point in the frame of `u`.
    pub v: Quadratic,
    /// Coordinate z of the point in frame 1. If joint 2 is prismatic, the D-H offset r_2 is left out.
    pub h: Quadratic,
    /// Two forms F and G; `F + G^2` is the squared distance of the point from the origin of frame 1. The
    /// forms are used only if joint 2 is revolute.
    pub distance2: (Quadratic, Quadratic),
}

/// Target of the point that three joints move.
///
/// The struct contains the position in frame 0, and quantities that joint 1 cannot change.
pub(in crate::reach) struct PointTarget {
    /// Target in frame 0, m.
    pub p: Vector3<f64>,
    /// Height of the target above the origin of frame 1 along axis 1, m. The height is used only if joint 1
    /// is revolute.
    pub height: f64,
    /// Squared distance of the target from a point Q, minus `l_1^2`, m^2.
    ///
    /// Q is the point where the common normal of axes 1 and 2 meets axis 1. l_1 is the D-H length of link 1.
    /// The value is used only if joint 1 is revolute.
    pub distance2: f64,
    /// Coordinate x of the target, m, in a rotated frame: frame 0 after the rotation by theta_1 about z.
    /// The value is used only if joint 1 is prismatic, so theta_1 is fixed.
    pub x: f64,
    /// Coordinate y of the target in the frame of `x`, m.
    pub y: f64,
}

/// Joint 3 as a function of a parameter t, given by the ratios of three polynomials of t.
///
/// For a revolute joint 3, `a / one` is cos theta_3 and `b / one` is sin theta_3. For a prismatic joint 3,
/// `a / one` is the D-H offset r_3, and `b` is 0.
pub(in crate::reach) struct Path {
    pub one: Quadratic,
    pub a: Quadratic,
    pub b: Quadratic,
}

impl Path {
    /// Returns the polynomial `f[0] * one + f[1] * a + f[2] * b` of the parameter t.
    ///
    /// This polynomial divided by `one` is the value of the linear form `f` (see [`PointForms`]) on this
    /// path.
    fn on(&self, f: &Quadratic) -> Quadratic {
        std::array::from_fn(|k| f[0] * self.one[k] + f[1] * self.a[k] + f[2] * self.b[k])
    }

    /// Returns the polynomial `constant * one - p`, where `p` is a polynomial that `on` returned.
    fn minus(&self, constant: f64, p: &Quadratic) -> Quadratic {
        std::array::from_fn(|k| constant * self.one[k] - p[k])
    }
}

impl PointForms {
    /// Returns the linear forms of the point on axis 4 at a distance `r4` (m) from the origin of frame 3.
    pub fn new(links: &[Link; 3], r4: f64) -> Self {
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
        let twist1 = (a.cos_alpha, a.sin_alpha);
        Self { kinds, twist1, zero, l1: a.l, u, v, h, distance2: (form, z) }
    }

    /// Returns joint 3 as a function of a parameter t.
    ///
    /// For a prismatic joint 3, t is the D-H offset r_3. For a revolute joint 3, t is
    /// `tan((theta_3 - o) / 2)`. The origin o is the angle with the cosine `c` and the sine `s`.
    pub fn path(&self, (c, s): Angle) -> Path {
        match self.kinds[2] {
            Revolute => Path { one: [1.0, 0.0, 1.0], a: [c, -2.0 * s, -c], b: [s, 2.0 * c, -s] },
            Prismatic => Path { one: [1.0, 0.0, 0.0], a: [0.0, 1.0, 0.0], b: [0.0; 3] },
        }
    }

    /// Returns Pieper's equation: a polynomial of the parameter t of `path` that is 0 at every solution.
    ///
    /// Some roots are not solutions, because joints 1 and 2 cannot bring the point to the target.
    pub fn equation(&self, target: &PointTarget, path: &Path) -> Polynomial {
        let (u, v, h) = (path.on(&self.u), path.on(&self.v), path.on(&self.h));
        match (self.kinds[0], self.kinds[1]) {
            (Revolute, Revolute) => self.both_turn(target, path, &h),
            (Prismatic, Revolute) => self.slide_turns(target, path, &h),
            (Revolute, Prismatic) => self.turn_slides(target, path, &self.turned(&u, &v)),
            (Prismatic, Prismatic) => raised(&path.minus(target.x - self.l1, &self.turned(&u, &v).0)),
        }
    }

    /// Returns Pieper's equation for revolute joints 1 and 2.
    ///
    /// Coordinate x of the point in frame 1 follows from [`PointTarget::distance2`]. Coordinate y follows
    /// from [`PointTarget::height`]. The equation states that `x^2 + y^2` is the squared distance of the
    /// point from axis 2. If the D-H length l_1 is 0, only the distances of point and target from the origin
    /// of frame 1 are compared. If sin alpha_1 is 0, only their heights along axis 1 are compared.
    fn both_turn(&self, target: &PointTarget, path: &Path, h: &Quadratic) -> Polynomial {
        let ((ca, sa), l1, far) = (self.twist1, self.l1, self.distance2_on(path));
        let (e, z) = (path.minus(target.distance2, &far), path.minus(target.height, &h.map(|k| ca * k)));
        if l1 == 0.0 {
            return raised(&e);
        }
        if sa == 0.0 {
            return raised(&z);
        }
        let k = 4.0 * l1 * l1;
        let squares = [(sa * sa, product(&e, &e)), (k, product(&z, &z))];
        weighted(&[squares[0], squares[1], (-k * sa * sa, radius2(&far, h, path))])
    }

    /// Returns Pieper's equation for a prismatic joint 1 and a revolute joint 2.
    ///
    /// Coordinates x and y of the point in frame 1 follow from [`PointTarget::x`] and [`PointTarget::y`]. The
    /// equation states that `x^2 + y^2` is the squared distance of the point from axis 2. If cos alpha_1 is
    /// 0, the equation compares only coordinate y of point and target in the frame of [`PointTarget::x`].
    fn slide_turns(&self, target: &PointTarget, path: &Path, h: &Quadratic) -> Polynomial {
        let (ca, sa) = self.twist1;
        let y = path.minus(target.y, &h.map(|k| -sa * k));
        if ca == 0.0 {
            return raised(&y);
        }
        let x = ca * (target.x - self.l1);
        let one2 = product(&path.one, &path.one);
        let radius2 = radius2(&self.distance2_on(path), h, path);
        weighted(&[(x * x, one2), (1.0, product(&y, &y)), (-ca * ca, radius2)])
    }

    /// Returns Pieper's equation for a revolute joint 1 and a prismatic joint 2.
    ///
    /// Coordinate z of the point in frame 1 follows from the height along axis 1. The equation states that
    /// `x^2 + y^2 + z^2 + 2 l_1 x` is equal to [`PointTarget::distance2`]; l_1 is a D-H length. If cos
    /// alpha_1 is 0, the equation compares only the heights of point and target along axis 1.
    fn turn_slides(&self, target: &PointTarget, path: &Path, (x, y): &(Quadratic, Quadratic)) -> Polynomial {
        let (ca, sa) = self.twist1;
        let z = path.minus(target.height, &y.map(|k| sa * k));
        if ca == 0.0 {
            return raised(&z);
        }
        let rest = path.minus(target.distance2, &x.map(|k| 2.0 * self.l1 * k));
        let k = ca * ca;
        let plane = [(k, product(x, x)), (k, product(y, y))];
        weighted(&[plane[0], plane[1], (1.0, product(&z, &z)), (-k, product(&rest, &path.one))])
    }

    /// Returns the squared distance of the point from the origin of frame 1, as a polynomial of the
    /// parameter t.
    fn distance2_on(&self, path: &Path) -> Quadratic {
        let (form, z) = &self.distance2;
        let square = match self.kinds[2] {
            Revolute => path.one.map(|k| z[0] * z[0] * k),
            Prismatic => [z[0] * z[0], 2.0 * z[0] * z[1], z[1] * z[1]],
        };
        let form = path.on(form);
        std::array::from_fn(|k| form[k] + square[k])
    }

    /// Returns coordinates x and y of the point in frame 1 for a prismatic joint 2, whose theta_2 is fixed.
    fn turned(&self, u: &Quadratic, v: &Quadratic) -> (Quadratic, Quadratic) {
        let (c, s) = self.zero[1];
        (combined(c, u, -s, v, 0.0), combined(s, u, c, v, 0.0))
    }
}

fn raised(q: &Quadratic) -> Polynomial {
    [q[0], q[1], q[2], 0.0, 0.0]
}

fn weighted(terms: &[(f64, Polynomial)]) -> Polynomial {
    std::array::from_fn(|k| terms.iter().map(|(w, p)| w * p[k]).sum())
}

/// Returns the squared distance of the point from axis 2, as a polynomial of the parameter t.
///
/// `far` is the squared distance of the point from the origin of frame 1. `h` is the height of the point
/// along axis 2.
fn radius2(far: &Quadratic, h: &Quadratic, path: &Path) -> Polynomial {
    weighted(&[(1.0, product(far, &path.one)), (-1.0, product(h, h))])
}
