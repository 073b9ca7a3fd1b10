//! What the errors of an operation depend on in one layout besides its own posture.

use super::outcome::{Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::teaching::work_site;
use crate::reading::{Reference, Situation};

impl PlacedLayout<'_> {
    /// Computes what the errors of an operation depend on besides its posture.
    ///
    /// `spots` are those of the operations before it.
    ///
    /// # Errors
    /// Something is missing, so that no posture can be judged.
    pub fn situation(&self, operation: usize, spots: &[Option<Spot>]) -> Result<Situation, Unjudged> {
        let setup = &self.mapper.setups[operation];
        let site = work_site(self, &setup.gauge, &self.surface(operation))?;
        let Some(pick) = setup.relative_to else { return Ok(Situation { site, reference: None }) };
        let spot = spots.get(pick).copied().flatten().ok_or(Unjudged::NoPick)?;
        let (arm, surface) = (&self.mapper.arm, self.surface(pick));
        let (target, approach) = (self.target(&surface, spot.node), self.approach(&surface));
        let posture = arm.inverse.posture(&target, &approach, spot.branch).ok_or(Unjudged::NoPick)?;
        let site_of_pick = work_site(self, &setup.gauge, &surface)?;
        let reference = Reference::new(&setup.gauge, site_of_pick, arm.chain.frames(&posture));
        Ok(Situation { site, reference: Some(Box::new(reference)) })
    }
}
