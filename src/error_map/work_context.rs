//! What the errors of an operation depend on in one layout besides its own posture.

use super::outcome::{Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::teaching::work_frame;
use crate::reading::WorkContext;

impl PlacedLayout<'_> {
    /// Computes what the errors of an operation depend on besides its posture.
    ///
    /// `spots` are those of the operations before it.
    ///
    /// # Errors
    /// Something is missing, so that no posture can be judged.
    pub fn work_context(&self, operation: usize, spots: &[Option<Spot>]) -> Result<WorkContext, Unjudged> {
        let setup = &self.mapper.setups[operation];
        let site = work_frame(self, &setup.evaluator, &self.surface(operation))?;
        let Some(pick) = setup.relative_to else { return Ok(WorkContext { site, reference: None }) };
        let spot = spots.get(pick).copied().flatten().ok_or(Unjudged::NoPick)?;
        let (arm, surface) = (&self.mapper.arm, self.surface(pick));
        let (target, attitudes) = (self.target(&surface, spot.node), self.attitudes(&surface));
        let posture = arm.inverse.posture(&target, &attitudes, spot.branch).ok_or(Unjudged::NoPick)?;
        let frame_of_pick = work_frame(self, &setup.evaluator, &surface)?;
        let reference = setup.evaluator.pick_reference(frame_of_pick, arm.chain.frames(&posture));
        Ok(WorkContext { site, reference: Some(Box::new(reference)) })
    }
}
