//! The linearized model, eqs. (7)-(8): `[d; delta] = J_q dq + J_r dr + J_l dl + J_alpha dalpha`.
//!
//! The walk of the nonlinear model without products of errors. It yields the world frame at once;
//! the paper's turn from the end-effector frame by n, o, a is the same rotation.

use super::nonlinear::{turned_x, turned_z};
use super::{Perturbation, PoseError};
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// Position (m) and rotation (rad) error to first order, base frame.
pub fn pose_error(chain: &Chain, errors: &Perturbation, posture: &Posture) -> PoseError {
    let mut v = chain.tool.translation;
    let (mut d, mut delta) = (Vector3::zeros(), Vector3::zeros());
    for (i, (link, error)) in chain.links.iter().zip(&errors.links).enumerate().rev() {
        let (c, s) = (posture.cos[i], posture.sin[i]);
        let (ca, sa) = (link.cos_alpha, link.sin_alpha);
        // Rx and the shift (l, 0, r)
        v = turned_x(v, ca, sa);
        d = turned_x(d, ca, sa) + Vector3::new(error.dl, -error.dalpha * v.z, error.dalpha * v.y + error.dr);
        delta = turned_x(delta, ca, sa) + Vector3::new(error.dalpha, 0.0, 0.0);
        v += Vector3::new(link.l, 0.0, posture.r[i]);
        // Rz
        v = turned_z(v, c, s);
        d = turned_z(d, c, s) + Vector3::new(-error.dtheta * v.y, error.dtheta * v.x, 0.0);
        delta = turned_z(delta, c, s) + Vector3::new(0.0, 0.0, error.dtheta);
    }
    PoseError { position: d, rotation: delta }
}
