//! Self-collisions of a posture and of all postures near it.
//!
//! Two convex solids overlap by the depth d if a translation shorter than d cannot separate them. If every
//! point of one solid moves by less than d, its support function changes by less than d in every direction.
//! The Minkowski difference of the two solids then still contains the origin, so the solids still overlap.
//!
//! The depth of two capsules is the sum of their radii minus the distance of their axes. For other solids,
//! parry3d computes the depth with the expanding polytope algorithm (G. van den Bergen, 2001). The polytope
//! lies inside the Minkowski difference, so the result is at most the depth.

use super::arm_part::ArmPart;
use super::bodies::CollisionBody;
use super::bounding_capsule::{BoundingCapsule, segments_apart_squared};
use super::distance::core;
use super::pairs::Load;
use super::placed_solids::LinkFrames;
use super::robot_solids::RobotSolid;
use super::scene::Scene;
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};

/// Amount, m, by which a computed depth is reduced to allow for errors of parry3d.
const DEPTH_MARGIN: f64 = 1e-5;

/// Largest distance, m, between two points that count as equal.
const AXIS_ROUNDING: f64 = 1e-9;

impl Scene {
    /// Returns the pairs of robot solids whose contact is a collision during an operation. Each pair holds
    /// two indices into [`Self::bounding_spheres`]; the solid nearer to the base comes first.
    pub fn self_collision_checks(&self, operation: usize) -> Vec<(usize, usize)> {
        if self.enabled { self.self_pairs(Load::of(Some(operation))).collect() } else { Vec::new() }
    }

    /// Returns whether a solid of the robot is a solid of revolution about an axis. The axis is the z axis of
    /// `frame`, which is given in the frame that carries the solid.
    pub fn is_round_about(&self, solid: usize, frame: &Pose) -> bool {
        let distance = |p: &Vector3<f64>| (p - frame.translation).cross(&frame.rotation.column(2)).norm();
        self.links[solid].axis.is_some_and(|ends| ends.iter().all(|end| distance(end) < AXIS_ROUNDING))
    }

    /// Returns whether the robot touches itself or its pedestal in a posture during an operation. `frames`
    /// are the link frames in the robot base frame.
    pub fn touches_itself(&self, frames: &LinkFrames, operation: usize) -> bool {
        let capsule = |l: &RobotSolid| l.capsule(l.carrier(frames));
        let capsules: Vec<BoundingCapsule> = self.links.iter().map(capsule).collect();
        self.enabled && self.own_hit(ArmPart::Whole, frames, &capsules, Some(operation)).is_some()
    }

    /// Returns whether two solids of the robot certainly still overlap after every point of one solid has
    /// moved by at most `by` (m) relative to the other solid.
    ///
    /// `frames` are the link frames before this motion, in the robot base frame. The solids are indices into
    /// [`Self::bounding_spheres`].
    pub fn overlap_despite(&self, frames: &LinkFrames, (a, b): (usize, usize), by: f64) -> bool {
        let (a, b) = (&self.links[a], &self.links[b]);
        let (frame, there) = (a.carrier(frames), b.carrier(frames));
        let (round, other) = (a.core.at(frame), b.core.at(there));
        let room = round.radius + other.radius - by;
        if room <= 0.0 || segments_apart_squared(&round.a, &round.b, &other.a, &other.b) > room * room {
            return false;
        }
        let is_deep = |x: &CollisionBody, y: &CollisionBody| {
            let relative = x.pose_in(frame).inv_mul(&y.pose_in(there));
            depth(x, &relative, y).is_some_and(|depth| depth >= by + DEPTH_MARGIN)
        };
        a.core.is_solid && b.core.is_solid || a.bare.iter().any(|x| b.bare.iter().any(|y| is_deep(x, y)))
    }
}

/// Returns a lower bound, m, of the depth by which two convex solids overlap; None if they do not overlap.
/// `relative` is the pose of `b` in the frame of `a`.
fn depth(a: &CollisionBody, relative: &parry3d::math::Pose, b: &CollisionBody) -> Option<f64> {
    let ((a, by), (b, other)) = (core(a), core(b));
    let round = by + other;
    let contact = DefaultQueryDispatcher.contact(relative, a, b, round).ok()??;
    Some(round - contact.dist)
}
