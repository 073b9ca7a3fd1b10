//! Postures that an operation keeps while the layout changes.

use super::node_record::Status;
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::cell::JointVector;
use crate::reach::{Branch, Cost, Reach};
use crate::robot::Posture;
use nalgebra::Vector3;

/// A point of the surface at which the operation can happen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSpot {
    /// Point in the frame of the equipment, m.
    pub at: (f64, f64),
    pub branch: u32,
    /// Value to minimize, defined like [`Spot::value`].
    pub value: f64,
}

/// Point and posture that are kept while the layout changes a little.
///
/// Closed-form inverse kinematics finds the posture again by its branch index. Numeric inverse kinematics takes the
/// usable posture whose joint coordinates are nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldPosture {
    /// Point in the frame of the equipment, m.
    pub at: (f64, f64),
    pub branch: u32,
    /// Joint coordinates. They identify the posture of an arm whose branch indices change from target to
    /// target.
    pub joints: JointVector,
}

impl OperationQuery<'_> {
    /// Returns the TCP target over a point of the surface, base frame, m.
    pub fn target(&self, at: (f64, f64)) -> Vector3<f64> {
        self.setup.grid.point(&self.at, at)
    }

    /// Finds the branch of a held posture in this layout, and the operation's value ([`Spot::value`]) there.
    /// Collisions and motion rules are not checked.
    ///
    /// `held` may come from a slightly different layout. The point keeps its coordinates in the frame of the
    /// equipment, and the joint coordinates are computed anew.
    ///
    /// Closed-form inverse kinematics gives the posture with the branch index of `held`.
    ///
    /// Numeric inverse kinematics does not keep branch indices from target to target. In this case, the
    /// function takes the usable posture whose joint coordinates are nearest to those of `held`.
    ///
    /// # Errors
    /// Returns the status of the point if no branch within the joint limits holds the posture.
    pub fn held(&self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<PointSpot, Status> {
        let target = self.target(held.at);
        let inverse = &self.placed.mapper.arm.inverse;
        let is_numeric = inverse.cost() == Cost::Numeric;
        let found = match is_numeric {
            true => self.branch_near(held).map(|b| (b.posture, b.index)),
            false => inverse.usable(&target, &self.attitudes, held.branch).map(|p| (p, held.branch)),
        };
        let Some((posture, branch)) = found else {
            return Err(self.why_unreached(&target, |b| is_numeric || b.index == held.branch));
        };
        Ok(PointSpot { at: held.at, branch, value: self.value(&posture, memory)? })
    }

    /// Returns the spot like [`Self::held`]; its posture must be free of collisions and allowed by the motion rules.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn holding(&self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<PointSpot, Status> {
        let found = self.held(held, memory)?;
        let trouble = self.refusal_status(&self.target(found.at), found.branch, memory);
        trouble.map_or(Ok(found), Err)
    }

    /// Finds the branch of a held posture.
    ///
    /// The branch may exceed a joint limit, unless the inverse kinematics is numeric. In that case, the
    /// usable branch nearest to `held` is taken.
    pub fn branch_near(&self, held: &HeldPosture) -> Option<Branch> {
        let inverse = &self.placed.mapper.arm.inverse;
        let Reach::Branches(all) = inverse.branches(&self.target(held.at), &self.attitudes) else {
            return None;
        };
        match inverse.cost() {
            Cost::Numeric => nearest(&all, &held.joints).copied(),
            _ => all.into_iter().find(|b| b.index == held.branch),
        }
    }

    /// Computes the operation's value in a posture, and places the frames of the posture in `memory`.
    ///
    /// # Errors
    /// Returns the status of the point if errors cannot be computed in this layout.
    pub fn value(&self, posture: &Posture, memory: &mut PostureMemory) -> Result<f64, Status> {
        let PostureMemory { frames, scratch, .. } = memory;
        let context = self.context.as_ref().map_err(|why| Status::Unjudged(*why))?;
        self.placed.mapper.arm.chain.place(posture, frames);
        Ok(self.setup.evaluator.value(context, frames, scratch))
    }
}

impl PlacedLayout<'_> {
    /// Finds the held posture of an operation in this layout, and its value, by the rules of [`HeldPosture`]; `spots`
    /// holds the spots of the earlier operations.
    ///
    /// If `is_free`, the posture must be free of collisions and allowed by the motion rules, too.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn held(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        held: &HeldPosture,
        is_free: bool,
        workspace: &mut MapperWorkspace,
    ) -> Result<PointSpot, Status> {
        let attitudes = std::mem::take(&mut workspace.attitudes);
        let query = OperationQuery::reusing(self, &self.surface(operation), spots, attitudes);
        let memory = workspace.of(self.mapper, operation).postures;
        let found = if is_free { query.holding(held, memory) } else { query.held(held, memory) };
        workspace.attitudes = query.attitudes;
        found
    }
}

/// Returns the usable branch whose largest joint difference from `joints` is least.
fn nearest<'b>(branches: &'b [Branch], joints: &JointVector) -> Option<&'b Branch> {
    let off = |b: &Branch| b.joints.iter().zip(joints).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    branches.iter().filter(|b| b.is_usable()).min_by(|a, b| off(a).total_cmp(&off(b)))
}
