//! The set of distinct solutions that the numeric solver has found so far.

use super::joint_ranges::JointRanges;
use crate::cell::JointVector;

/// Number of consecutive start postures without a new solution that ends the search, if a solution is known.
const MAX_IDLE_STARTS: usize = 256;
/// Largest number of reported solutions: a chain of six revolute joints has up to 16.
const MAX_SOLUTIONS: usize = 16;
/// Largest number of collected solutions, from which at most [`MAX_SOLUTIONS`] are chosen.
const MAX_COLLECTED: usize = 64;
/// Largest joint difference of two solutions that count as the same, rad (m for a prismatic joint).
const SAME_SOLUTION: f64 = 1e-4;
/// Least joint difference of two collected solutions if the solutions form a continuum, rad (m for a
/// prismatic joint).
const CONTINUUM_SPACING: f64 = 0.1;

/// Set of the distinct solutions found so far.
pub(super) struct DistinctSolutions<'a> {
    pub found: Vec<JointVector>,
    joints: &'a JointRanges,
    apart: f64,
    /// Number of start postures tried since the last new solution.
    idle: usize,
}

impl<'a> DistinctSolutions<'a> {
    /// Returns an empty set of solutions for a goal that states `rows` scalar conditions.
    pub fn new(joints: &'a JointRanges, rows: usize) -> Self {
        let apart = if rows < joints.ranges().len() { CONTINUUM_SPACING } else { SAME_SOLUTION };
        Self { found: Vec::new(), joints, apart, idle: 0 }
    }

    /// Adds the result of one start posture, if it is a new solution.
    pub fn take(&mut self, q: Option<JointVector>) {
        self.idle += 1;
        if let Some(q) = q.filter(|q| self.found.iter().all(|other| self.joints.apart(other, q) > self.apart))
        {
            self.found.push(q);
            self.idle = 0;
        }
    }

    /// Returns whether the search can end. It ends after [`MAX_COLLECTED`] solutions. It also ends after
    /// [`MAX_IDLE_STARTS`] start postures without a new solution, if at least one solution is known.
    pub fn is_done(&self) -> bool {
        self.found.len() >= MAX_COLLECTED || !self.found.is_empty() && self.idle >= MAX_IDLE_STARTS
    }

    /// Writes the solutions, sorted by their coordinates, to `out`.
    ///
    /// If there are more than [`MAX_SOLUTIONS`], solutions that are far from each other are chosen.
    pub fn into_sorted(self, out: &mut Vec<JointVector>) {
        let distance = |q: &JointVector, chosen: &[JointVector]| {
            chosen.iter().map(|other| self.joints.apart(other, q)).fold(f64::INFINITY, f64::min)
        };
        while out.len() < MAX_SOLUTIONS.min(self.found.len()) {
            let farthest = self.found.iter().max_by(|a, b| distance(a, out).total_cmp(&distance(b, out)));
            out.extend(farthest);
        }
        let first_difference = |a: &JointVector, b: &JointVector| {
            a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne())
        };
        out.sort_by(|a, b| first_difference(a, b).unwrap_or(std::cmp::Ordering::Equal));
    }
}
