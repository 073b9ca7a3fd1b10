//! Forward kinematics: the Denavit-Hartenberg chain with joint coupling.
//!
//! Eq. (1) of the seed paper, `A_i = Rz(q_i) Tz(r_i) Tx(l_i) Rx(alpha_i)`, and eq. (2),
//! `T_N = A_1 A_2 ... A_N`. A [`Posture`] carries sines and cosines instead of angles: an inverse
//! kinematics that computes these directly never calls a trigonometric function.

mod chain;

pub use chain::{Chain, Frames, Link, Posture};
