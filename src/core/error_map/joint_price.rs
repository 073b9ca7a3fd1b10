//! Cost of the cheapest tolerances with which all operations of a layout keep their limits together.

use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::allocation::{FigureScratch, LinearFigure, OperationPricing};
use crate::cell::Cell;

impl PlacedLayout<'_> {
    /// Returns the cost of the cheapest tolerances with which every operation keeps its limit at its spot, or at all
    /// nodes if it happens at every node.
    ///
    /// Returns None if the cell does not price tolerances, an operation has no limit, or a posture cannot be posed.
    pub fn joint_price(
        &self,
        cell: &Cell,
        spots: &[Option<Spot>],
        workspace: &mut MapperWorkspace,
    ) -> Option<f64> {
        let tolerances = self.mapper.tolerances.as_ref()?;
        let mut figures: Vec<LinearFigure> = Vec::new();
        for (k, operation) in cell.operations.iter().enumerate() {
            let evaluator = self.mapper.evaluator(k);
            let pricing = OperationPricing::new(tolerances.clone(), operation, evaluator)?;
            let nodes = match operation.over.needs_every_node() {
                true => self.every_free(k, spots, workspace).ok()?,
                false => vec![(*spots.get(k)?)?],
            };
            let query = OperationQuery::new(self, k, spots);
            let memory = workspace.of(self.mapper, k).postures;
            for spot in &nodes {
                figures.push(query.priced_figure(&pricing, spot, memory)?);
            }
        }
        Some(tolerances.price(&figures, &mut FigureScratch::default()))
    }
}

impl OperationQuery<'_> {
    /// Returns the figure of the operation at a spot, divided by its limit.
    fn priced_figure(
        &self,
        pricing: &OperationPricing,
        spot: &Spot,
        memory: &mut PostureMemory,
    ) -> Option<LinearFigure> {
        let target = self.setup.grid.target(&self.at, spot.node);
        let posture = self.branch_at(&target, spot.branch)?.posture;
        let PostureMemory { frames, scratch, .. } = memory;
        self.placed.mapper.arm.chain.place(&posture, frames);
        let node = self.setup.figure(self.context.as_ref().ok()?, frames);
        Some(pricing.figure(&node, &mut scratch.evaluator))
    }
}
