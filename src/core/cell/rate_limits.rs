//! Limits of the speed and the acceleration of joints.

/// Maximum speed and acceleration of the actuator of a joint; a limit is None if the robot file does not
/// state it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RateLimits {
    /// Maximum speed, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Maximum acceleration and deceleration, rad/s^2 or m/s^2.
    pub acceleration: Option<f64>,
}

impl RateLimits {
    /// Returns these limits; a limit that is None is taken from `other`.
    pub fn or(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.or(other.velocity),
            acceleration: self.acceleration.or(other.acceleration),
        }
    }
}
