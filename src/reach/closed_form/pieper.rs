//! The equation for joint 3 of any three joints that put a point somewhere (Pieper 1968).

use super::quartic::{Polynomial, Quadratic, product};
use super::subproblems::Angle;
use super::three_joints::{Target, ThreeJoints};
use crate::cell::JointKind::{Prismatic, Revolute};

/// Polynomials of a parameter t of the path of joint 3 that are to 1 : a : b as the path demands.
pub(in crate::reach) struct Path {
    pub one: Quadratic,
    pub a: Quadratic,
    pub b: Quadratic,
}

impl Path {
    /// A form along the path.
    fn on(&self, f: &Quadratic) -> Quadratic {
        std::array::from_fn(|k| f[0] * self.one[k] + f[1] * self.a[k] + f[2] * self.b[k])
    }

    /// A constant less a form.
    fn minus(&self, constant: f64, p: &Quadratic) -> Quadratic {
        std::array::from_fn(|k| constant * self.one[k] - p[k])
    }
}

impl ThreeJoints {
    /// The circle by the tangent of half the angle from `origin`, or the line by r_3.
    pub fn path(&self, (c, s): Angle) -> Path {
        match self.kinds[2] {
            Revolute => Path { one: [1.0, 0.0, 1.0], a: [c, -2.0 * s, -c], b: [s, 2.0 * c, -s] },
            Prismatic => Path { one: [1.0, 0.0, 0.0], a: [0.0, 1.0, 0.0], b: [0.0; 3] },
        }
    }

    /// What joint 3 must fulfil so that joints 1 and 2 can do the rest.
    pub fn equation(&self, target: &Target, path: &Path) -> Polynomial {
        let (u, v, h) = (path.on(&self.u), path.on(&self.v), path.on(&self.h));
        match (self.kinds[0], self.kinds[1]) {
            (Revolute, Revolute) => self.both_turn(target, path, &h),
            (Prismatic, Revolute) => self.slide_turns(target, path, &h),
            (Revolute, Prismatic) => self.turn_slides(target, path, &self.turned(&u, &v)),
            (Prismatic, Prismatic) => raised(&path.minus(target.x - self.l1, &self.turned(&u, &v).0)),
        }
    }

    /// Distance from the origin of frame 1 and height along axis 1 give x and y of frame 1, and these
    /// the distance from axis 2.
    fn both_turn(&self, target: &Target, path: &Path, h: &Quadratic) -> Polynomial {
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

    /// x and y across the slide give x and y of frame 1, and these the distance from axis 2.
    fn slide_turns(&self, target: &Target, path: &Path, h: &Quadratic) -> Polynomial {
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

    /// The height along axis 1 gives the slide, and all of it the distance from the origin of frame 1.
    fn turn_slides(&self, target: &Target, path: &Path, (x, y): &(Quadratic, Quadratic)) -> Polynomial {
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

    /// The square of the distance of the point from the origin of frame 1, as a polynomial.
    fn distance2_on(&self, path: &Path) -> Quadratic {
        let (form, z) = &self.distance2;
        let square = match self.kinds[2] {
            Revolute => path.one.map(|k| z[0] * z[0] * k),
            Prismatic => [z[0] * z[0], 2.0 * z[0] * z[1], z[1] * z[1]],
        };
        let form = path.on(form);
        std::array::from_fn(|k| form[k] + square[k])
    }

    /// x and y of the point in frame 1 with a fixed theta_2.
    fn turned(&self, u: &Quadratic, v: &Quadratic) -> (Quadratic, Quadratic) {
        let (c, s) = self.zero[1];
        (combined(c, u, -s, v, 0.0), combined(s, u, c, v, 0.0))
    }
}

/// `f a + g b + constant`.
pub(in crate::reach) fn combined(f: f64, a: &Quadratic, g: f64, b: &Quadratic, constant: f64) -> Quadratic {
    [f * a[0] + g * b[0] + constant, f * a[1] + g * b[1], f * a[2] + g * b[2]]
}

fn raised(q: &Quadratic) -> Polynomial {
    [q[0], q[1], q[2], 0.0, 0.0]
}

fn weighted(terms: &[(f64, Polynomial)]) -> Polynomial {
    std::array::from_fn(|k| terms.iter().map(|(w, p)| w * p[k]).sum())
}

/// The square of the distance from axis 2, from that from the origin of frame 1 and the height.
fn radius2(far: &Quadratic, h: &Quadratic, path: &Path) -> Polynomial {
    weighted(&[(1.0, product(far, &path.one)), (-1.0, product(h, h))])
}
