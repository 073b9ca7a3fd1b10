//! Evaluation of the postures that an operation keeps while the layout changes.

use super::candidate::Certainty;
use super::held_posture::HeldPosture;
use super::node_record::Status;
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::{OperationQuery, least_violation};
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::reach::{Branch, PoseMiss};
use crate::robot::Posture;
use nalgebra::Vector3;

impl OperationQuery<'_> {
    /// Returns the TCP target over a point of the surface, in the base frame, m.
    pub fn target(&self, at: (f64, f64)) -> Vector3<f64> {
        self.setup.grid.point(&self.at, at)
    }

    /// Returns the posture of a branch at a point of the surface, so that this operation can keep it while
    /// the layout changes. Returns None if the branch does not exist at the point.
    pub fn hold(&self, at: (f64, f64), branch: u64) -> Option<HeldPosture> {
        let target = self.target(at);
        let joints = self.branch_at(&target, branch)?.joints;
        let heading = self.placed.mapper.arm.inverse.heading(&target, &self.attitudes);
        Some(HeldPosture { at, branch, joints, heading })
    }

    /// Computes the value of the operation ([`Spot::value`]) in a held posture. Collisions and motion rules
    /// are not checked.
    ///
    /// `held` may come from a slightly different layout. The point keeps its coordinates in the frame of
    /// the equipment. The joint coordinates are computed anew by the rules of [`HeldPosture`].
    ///
    /// # Errors
    /// Returns the status of the point if no posture within the joint limits corresponds to the held posture.
    /// Also returns the status if the errors cannot be computed.
    pub fn held(&mut self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<f64, Status> {
        let posture = self.held_posture(held)?;
        self.value(&posture, memory)
    }

    /// Finds the posture in this layout that corresponds to a held posture ([`HeldPosture`]).
    ///
    /// # Errors
    /// Returns the status of the point if no posture within the joint limits corresponds to the held posture.
    fn held_posture(&mut self, held: &HeldPosture) -> Result<Posture, Status> {
        self.kept = Some(*held);
        let target = self.target(held.at);
        let inverse = &self.placed.mapper.arm.inverse;
        if inverse.continues_postures() {
            return match held.continued(inverse, &target, &self.attitudes) {
                Ok(found) => Ok(found.posture),
                Err(PoseMiss { position, angle }) => Err(Status::NotConverged { position, angle }),
            };
        }
        inverse.usable(&target, &self.attitudes, held.branch).ok_or_else(|| {
            match inverse.branch_beyond_limits(&target, &self.attitudes, held.branch) {
                Ok(branch) => least_violation(&[branch]),
                Err(by) => Status::OutOfReach { by },
            }
        })
    }

    /// Returns the reason for the status of a held posture. If the numeric solver did not converge because a
    /// joint is at its limit, the result names this joint. Otherwise, the result is the status itself.
    pub fn reason(&self, held: &HeldPosture, status: Status) -> Status {
        let Status::NotConverged { .. } = status else { return status };
        let branch = self.branch_beyond_limits(held).filter(|branch| branch.violation.is_some());
        branch.map_or(status, |branch| least_violation(&[branch]))
    }

    /// Checks that a held posture, transferred to this layout, is collision-free. Also
    /// checks that the motion rules allow this posture.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn keeps_free(&mut self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<(), Status> {
        let posture = self.held_posture(held)?;
        self.placed.mapper.arm.chain.place(&posture, &mut memory.frames);
        self.refused(held, memory)
    }

    /// Checks collisions and motion rules of a held posture whose frames are in `memory`.
    ///
    /// # Errors
    ///
    /// Returns the status of the point if the posture cannot be held.
    fn refused(&self, held: &HeldPosture, memory: &PostureMemory) -> Result<(), Status> {
        let branch = held.branch_elsewhere(&self.placed.mapper.arm.inverse);
        self.refusal_status(&self.target(held.at), branch, memory).map_or(Ok(()), Err)
    }

    /// Computes the value like [`Self::held`], and checks that the posture is collision-free and allowed by
    /// the motion rules.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn holding(&mut self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<f64, Status> {
        let value = self.held(held, memory)?;
        self.refused(held, memory).map(|()| value)
    }

    /// Finds the branch in this layout that corresponds to a held posture; None if there is no such branch.
    ///
    /// The branch may exceed a joint limit, unless the arm has only a numeric solver.
    pub fn branch_beyond_limits(&self, held: &HeldPosture) -> Option<Branch> {
        let (target, inverse) = (self.target(held.at), &self.placed.mapper.arm.inverse);
        if inverse.continues_postures() {
            let within = held.continued(inverse, &target, &self.attitudes).ok();
            return within.or_else(|| held.continued_beyond_limits(inverse, &target, &self.attitudes));
        }
        inverse.branch_beyond_limits(&target, &self.attitudes, held.branch).ok()
    }

    /// Computes the value of the operation in a posture, and places the frames of the posture in `memory`.
    ///
    /// # Errors
    /// Returns the status of the point if errors cannot be computed in this layout.
    pub fn value(&self, posture: &Posture, memory: &mut PostureMemory) -> Result<f64, Status> {
        let PostureMemory { frames, scratch, .. } = memory;
        let context = self.context.as_ref().map_err(|why| Status::Unjudged(*why))?;
        self.placed.mapper.arm.chain.place(posture, frames);
        Ok(self.setup.value(context, frames, scratch))
    }

    /// Computes a lower bound of [`Self::held`], or the value itself if a bound would save little time.
    ///
    /// # Errors
    /// Returns the status of the point as [`Self::held`] does.
    fn held_bound(&mut self, held: &HeldPosture, memory: &mut PostureMemory) -> Result<f64, Status> {
        let posture = self.held_posture(held)?;
        let PostureMemory { frames, scratch, .. } = memory;
        let context = self.context.as_ref().map_err(|why| Status::Unjudged(*why))?;
        self.placed.mapper.arm.chain.place(&posture, frames);
        Ok(self.setup.bound(Certainty::Bound, context, frames, scratch))
    }
}

impl PlacedLayout<'_> {
    /// Returns the posture of a branch at a point of the surface, so that an operation can keep it while the
    /// layout changes. Returns None if the branch does not exist at the point.
    pub fn hold(&self, operation: usize, at: (f64, f64), branch: u64) -> Option<HeldPosture> {
        OperationQuery::new(self, operation, &[]).hold(at, branch)
    }

    /// Computes the value of an operation in a held posture in this layout. Collisions and motion rules are
    /// not checked. `spots` holds the spots of the earlier operations.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn held(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        held: &HeldPosture,
        workspace: &mut MapperWorkspace,
    ) -> Result<f64, Status> {
        self.asking(operation, spots, workspace, |query, memory| query.held(held, memory))
    }

    /// Computes a lower bound of [`Self::held`], or the value itself if a bound would save little time.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn held_bound(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        held: &HeldPosture,
        workspace: &mut MapperWorkspace,
    ) -> Result<f64, Status> {
        self.asking(operation, spots, workspace, |query, memory| query.held_bound(held, memory))
    }

    /// Returns whether [`Self::held_bound`] may be less than [`Self::held`].
    pub fn has_held_bound(&self, operation: usize) -> bool {
        self.mapper.setups[operation].has_sharp_bound()
    }

    /// Checks that the arm can reach a held posture of an operation in this layout. Collisions and motion
    /// rules are not checked.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn keeps(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        held: &HeldPosture,
        workspace: &mut MapperWorkspace,
    ) -> Result<(), Status> {
        self.asking(operation, spots, workspace, |query, _| query.held_posture(held).map(drop))
    }

    /// Checks that a held posture of an operation is reachable, collision-free and allowed by the motion
    /// rules in this layout.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn keeps_free(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        held: &HeldPosture,
        workspace: &mut MapperWorkspace,
    ) -> Result<(), Status> {
        self.asking(operation, spots, workspace, |query, memory| query.keeps_free(held, memory))
    }

    /// Calls `ask` with the query of one operation and with the memory of this operation in the workspace.
    fn asking<T>(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
        ask: impl FnOnce(&mut OperationQuery<'_>, &mut PostureMemory) -> T,
    ) -> T {
        let attitudes = std::mem::take(&mut workspace.attitudes);
        let mut query = OperationQuery::reusing(self, &self.surface(operation), spots, attitudes);
        let answer = ask(&mut query, workspace.of(self.mapper, operation).postures);
        workspace.attitudes = query.attitudes;
        answer
    }
}
