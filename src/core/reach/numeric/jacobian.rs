//! Geometric Jacobian of a chain, and the normal equations of a goal.

use super::goal::TwistError;
use super::step::NormalMatrix;
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::pose::Displacement;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Returns the geometric Jacobian in the base frame. Column j is the motion of the TCP per unit of actuator
/// j.
///
/// Let z_i be the axis of joint i, o_i a point on this axis and p the position of the TCP. A revolute joint
/// moves the TCP by `z_i x (p - o_i)` and rotates it by `z_i`; a prismatic joint moves it by `z_i`. The
/// column of an actuator is the sum of these motions over all joints that the actuator drives. Each motion is
/// multiplied by the coupling factor from the actuator to the joint. Columns beyond the number of joints are
/// 0.
pub fn jacobian(chain: &Chain, frames: &Frames) -> [Displacement; MAX_JOINTS] {
    let mut columns = dh_jacobian(chain, frames);
    // The coupling matrix is lower triangular: the columns after j still refer to the D-H coordinates.
    for (i, row) in chain.coupling.iter().enumerate() {
        for (j, &factor) in row[..i].iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            columns[j] = columns[j] + columns[i] * factor;
        }
    }
    columns
}

/// Returns the geometric Jacobian with respect to the D-H coordinates, without the joint coupling.
pub(in crate::reach) fn dh_jacobian(chain: &Chain, frames: &Frames) -> [Displacement; MAX_JOINTS] {
    let mut columns = [Displacement::NONE; MAX_JOINTS];
    let tcp = frames.tcp.translation;
    for ((link, frame), column) in chain.links.iter().zip(&frames.links).zip(&mut columns) {
        let axis: Vector3<f64> = frame.rotation.column(2).into_owned();
        *column = match link.kind {
            JointKind::Revolute => {
                Displacement { position: axis.cross(&(tcp - frame.translation)), rotation: axis }
            }
            JointKind::Prismatic => Displacement { position: axis, rotation: Vector3::zeros() },
        };
    }
    columns
}

/// Returns `J^T J` and `J^T e` for the Jacobian J and the twist e to the goal.
///
/// Lengths are multiplied by `scale` (1/m). Rotations that the goal does not constrain are left out.
pub(super) fn normal_equations(
    n: usize,
    columns: &[Displacement; MAX_JOINTS],
    miss: &TwistError,
    scale: f64,
) -> (NormalMatrix, JointVector) {
    let (mut matrix, mut right) = (NormalMatrix::default(), JointVector::default());
    let mut seen = [Displacement::NONE; MAX_JOINTS];
    for (seen, column) in seen.iter_mut().zip(columns).take(n) {
        *seen = Displacement { position: column.position * scale, rotation: miss.seen.of(&column.rotation) };
    }
    let position = miss.position * scale;
    for i in 0..n {
        right[i] = seen[i].position.dot(&position) + seen[i].rotation.dot(&miss.rotation);
        for j in 0..=i {
            matrix[i][j] = seen[i].position.dot(&seen[j].position) + seen[i].rotation.dot(&seen[j].rotation);
        }
    }
    (matrix, right)
}

/// Adds the second-order part of the Hessian of the position cost `|e|^2 / 2` to `matrix`.
///
/// Let e be the vector from the TCP position p to the goal and q_i the joint coordinates. The second-order
/// part is `-e . d2p / dq_i dq_j`. For i <= j, the second derivative of p is `w_i x J_j`. Here w_i is the
/// rotation of the TCP per unit of joint i, and J_j is the translation of the TCP per unit of joint j. Only
/// the lower triangle is changed, and `scale` (1/m) multiplies lengths. The second-order part makes Newton's
/// method converge quadratically even if the goal is out of reach.
pub(super) fn add_curvature(
    chain: &Chain,
    frames: &Frames,
    miss: &TwistError,
    scale: f64,
    matrix: &mut NormalMatrix,
) {
    let n = chain.axes();
    let columns = dh_jacobian(chain, frames);
    let entry = |i: usize, j: usize| {
        let (first, last) = (i.min(j), i.max(j));
        -scale * scale * miss.position.dot(&columns[first].rotation.cross(&columns[last].position))
    };
    let factor = |i: usize, j: usize| chain.coupling[i][j];
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let driven = (i..n).flat_map(|k| (j..n).map(move |l| (k, l)));
        matrix[i][j] += driven.map(|(k, l)| factor(k, i) * entry(k, l) * factor(l, j)).sum::<f64>();
    }
}
