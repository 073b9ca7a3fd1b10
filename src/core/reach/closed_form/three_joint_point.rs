//! Numeric solution, by damped least squares, for three joints that move a point as near to a target as
//! possible.

use super::subproblems::Angle;
use crate::cell::JointKind::{Prismatic, Revolute};
use crate::robot::Link;
use nalgebra::{Matrix3, Vector3};

/// Point on axis 4 that the first three joints move.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ThreeJointPoint {
    pub links: [Link; 3],
    /// Distance of the point from the origin of frame 3, m.
    pub r4: f64,
}

/// D-H variables of the three joints: cosine and sine of each theta, and each r (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct ThreeJointState {
    pub theta: [Angle; 3],
    pub r: [f64; 3],
}

impl ThreeJointPoint {
    /// Returns the point in frame `from`, m; frame 0 is the base of the chain.
    fn seen_from(&self, from: usize, joints: &ThreeJointState) -> Vector3<f64> {
        let mut p = Vector3::new(0.0, 0.0, self.r4);
        for k in (from..3).rev() {
            let (link, (c, s)) = (&self.links[k], joints.theta[k]);
            let (x, y) = (p.x + link.l, link.cos_alpha * p.y - link.sin_alpha * p.z);
            let z = link.sin_alpha * p.y + link.cos_alpha * p.z + joints.r[k];
            p = Vector3::new(c * x - s * y, s * x + c * y, z);
        }
        p
    }

    /// Returns the point in frame 0 and its Jacobian, one column per joint.
    fn derivative(&self, joints: &ThreeJointState) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut turned, mut moves) = (Matrix3::identity(), Matrix3::zeros());
        for k in 0..3 {
            let axis = turned.column(2).into_owned();
            let column = match self.links[k].kind {
                Revolute => axis.cross(&(turned * self.seen_from(k, joints))),
                Prismatic => axis,
            };
            moves.set_column(k, &column);
            turned *= self.rotation(k, joints);
        }
        (self.seen_from(0, joints), moves)
    }

    /// Sets only joint 1. A revolute joint rotates the point to the heading of `p`; a prismatic joint moves
    /// the point to the height of `p`.
    pub fn aim(&self, p: &Vector3<f64>, joints: &mut ThreeJointState) {
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
        let size = (c * c + s * s).sqrt();
        if size > 1e-24 {
            joints.theta[0] = (c / size, s / size);
        }
    }

    /// Refines the joints by Newton's method with least-norm steps; returns the remaining distance from the
    /// point to `p`, m.
    pub fn polish(&self, p: &Vector3<f64>, joints: &mut ThreeJointState) -> f64 {
        const MAX_STEPS: usize = 10;
        let mut missed = f64::INFINITY;
        let mut next = *joints;
        for _ in 0..MAX_STEPS {
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

    /// Returns whether the reach is rotationally symmetric and bounded: all three joints are revolute.
    pub fn turns_only(&self) -> bool {
        self.links.iter().all(|link| link.kind == Revolute)
    }

    /// Returns the distance of the point from axis 1, and its height along axis 1, m.
    pub fn section(&self, joints: &ThreeJointState) -> (f64, f64) {
        let q = self.seen_from(0, joints);
        (q.x.hypot(q.y), q.z)
    }

    /// Returns an upper bound (m) of the motion of the point if joints 2 and 3 each rotate by 1 rad.
    pub fn travel(&self) -> f64 {
        let [_, second, third] = &self.links;
        let about_third = third.l.hypot(third.sin_alpha * self.r4);
        let along_third = third.r + third.cos_alpha * self.r4;
        about_third + second.l.abs() + about_third.hypot(along_third)
    }

    /// Returns the least distance from the point to `p` (m), and the D-H variables that give this distance.
    ///
    /// The function starts [`Self::approached`] from the best postures of a grid.
    pub fn nearest(&self, p: &Vector3<f64>) -> (f64, ThreeJointState) {
        const STARTS: usize = 4;
        let mut best = [(f64::INFINITY, ThreeJointState { theta: [(1.0, 0.0); 3], r: [0.0; 3] }); STARTS];
        for k in 0..GRID * GRID {
            let mut joints = self.on_grid([k % GRID, k / GRID], GRID);
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

    /// Returns the posture at `place` in a grid of `count` by `count` angles of joints 2 and 3; prismatic
    /// joints have coordinate 0.
    pub fn on_grid(&self, place: [usize; 2], count: usize) -> ThreeJointState {
        let mut joints =
            ThreeJointState { theta: [(1.0, 0.0); 3], r: std::array::from_fn(|k| self.links[k].r) };
        for (k, &at) in (1..).zip(&place) {
            let link = &self.links[k];
            let angle = match link.kind {
                Revolute => std::f64::consts::TAU * at as f64 / count as f64,
                Prismatic => link.theta,
            };
            joints.theta[k] = (angle.cos(), angle.sin());
        }
        joints
    }

    /// Moves the point towards `p` by Newton's method with damping. Returns the remaining distance (m) and
    /// the D-H variables of the final posture.
    ///
    /// The Hessian matrix of half the squared distance includes the curvature of the point's path. For a
    /// target far out of reach, the method therefore needs few steps, unlike a method that uses only the
    /// Jacobian.
    pub fn approached(&self, p: &Vector3<f64>, mut joints: ThreeJointState) -> (f64, ThreeJointState) {
        const MAX_STEPS: usize = 100;
        const LEAST_DAMPING: f64 = 1e-14;
        let (mut rest, mut damping) = ((p - self.seen_from(0, &joints)).norm(), 1e-3);
        for _ in 0..MAX_STEPS {
            let (q, moves) = self.derivative(&joints);
            let off = q - p;
            let hessian = self.hessian(&joints, &moves, &off);
            let gradient = moves.tr_mul(&off);
            let scale = moves.norm_squared();
            let solve = |damping: f64| {
                (hessian + Matrix3::identity() * (damping * scale)).cholesky().map(|c| -c.solve(&gradient))
            };
            let Some(step) = solve(damping) else {
                damping = (10.0 * damping).max(1e-3);
                if damping > 1e6 { break } else { continue }
            };
            let next = self.moved(&joints, &step);
            let missed = (p - self.seen_from(0, &next)).norm();
            if missed < rest {
                let gain = rest - missed;
                (joints, rest, damping) = (next, missed, (0.01 * damping).max(LEAST_DAMPING));
                if gain < 1e-13 {
                    break;
                }
            } else if step.norm() < 1e-9 || damping > 1e6 {
                break;
            } else {
                damping = (10.0 * damping).max(1e-6);
            }
        }
        (rest, joints)
    }

    /// Returns the Hessian matrix of half the squared distance from the point to a target, m^2.
    ///
    /// `moves` is the Jacobian of the point, and `off` is the vector from the target to the point, m.
    ///
    /// Let `moves_i` be column i of `moves`, and z_j the direction of the axis of joint j. For a revolute
    /// joint j <= i, the derivative of `moves_i` with respect to theta_j is `z_j x moves_i`. For a prismatic
    /// joint j, the derivative is 0.
    fn hessian(&self, joints: &ThreeJointState, moves: &Matrix3<f64>, off: &Vector3<f64>) -> Matrix3<f64> {
        let mut hessian = moves.tr_mul(moves);
        let mut axis = Vector3::z();
        let mut turned = Matrix3::identity();
        for j in 0..3 {
            if self.links[j].kind == Revolute {
                for i in j..3 {
                    let curved = off.dot(&axis.cross(&moves.column(i)));
                    hessian[(i, j)] += curved;
                    if i != j {
                        hessian[(j, i)] += curved;
                    }
                }
            }
            turned *= self.rotation(j, joints);
            axis = turned.column(2).into_owned();
        }
        hessian
    }

    /// Returns the rotation matrix of D-H row `k`.
    fn rotation(&self, k: usize, joints: &ThreeJointState) -> Matrix3<f64> {
        let ((c, s), ca, sa) = (joints.theta[k], self.links[k].cos_alpha, self.links[k].sin_alpha);
        Matrix3::new(c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca)
    }

    /// Returns whether there is a posture in which the joints can move the point in all directions.
    pub fn moves_in_space(&self) -> bool {
        (0..GRID * GRID).any(|k| {
            let mut joints = self.on_grid([k % GRID, k / GRID], GRID);
            // At coordinate 0 of a prismatic joint, the point may lie on a revolute axis, which then cannot
            // move the point.
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

    fn moved(&self, joints: &ThreeJointState, step: &Vector3<f64>) -> ThreeJointState {
        let mut next = *joints;
        for k in 0..3 {
            match self.links[k].kind {
                Revolute => {
                    // Half the step is taken as the tangent of half the angle, so that a step of any length
                    // is a rotation.
                    let ((c, s), t) = (joints.theta[k], 0.5 * step[k]);
                    let (ct, st) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
                    let (c, s) = (c * ct - s * st, s * ct + c * st);
                    let per = 1.0 / (c * c + s * s).sqrt();
                    next.theta[k] = (c * per, s * per);
                }
                Prismatic => next.r[k] += step[k],
            }
        }
        next
    }
}

/// Number of angles of the grid for each of joints 2 and 3.
const GRID: usize = 12;

/// Returns the damped least-squares solution of `moves * step = rest`; None if the damped matrix `J^T J` is
/// not positive definite.
///
/// `moves` is the Jacobian J of a point, and `rest` is the vector from the point to its target, m. `damping`
/// is relative to the trace of `J^T J`.
fn damped(moves: &Matrix3<f64>, rest: &Vector3<f64>, damping: f64) -> Option<Vector3<f64>> {
    let normal = moves.tr_mul(moves);
    let damping = damping * normal.trace();
    (normal + Matrix3::identity() * damping).cholesky().map(|c| c.solve(&moves.tr_mul(rest)))
}
