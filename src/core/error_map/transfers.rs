//! Transfers between the operations of a layout, and the cycle time.

use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::workspace::MapperWorkspace;
use crate::cell::{Cell, JointVector};
use crate::clearance::Load;
use crate::cycle_time::{CycleTime, MotionSequence, RateBounds};
use crate::motion::{Blocked, OperationPosture, Transfer};

impl PlacedLayout<'_> {
    /// Plans the transfers between the spots of the operations.
    ///
    /// An operation that happens at all of its listed points adds the transfers between these points.
    ///
    /// If the layout must withstand misplacements, every transfer is certified.
    ///
    /// No transfers are returned if the cell has no transfer rules, or if an operation has no spot.
    ///
    /// # Errors
    /// Returns the first transfer that is blocked.
    pub fn transfers(&self, spots: &[Option<Spot>]) -> Result<Vec<Transfer>, Blocked> {
        let Some(guard) = self.mapper.guard.as_ref().filter(|guard| guard.asks_transfers()) else {
            return Ok(Vec::new());
        };
        self.stops(spots).map_or(Ok(Vec::new()), |stops| {
            let check = |ends: [usize; 2], path: &[JointVector], load: Load| match self.demand {
                Some(demand) => self.certify_transfer(ends, path, load, spots, &demand),
                None => Ok(()),
            };
            guard.transfers(&self.mapper.scene, &self.solids, &stops, &check)
        })
    }

    /// Returns the postures of all operations in their order; None if an operation has no spot.
    ///
    /// An operation has one posture at its spot, or one posture at every listed point.
    pub fn stops(&self, spots: &[Option<Spot>]) -> Option<Vec<OperationPosture>> {
        let stops: Option<Vec<Vec<OperationPosture>>> =
            (0..spots.len()).map(|k| self.stops_of(k, spots)).collect();
        Some(stops?.concat())
    }

    /// Computes the least time of the motions and operations of the layout. `spots` holds the spots of all
    /// operations, and `transfers` holds the transfers between them.
    ///
    /// Returns None if an operation has no spot, or if the arm cannot follow an approach or a retract.
    pub fn cycle_time(
        &self,
        cell: &Cell,
        spots: &[Option<Spot>],
        transfers: &[Transfer],
        bounds: &RateBounds,
    ) -> Option<CycleTime> {
        let stops = self.stops(spots)?;
        let (chain, guard) = (self.mapper.chain(), self.mapper.guard.as_ref());
        MotionSequence { cell, chain, guard, stops: &stops, transfers }.time(bounds)
    }

    /// Returns the postures of an operation in their order: at its spot, or at every listed point.
    ///
    /// The nodes of a grid have no order. An operation at every node of a grid therefore has only one posture
    /// here. This is the posture at the spot, which is the node with the largest value.
    fn stops_of(&self, operation: usize, spots: &[Option<Spot>]) -> Option<Vec<OperationPosture>> {
        let (setup, spot) = (&self.mapper.setups[operation], spots[operation]?);
        if !setup.over.needs_every_node() || !setup.grid.is_listed() {
            return Some(vec![self.operation_posture(operation, &spot)?]);
        }
        let all = self.every_free(operation, spots, &mut MapperWorkspace::default()).ok()?;
        all.iter().map(|spot| self.operation_posture(operation, spot)).collect()
    }
}
