//! Motion rules for the postures of an operation: distance from singularities, and collision-free approach
//! and retract.

use super::continuous_collision::{PathHit, PathSlack, first_hit};
use super::measures::{is_regular, singularity};
use super::straight_line::{Stopped, straight};
use crate::cell::{Cell, JointVector, TransferRules};
use crate::clearance::{Load, PlacedSolids, Scene};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Motion rules of a cell, prepared for checking postures and moves.
pub struct Guard {
    /// Chain with joint limits reduced by the margins of the cell.
    pub(super) chain: Chain,
    /// Characteristic length of the arm, m.
    pub(super) reach: f64,
    /// Least allowed [`singularity`] measure. The value 0 allows every posture.
    singularity: f64,
    /// Lengths of approach and retract of every operation, m.
    pub(super) lengths: Vec<(f64, f64)>,
    pub(super) transfer: Option<TransferRules>,
}

/// Reason why a posture cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PostureRefusal {
    /// The posture, or a posture on its approach or retract line, is too near to a singularity. The field
    /// `measure` is the value of the function [`singularity`].
    Singular { measure: f64 },
    /// The straight line to the spot is blocked. Lengths along the line are measured from the spot.
    Approach(Hindrance),
    /// The straight line back from the spot is blocked. Lengths along the line are measured from the spot.
    Retract(Hindrance),
}

/// Contact or limit that blocks a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hindrance {
    /// Contact with a solid. The path along an approach or retract line begins at the spot, so
    /// [`PathHit::at`] is 0 there.
    Hit(PathHit),
    /// The arm cannot follow a straight line of the TCP.
    Stopped(Stopped),
}

/// Joint vectors (rad or m) at the far ends of the straight lines that end or begin at a posture.
#[derive(Debug, Clone, Copy)]
pub struct LineEnds {
    /// Joint vector at the spot.
    pub spot: JointVector,
    /// Start of the approach; None if it was not computed.
    pub approach: Option<JointVector>,
    /// End of the retract; None if it was not computed.
    pub retract: Option<JointVector>,
}

impl Guard {
    /// Returns the motion rules of a cell; None if the cell has no motion rules.
    pub fn new(cell: &Cell) -> Option<Self> {
        let lengths: Vec<_> = cell.operations.iter().map(|o| (o.approach, o.retract)).collect();
        let singularity = cell.margins.singularity;
        if singularity == 0.0 && cell.transfer.is_none() && lengths.iter().all(|l| *l == (0.0, 0.0)) {
            return None;
        }
        let chain = Chain::with_margins(&cell.robot, &cell.margins);
        Some(Self { chain, reach: cell.robot.reach(), singularity, lengths, transfer: cell.transfer.clone() })
    }

    /// Returns whether [`Self::admits`] has anything to check for an operation.
    pub fn asks_postures(&self, operation: usize) -> bool {
        self.singularity > 0.0 || self.lengths[operation] != (0.0, 0.0)
    }

    /// Checks that a collision-free posture can be used for an operation. Cheap checks come first. Returns
    /// the ends of the lines that were checked.
    ///
    /// # Errors
    /// Returns the reason if the posture cannot be used.
    pub fn admits(
        &self,
        scene: &Scene,
        placed: &PlacedSolids,
        operation: usize,
        joints: &JointVector,
    ) -> Result<LineEnds, PostureRefusal> {
        self.regular(joints)?;
        let (approach, retract) = self.lengths[operation];
        let load = Load::of(Some(operation));
        // The approach line is checked in reverse, from the spot, like the retract line.
        let back = |length: f64, refusal: fn(Hindrance) -> PostureRefusal| {
            let knots = self.back(joints, length).map_err(|stopped| refusal(Hindrance::Stopped(stopped)))?;
            knots[1..].iter().try_for_each(|q| self.regular(q))?;
            match self.first_hit(scene, placed, &knots, load) {
                Some(hit) => Err(refusal(Hindrance::Hit(hit))),
                None => Ok(knots.last().copied()),
            }
        };
        let mut ends = LineEnds { spot: *joints, approach: None, retract: None };
        if retract > 0.0 {
            ends.retract = back(retract, PostureRefusal::Retract)?;
        }
        // The longer line contains the shorter one.
        if approach > retract {
            ends.approach = back(approach, PostureRefusal::Approach)?;
        } else if approach == retract {
            ends.approach = ends.retract;
        }
        Ok(ends)
    }

    /// Returns whether a posture is one of the via postures of the transfer rules.
    pub fn is_via(&self, joints: &JointVector) -> bool {
        self.transfer.as_ref().is_some_and(|rules| rules.via.contains(joints))
    }

    /// Returns the lengths (m) of the straight approach to the spot of an operation and of the retract from
    /// this spot.
    pub fn approach_and_retract(&self, operation: usize) -> (f64, f64) {
        self.lengths[operation]
    }

    /// Checks that a posture is far enough from a singularity.
    fn regular(&self, joints: &JointVector) -> Result<(), PostureRefusal> {
        if self.singularity == 0.0 {
            return Ok(());
        }
        let frames = self.chain.frames(&self.chain.posture(joints));
        if is_regular(&self.chain, &frames, self.reach, self.singularity) {
            return Ok(());
        }
        let measure = singularity(&self.chain, &frames, self.reach);
        if measure < self.singularity { Err(PostureRefusal::Singular { measure }) } else { Ok(()) }
    }

    /// Returns a lower bound of the [`singularity`] measure of a posture after a change of the scaled
    /// Jacobian. Returns None if this bound is at least as large as the margin.
    ///
    /// The function `change` receives the length (m) by which all lengths in the Jacobian are divided. The
    /// result of `change` is an upper bound of the spectral norm of the change in the Jacobian.
    ///
    /// If a matrix changes, each singular value changes by at most the spectral norm of the change (H. Weyl
    /// 1912).
    pub fn may_become_singular(&self, frames: &Frames, change: impl Fn(f64) -> f64) -> Option<f64> {
        if self.singularity == 0.0 {
            return None;
        }
        let change = change(self.reach);
        if is_regular(&self.chain, frames, self.reach, self.singularity + change) {
            return None;
        }
        let least = singularity(&self.chain, frames, self.reach) - change;
        (least < self.singularity).then_some(least.max(0.0))
    }

    /// Returns joint vectors that move the TCP back from a spot by `length` (m), against the direction of the
    /// tool axis.
    pub fn back(&self, joints: &JointVector, length: f64) -> Result<Vec<JointVector>, Stopped> {
        let tcp = self.chain.forward(&self.chain.posture(joints));
        let axis: Vector3<f64> = tcp.rotation * self.chain.tool_axis;
        straight(&self.chain, joints, &(axis * -length), self.reach)
    }

    /// Returns the first contact on a path.
    pub(super) fn first_hit(
        &self,
        scene: &Scene,
        placed: &PlacedSolids,
        knots: &[JointVector],
        load: Load,
    ) -> Option<PathHit> {
        first_hit(&self.chain, scene, placed, knots, load, &PathSlack::default())
    }
}
