//! Boxes of joint coordinates in which the robot certainly collides with itself.
//!
//! In the middle of a box, two solids of the robot may overlap so deeply that they overlap in the whole box.
//! This is proven by an upper bound of their relative motion in the box ([`MotionBounds`]). The relative
//! motion depends only on the joints between the two solids. A joint without a coordinate in the boxes does
//! not matter if it rotates one of the two solids about its axis of revolution. If another joint between the
//! two solids has no coordinate, the pair is not checked.

use super::coordinates::middle;
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::clearance::Scene;
use crate::kinematic_error::JointValues;
use crate::layout::Workcell;
use crate::motion::MotionBounds;
use crate::pose::Pose;
use crate::robot::Chain;

/// Check of boxes and postures of one operation for self-collision.
pub(super) struct SelfCollisionCheck<'a> {
    chain: &'a Chain,
    scene: &'a Scene,
    operation: usize,
    /// Pairs of solids whose relative motion depends only on joints with a coordinate.
    pairs: Vec<(usize, usize)>,
}

impl<'a> SelfCollisionCheck<'a> {
    /// Prepares the check. Joints marked in `held` have no coordinate in the boxes.
    pub fn new(workcell: &'a Workcell, operation: usize, held: &[bool; MAX_JOINTS]) -> Self {
        let (chain, scene) = (workcell.inverse().chain(), workcell.scene());
        let frame = |solid: usize| scene.bounding_spheres()[solid].frame;
        let links = chain.frames(&chain.posture(&middle(chain))).links;
        // A held joint does not matter if it rotates one of the two solids about its axis of revolution.
        let is_round = |solid: usize, joint: usize| {
            let carrier = if frame(solid) == 0 { Pose::IDENTITY } else { links[frame(solid)] };
            chain.links[joint].kind == JointKind::Revolute
                && scene.is_round_about(solid, &(carrier.inverse() * links[joint]))
        };
        let mut pairs = scene.self_collision_checks(operation);
        pairs.retain(|&(a, b)| {
            let (first, last) = (frame(a), frame(b) - 1);
            let matters = |joint: usize| {
                held[joint]
                    && !(joint == first && is_round(a, joint))
                    && !(joint == last && is_round(b, joint))
            };
            !(first..=last).any(matters)
        });
        Self { chain, scene, operation, pairs }
    }

    /// Returns whether the robot collides with itself in every posture near a posture. `joints` are the
    /// actuator coordinates of that posture, rad or m. Each D-H coordinate changes by at most `travel`.
    pub fn surrounds(&self, joints: &JointVector, travel: JointValues) -> bool {
        if self.pairs.is_empty() {
            return false;
        }
        let frames = self.chain.frames(&self.chain.posture(joints)).links;
        let bounds = MotionBounds::around(self.chain, joints, travel);
        let spheres = self.scene.bounding_spheres();
        self.pairs.iter().any(|&(a, b)| {
            let by = bounds.displacement(&spheres[b], spheres[a].frame);
            self.scene.overlap_despite(&frames, (a, b), by)
        })
    }

    /// Returns whether the robot touches itself or its pedestal in the posture with the given actuator
    /// coordinates, rad or m.
    pub fn is_in(&self, joints: &JointVector) -> bool {
        let frames = self.chain.frames(&self.chain.posture(joints)).links;
        self.scene.touches_itself(&frames, self.operation)
    }
}
