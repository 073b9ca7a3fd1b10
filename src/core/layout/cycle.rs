//! Cycle time of a layout.

use super::evaluation::Evaluation;
use super::workcell::Workcell;
use crate::cell::Layout;
use crate::cycle_time::CycleTime;
use crate::error_map::{Outcome, PlacedLayout, Spot};

impl Workcell {
    /// Computes the cycle time of a layout, with every step of the cycle.
    ///
    /// Returns None if the layout is not feasible, if the maximum speed of a joint is not known, or if the
    /// arm cannot follow an approach or a retract.
    pub fn cycle_time(&self, layout: &Layout, evaluation: &Evaluation) -> Option<CycleTime> {
        evaluation.objective?;
        let found = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(*spot) } else { None };
        let spots: Vec<Option<Spot>> = evaluation.outcomes.iter().map(found).collect();
        self.cycle_at(&self.placed(layout), evaluation, &spots)
    }

    /// Computes the cycle time of a placed layout with these spots.
    pub(super) fn cycle_at(
        &self,
        placed: &PlacedLayout<'_>,
        evaluation: &Evaluation,
        spots: &[Option<Spot>],
    ) -> Option<CycleTime> {
        let stops = placed.stops(spots, &evaluation.every_node)?;
        placed.cycle_time(&self.cell, &stops, &evaluation.transfers, self.rates.as_ref().ok()?)
    }
}
