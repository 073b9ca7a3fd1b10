//! Context of an operation in one layout: the data, other than the posture, that determine the errors of
//! the operation.

use super::outcome::{Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::teaching::work_frame;
use crate::reach::CONTINUED;
use crate::reading::WorkContext;

impl PlacedLayout<'_> {
    /// Computes all data that determine the errors of an operation, except the posture.
    ///
    /// `spots` holds the spots of the earlier operations.
    ///
    /// # Errors
    /// Returns the reason if the errors of the operation cannot be computed.
    pub fn work_context(&self, operation: usize, spots: &[Option<Spot>]) -> Result<WorkContext, Unjudged> {
        let setup = &self.mapper.setups[operation];
        let site = work_frame(self, &setup.evaluator, &self.surface(operation))?;
        let Some(pick) = setup.relative_to else { return Ok(WorkContext { site, reference: None }) };
        let spot = spots.get(pick).copied().flatten().ok_or(Unjudged::NoPick)?;
        let (arm, surface) = (&self.mapper.arm, self.surface(pick));
        let (target, attitudes) = (self.target(&surface, spot.node), self.attitudes(&surface));
        let posture = match self.kept_posture(pick).filter(|_| spot.branch == CONTINUED) {
            Some(held) => held.continued(&arm.inverse, &target, &attitudes).ok().map(|found| found.posture),
            None => arm.inverse.posture(&target, &attitudes, spot.branch),
        };
        let posture = posture.ok_or(Unjudged::NoPick)?;
        let frame_of_pick = work_frame(self, &setup.evaluator, &surface)?;
        let reference = setup.evaluator.pick_reference(frame_of_pick, arm.chain.frames(&posture));
        Ok(WorkContext { site, reference: Some(Box::new(reference)) })
    }
}
