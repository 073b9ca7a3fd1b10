//! Start postures of the numeric solver: a low-discrepancy sequence over the joint ranges.

use super::goal::TcpGoal;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::low_discrepancy::RobertsSequence;
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Number of start postures.
pub(super) const STARTS: usize = 384;

/// Joint coordinates of a start posture, and the pose of its TCP.
#[derive(Debug, Clone, PartialEq)]
struct Start {
    q: JointVector,
    tcp: Pose,
}

/// All start postures of a chain.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Starts {
    all: Vec<Start>,
    tool_axis: Vector3<f64>,
}

impl Starts {
    /// Returns start postures at the points of a low-discrepancy sequence ([`RobertsSequence`]), scaled to
    /// `ranges`.
    ///
    /// The first posture is in the middle of all ranges.
    pub fn new(chain: &Chain, ranges: &[(f64, f64)]) -> Self {
        let sequence = RobertsSequence::new(ranges.len());
        let mut frames = Frames::default();
        let all = (0..STARTS).map(|k| {
            let mut q = [0.0; MAX_JOINTS];
            for (j, (q, (lo, hi))) in q.iter_mut().zip(ranges).enumerate() {
                *q = lo + (hi - lo) * sequence.coordinate(k, j);
            }
            chain.place(&chain.posture(&q), &mut frames);
            Start { q, tcp: frames.tcp }
        });
        Self { all: all.collect(), tool_axis: chain.tool_axis }
    }

    /// Returns the start posture with the index `start`; None if there is no such posture.
    pub fn get(&self, start: usize) -> Option<&JointVector> {
        self.all.get(start).map(|start| &start.q)
    }

    /// Returns the start postures in ascending order of the distance of their TCP to the goal.
    ///
    /// The factor `scale` (1/m) multiplies lengths in this distance.
    pub fn ranked(&self, goal: &TcpGoal, scale: f64) -> Ranked<'_> {
        let mut far = [0.0; STARTS];
        for (far, start) in far.iter_mut().zip(&self.all) {
            *far = goal.far(&start.tcp, &self.tool_axis, scale);
        }
        Ranked { starts: self, far }
    }
}

/// Iterator over the start postures in the order of [`Starts::ranked`]. The next posture is found on demand,
/// because most goals need only one or two postures.
pub(super) struct Ranked<'a> {
    starts: &'a Starts,
    far: [f64; STARTS],
}

impl<'a> Iterator for Ranked<'a> {
    /// Index of a start posture, and its joint coordinates.
    type Item = (usize, &'a JointVector);

    fn next(&mut self) -> Option<Self::Item> {
        let (mut best, mut least) = (0, f64::INFINITY);
        for (k, &far) in self.far.iter().enumerate() {
            if far < least {
                (best, least) = (k, far);
            }
        }
        *self.far.get_mut(best).filter(|far| **far < f64::INFINITY)? = f64::INFINITY;
        self.starts.all.get(best).map(|start| (best, &start.q))
    }
}
