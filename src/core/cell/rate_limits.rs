//! Limits of the speed and the acceleration of joints.

/// Greatest speed and acceleration of the actuator of a joint; None for what the robot file does not state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RateLimits {
    /// Greatest speed, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Greatest acceleration and deceleration, rad/s^2 or m/s^2.
    pub acceleration: Option<f64>,
}

impl RateLimits {
    /// Returns these limits, with those of `other` for what these do not state.
    pub fn or(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.or(other.velocity),
            acceleration: self.acceleration.or(other.acceleration),
        }
    }
}
