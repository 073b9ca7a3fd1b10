//! Joint price: cost of the cheapest tolerances with which all operations of a layout stay within their
//! limits.

use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::allocation::{LinearFigure, NearbyPrice};

impl PlacedLayout<'_> {
    /// Returns the cost of the cheapest tolerances with which every operation stays within its limit at its
    /// spot. An operation that happens at every node must stay within its limit at all nodes.
    ///
    /// Returns None if the search ignores the cost of tolerances, if an operation has no limit, or if a
    /// posture is not found.
    pub fn joint_price(&self, spots: &[Option<Spot>], workspace: &mut MapperWorkspace) -> Option<f64> {
        let figures = self.joint_figures(spots, workspace)?;
        Some(self.mapper.tolerances.as_ref()?.price(&figures, &mut workspace.price))
    }

    /// Returns the cheapest tolerances with which every operation stays within its limit. Returns None if
    /// [`Self::joint_price`] returns None, or if a cost model has discrete grades. Also returns None if the
    /// dual ascent (numeric search for the shadow prices) fails.
    pub fn nearby_price(
        &self,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Option<NearbyPrice> {
        let figures = self.joint_figures(spots, workspace)?;
        NearbyPrice::new(self.mapper.tolerances.as_ref()?.costs(), &figures, &mut workspace.price)
    }

    /// Returns an upper bound of the cost that [`Self::joint_price`] computes. A returned bound never exceeds
    /// `most`. Returns None if [`Self::joint_price`] returns None or a cost above `most`.
    ///
    /// The argument `near` holds the cheapest tolerances of a similar layout. The function first reduces
    /// these tolerances until they meet every limit. If this fails, or if the reduced tolerances cost more
    /// than `most`, the function falls back on the cost from [`Self::joint_price`].
    pub fn joint_price_within(
        &self,
        spots: &[Option<Spot>],
        (near, most): (&NearbyPrice, f64),
        workspace: &mut MapperWorkspace,
    ) -> Option<f64> {
        let figures = self.joint_figures(spots, workspace)?;
        near.within(self.mapper.tolerances.as_ref()?, &figures, most, &mut workspace.price)
    }

    /// Returns the error figures of all operations, each divided by the limit of the operation; None if a
    /// figure is unknown.
    fn joint_figures(
        &self,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Option<Vec<LinearFigure>> {
        let mut figures: Vec<LinearFigure> = Vec::new();
        for (k, setup) in self.mapper.setups.iter().enumerate() {
            let nodes = match setup.over.needs_every_node() {
                true => self.every_free(k, spots, workspace).ok()?,
                false => vec![(*spots.get(k)?)?],
            };
            let query = OperationQuery::new(self, k, spots);
            let memory = workspace.of(self.mapper, k).postures;
            for spot in &nodes {
                figures.push(query.priced_figure(spot, memory)?);
            }
        }
        Some(figures)
    }
}

impl OperationQuery<'_> {
    /// Returns the error figure of the operation at a spot, divided by the limit; None if the figure is
    /// unknown.
    fn priced_figure(&self, spot: &Spot, memory: &mut PostureMemory) -> Option<LinearFigure> {
        let target = self.setup.grid.target(&self.at, spot.node);
        let posture = self.branch_at(&target, spot.branch)?.posture;
        let PostureMemory { frames, scratch, .. } = memory;
        self.placed.mapper.arm.chain.place(&posture, frames);
        let node = self.setup.figure(self.context.as_ref().ok()?, frames);
        Some(self.setup.pricing.as_ref()?.figure(&node, &mut scratch.evaluator))
    }
}
