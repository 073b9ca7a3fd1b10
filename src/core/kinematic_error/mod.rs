//! Kinematic error (section 2 of the seed paper): from parameter errors to the error of the TCP.
//!
//! Every model reads one representation of the chain, its [`Frames`] at a posture. A parameter error
//! is a small motion about or along an axis of one of these frames:
//!
//! - dtheta about and dr along the z axis before the link;
//! - dl along and dalpha about the x axis after the link;
//! - dbeta about the y axis after the link (the fifth parameter of Hayati);
//! - six components each of the base, of the tool and of every joint frame, which precedes its row.
//!
//! Let `S_k` be the twist of motion k in the base frame and `a_k` its size, counted from the base. Then
//!
//! ```text
//! T' T^-1 = exp(S_1 a_1) exp(S_2 a_2) ... exp(S_K a_K)
//! ```
//!
//! holds exactly. All models follow from it, for the TCP at p:
//!
//! - nonlinear, eqs. (4)-(6): the product itself, evaluated from the tool back to the base as a sum of
//!   displacements, so that errors of 1 nm keep their digits;
//! - linear, eqs. (7)-(8): `e = sum_k a_k g_k` with `g_k = S_k p`, that is `w_k x (p - o_k)` for a
//!   rotation and `w_k` for a translation;
//! - second-order (section 2.3): the linear model plus `sum_(j<k) a_j a_k w_j x g_k + 1/2 sum_k a_k^2
//!   w_k x g_k` over the rotations j. This is the exact quadratic form: a motion nearer to the base
//!   acts on what the later ones have done.
//!
//! Errors are in the base frame: position in m, rotation as a rotation vector in rad.

mod discrepancy;
mod expansion;
mod identification;
mod nonlinear;
mod perturbation;

pub use discrepancy::{Discrepancy, NEGLIGIBLE, deviation, discrepancy};
pub use expansion::{Expansion, MotionTerm};
pub use identification::{ParameterSet, condition, identifiable, identification_jacobian};
pub use perturbation::{FrameError, JointErrors, LinkError, Perturbation, Turn};

use crate::cell::Model;
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::Vector3;

/// Returns the position error of the TCP, m, base frame; a search asks for it at every node.
pub fn position_error(frames: &Frames, errors: &Perturbation, model: Model) -> Vector3<f64> {
    match model {
        Model::Nonlinear => nonlinear::position_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors).position,
        Model::SecondOrder => expansion::second_order(frames, errors).position,
    }
}

/// Returns position and rotation error of the TCP, base frame.
pub fn pose_error(frames: &Frames, errors: &Perturbation, model: Model) -> Displacement {
    match model {
        Model::Nonlinear => nonlinear::pose_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors),
        Model::SecondOrder => expansion::second_order(frames, errors),
    }
}
