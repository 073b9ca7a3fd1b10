//! Section 2 of the seed paper: from errors of the parameters to the error of the end effector.
//!
//! Every model reads one representation of the chain, its [`Frames`] at a posture. An error of a
//! parameter is a small motion about or along an axis of one of them: dtheta about and dr along the
//! z axis before the link, dl along and dalpha about the x axis after it, dbeta about its y axis
//! (Hayati's fifth parameter), and the six components of the base, of the tool and of every joint
//! frame, which stands before the row of its joint. With `S_k`
//! the twist of the k-th motion in the base frame and `a_k` its size, base first,
//!
//! ```text
//! T' T^-1 = exp(S_1 a_1) exp(S_2 a_2) ... exp(S_K a_K)
//! ```
//!
//! holds exactly, and all models follow from it, for the TCP at p:
//!
//! - nonlinear, eqs. (4)-(6): the product itself, from the tool back to the base, as a sum of
//!   displacements, so that errors of 1 nm keep their digits;
//! - linear, eqs. (7)-(8): `e = sum_k a_k g_k` with `g_k = S_k p`, that is `w_k x (p - o_k)` of a
//!   turn and `w_k` of a slide;
//! - second-order (section 2.3): the linear one and `sum_(j<k) a_j a_k w_j x g_k + 1/2 sum_k a_k^2
//!   w_k x g_k` over the turns j, which is the exact quadratic form: motions nearer to the base act
//!   on what the later ones have done.
//!
//! Errors are given in the base frame: position in m, rotation as a rotation vector in rad.

mod discrepancy;
mod expansion;
mod identification;
mod nonlinear;
mod perturbation;

pub use discrepancy::{Discrepancy, NOTHING, deviation, discrepancy};
pub use expansion::{Expansion, Term};
pub use identification::{ParameterSet, condition, identifiable, identification_jacobian};
pub use perturbation::{FrameError, JointErrors, LinkError, Perturbation, Turn};

use crate::cell::Model;
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::Vector3;

/// The position error of the TCP alone, m, base frame: what a search asks for at every node.
pub fn position_error(frames: &Frames, errors: &Perturbation, model: Model) -> Vector3<f64> {
    match model {
        Model::Nonlinear => nonlinear::position_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors).position,
        Model::SecondOrder => expansion::second_order(frames, errors).position,
    }
}

/// Position and rotation error of the TCP, base frame.
pub fn pose_error(frames: &Frames, errors: &Perturbation, model: Model) -> Displacement {
    match model {
        Model::Nonlinear => nonlinear::pose_error(frames, errors),
        Model::Linear => expansion::linear(frames, errors),
        Model::SecondOrder => expansion::second_order(frames, errors),
    }
}
