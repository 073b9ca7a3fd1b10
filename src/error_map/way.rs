//! Postures and layouts asked for their motion: margins, approach and retract, ways between operations.

use super::mapper::Mapper;
use super::node::Status;
use super::outcome::Spot;
use crate::cell::{JointVector, Layout};
use crate::clearance::{Placed, Scene};
use crate::motion::{Blocked, Guard, Refusal, Stance, Transfer};
use crate::reach::Approach;
use crate::robot::Frames;
use nalgebra::Vector3;

impl Mapper {
    /// Why a posture that touches nothing cannot be used; None: it can.
    pub(super) fn refusal(
        &self,
        (operation, approach): (usize, &Approach),
        (target, branch): (&Vector3<f64>, u32),
        scene: &Scene,
        placed: &Placed,
    ) -> Option<Refusal> {
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
        placed: &Placed,
    ) -> Option<Status> {
        if let Some(hit) = scene.hit(placed, &frames.links, Some(operation)) {
            return Some(Status::Collision { hit });
        }
        let refused = |guard: &Guard| guard.admits(scene, placed, operation, joints).err();
        self.guard.as_ref().and_then(refused).map(Status::Refused)
    }

    /// The joint coordinates at a spot.
    pub fn joints(&self, operation: usize, layout: &Layout, spot: &Spot) -> Option<JointVector> {
        let stand = self.stand(operation, layout);
        let approach = stand.approach(&self.arm);
        let target = self.stations[operation].grid.target(&stand.at, spot.node);
        self.arm.inverse.branch_at(&target, &approach, spot.branch).map(|branch| branch.joints)
    }

    /// Whether the ways between operations are asked for.
    pub fn asks_transfers(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::asks_transfers)
    }

    /// The ways between the operations at their spots; none if the cell does not ask for them or a spot is
    /// missing.
    ///
    /// # Errors
    /// The first that is blocked.
    pub fn transfers(
        &self,
        layout: &Layout,
        scene: &Scene,
        placed: &Placed,
        spots: &[Option<Spot>],
    ) -> Result<Vec<Transfer>, Blocked> {
        let Some(guard) = self.guard.as_ref().filter(|guard| guard.asks_transfers()) else {
            return Ok(Vec::new());
        };
        let stance = |(operation, spot): (usize, &Option<Spot>)| {
            let joints = self.joints(operation, layout, &(*spot)?)?;
            Some(Stance { operation, joints })
        };
        let stances: Option<Vec<_>> = spots.iter().enumerate().map(stance).collect();
        stances.map_or(Ok(Vec::new()), |stances| guard.transfers(scene, placed, &stances))
    }
}
