//! The nonlinear model, eqs. (4)-(6): `dT = prod(A_i + dA_i) - T`, as a telescoping sum.

use super::{LinkError, Perturbation, PoseError};
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;

/// Position error, m, base frame. About 50 multiplications a link; no allocation.
#[inline]
pub fn position_error(chain: &Chain, errors: &Perturbation, posture: &Posture) -> Vector3<f64> {
    let mut v = chain.tool.translation;
    let mut e = Vector3::zeros();
    for (i, (link, error)) in chain.links.iter().zip(&errors.links).enumerate().rev() {
        (v, e) = step_back(link, error, posture.cos[i], posture.sin[i], posture.r[i], v, e);
    }
    e
}

/// From the frame after `A_i` to the frame before it: `v` becomes `A v`, `e` becomes `A' v' - A v`.
#[inline]
fn step_back(
    link: &Link,
    error: &LinkError,
    c: f64,
    s: f64,
    r: f64,
    v: Vector3<f64>,
    e: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let (ca, sa) = (link.cos_alpha, link.sin_alpha);
    let w = Vector3::new(v.x + link.l, ca * v.y - sa * v.z, sa * v.y + ca * v.z + r);
    let moved = v + e;
    let dw = Vector3::new(
        e.x + error.dl,
        ca * e.y - sa * e.z + error.dcos_alpha * moved.y - error.dsin_alpha * moved.z,
        sa * e.y + ca * e.z + error.dsin_alpha * moved.y + error.dcos_alpha * moved.z + error.dr,
    );
    let dc = c * error.cos_dtheta_less_1 - s * error.sin_dtheta;
    let ds = s * error.cos_dtheta_less_1 + c * error.sin_dtheta;
    let (px, py) = (w.x + dw.x, w.y + dw.y);
    let before = Vector3::new(c * w.x - s * w.y, s * w.x + c * w.y, w.z);
    let e =
        Vector3::new(c * dw.x - s * dw.y + dc * px - ds * py, s * dw.x + c * dw.y + ds * px + dc * py, dw.z);
    (before, e)
}

/// Position and rotation error, base frame.
pub fn pose_error(chain: &Chain, errors: &Perturbation, posture: &Posture) -> PoseError {
    PoseError {
        position: position_error(chain, errors, posture),
        rotation: rotation_error(chain, errors, posture),
    }
}

/// The rotation `R' R^T` as a rotation vector. Its quaternion (w; v) is built link by link,
/// `Q <- Rz(dtheta) (A Rx(dalpha) Q A^T)`, so that the small vector part is never the difference
/// of large numbers.
fn rotation_error(chain: &Chain, errors: &Perturbation, posture: &Posture) -> Vector3<f64> {
    let (mut w, mut v) = (1.0, Vector3::zeros());
    for (i, (link, error)) in chain.links.iter().zip(&errors.links).enumerate().rev() {
        let (c, s) = (posture.cos[i], posture.sin[i]);
        (w, v) =
            product(half_turn(Vector3::x(), error.dalpha), (w, turned_x(v, link.cos_alpha, link.sin_alpha)));
        (w, v) = product(half_turn(Vector3::z(), error.dtheta), (w, turned_z(v, c, s)));
    }
    rotation_vector(w, v)
}

/// Quaternion of a turn by `angle` about a unit `axis`.
fn half_turn(axis: Vector3<f64>, angle: f64) -> (f64, Vector3<f64>) {
    let (s, c) = (angle / 2.0).sin_cos();
    (c, axis * s)
}

fn product((w1, v1): (f64, Vector3<f64>), (w2, v2): (f64, Vector3<f64>)) -> (f64, Vector3<f64>) {
    (w1 * w2 - v1.dot(&v2), v2 * w1 + v1 * w2 + v1.cross(&v2))
}

pub(super) fn turned_x(v: Vector3<f64>, c: f64, s: f64) -> Vector3<f64> {
    Vector3::new(v.x, c * v.y - s * v.z, s * v.y + c * v.z)
}

pub(super) fn turned_z(v: Vector3<f64>, c: f64, s: f64) -> Vector3<f64> {
    Vector3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
}

/// Logarithm of the unit quaternion (w; v): the rotation vector of at most pi.
fn rotation_vector(w: f64, v: Vector3<f64>) -> Vector3<f64> {
    let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
    let size = v.norm();
    // angle / sin(angle / 2); at 0 it is 2, and atan2 / size is exact to rounding down to 1e-160.
    let factor = if size < 1e-150 { 2.0 } else { 2.0 * size.atan2(w) / size };
    v * factor
}
