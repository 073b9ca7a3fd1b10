//! Error maps of a layout.

use super::spot_choice::{SpotMemory, SpotQuery};
use super::workcell::Workcell;
use crate::cell::Layout;
use crate::certificate::Misplacements;
use crate::error_map::{OperationMap, Outcome, PostureRecord, Spot, Unjudged};
use crate::reading::WorkContext;
use crate::robot::Frames;

impl Workcell {
    /// Computes the error map of every operation. If the equipment of an operation has an overlap, the
    /// reachable nodes of the operation are marked as blocked.
    ///
    /// If the layout does not belong to the cell, the maps have no nodes.
    pub fn maps(&self, layout: &Layout) -> Vec<OperationMap> {
        if self.cell.misfit(layout).is_some() {
            return (0..self.cell.operations.len()).map(|k| self.empty_map(k)).collect();
        }
        let placed = self.placed(layout);
        let mut overlaps = Vec::new();
        self.plan.overlaps(layout, &mut overlaps);
        let mut memory = SpotMemory::default();
        let misplacements = self.misplacements(layout);
        let demand = misplacements.as_ref().map(|misplacements| self.demand(misplacements));
        let strict = self.placed(layout).demanding(demand);
        let (mut maps, mut spots) = (Vec::<OperationMap>::new(), Vec::<Option<Spot>>::new());
        for (k, operation) in self.cell.operations.iter().enumerate() {
            let mut map = placed.map(k, &spots);
            if let Some(overlap) = overlaps.iter().find(|o| o.concerns(operation.equipment)) {
                map.block(*overlap);
            } else if (demand.is_some() || placed.refines(k)) && map.best.is_some() {
                // The best node of the map need not be the spot: it may lack a certificate, and the search
                // refines the postures of few nodes.
                let query = SpotQuery { workcell: self, placed: &strict, operation: k, spots: &spots };
                let choice = query.choose(&mut memory);
                if let Outcome::Found(spot) = choice.outcome {
                    let chosen = choice.every_node.unwrap_or_else(|| vec![spot]);
                    placed.show(&mut map, &spots, &chosen);
                    (map.best, map.value) = (Some(spot.node), Some(spot.value));
                }
            }
            spots.push(map.spot());
            maps.push(map);
        }
        maps
    }

    /// Returns the misplacements of the bodies inside the placement tolerances; None if the layout need not
    /// withstand misplacements.
    fn misplacements(&self, layout: &Layout) -> Option<Misplacements> {
        self.certifies().then(|| {
            let mut misplacements = Misplacements::default();
            misplacements.set(&self.cell, layout, self.cell.robot.reach());
            misplacements
        })
    }

    fn empty_map(&self, operation: usize) -> OperationMap {
        let senses = self.evaluator(operation).reported.clone();
        OperationMap { operation, senses, nodes: Vec::new(), best: None, value: None }
    }

    /// Computes the map of every operation that has no spot. Each node has the same status as in
    /// [`Workcell::maps`], but no posture and no errors.
    ///
    /// This function is many times faster than [`Workcell::maps`], because it does not compute the error of
    /// every node. If the layout does not belong to the cell, both functions return the same maps.
    pub fn maps_without_spot(&self, layout: &Layout) -> Vec<OperationMap> {
        if self.cell.misfit(layout).is_some() {
            return self.maps(layout);
        }
        let placed = self.placed(layout);
        let mut overlaps = Vec::new();
        self.plan.overlaps(layout, &mut overlaps);
        let mut memory = SpotMemory::default();
        let misplacements = self.misplacements(layout);
        let demand = misplacements.as_ref().map(|misplacements| self.demand(misplacements));
        let strict = self.placed(layout).demanding(demand);
        let (mut maps, mut spots) = (Vec::new(), Vec::<Option<Spot>>::new());
        for (k, operation) in self.cell.operations.iter().enumerate() {
            let overlap = overlaps.iter().find(|o| o.concerns(operation.equipment));
            let query = SpotQuery { workcell: self, placed: &strict, operation: k, spots: &spots };
            let spot = match overlap {
                Some(_) => None,
                None => match query.choose(&mut memory).outcome {
                    Outcome::Found(spot) => Some(spot),
                    _ => None,
                },
            };
            if spot.is_none() {
                let mut map = placed.statuses(k, &spots);
                overlap.into_iter().for_each(|overlap| map.block(*overlap));
                maps.push(map);
            }
            spots.push(spot);
        }
        maps
    }

    /// Returns the [`WorkContext`] of an operation, and the link frames of a posture in the map of this
    /// operation. The errors of this posture are computed from both.
    ///
    /// # Errors
    /// Returns the reason if the errors cannot be computed in this layout.
    pub fn posed(
        &self,
        layout: &Layout,
        maps: &[OperationMap],
        operation: usize,
        posture: &PostureRecord,
    ) -> Result<(WorkContext, Frames), Unjudged> {
        if self.cell.misfit(layout).is_some() {
            return Err(Unjudged::NotALayout);
        }
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let context = self.placed(layout).work_context(operation, &spots)?;
        Ok((context, self.mapper.frames(&posture.joints)))
    }
}
