//! What moves: the Denavit-Hartenberg chain, the joint coupling, forward kinematics.
//!
//! Eq. (1) of the seed paper, `A_i = Rz(q_i) Tz(r_i) Tx(l_i) Rx(alpha_i)`, and eq. (2),
//! `T_N = A_1 A_2 ... A_N`. A [`Posture`] carries sines and cosines instead of angles, so that an
//! inverse kinematics that finds those directly never calls a trigonometric function.

mod chain;

pub use chain::{Chain, Frames, Link, Posture};
