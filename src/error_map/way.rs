//! Postures and layouts asked for their motion: margins, approach and retract, ways between operations.

use super::mapper::{Mapper, Scratch};
use super::node::Status;
use super::outcome::Spot;
use crate::cell::{JointVector, Layout};
use crate::clearance::{PlacedSolids, Scene};
use crate::motion::{Blocked, Guard, OperationPosture, PostureRefusal, Transfer};
use crate::reach::ToolAttitudes;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

impl Mapper {
    /// Why a posture that touches nothing cannot be used; None: it can.
    pub(super) fn refusal(
        &self,
        (operation, approach): (usize, &ToolAttitudes),
        (target, branch): (&Vector3<f64>, u32),
        scene: &Scene,
        placed: &PlacedSolids,
    ) -> Option<PostureRefusal> {
        let guard = self.guard.as_ref().filter(|guard| guard.asks_postures(operation))?;
        let joints = self.arm.inverse.branch_at(target, approach, branch)?.joints;
        guard.admits(scene, placed, operation, &joints).err()
    }

    /// What is the matter with a posture within its limits; None: nothing.
    pub(super) fn trouble(
        &self,
        operation: usize,
        (frames, joints): (&Frames, &JointVector),
        scene: &Scene,
        placed: &PlacedSolids,
    ) -> Option<Status> {
        if let Some(hit) = scene.hit(placed, &frames.links, Some(operation)) {
            return Some(Status::Collision { hit });
        }
        let refused = |guard: &Guard| guard.admits(scene, placed, operation, joints).err();
        self.guard.as_ref().and_then(refused).map(Status::Refused)
    }

    /// Whether the ways between operations are asked for.
    pub fn asks_transfers(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::asks_transfers)
    }

    /// The ways between the operations, at their spots and from point to point of one at many points; none if the cell does not ask for them or a spot is
    /// missing.
    ///
    /// # Errors
    /// The first that is blocked.
    pub fn transfers(
        &self,
        layout: &Layout,
        scene: &Scene,
        placed: &PlacedSolids,
        spots: &[Option<Spot>],
    ) -> Result<Vec<Transfer>, Blocked> {
        let Some(guard) = self.guard.as_ref().filter(|guard| guard.asks_transfers()) else {
            return Ok(Vec::new());
        };
        let stances: Option<Vec<Vec<OperationPosture>>> =
            (0..spots.len()).map(|k| self.stances(k, layout, scene, spots)).collect();
        stances.map_or(Ok(Vec::new()), |stances| guard.transfers(scene, placed, &stances.concat()))
    }

    /// The postures of an operation in their order: at its spot, or at every one of its points. Of a region
    /// that at the worst node: no order is given to the others.
    fn stances(
        &self,
        operation: usize,
        layout: &Layout,
        scene: &Scene,
        spots: &[Option<Spot>],
    ) -> Option<Vec<OperationPosture>> {
        let (station, spot) = (&self.stations[operation], spots[operation]?);
        if !station.over.takes_all() || !station.grid.is_listed() {
            return Some(vec![self.stance(operation, layout, &spot)?]);
        }
        let (mut placed, mut scratch) = (PlacedSolids::default(), Scratch::default());
        scene.place(layout, &mut placed);
        let all = self.every_free(operation, layout, scene, &mut placed, spots, &mut scratch).ok()?;
        all.iter().map(|spot| self.stance(operation, layout, spot)).collect()
    }

    /// The joint coordinates of an operation at its spot.
    pub fn stance(&self, operation: usize, layout: &Layout, spot: &Spot) -> Option<OperationPosture> {
        let stand = self.stand(operation, layout);
        let approach = stand.approach(&self.arm);
        let target = self.stations[operation].grid.target(&stand.at, spot.node);
        let joints = self.arm.inverse.branch_at(&target, &approach, spot.branch)?.joints;
        Some(OperationPosture { operation, joints })
    }

    /// The arm; its limits are those of the robot less the margins.
    pub fn chain(&self) -> &Chain {
        &self.arm.chain
    }
}
