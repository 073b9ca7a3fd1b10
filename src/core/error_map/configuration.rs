//! Configurations of an arm: classes of postures that signs of joint angles tell apart.
//!
//! The branches of the inverse kinematics at one target usually differ in such signs, for example in the sign
//! of the sine of the elbow angle. Robot controllers state the signs as the flags of a configuration.

use crate::robot::Posture;
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest number of flags.
pub const MAX_FLAGS: usize = 4;
/// Margin, rad, by which a range of angles is widened. The margin is far above the angle errors of the
/// inverse kinematics.
const SLACK: f64 = 1e-6;

/// Sign of the sine or cosine of a joint angle theta (D-H).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConfigurationFlag {
    /// Index of the joint.
    pub joint: usize,
    /// Whether the flag is the sign of the sine; otherwise the sign of the cosine.
    pub is_sine: bool,
}

impl ConfigurationFlag {
    /// Returns whether the sine or cosine is positive.
    #[inline]
    pub fn is_set(&self, posture: &Posture) -> bool {
        let of = if self.is_sine { &posture.sin } else { &posture.cos };
        of[self.joint] > 0.0
    }

    /// Returns whether some angle in a range (rad) sets the flag, and whether some angle does not set it.
    fn is_possible(&self, (low, high): (f64, f64)) -> [bool; 2] {
        // The cosine is the sine of the angle plus a quarter turn.
        let phase = if self.is_sine { 0.0 } else { FRAC_PI_2 };
        let (low, high) = (low + phase - SLACK, high + phase + SLACK);
        // The sine is positive between the multiples k pi and (k + 1) pi if k is even.
        let (first, last) = ((low / PI).floor(), (high / PI).floor());
        let is_even = first.rem_euclid(2.0) == 0.0;
        [is_even || last > first, !is_even || last > first]
    }
}

/// Flags whose signs define the configuration of a posture.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ConfigurationFlags(Vec<ConfigurationFlag>);

impl ConfigurationFlags {
    /// Creates the flags. Only the first [`MAX_FLAGS`] flags of the list are used.
    pub fn new(mut list: Vec<ConfigurationFlag>) -> Self {
        list.truncate(MAX_FLAGS);
        Self(list)
    }

    /// Returns the number of configurations.
    pub fn configurations(&self) -> usize {
        1 << self.0.len()
    }

    /// Returns the index of the configuration of a posture.
    #[inline]
    pub fn configuration(&self, posture: &Posture) -> usize {
        self.0.iter().enumerate().map(|(bit, flag)| usize::from(flag.is_set(posture)) << bit).sum()
    }

    /// Returns the configurations of all postures whose joint angles theta lie in given ranges, as a bit
    /// mask. `range` returns the range (rad) of the joint with the given index.
    pub fn among(&self, range: impl Fn(usize) -> (f64, f64)) -> u32 {
        let possible: Vec<[bool; 2]> =
            self.0.iter().map(|flag| flag.is_possible(range(flag.joint))).collect();
        let is_among = |k: &usize| {
            possible
                .iter()
                .enumerate()
                .all(|(bit, [set, clear])| if k >> bit & 1 == 1 { *set } else { *clear })
        };
        (0..self.configurations()).filter(is_among).map(|k| 1 << k).sum()
    }
}
