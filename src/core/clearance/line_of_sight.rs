//! Line of sight between two points: the first solid that hides one from the other.

use super::bodies::{CollisionBody, EquipmentSolid, parry_pose, vector};
use super::contact::SolidRef;
use super::placed_solids::{LinkFrames, LinkPoses, PlacedSolid, PlacedSolids};
use super::scene::Scene;
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::query::Ray;
use parry3d::shape::{Cuboid, Shape};

impl Scene {
    /// Returns the solid that contains a point (world frame, m). Only solids of equipment, fence and robot
    /// base are checked. Returns None if none of these solids contains the point.
    ///
    /// For a point below the floor, the result is the floor.
    pub fn solid_at(&self, placed: &PlacedSolids, point: &Vector3<f64>) -> Option<SolidRef> {
        if !self.enabled {
            return None;
        }
        if point.z < self.floor {
            return Some(SolidRef::Floor);
        }
        let base = placed.in_world(&Pose::IDENTITY);
        let mut of_base = self.links.iter().filter(|link| link.frame == 0);
        let holds = |body: &CollisionBody| holds(plain(body), &body.pose_in(&base), point);
        of_base.find(|link| link.bare.iter().any(holds)).map(|link| link.id).or_else(|| {
            let mut bodies = placed.bodies.iter().filter(|body| !self.is_keep_out(body));
            bodies.find(|body| self.holds_point(body, point)).map(|body| self.name(body.id))
        })
    }

    /// Returns a solid that hides a reflector on the tool from an instrument. Returns None if the
    /// reflector is visible.
    ///
    /// Both points are in the world frame, m. `frames` are the link frames in the robot base frame; the robot
    /// holds no part. A solid of the flange or the tool that contains the reflector is ignored, because it
    /// carries the reflector.
    pub fn hides(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        reflector: &Vector3<f64>,
        instrument: &Vector3<f64>,
    ) -> Option<SolidRef> {
        if !self.enabled {
            return None;
        }
        if instrument.z.min(reflector.z) < self.floor {
            return Some(SolidRef::Floor);
        }
        let poses = LinkPoses { frames, base: placed.base.as_ref() };
        let mut links = self.links.iter().filter(|link| link.is_there(None)).filter_map(|link| {
            let carrier = poses.carrier(link);
            let carries = |body: &&CollisionBody| {
                link.frame == self.last && holds(plain(body), &body.pose_in(&carrier), reflector)
            };
            let mut others = link.bare.iter().filter(|body| !carries(body));
            let blocks =
                |body: &CollisionBody| crosses(plain(body), &body.pose_in(&carrier), reflector, instrument);
            others.any(blocks).then_some(link.id)
        });
        links.next().or_else(|| {
            let mut bodies = placed.bodies.iter().filter(|body| !self.is_keep_out(body));
            bodies.find(|body| self.blocks(body, reflector, instrument)).map(|body| self.name(body.id))
        })
    }

    fn holds_point(&self, body: &PlacedSolid, point: &Vector3<f64>) -> bool {
        let pose = parry_pose(&body.pose);
        match &self.equipment[body.id.0].parts[body.id.1] {
            EquipmentSolid::Convex(solid) => holds(&*solid.shape, &pose, point),
            EquipmentSolid::Mesh { body, closed } => *closed && holds(&*body.shape, &pose, point),
            EquipmentSolid::Leg { .. } => holds(&Cuboid::new(vector(&body.bounds.half)), &pose, point),
        }
    }

    fn blocks(&self, body: &PlacedSolid, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
        let pose = parry_pose(&body.pose);
        match &self.equipment[body.id.0].parts[body.id.1] {
            EquipmentSolid::Convex(solid) | EquipmentSolid::Mesh { body: solid, .. } => {
                crosses(&*solid.shape, &pose, from, to)
            }
            EquipmentSolid::Leg { .. } => crosses(&Cuboid::new(vector(&body.bounds.half)), &pose, from, to),
        }
    }
}

/// Returns the shape of a body without the rounding that enlarges it.
fn plain(body: &CollisionBody) -> &dyn Shape {
    body.unswollen.as_ref().map_or(&*body.shape, |(shape, _)| &**shape)
}

fn holds(shape: &dyn Shape, pose: &parry3d::math::Pose, point: &Vector3<f64>) -> bool {
    shape.contains_point(pose, vector(point))
}

/// Returns whether the line segment from one point to another shares a point with a shape.
fn crosses(shape: &dyn Shape, pose: &parry3d::math::Pose, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
    shape.intersects_ray(pose, &Ray::new(vector(from), vector(&(to - from))), 1.0)
}
