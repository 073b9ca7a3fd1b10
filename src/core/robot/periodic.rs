//! Periodic errors of joints at a posture.

use crate::cell::PeriodicError;
use crate::pose::Pose;

/// Periodic error of one revolute joint of a chain without joint coupling.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicDeflection {
    pub joint: usize,
    /// Cosine and sine of the joint angle theta at coordinate 0.
    zero: (f64, f64),
    /// Coefficients of cosine and sine for the orders 1, 2, ..., rad.
    terms: Vec<(f64, f64)>,
}

impl PeriodicDeflection {
    /// Prepares the periodic error of a joint whose angle is `theta` (rad) at coordinate 0.
    pub fn new(error: &PeriodicError, theta: f64) -> Self {
        let terms = error.cos.iter().copied().zip(error.sin.iter().copied()).collect();
        Self { joint: error.joint, zero: (theta.cos(), theta.sin()), terms }
    }

    /// Returns the error of the joint, rad, at a posture. The argument `frames` holds D-H frame 0, then the
    /// D-H frame after every link.
    pub fn at(&self, frames: &[Pose]) -> f64 {
        let (before, after) = (&frames[self.joint].rotation, &frames[self.joint + 1].rotation);
        // The x axis after a Denavit-Hartenberg row is the x axis before the row, rotated by theta.
        let x = after.column(0);
        let (cos_theta, sin_theta) = (before.column(0).dot(&x), before.column(1).dot(&x));
        let (cos_zero, sin_zero) = self.zero;
        let cos = cos_theta * cos_zero + sin_theta * sin_zero;
        let sin = sin_theta * cos_zero - cos_theta * sin_zero;
        let (mut wave, mut sum) = ((cos, sin), 0.0);
        for (a, b) in &self.terms {
            sum += a * wave.0 + b * wave.1;
            wave = (wave.0 * cos - wave.1 * sin, wave.1 * cos + wave.0 * sin);
        }
        sum
    }

    /// Returns an upper bound of the size of the error at any posture, rad.
    pub fn largest(&self) -> f64 {
        self.terms.iter().map(|(a, b)| a.hypot(*b)).sum()
    }
}
