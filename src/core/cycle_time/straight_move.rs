//! Time of a straight move in joint coordinates, from rest to rest.

use super::rate_bounds::RateBounds;
use crate::cell::JointVector;

/// Returns the least time, s, of a motion over a distance from rest to rest.
///
/// The speed has a trapezoidal profile, or a triangular profile if the distance is too short for the full
/// speed. For the distance d, the maximum speed v and the maximum acceleration a,
///
/// ```text
/// t = d / v + v / a    if d >= v^2 / a,
/// t = 2 sqrt(d / a)    otherwise.
/// ```
pub fn rest_to_rest(distance: f64, velocity: f64, acceleration: f64) -> f64 {
    if distance <= 0.0 {
        0.0
    } else if distance * acceleration >= velocity * velocity {
        distance / velocity + velocity / acceleration
    } else {
        2.0 * (distance / acceleration).sqrt()
    }
}

/// Returns the least time, s, of a straight move in joint coordinates from rest to rest.
///
/// The joints are synchronized: at every instant, all joints have completed equal shares of their travels.
/// The arm therefore stays on the straight line in joint coordinates that the collision check assumes. The
/// completed share has a trapezoidal speed profile. Let d be the travel of a joint, v its maximum speed and a
/// its maximum acceleration. The maximum speed of the completed share is the least `v / |d|` over all joints.
/// The maximum acceleration of the completed share is the least `a / |d|` over all joints.
pub fn straight_move_time(from: &JointVector, to: &JointVector, bounds: &RateBounds) -> f64 {
    limited_move_time(from, to, bounds, f64::INFINITY)
}

/// Returns the time, s, of [`straight_move_time`] with one more limit. The completed share of the travel
/// grows by at most `rate` per s.
pub(super) fn limited_move_time(from: &JointVector, to: &JointVector, bounds: &RateBounds, rate: f64) -> f64 {
    let (mut velocity, mut acceleration) = (rate, f64::INFINITY);
    let mut moves = false;
    for (j, (from, to)) in from.iter().zip(to).enumerate() {
        let travel = (to - from).abs();
        if travel > 0.0 && bounds.velocity[j].is_finite() {
            velocity = velocity.min(bounds.velocity[j] / travel);
            acceleration = acceleration.min(bounds.acceleration[j] / travel);
            moves = true;
        }
    }
    if moves { rest_to_rest(1.0, velocity, acceleration) } else { 0.0 }
}
