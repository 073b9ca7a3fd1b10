//! What a cell asks of the postures of an operation: not singular, approach and retract free.

use super::line::{Stopped, straight};
use super::measures::singularity;
use super::path::{PathHit, first_hit};
use crate::cell::{Cell, JointVector, TransferRules};
use crate::clearance::{Load, Placed, Scene};
use crate::robot::Chain;
use nalgebra::Vector3;

/// The rules of motion of a cell, made ready.
pub struct Guard {
    /// Its limits are those of the robot less the margin.
    pub(super) chain: Chain,
    /// A length of the size of the arm, m.
    pub(super) reach: f64,
    singularity: f64,
    /// Approach and retract of every operation, m.
    pub(super) lengths: Vec<(f64, f64)>,
    pub(super) transfer: Option<TransferRules>,
}

/// Why a posture cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// So near to a singularity, at the spot or on the line to or from it; see [`singularity`].
    Singular {
        measure: f64,
    },
    /// The straight line to the spot, or back from it, is not to be had; metres are those of that line.
    Approach(Hindrance),
    Retract(Hindrance),
}

/// What stands in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hindrance {
    /// `at`: share of the way before it; of a line to a spot, from the spot.
    Hit(PathHit),
    Stopped(Stopped),
}

impl Guard {
    /// None if the cell asks nothing of motion.
    pub fn new(cell: &Cell) -> Option<Self> {
        let lengths: Vec<_> = cell.operations.iter().map(|o| (o.approach, o.retract)).collect();
        let singularity = cell.margins.singularity;
        if singularity == 0.0 && cell.transfer.is_none() && lengths.iter().all(|l| *l == (0.0, 0.0)) {
            return None;
        }
        let chain = Chain::with_margins(&cell.robot, &cell.margins);
        Some(Self { chain, reach: cell.robot.reach(), singularity, lengths, transfer: cell.transfer.clone() })
    }

    /// Whether [`Self::admits`] has anything to look at.
    pub fn asks_postures(&self, operation: usize) -> bool {
        self.singularity > 0.0 || self.lengths[operation] != (0.0, 0.0)
    }

    /// Whether a posture that touches nothing can be used for an operation, cheap questions first.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn admits(
        &self,
        scene: &Scene,
        placed: &Placed,
        operation: usize,
        joints: &JointVector,
    ) -> Result<(), Refusal> {
        self.regular(joints)?;
        let (approach, retract) = self.lengths[operation];
        let load = Load::of(Some(operation));
        // The way to the spot is the way back from it, checked from the spot.
        let back = |length: f64| -> Result<Option<Hindrance>, Refusal> {
            let knots = match self.back(joints, length) {
                Ok(knots) => knots,
                Err(stopped) => return Ok(Some(Hindrance::Stopped(stopped))),
            };
            knots[1..].iter().try_for_each(|q| self.regular(q))?;
            Ok(self.first_hit(scene, placed, &knots, load).map(Hindrance::Hit))
        };
        if retract > 0.0
            && let Some(hindrance) = back(retract)?
        {
            return Err(Refusal::Retract(hindrance));
        }
        // The longer line holds the shorter one.
        if approach > retract
            && let Some(hindrance) = back(approach)?
        {
            return Err(Refusal::Approach(hindrance));
        }
        Ok(())
    }

    fn regular(&self, joints: &JointVector) -> Result<(), Refusal> {
        if self.singularity == 0.0 {
            return Ok(());
        }
        let measure = singularity(&self.chain, &self.chain.frames(&self.chain.posture(joints)), self.reach);
        if measure < self.singularity { Err(Refusal::Singular { measure }) } else { Ok(()) }
    }

    /// Joint vectors from a spot back along the tool axis.
    pub(super) fn back(&self, joints: &JointVector, length: f64) -> Result<Vec<JointVector>, Stopped> {
        let tcp = self.chain.forward(&self.chain.posture(joints));
        let axis: Vector3<f64> = tcp.rotation * self.chain.tool_axis;
        straight(&self.chain, joints, &(axis * -length), self.reach)
    }

    /// The first contact along several moves; `at` is a share of all of them, each as long as another.
    pub(super) fn first_hit(
        &self,
        scene: &Scene,
        placed: &Placed,
        knots: &[JointVector],
        load: Load,
    ) -> Option<PathHit> {
        let moves = knots.windows(2).enumerate();
        let count = knots.len().saturating_sub(1) as f64;
        moves.into_iter().find_map(|(k, ends)| {
            let found = first_hit(&self.chain, scene, placed, (&ends[0], &ends[1]), load)?;
            Some(PathHit { at: (k as f64 + found.at) / count, ..found })
        })
    }
}
