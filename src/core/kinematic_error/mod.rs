//! Kinematic error (section 2 of the seed paper): from parameter errors to the error of the TCP.
//!
//! The seed paper is the journal paper from which this project grew. Every model uses the same description of
//! the chain: its [`Frames`] at a posture. A parameter error is a small rotation about an axis of one of
//! these frames, or a small translation along such an axis:
//!
//! - dtheta is a rotation about the z axis before the link, and dr is a translation along that axis;
//! - dl is a translation along the x axis after the link, and dalpha is a rotation about that axis;
//! - dbeta is a rotation about the y axis after the link (the fifth parameter of Hayati);
//! - the base frame, the tool frame and every joint frame have six components each. A joint frame is fixed to
//!   the link before its joint. The motions of the joint frame come before the motions of the joint's
//!   Denavit-Hartenberg (D-H) row;
//! - an elastic deflection is a rotation about the axis of a revolute joint and adds to dtheta. The size of
//!   a deflection is the value of a parameter times a factor: a lever, a torque of gravity, or a periodic
//!   error. The factor is computed for the chain without errors at the posture. The joint coupling does not
//!   transmit deflections, because deflections arise on the output side of the gears.
//!
//! Number the motions from the base to the tool. Motion k has the size `a_k` (rad or m). Let `S_k` be the
//! twist of motion k for `a_k = 1`, in the base frame. Let T be the pose of the TCP without errors and T'
//! the pose with errors. Then
//!
//! ```text
//! T' T^-1 = exp(S_1 a_1) exp(S_2 a_2) ... exp(S_K a_K)
//! ```
//!
//! holds exactly. All models follow from this product. Let p be the position of the TCP, `w_k` the unit
//! vector along the axis of motion k, and `o_k` a point on this axis:
//!
//! - nonlinear, eqs. (4)-(6): the product itself is evaluated from the tool back to the base. The error is
//!   computed as a sum of displacements, so that errors of 1 nm lose no digits;
//! - linear, eqs. (7)-(8): the position error is `e = sum_k a_k g_k`. The displacement per unit is
//!   `g_k = w_k x (p - o_k)` for a rotation and `g_k = w_k` for a translation;
//! - second-order (section 2.3): the error is the linear error plus `sum_(j<k) a_j a_k w_j x g_k + 1/2 sum_k
//!   a_k^2 w_k x g_k`. In these sums, `w_j` and `w_k` are the axes of rotations, and are zero for
//!   translations. The two sums together are the exact second-order part of the product. In the first sum,
//!   the rotation j also rotates the displacement by motion k, which is nearer to the tool.
//!
//! Errors are in the base frame: position in m, rotation as a rotation vector in rad.

mod discrepancy;
mod elastic;
mod expansion;
mod identification;
mod nonlinear;
mod perturbation;
mod screw_motion;
mod screws;
mod two_valued;

pub use discrepancy::{Discrepancy, NEGLIGIBLE, deviation, discrepancy};
pub use elastic::{ElasticErrors, deflection};
pub use expansion::{Expansion, MotionTerm};
pub use identification::{ParameterSet, condition, identifiable, identification_jacobian};
pub use perturbation::{FrameError, JointErrors, LinkError, Perturbation, Turn};
pub use screw_motion::{ScrewMotion, largest_deflection, motions};
pub use screws::{JointValues, PosedScrews, Screws};
pub use two_valued::TwoValuedWalk;

use crate::cell::Model;
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::Vector3;

/// Returns the position error of the TCP in the base frame, m. A search calls this function at every node.
pub fn position_error(frames: &Frames, errors: &Perturbation, model: Model) -> Vector3<f64> {
    if errors.elastic.is_some() {
        return position_error_of_elastic(frames, errors, model);
    }
    match model {
        Model::Nonlinear => nonlinear::position_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors).position,
        Model::SecondOrder => expansion::second_order(frames, errors).position,
    }
}

/// Returns the position error of the TCP for errors with elastic deflections.
///
/// This function is separate because it must not slow down the usual case without elastic deflections.
#[cold]
#[inline(never)]
fn position_error_of_elastic(frames: &Frames, errors: &Perturbation, model: Model) -> Vector3<f64> {
    position_error(frames, &errors.deflected(frames), model)
}

/// Returns the position error (m) and the rotation error (rad) of the TCP in the base frame.
pub fn pose_error(frames: &Frames, errors: &Perturbation, model: Model) -> Displacement {
    if errors.elastic.is_some() {
        return pose_error(frames, &errors.deflected(frames), model);
    }
    match model {
        Model::Nonlinear => nonlinear::pose_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors),
        Model::SecondOrder => expansion::second_order(frames, errors),
    }
}
