//! Time in which the TCP moves along a straight line, and time of a transfer path.

use super::path_timing::path_time;
use super::rate_bounds::RateBounds;
use super::straight_move::limited_move_time;
use crate::cell::JointVector;
use crate::robot::Chain;

/// Largest distance along the line, m, at which two TCP positions count as the same point.
const NO_LENGTH: f64 = 1e-9;

/// Returns the least time, s, in which the TCP moves along a straight line from rest to rest. The joint
/// vectors `knots` are postures along this line.
///
/// The arm does not stop at the joint vectors between the ends. `speed` is the maximum speed of the TCP, m/s,
/// which may be infinite.
pub fn line_time(chain: &Chain, knots: &[JointVector], bounds: &RateBounds, speed: f64) -> f64 {
    let Some(first) = knots.first() else { return 0.0 };
    let position = |q: &JointVector| chain.forward(&chain.posture(q)).translation;
    let start = position(first);
    let (mut at, mut values) = (vec![0.0], vec![*first]);
    for (k, knot) in knots.iter().enumerate().skip(1) {
        let length = (position(knot) - start).norm();
        if length > at[at.len() - 1] + NO_LENGTH {
            at.push(length);
            values.push(*knot);
        } else if k + 1 == knots.len() {
            // The line ends exactly at its last joint vector, even if the last two joint vectors are at the
            // same point.
            values.pop();
            values.push(*knot);
        }
    }
    match &values[..] {
        [from, to] => limited_move_time(from, to, bounds, speed / at[1]),
        [_, _, ..] => path_time(at, values, bounds, speed),
        _ => 0.0,
    }
}

/// Returns the least time, s, of a path that consists of straight moves and straight lines of the TCP.
///
/// `corners` holds the indices of the joint vectors at which the arm stops, including both ends of the path.
/// A leg consists of the joint vectors from one stop to the next, including both stops. A leg of two joint
/// vectors is a straight move in joint coordinates. In a leg of three or more joint vectors, the TCP moves
/// along a straight line.
pub fn path_of_legs_time(chain: &Chain, path: &[JointVector], corners: &[usize], bounds: &RateBounds) -> f64 {
    let leg = |ends: &[usize]| match path.get(ends[0]..=ends[1]) {
        Some([from, to]) => limited_move_time(from, to, bounds, f64::INFINITY),
        Some(knots) => line_time(chain, knots, bounds, f64::INFINITY),
        None => 0.0,
    };
    corners.windows(2).map(leg).sum()
}
