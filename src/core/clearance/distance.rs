//! Distance queries: the distance of the robot from the solids that it must not touch.
//!
//! For rounded shapes, the distances computed by parry3d are wrong by up to 1.2e-5 m. So distances are
//! measured between the solids without rounding. A capsule is replaced by its segment. The radii are then
//! subtracted.
//!
//! parry3d gives the nearest points of two solids. An empty slab lies between two convex solids. The faces of
//! the slab are perpendicular to the line through the nearest points. The returned distance is the width of
//! this slab, which never exceeds the true distance. For a mesh, the returned distance is the distance
//! between the nearest points.

use super::bodies::{CollisionBody, EquipmentSolid, parry_pose, vector};
use super::bounding_capsule::BoundingCapsule;
use super::contact::Hit;
use super::pairs::{Against, Load, Pair};
use super::placed_solids::{LinkFrames, PlacedSolid, PlacedSolids};
use super::robot_solids::RobotSolid;
use super::scene::{Scene, swallows};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math as pm;
use parry3d::query::{ClosestPoints, DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::{Cuboid, Shape, SharedShape};

/// Largest amount, m, by which a computed distance may exceed the true distance.
pub const ACCURACY: f64 = 1e-6;

/// Required distance, m, above which a mesh is checked by its bounding box instead of its triangles.
///
/// A required distance is the sum of the clearance, the displacement of the robot solid and [`ACCURACY`].
const BOUNDS_ONLY_DISTANCE: f64 = 0.1;

/// Result of a distance query: the least distance, and the two solids at this distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearness {
    /// Least distance, m: 0 at contact, and at most the argument `max` of the query.
    pub distance: f64,
    /// The two nearest solids; None if no pair is nearer than the argument `max` of the query.
    pub pair: Option<Hit>,
}

/// Bounds of a robot solid without the clearance, in the world: bounding capsule and axis-aligned bounding
/// box.
///
/// The bounds are kept from pair to pair, because successive pairs often have a solid of the robot in common.
#[derive(Default)]
pub struct LinkBounds {
    /// Index of the robot solid; None before the first pair.
    link: Option<usize>,
    capsule: BoundingCapsule,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl LinkBounds {
    /// Computes the bounds of another robot solid, unless they are already here.
    fn update(&mut self, scene: &Scene, placed: &PlacedSolids, frames: &LinkFrames, link: usize) {
        if self.link != Some(link) {
            let solid = &scene.links[link];
            let capsule = solid.bare_capsule(&placed.in_world(solid.carrier(frames)));
            let (low, high) = capsule.bounds();
            *self = Self { link: Some(link), capsule, low, high };
        }
    }

    /// Returns whether the bounding boxes show that a placed solid is at least `distance` (m) away.
    fn is_beyond(&self, other: &PlacedSolid, distance: f64) -> bool {
        (0..3).any(|i| self.low[i] - other.high[i] >= distance || other.low[i] - self.high[i] >= distance)
    }
}

impl Scene {
    /// Returns the least distance of the robot from equipment, floor and fence. If this distance exceeds
    /// `max` (m), the result is `max`.
    ///
    /// `frames` are the link frames in the robot base frame, and `operation` selects the held parts. The
    /// solids are not enlarged by the clearance. The robot is not checked against itself. The program itself
    /// calls [`Self::distance_at_work`]; this function is for users of the library.
    pub fn distance(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: Option<usize>,
        max: f64,
    ) -> Nearness {
        self.nearest(placed, frames, self.outer_pairs(placed, Load::of(operation)), max)
    }

    /// Returns the least distance of the robot from its surroundings during an operation. If this distance
    /// exceeds `max` (m), the result is `max`.
    ///
    /// Two kinds of pairs are left out, because their distance gives no information about the layout:
    ///
    /// - a solid after the last joint and the equipment of the operation: the standoff sets the distance;
    /// - the floor and a solid that only the first joint moves.
    pub fn distance_at_work(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: usize,
        equipment: usize,
        max: f64,
    ) -> Nearness {
        let is_usual = |pair: &Pair| match pair.against {
            Against::Floor => self.links[pair.link].frame <= 1,
            Against::Placed(k) => {
                self.links[pair.link].frame == self.last && placed.bodies[k].id.0 == equipment
            }
            Against::Own(_) => false,
        };
        let pairs = self.outer_pairs(placed, Load::of(Some(operation))).filter(|p| !is_usual(p));
        self.nearest(placed, frames, pairs, max)
    }

    fn nearest(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        pairs: impl Iterator<Item = Pair>,
        max: f64,
    ) -> Nearness {
        let mut nearest = Nearness { distance: max, pair: None };
        if !self.enabled {
            return nearest;
        }
        for pair in pairs {
            let distance = self.gap(placed, frames, pair, nearest.distance);
            if distance < nearest.distance {
                nearest = Nearness { distance, pair: Some(self.hit_of(placed, pair)) };
            }
        }
        nearest
    }

    /// Returns whether a pair certainly keeps its clearance while the first solid moves.
    ///
    /// Every point of the first solid may move by at most `by` (m).
    ///
    /// Two solids of the robot must not touch, but need no clearance. `memory` belongs to one posture of one
    /// layout.
    pub fn is_apart(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        memory: &mut LinkBounds,
        pair: Pair,
        by: f64,
    ) -> bool {
        let clearance = if pair.partner().is_some() { 0.0 } else { self.clearance };
        let wanted = clearance + by + ACCURACY;
        memory.update(self, placed, frames, pair.link);
        if let Against::Placed(k) = pair.against
            && memory.is_beyond(&placed.bodies[k], wanted)
        {
            return true;
        }
        let (bound, is_exact) = self.capsule_gap(placed, frames, memory, pair);
        if bound >= wanted || is_exact {
            return bound >= wanted;
        }
        if let Against::Placed(k) = pair.against
            && wanted > BOUNDS_ONLY_DISTANCE
            && self.is_mesh(&placed.bodies[k])
        {
            let (link, other) = (&self.links[pair.link], &placed.bodies[k]);
            let (frame, pose) = (placed.in_world(link.carrier(frames)), parry_pose(&other.pose));
            let is_near =
                |b: &CollisionBody| near(b, &pose.inv_mul(&b.pose_in(&frame)), &bounds_of(other), wanted);
            return !link.bare.iter().any(is_near);
        }
        self.gap(placed, frames, pair, wanted) >= wanted
    }

    /// Returns a lower bound of the distance between the solids of a pair, m, and whether the bound equals
    /// the distance. `bounds` are those of the first solid.
    ///
    /// Closed forms give the distance of the bounding capsules from boxes, from each other and from the
    /// floor. The closed forms cost far less than [`Self::gap`].
    fn capsule_gap(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        bounds: &LinkBounds,
        pair: Pair,
    ) -> (f64, bool) {
        let link = &self.links[pair.link];
        match pair.against {
            Against::Floor => (bounds.low.z - self.floor, link.core.is_solid),
            Against::Placed(k) => {
                let other = &placed.bodies[k];
                let gap = bounds.capsule.seen_from(&other.pose).gap_to_box(&other.bounds);
                (gap, link.core.is_solid && other.bounds.is_solid)
            }
            Against::Own(other) => {
                let other = &self.links[other];
                let (capsule, there) = (link.bare_capsule(link.carrier(frames)), other.carrier(frames));
                match &other.cuboid {
                    Some((pose, cuboid)) => {
                        let gap = capsule.seen_from(&(*there * *pose)).gap_to_box(cuboid);
                        (gap, link.core.is_solid)
                    }
                    None => {
                        let gap = capsule.gap_to(&other.bare_capsule(there));
                        (gap, link.core.is_solid && other.core.is_solid)
                    }
                }
            }
        }
    }

    fn is_mesh(&self, body: &PlacedSolid) -> bool {
        matches!(self.equipment[body.id.0].parts[body.id.1], EquipmentSolid::Mesh { .. })
    }

    /// Returns the distance between the solids of a pair. If this distance exceeds `max` (m), the result is
    /// `max`.
    fn gap(&self, placed: &PlacedSolids, frames: &LinkFrames, pair: Pair, max: f64) -> f64 {
        let link = &self.links[pair.link];
        match pair.against {
            Against::Floor => {
                let frame = placed.in_world(&frames[link.frame]);
                let low = |b: &CollisionBody| b.shape.compute_aabb(&b.pose_in(&frame)).mins.z;
                let low = link.bare.iter().map(low).fold(f64::INFINITY, f64::min);
                (low - self.floor).clamp(0.0, max)
            }
            Against::Placed(k) => {
                let carrier = link.carrier(frames);
                self.gap_to_placed(link, &placed.in_world(carrier), &placed.bodies[k], max)
            }
            Against::Own(other) => gap_of_links(link, &self.links[other], frames, max),
        }
    }

    fn gap_to_placed(&self, link: &RobotSolid, frame: &Pose, other: &PlacedSolid, max: f64) -> f64 {
        let (part, pose) = (&self.equipment[other.id.0].parts[other.id.1], parry_pose(&other.pose));
        if swallows(link, frame, part, &pose) {
            return 0.0;
        }
        let mut gap = max;
        for body in &link.bare {
            let relative = pose.inv_mul(&body.pose_in(frame));
            if !near(body, &relative, &bounds_of(other), gap) {
                continue;
            }
            match part {
                EquipmentSolid::Leg { .. } => {
                    let leg = Cuboid::new(vector(&other.bounds.half));
                    gap = gap_of_cores((&leg, 0.0), &relative, core(body), gap);
                }
                EquipmentSolid::Convex(solid) => gap = gap_of_cores(core(solid), &relative, core(body), gap),
                EquipmentSolid::Mesh { body: mesh, closed } => {
                    if *closed && mesh.holds(&(relative * body.inside)) {
                        return 0.0;
                    }
                    gap = gap_to_mesh(&*mesh.shape, &relative, body, gap);
                }
            }
        }
        gap
    }
}

/// Returns the bounding box of a placed solid in its own frame.
fn bounds_of(body: &PlacedSolid) -> Aabb {
    Aabb::from_half_extents(vector(&body.bounds.centre), vector(&body.bounds.half))
}

/// Returns the distance between two solids of the robot. If this distance exceeds `max` (m), the result is
/// `max`.
fn gap_of_links(link: &RobotSolid, other: &RobotSolid, frames: &LinkFrames, max: f64) -> f64 {
    let (frame, there) = (link.carrier(frames), other.carrier(frames));
    if link.swallows(frame, other, there) || other.swallows(there, link, frame) {
        return 0.0;
    }
    let mut gap = max;
    for b in &link.bare {
        let pose = b.pose_in(frame);
        for a in &other.bare {
            let relative = a.pose_in(there).inv_mul(&pose);
            if near(b, &relative, &a.bounds, gap) {
                gap = gap_of_cores(core(a), &relative, core(b), gap);
            }
        }
    }
    gap
}

/// Returns whether the bounding box of a body is within the distance `by` (m) of the box `bounds`.
///
/// `relative` is the pose of the body in the frame of `bounds`.
fn near(body: &CollisionBody, relative: &pm::Pose, bounds: &Aabb, by: f64) -> bool {
    body.bounds_in(relative).loosened(by).intersects(bounds)
}

/// Shape before its rounding, and the radius (m) of the rounding.
type Core<'b> = (&'b dyn Shape, f64);

pub(super) fn core(body: &CollisionBody) -> Core<'_> {
    match (&body.unswollen, body.shape.as_capsule()) {
        (Some((shape, by)), _) => (&**shape, *by),
        (None, Some(capsule)) => (&capsule.segment, capsule.radius),
        (None, None) => (&*body.shape, 0.0),
    }
}

fn gap_to_mesh(mesh: &dyn Shape, relative: &pm::Pose, body: &CollisionBody, max: f64) -> f64 {
    let piece = |shape: &SharedShape, max: f64| match shape.as_capsule() {
        Some(capsule) => gap_of_cores((mesh, 0.0), relative, (&capsule.segment, capsule.radius), max),
        None => gap_of_cores((mesh, 0.0), relative, core(body), max),
    };
    let whole = std::slice::from_ref(&body.shape);
    let pieces = if body.pieces.is_empty() { whole } else { &body.pieces };
    pieces.iter().fold(max, |gap, shape| piece(shape, gap))
}

/// Returns the distance between two solids. If this distance exceeds `max` (m), the result is `max`.
/// `relative` is the pose of `b` in the frame of `a`.
fn gap_of_cores((a, ra): Core<'_>, relative: &pm::Pose, (b, rb): Core<'_>, max: f64) -> f64 {
    let round = ra + rb;
    let found = DefaultQueryDispatcher.closest_points(relative, a, b, max + round);
    let core_gap = match found {
        Ok(ClosestPoints::Disjoint) => return max,
        Ok(ClosestPoints::WithinMargin(p, q)) => {
            let apart = relative * q - p;
            certified(a, relative, b, &apart).unwrap_or(apart.length())
        }
        // If parry3d has no answer, contact is the safe assumption.
        Ok(ClosestPoints::Intersecting) | Err(_) => 0.0,
    };
    (core_gap - round).clamp(0.0, max)
}

/// Returns the width of the empty slab between two convex solids, measured along a direction from `a` to `b`.
///
/// The planes of the slab are perpendicular to the direction. The width is a lower bound of the distance, and
/// negative if no such plane separates the solids. The result is None if a solid is a mesh, or if the
/// direction is 0.
fn certified(a: &dyn Shape, relative: &pm::Pose, b: &dyn Shape, direction: &pm::Vector) -> Option<f64> {
    let (a, b, n) = (a.as_support_map()?, b.as_support_map()?, direction.try_normalize()?);
    let far = a.local_support_point(n).dot(n);
    Some(b.support_point(relative, -n).dot(n) - far)
}
