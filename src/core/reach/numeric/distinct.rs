//! Set of distinct solutions that the numeric solver has found so far.

use super::joint_ranges::JointRanges;
use crate::cell::JointVector;

/// Largest number of consecutive start postures without a new solution.
///
/// After this number, the search ends if a solution is known.
const MAX_IDLE_STARTS: usize = 256;
/// Largest number of reported solutions: a chain of six revolute joints has up to 16.
const MAX_SOLUTIONS: usize = 16;
/// Largest number of collected solutions, from which at most [`MAX_SOLUTIONS`] are chosen.
const MAX_COLLECTED: usize = 64;
/// Two solutions count as the same if no joint differs by more than this value, rad (m for a prismatic
/// joint).
const SAME_SOLUTION: f64 = 1e-4;
/// Least joint difference between two collected solutions of a redundant chain, rad (m for a prismatic
/// joint).
const CONTINUUM_SPACING: f64 = 0.1;

/// Solution of the numeric solver, and the start posture that leads to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumericSolution {
    /// Index of the start posture. If fast descents find no solution, slower full descents follow. If a full
    /// descent leads to the solution, the total number of start postures is added to the index.
    pub start: usize,
    /// Joint coordinates, rad or m.
    pub joints: JointVector,
}

/// Set of the distinct solutions found so far.
pub(super) struct DistinctSolutions<'a> {
    pub found: Vec<NumericSolution>,
    joints: &'a JointRanges,
    apart: f64,
    /// Number of start postures tried since the last new solution.
    idle: usize,
}

impl<'a> DistinctSolutions<'a> {
    /// Returns an empty set of solutions for a goal with `rows` scalar conditions.
    pub fn new(joints: &'a JointRanges, rows: usize) -> Self {
        let apart = if rows < joints.ranges().len() { CONTINUUM_SPACING } else { SAME_SOLUTION };
        Self { found: Vec::new(), joints, apart, idle: 0 }
    }

    /// Adds the result of one start posture, if it is a new solution.
    pub fn take(&mut self, start: usize, q: Option<JointVector>) {
        self.idle += 1;
        let is_new =
            |q: &JointVector| self.found.iter().all(|f| self.joints.apart(&f.joints, q) > self.apart);
        if let Some(joints) = q.filter(is_new) {
            self.found.push(NumericSolution { start, joints });
            self.idle = 0;
        }
    }

    /// Returns whether the search can end. The search ends after [`MAX_COLLECTED`] solutions. If a solution
    /// is known, the search also ends after [`MAX_IDLE_STARTS`] start postures without a new solution.
    pub fn is_done(&self) -> bool {
        self.found.len() >= MAX_COLLECTED || !self.found.is_empty() && self.idle >= MAX_IDLE_STARTS
    }

    /// Writes the solutions, sorted by their coordinates, to `out`.
    ///
    /// If there are more than [`MAX_SOLUTIONS`], solutions that are far from each other are chosen.
    pub fn into_sorted(self, out: &mut Vec<NumericSolution>) {
        let mut distances = vec![f64::INFINITY; self.found.len()];
        while out.len() < MAX_SOLUTIONS.min(self.found.len()) {
            let farthest = (0..distances.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b]));
            let Some(chosen) = farthest.map(|k| self.found[k]) else { break };
            out.push(chosen);
            for (distance, other) in distances.iter_mut().zip(&self.found) {
                *distance = distance.min(self.joints.apart(&chosen.joints, &other.joints));
            }
        }
        let first_difference = |a: &JointVector, b: &JointVector| {
            a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne())
        };
        out.sort_by(|a, b| first_difference(&a.joints, &b.joints).unwrap_or(std::cmp::Ordering::Equal));
    }
}
