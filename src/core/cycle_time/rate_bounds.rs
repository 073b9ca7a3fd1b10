//! Maximum speed and acceleration of every joint of a robot.

use crate::cell::{JointVector, MAX_JOINTS, Robot};

/// Time (s) that a joint is assumed to need from rest to full speed if the robot file states no acceleration.
///
/// Joints of collaborative arms need a little more than this time in typical programs. For example, a joint
/// reaches 60 degrees per s in 0.75 s at 80 degrees per s^2. Fast industrial arms need less time: 0.2 to
/// 0.4 s.
pub const ASSUMED_FULL_SPEED_AFTER: f64 = 0.5;

/// Maximum speed and acceleration of every joint; both are infinite for a joint without an actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct RateBounds {
    /// Maximum speed, rad/s or m/s.
    pub velocity: JointVector,
    /// Maximum acceleration and deceleration, rad/s^2 or m/s^2.
    pub acceleration: JointVector,
    /// Whether an acceleration is computed from [`ASSUMED_FULL_SPEED_AFTER`]. If so, all computed times are
    /// estimates.
    pub is_assumed: bool,
}

impl RateBounds {
    /// Returns the bounds of a robot.
    ///
    /// A joint without a stated acceleration reaches its maximum speed in the time
    /// [`Robot::full_speed_after`]. If the robot file does not state this time, the joint reaches its maximum
    /// speed in the time [`ASSUMED_FULL_SPEED_AFTER`].
    ///
    /// # Errors
    /// Returns the indices of the joints without a stated speed.
    pub fn new(robot: &Robot) -> Result<Self, Vec<usize>> {
        let missing = robot.joints_without_speed();
        if !missing.is_empty() {
            return Err(missing);
        }
        let (mut velocity, mut acceleration) = ([f64::INFINITY; MAX_JOINTS], [f64::INFINITY; MAX_JOINTS]);
        let mut is_assumed = false;
        for (k, joint) in robot.joints.iter().enumerate() {
            let Some(speed) = joint.rates.velocity.filter(|_| !joint.is_passive()) else { continue };
            velocity[k] = speed;
            is_assumed |= joint.rates.acceleration.is_none() && robot.full_speed_after.is_none();
            let ramp = robot.full_speed_after.unwrap_or(ASSUMED_FULL_SPEED_AFTER);
            acceleration[k] = joint.rates.acceleration.unwrap_or(speed / ramp);
        }
        Ok(Self { velocity, acceleration, is_assumed })
    }
}
