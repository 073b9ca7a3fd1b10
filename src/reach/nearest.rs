//! The point that three joints move: Newton's method that brings it to a target, or as near as it goes.

use super::closed_form::subproblems::Angle;
use crate::cell::JointKind::{Prismatic, Revolute};
use crate::robot::Link;
use nalgebra::{Matrix3, Vector3};

/// A point on the axis after three joints, `r4` m from the origin of frame 3.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub links: [Link; 3],
    pub r4: f64,
}

/// D-H variables of the three joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joints {
    pub theta: [Angle; 3],
    pub r: [f64; 3],
}

impl Point {
    /// The point in frame `from` (0: the base).
    fn seen_from(&self, from: usize, joints: &Joints) -> Vector3<f64> {
        let mut p = Vector3::new(0.0, 0.0, self.r4);
        for k in (from..3).rev() {
            let (link, (c, s)) = (&self.links[k], joints.theta[k]);
            let (x, y) = (p.x + link.l, link.cos_alpha * p.y - link.sin_alpha * p.z);
            let z = link.sin_alpha * p.y + link.cos_alpha * p.z + joints.r[k];
            p = Vector3::new(c * x - s * y, s * x + c * y, z);
        }
        p
    }

    /// The point in frame 0 and, as columns, how it moves with each joint.
    fn derivative(&self, joints: &Joints) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut turned, mut moves) = (Matrix3::identity(), Matrix3::zeros());
        for k in 0..3 {
            let axis = turned.column(2).into_owned();
            let column = match self.links[k].kind {
                Revolute => axis.cross(&(turned * self.seen_from(k, joints))),
                Prismatic => axis,
            };
            moves.set_column(k, &column);
            let ((c, s), ca, sa) = (joints.theta[k], self.links[k].cos_alpha, self.links[k].sin_alpha);
            turned *= Matrix3::new(c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca);
        }
        (self.seen_from(0, joints), moves)
    }

    /// Sets joint 1 alone: turned to the direction of `p`, or slid to its height.
    pub fn aim(&self, p: &Vector3<f64>, joints: &mut Joints) {
        let first = &self.links[0];
        (joints.theta[0], joints.r[0]) = match first.kind {
            Revolute => ((1.0, 0.0), first.r),
            Prismatic => ((first.theta.cos(), first.theta.sin()), 0.0),
        };
        let q = self.seen_from(0, joints);
        if first.kind == Prismatic {
            joints.r[0] = p.z - q.z;
            return;
        }
        let (c, s) = (q.x * p.x + q.y * p.y, q.x * p.y - q.y * p.x);
        let size = c.hypot(s);
        if size > 1e-24 {
            joints.theta[0] = (c / size, s / size);
        }
    }

    /// Newton's method with steps of least length; what remains, m.
    pub fn polish(&self, p: &Vector3<f64>, joints: &mut Joints) -> f64 {
        let mut missed = f64::INFINITY;
        let mut next = *joints;
        for _ in 0..10 {
            let (q, moves) = self.derivative(&next);
            let rest = (p - q).norm();
            if rest >= missed {
                break;
            }
            (missed, *joints) = (rest, next);
            let (true, Some(step)) = (rest > 1e-15, damped(&moves, &(p - q), 1e-13)) else { break };
            next = self.moved(joints, &step);
        }
        missed
    }

    /// The distance from `p` to the nearest place of the point, m, and the joints there:
    /// Levenberg-Marquardt from the best of many postures.
    pub fn nearest(&self, p: &Vector3<f64>) -> (f64, Joints) {
        const STARTS: usize = 4;
        let mut best = [(f64::INFINITY, Joints { theta: [(1.0, 0.0); 3], r: [0.0; 3] }); STARTS];
        for k in 0..GRID * GRID {
            let mut joints = self.on_grid([k % GRID, k / GRID]);
            self.aim(p, &mut joints);
            let rest = (p - self.seen_from(0, &joints)).norm();
            let place = best.iter().position(|b| rest < b.0);
            if let Some(place) = place {
                best[place..].rotate_right(1);
                best[place] = (rest, joints);
            }
        }
        let [first, rest @ ..] = best.map(|b| self.approached(p, b.1));
        rest.into_iter().fold(first, |a, b| if b.0 < a.0 { b } else { a })
    }

    /// Postures of joints 2 and 3, all around; slides at their zero.
    fn on_grid(&self, place: [usize; 2]) -> Joints {
        let mut joints = Joints { theta: [(1.0, 0.0); 3], r: std::array::from_fn(|k| self.links[k].r) };
        for (k, &at) in (1..).zip(&place) {
            let link = &self.links[k];
            let angle = match link.kind {
                Revolute => std::f64::consts::TAU * at as f64 / GRID as f64,
                Prismatic => link.theta,
            };
            joints.theta[k] = (angle.cos(), angle.sin());
        }
        joints
    }

    fn approached(&self, p: &Vector3<f64>, mut joints: Joints) -> (f64, Joints) {
        let (mut rest, mut damping) = ((p - self.seen_from(0, &joints)).norm(), 1e-2);
        for _ in 0..200 {
            let (q, moves) = self.derivative(&joints);
            let Some(step) = damped(&moves, &(p - q), damping) else { break };
            let next = self.moved(&joints, &step);
            let missed = (p - self.seen_from(0, &next)).norm();
            if missed < rest {
                let gain = rest - missed;
                (joints, rest, damping) = (next, missed, 0.3 * damping);
                if gain < 1e-13 {
                    break;
                }
            } else if damping > 1e6 {
                break;
            } else {
                damping *= 4.0;
            }
        }
        (rest, joints)
    }

    /// Whether the joints move the point in all directions somewhere.
    pub fn moves_in_space(&self) -> bool {
        (0..GRID * GRID).any(|k| {
            let mut joints = self.on_grid([k % GRID, k / GRID]);
            // A boom of no length would turn its point on the spot.
            joints
                .r
                .iter_mut()
                .zip(&self.links)
                .filter(|(_, link)| link.kind == Prismatic)
                .for_each(|(r, _)| *r += 1.0);
            let (_, moves) = self.derivative(&joints);
            moves.determinant().abs() > 1e-9 * moves.norm().powi(3)
        })
    }

    fn moved(&self, joints: &Joints, step: &Vector3<f64>) -> Joints {
        let mut next = *joints;
        for k in 0..3 {
            match self.links[k].kind {
                Revolute => {
                    // Half the angle by its tangent: a rotation for every step.
                    let ((c, s), t) = (joints.theta[k], 0.5 * step[k]);
                    let (ct, st) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
                    let (c, s) = (c * ct - s * st, s * ct + c * st);
                    let size = c.hypot(s);
                    next.theta[k] = (c / size, s / size);
                }
                Prismatic => next.r[k] += step[k],
            }
        }
        next
    }
}

/// Postures tried for joint 2 and for joint 3.
const GRID: usize = 12;

/// The step that brings `moves * step` to `rest` at the price of its own length.
fn damped(moves: &Matrix3<f64>, rest: &Vector3<f64>, damping: f64) -> Option<Vector3<f64>> {
    let normal = moves.tr_mul(moves);
    let damping = damping * normal.trace();
    (normal + Matrix3::identity() * damping).cholesky().map(|c| c.solve(&moves.tr_mul(rest)))
}
