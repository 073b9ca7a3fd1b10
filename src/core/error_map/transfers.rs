//! Transfers between the operations of a layout, and the cycle time.

use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::workspace::MapperWorkspace;
use crate::cell::{Cell, JointVector};
use crate::clearance::Load;
use crate::cycle_time::{CycleTime, MotionSequence, RateBounds};
use crate::motion::{Blocked, Guard, OperationPosture, PathCheck, Transfer};

impl PlacedLayout<'_> {
    /// Plans the transfers between the spots of the operations.
    ///
    /// An operation that happens at all of its listed points adds the transfers between these points.
    ///
    /// If the layout must withstand misplacements, every transfer is certified.
    ///
    /// No transfers are returned if the cell has no transfer rules, or if an operation has no spot. See
    /// [`Self::stops`] for the argument `every`. `workspace` holds the ends of the approach and retract lines
    /// that were checked before.
    ///
    /// # Errors
    /// Returns the first transfer that is blocked.
    pub fn transfers(
        &self,
        spots: &[Option<Spot>],
        every: &[Option<Vec<Spot>>],
        workspace: &MapperWorkspace,
    ) -> Result<Vec<Transfer>, Blocked> {
        let Some(guard) = self.mapper.guard.as_ref().filter(|guard| guard.asks_transfers()) else {
            return Ok(Vec::new());
        };
        self.stops(spots, every).map_or(Ok(Vec::new()), |stops| {
            let check = self.demand.as_ref().map(|demand| {
                move |ends: [usize; 2], path: &[JointVector], load: Load| {
                    self.certify_transfer(ends, path, load, spots, demand)
                }
            });
            let check = check.as_ref().map(|check| check as PathCheck<'_>);
            let known = |stop: &OperationPosture| workspace.line_ends(stop.operation, &stop.joints);
            guard.transfers(&self.mapper.scene, &self.solids, &stops, &known, check)
        })
    }

    /// Returns the postures of all operations in their order; None if an operation has no spot.
    ///
    /// An operation has one posture at its spot, or one posture at every listed point. `every` holds the
    /// spots that [`Self::every_free`] has found for each operation. If the spots of an operation are
    /// missing, they are computed.
    pub fn stops(
        &self,
        spots: &[Option<Spot>],
        every: &[Option<Vec<Spot>>],
    ) -> Option<Vec<OperationPosture>> {
        let known = |k: usize| every.get(k)?.as_deref();
        let stops: Option<Vec<Vec<OperationPosture>>> =
            (0..spots.len()).map(|k| self.stops_of(k, spots, known(k))).collect();
        Some(stops?.concat())
    }

    /// Returns whether the transfers visit every listed point of an operation.
    pub fn visits_every_point(&self, operation: usize) -> bool {
        let setup = &self.mapper.setups[operation];
        let has_transfers = self.mapper.guard.as_ref().is_some_and(Guard::asks_transfers);
        has_transfers && setup.over.needs_every_node() && setup.grid.is_listed()
    }

    /// Computes the least time of the motions and operations of the layout. `stops` holds the postures of all
    /// operations ([`Self::stops`]), and `transfers` holds the transfers between them.
    ///
    /// Returns None if the arm cannot follow an approach or a retract.
    pub fn cycle_time(
        &self,
        cell: &Cell,
        stops: &[OperationPosture],
        transfers: &[Transfer],
        bounds: &RateBounds,
    ) -> Option<CycleTime> {
        let (chain, guard) = (self.mapper.chain(), self.mapper.guard.as_ref());
        MotionSequence { cell, chain, guard, stops, transfers }.time(bounds)
    }

    /// Returns the postures of an operation in their order: at its spot, or at every listed point.
    ///
    /// The nodes of a grid have no order. An operation at every node of a grid therefore has only one posture
    /// here. This is the posture at the spot, which is the node with the largest value. `known` holds the
    /// spots of all points if they are known.
    fn stops_of(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        known: Option<&[Spot]>,
    ) -> Option<Vec<OperationPosture>> {
        let (setup, spot) = (&self.mapper.setups[operation], spots[operation]?);
        if !setup.over.needs_every_node() || !setup.grid.is_listed() {
            return Some(vec![self.operation_posture(operation, &spot)?]);
        }
        let postures =
            |all: &[Spot]| all.iter().map(|spot| self.operation_posture(operation, spot)).collect();
        match known {
            Some(all) => postures(all),
            None => postures(&self.every_free(operation, spots, &mut MapperWorkspace::default()).ok()?),
        }
    }
}
