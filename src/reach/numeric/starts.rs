//! Where the search starts: a fixed set of postures spread over the ranges of the joints.

use super::goal::Goal;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// How many there are.
pub(super) const STARTS: usize = 384;

/// A posture and where it puts the TCP.
#[derive(Debug, Clone, PartialEq)]
struct Start {
    q: JointVector,
    tcp: Pose,
}

/// The starts of a chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Starts {
    all: Vec<Start>,
    tool_axis: Vector3<f64>,
}

impl Starts {
    /// Between `ranges`, the middle first. The sequence is that of Roberts (2018, "R_d"): coordinate
    /// j of point k is the fraction of `1/2 + k / g^(j + 1)`, g the root of `g^(n + 1) = g + 1`.
    pub fn new(chain: &Chain, ranges: &[(f64, f64)]) -> Self {
        let n = ranges.len();
        let mut root: f64 = 2.0;
        for _ in 0..64 {
            root = (1.0 + root).powf(1.0 / (n as f64 + 1.0));
        }
        let mut frames = Frames::default();
        let all = (0..STARTS).map(|k| {
            let mut q = [0.0; MAX_JOINTS];
            for (j, (q, (lo, hi))) in q.iter_mut().zip(ranges).enumerate() {
                *q = lo + (hi - lo) * (0.5 + k as f64 / root.powi(j as i32 + 1)).fract();
            }
            chain.place(&chain.posture(&q), &mut frames);
            Start { q, tcp: frames.tcp }
        });
        Self { all: all.collect(), tool_axis: chain.tool_axis }
    }

    /// The starts from the nearest to the goal to the farthest; `scale` in 1/m.
    pub fn ranked(&self, goal: &Goal, scale: f64) -> Ranked<'_> {
        let mut far = [0.0; STARTS];
        for (far, start) in far.iter_mut().zip(&self.all) {
            *far = goal.far(&start.tcp, &self.tool_axis, scale);
        }
        Ranked { starts: self, far }
    }
}

/// Finds the next only when it is asked for: most goals need one or two.
pub(super) struct Ranked<'a> {
    starts: &'a Starts,
    far: [f64; STARTS],
}

impl<'a> Iterator for Ranked<'a> {
    type Item = &'a JointVector;

    fn next(&mut self) -> Option<Self::Item> {
        let (mut best, mut least) = (0, f64::INFINITY);
        for (k, &far) in self.far.iter().enumerate() {
            if far < least {
                (best, least) = (k, far);
            }
        }
        *self.far.get_mut(best).filter(|far| **far < f64::INFINITY)? = f64::INFINITY;
        self.starts.all.get(best).map(|start| &start.q)
    }
}
