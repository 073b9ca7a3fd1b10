//! Section 2 of the seed paper: from errors of the links to the error of the end effector.
//!
//! Every model is a walk along one representation of the chain, [`Perturbation`], from the TCP back
//! to the base. With `v` the TCP in the frame of link i, `w = Rx(alpha) v + (l, 0, r)` and
//! `A v = Rz(theta) w`, the walk carries the nominal vector and its error `e`:
//!
//! - nonlinear, eqs. (4)-(6): `A' v' - A v = Rz (w' - w) + (Rz' - Rz) w'`, exact, every difference
//!   formed from the small quantities themselves, so that errors of 1 nm keep their digits;
//! - linearized, eqs. (7)-(8): the same walk with products of errors left out.
//!
//! Errors are given in the world frame of the robot base: position in m, rotation as a rotation
//! vector in rad.

mod discrepancy;
mod linearized;
mod nonlinear;
mod perturbation;

pub use discrepancy::{Discrepancy, discrepancy};
pub use perturbation::{LinkError, Perturbation};

use crate::cell::Model;
use crate::robot::{Chain, Posture};
use nalgebra::Vector3;

/// Error of the TCP: `position` (m) and `rotation` (rotation vector, rad), in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    pub position: Vector3<f64>,
    pub rotation: Vector3<f64>,
}

/// The position error alone, m: what the search asks for at every node.
pub fn position_error(chain: &Chain, errors: &Perturbation, posture: &Posture, model: Model) -> Vector3<f64> {
    match model {
        Model::Nonlinear => nonlinear::position_error(chain, errors, posture),
        Model::Linear => linearized::pose_error(chain, errors, posture).position,
    }
}

/// Position and rotation error.
pub fn pose_error(chain: &Chain, errors: &Perturbation, posture: &Posture, model: Model) -> PoseError {
    match model {
        Model::Nonlinear => nonlinear::pose_error(chain, errors, posture),
        Model::Linear => linearized::pose_error(chain, errors, posture),
    }
}
