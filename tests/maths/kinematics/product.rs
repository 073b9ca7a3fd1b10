//! Independent D-H product, which uses only the description of a robot from the crate.

use nalgebra::{Matrix3, Matrix4, Vector3};
use num_dual::DualNum;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use sweetspot::cell::{JointKind, JointVector, Robot, SignedErrors};
use sweetspot::pose::Pose;

/// Returns the D-H matrix of eq. (1) in the form of textbooks.
fn link<D: DualNum<Primitive = f64> + Copy>(theta: D, r: D, l: D, alpha: D) -> Matrix4<D> {
    let ((s, c), (sa, ca)) = (theta.sin_cos(), alpha.sin_cos());
    let (o, i) = (D::from(0.0), D::from(1.0));
    Matrix4::new(c, -s * ca, s * sa, l * c, s, c * ca, -c * sa, l * s, o, sa, ca, r, o, o, o, i)
}

/// Returns a rotation about y after the link: Hayati's fifth parameter.
fn about_y<D: DualNum<Primitive = f64> + Copy>(angle: D) -> Matrix4<D> {
    let ((s, c), o, i) = (angle.sin_cos(), D::from(0.0), D::from(1.0));
    Matrix4::new(c, o, s, o, o, i, o, o, -s, o, c, o, o, o, o, i)
}

/// Returns `Trans(x, y, z) Rz(rz) Ry(ry) Rx(rx)`. D-H links give all factors except the rotation about y.
fn frame<D: DualNum<Primitive = f64> + Copy>(values: &[D]) -> Matrix4<D> {
    let (o, mut slide) = (D::from(0.0), Matrix4::identity());
    (slide[(0, 3)], slide[(1, 3)], slide[(2, 3)]) = (values[0], values[1], values[2]);
    slide * link(values[5], o, o, o) * about_y(values[4]) * link(o, o, o, values[3])
}

/// Returns the pose of the TCP with the given errors. The list has dq, dr, dl, dalpha and dbeta of every
/// link. It continues with x, y, z, rx, ry and rz of the base, of the tool and of every joint frame J. The
/// error of J is between J and its inverse.
pub fn product<D: DualNum<Primitive = f64> + Copy>(robot: &Robot, q: &[f64], errors: &[D]) -> Matrix4<D> {
    let (links, frames) = errors.split_at(5 * robot.axes());
    let mut t = frame(frames);
    for (i, (joint, e)) in robot.joints.iter().zip(links.chunks(5)).enumerate() {
        let factors = &robot.coupling[i];
        let moved: f64 = factors.iter().zip(q).map(|(c, q)| c * q).sum();
        let driven = factors.iter().zip(links.chunks(5));
        let moved = driven.fold(D::from(moved), |sum, (c, e)| sum + e[0] * *c);
        let (mut theta, mut r) = (D::from(joint.theta), e[1] + joint.r);
        match joint.kind {
            JointKind::Revolute => theta += moved,
            JointKind::Prismatic => r += moved,
        }
        let there = homogeneous(&robot.joint_frames[i]);
        let back = homogeneous(&robot.joint_frames[i].inverse());
        t = t * there * frame(&frames[12 + 6 * i..]) * back;
        t *= link(theta, r, e[2] + joint.l, e[3] + joint.alpha) * about_y(e[4]);
    }
    t * homogeneous(&robot.tool) * frame(&frames[6..])
}

fn homogeneous<D: DualNum<Primitive = f64> + Copy>(pose: &Pose) -> Matrix4<D> {
    let mut t = pose.rotation.to_homogeneous();
    t.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
    t.map(D::from)
}

/// Returns the pose of the TCP with `unit` times the errors in every D-H value. The unit 0 gives the nominal
/// robot, 1 the robot with errors, and an infinitesimal unit the derivative.
pub fn tcp<D: DualNum<Primitive = f64> + Copy>(
    robot: &Robot,
    q: &[f64],
    e: &SignedErrors,
    unit: D,
) -> Matrix4<D> {
    let links = (0..robot.axes()).flat_map(|i| [e.dq[i], e.dr[i], e.dl[i], e.dalpha[i], e.dbeta[i]]);
    let values = links.chain(e.base).chain(e.tool).chain(e.joints.iter().flatten().copied());
    product(robot, q, &values.map(|v| unit * v).collect::<Vec<_>>())
}

pub fn position(t: &Matrix4<f64>) -> Vector3<f64> {
    t.fixed_view::<3, 1>(0, 3).into_owned()
}

pub fn rotation(t: &Matrix4<f64>) -> Matrix3<f64> {
    t.fixed_view::<3, 3>(0, 0).into_owned()
}

pub fn no_errors(n: usize) -> SignedErrors {
    let zeros = || vec![0.0; n];
    let (name, base, tool, joints) = ("none".into(), [0.0; 6], [0.0; 6], vec![[0.0; 6]; n]);
    let [dq, dr, dl, dalpha, dbeta] = [(); 5].map(|()| zeros());
    SignedErrors { name, dq, dr, dl, dalpha, dbeta, base, tool, joints, elastic: vec![], periodic: vec![] }
}

pub fn random_joints(robot: &Robot, rng: &mut ChaCha8Rng) -> JointVector {
    from_fn(|i| robot.joints.get(i).map_or(0.0, |j| rng.random_range(j.limits.0..=j.limits.1)))
}
