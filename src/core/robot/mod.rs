//! Forward kinematics: the Denavit-Hartenberg chain with joint coupling.
//!
//! The transform of link i is `A_i = Rz(q_i) Tz(r_i) Tx(l_i) Rx(alpha_i)`, eq. (1) of the seed paper. Here
//! `q_i` is the joint angle theta of the link. `R` is a rotation about the named axis, and `T` is a
//! translation along the named axis. A chain of N links has the transform `T_N = A_1 A_2 ... A_N`, eq. (2).
//! The seed paper is the journal paper from which this project grew.
//!
//! A [`Posture`] holds sines and cosines instead of angles. A solver of the inverse kinematics that computes
//! sines and cosines directly needs no trigonometric function.

mod chain;
mod gravity;
mod loads;
mod periodic;
mod tool_spin;

pub use chain::{Chain, Frames, Link, Posture};
pub use gravity::{STANDARD_GRAVITY, gravity_torque, lever};
pub use loads::{CarriedMass, Loads};
pub use periodic::PeriodicDeflection;
