//! Which solutions are different.

use super::joints::Joints;
use crate::cell::JointVector;

/// Starts in a row that bring nothing new end the search.
const IDLE: usize = 256;
/// Solutions reported at most: a chain of six joints has up to 16.
const MOST: usize = 16;
/// Points of a continuum collected to choose from.
const COLLECTED: usize = 64;
/// Solutions that differ by less are one, rad (m for a slide); points of a continuum.
const SAME: f64 = 1e-4;
const SPREAD: f64 = 0.1;

/// The solutions so far.
pub(super) struct Distinct<'a> {
    pub found: Vec<JointVector>,
    joints: &'a Joints,
    apart: f64,
    /// Starts since the last new one.
    idle: usize,
}

impl<'a> Distinct<'a> {
    /// For goals of so many rows.
    pub fn new(joints: &'a Joints, rows: usize) -> Self {
        let apart = if rows < joints.ranges().len() { SPREAD } else { SAME };
        Self { found: Vec::new(), joints, apart, idle: 0 }
    }

    /// What one start brought.
    pub fn take(&mut self, q: Option<JointVector>) {
        self.idle += 1;
        if let Some(q) = q.filter(|q| self.found.iter().all(|other| self.joints.apart(other, q) > self.apart))
        {
            self.found.push(q);
            self.idle = 0;
        }
    }

    pub fn is_done(&self) -> bool {
        self.found.len() >= COLLECTED || !self.found.is_empty() && self.idle >= IDLE
    }

    /// In the order of the coordinates; of too many those that are farthest apart.
    pub fn into_sorted(self, out: &mut Vec<JointVector>) {
        let distance = |q: &JointVector, chosen: &[JointVector]| {
            chosen.iter().map(|other| self.joints.apart(other, q)).fold(f64::INFINITY, f64::min)
        };
        while out.len() < MOST.min(self.found.len()) {
            let farthest = self.found.iter().max_by(|a, b| distance(a, out).total_cmp(&distance(b, out)));
            out.extend(farthest);
        }
        let first_difference = |a: &JointVector, b: &JointVector| {
            a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne())
        };
        out.sort_by(|a, b| first_difference(a, b).unwrap_or(std::cmp::Ordering::Equal));
    }
}
