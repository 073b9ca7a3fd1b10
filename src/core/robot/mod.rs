//! Forward kinematics: the Denavit-Hartenberg chain with joint coupling.
//!
//! The transform of link i is `A_i = Rz(q_i) Tz(r_i) Tx(l_i) Rx(alpha_i)`, eq. (1) of the seed paper. Here
//! `R` is a rotation about, and `T` a translation along, the named axis. A chain of N links has the
//! transform `T_N = A_1 A_2 ... A_N`, eq. (2).
//!
//! A [`Posture`] holds sines and cosines instead of angles. An inverse kinematics that computes these
//! directly never calls a trigonometric function.

mod chain;
mod gravity;
mod loads;
mod periodic;

pub use chain::{Chain, Frames, Link, Posture};
pub use gravity::{STANDARD_GRAVITY, gravity_torque, lever};
pub use loads::{CarriedMass, Loads};
pub use periodic::PeriodicDeflection;
