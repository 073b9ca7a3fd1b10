//! Solids of the robot: base, links, tool and held parts.

use super::bodies::{CollisionBody, body, link_bodies, touching};
use super::bounding_capsule::{BoundingBox, BoundingCapsule, segments_apart_squared};
use super::contact::SolidRef;
use super::convex_decomposition::{Remember, hulls};
use crate::cell::{Cell, MAX_JOINTS, Shape, Solid};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::BoundingVolume;

/// Distance, m, below which two solids count as touching.
///
/// This distance exceeds the rounding errors of the coordinates. The iterative queries of parry3d have larger
/// errors. The constant `CONTACT_MARGIN` exceeds these errors.
const TOUCHING: f64 = 1e-7;

/// One solid that a frame of the robot carries.
pub(super) struct RobotSolid {
    pub(super) id: SolidRef,
    /// Index of the frame that carries the solid: 0 is the robot base, and k is the frame after row k of the
    /// chain.
    pub(super) frame: usize,
    /// Index of the operation during which the robot holds the solid; None if the robot always carries it.
    pub(super) operation: Option<usize>,
    /// Index of the equipment that the held part may touch, if any.
    pub(super) may_touch: Option<usize>,
    /// Solid enlarged by the clearance plus [`TOUCHING`]: one body, or the convex parts of a mesh.
    pub(super) bodies: Vec<CollisionBody>,
    /// Solid enlarged by [`TOUCHING`] alone, for distances and for checks of the robot against itself.
    pub(super) bare: Vec<CollisionBody>,
    /// Closed mesh of a solid with several convex parts; None for other solids. The mesh serves to test
    /// whether another solid lies wholly inside it.
    pub(super) shell: Option<CollisionBody>,
    /// Bounding capsule of the solid without the clearance, in the carrier frame.
    pub(super) core: BoundingCapsule,
    /// The solid as a box enlarged by [`TOUCHING`], and the pose of the box in the carrier frame; None for
    /// other shapes.
    pub(super) cuboid: Option<(Pose, BoundingBox)>,
    /// Two points on the axis of a solid of revolution, in the carrier frame; both are the centre of a
    /// sphere. The field is None for other shapes.
    pub(super) axis: Option<[Vector3<f64>; 2]>,
    /// Radius (m) with which the capsule `core` contains all `bodies`; infinite if no such radius is known.
    reach: f64,
}

/// Returns all solids in [`crate::cell::Robot::solids`], then the solids of the part held in each operation,
/// then the pedestal.
pub(super) fn all(cell: &Cell, remember: &mut Remember<'_>) -> Vec<RobotSolid> {
    let mut links = Vec::new();
    for (k, s) in cell.robot.solids.iter().enumerate() {
        let carrier =
            CarriedSolid { id: SolidRef::Robot(k), frame: s.link, mount: &Pose::IDENTITY, solid: &s.solid };
        links.push(link(&carrier, cell.clearance, remember));
    }
    for (operation, o) in cell.operations.iter().enumerate() {
        for (k, solid) in o.held.solids.iter().enumerate() {
            let (id, frame) = (SolidRef::HeldPart(operation, k), cell.robot.axes());
            let carrier = CarriedSolid { id, frame, mount: &cell.robot.tool, solid };
            let carried = link(&carrier, cell.clearance, remember);
            let may_touch = o.held.touches_surface.then_some(o.equipment);
            links.push(RobotSolid { operation: Some(operation), may_touch, ..carried });
        }
    }
    links.extend(pedestal(cell, remember));
    links
}

/// Returns the pedestal for the highest base position that the cell allows; None if no pedestal is needed.
///
/// This pedestal also serves every lower base position. The lower end is then below the floor, where nothing
/// collides. The arm must keep the clearance from the sides of the pedestal. The floor plan checks the
/// pedestal against equipment.
fn pedestal(cell: &Cell, remember: &mut Remember<'_>) -> Option<RobotSolid> {
    let (section, height) = cell.highest_pedestal()?;
    let (centre, size) = (section.centre, section.size);
    let pose = Pose { translation: Vector3::new(centre.0, centre.1, -height / 2.0), ..Pose::IDENTITY };
    let wider = 2.0 * cell.clearance;
    let size = Vector3::new(size.0 + wider, size.1 + wider, height);
    let solid = Solid { name: String::new(), shape: Shape::Box { pose, size } };
    let carrier = CarriedSolid { id: SolidRef::Pedestal, frame: 0, mount: &Pose::IDENTITY, solid: &solid };
    Some(link(&carrier, cell.clearance, remember))
}

/// Solid of the cell, and the frame that carries it.
struct CarriedSolid<'a> {
    id: SolidRef,
    frame: usize,
    /// Pose, in the carrier frame, of the frame in which the file gives the solid.
    mount: &'a Pose,
    solid: &'a Solid,
}

/// Prepares one solid of the robot for collision checking.
fn link(carried: &CarriedSolid<'_>, clearance: f64, remember: &mut Remember<'_>) -> RobotSolid {
    let CarriedSolid { id, frame, mount, solid } = *carried;
    let parts = match &solid.shape {
        Shape::Mesh { vertices, triangles, .. } => hulls(vertices, triangles, remember),
        _ => Vec::new(),
    };
    let bodies = |by: f64| {
        let bodies = link_bodies(&solid.shape, &parts, by).into_iter();
        bodies.map(|b| b.mounted(mount)).collect::<Vec<_>>()
    };
    let shell = match &solid.shape {
        Shape::Mesh { closed: true, .. } if parts.len() > 1 => Some(body(&solid.shape).mounted(mount)),
        _ => None,
    };
    let bare = bodies(TOUCHING);
    let slack = bare.iter().map(|b| b.unswollen.as_ref().map_or(TOUCHING, |(_, by)| *by));
    let core = BoundingCapsule::new(&solid.shape, mount, slack.fold(TOUCHING, f64::max));
    // A part without a hull becomes a ball, which the capsule does not necessarily contain.
    let is_held = core.is_solid || bare.iter().all(|b| b.shape.as_ball().is_none());
    RobotSolid {
        id,
        frame,
        operation: None,
        may_touch: None,
        bodies: bodies(clearance + TOUCHING),
        shell,
        cuboid: match &solid.shape {
            Shape::Box { pose, size } => {
                let half = (size / 2.0).add_scalar(TOUCHING);
                Some((*mount * *pose, BoundingBox { centre: Vector3::zeros(), half, is_solid: true }))
            }
            _ => None,
        },
        axis: match &solid.shape {
            Shape::Sphere { centre, .. } => Some([mount.transform(centre); 2]),
            Shape::Capsule { a, b, .. } | Shape::Cylinder { a, b, .. } => {
                Some([a, b].map(|end| mount.transform(end)))
            }
            _ => None,
        },
        reach: if is_held { core.radius + clearance } else { f64::INFINITY },
        core,
        bare,
    }
}

impl RobotSolid {
    /// Returns whether this is the pedestal of the robot base.
    pub(super) fn is_pedestal(&self) -> bool {
        self.id == SolidRef::Pedestal
    }

    /// Returns the pose, in the robot base frame, of the frame that carries the solid.
    ///
    /// A solid of the base is carried by the base frame, so the returned pose is the identity. Frame 0 of the
    /// chain may differ from the base frame.
    pub(super) fn carrier<'f>(&self, frames: &'f [Pose; MAX_JOINTS + 1]) -> &'f Pose {
        if self.frame == 0 { &Pose::IDENTITY } else { &frames[self.frame] }
    }

    /// Returns whether the robot carries the solid during an operation; the robot holds nothing if
    /// `operation` is None.
    pub(super) fn is_there(&self, operation: Option<usize>) -> bool {
        self.operation.is_none() || self.operation == operation
    }

    /// Returns a capsule that contains all bodies of the solid; `pose` is the pose of the carrier frame.
    pub(super) fn capsule(&self, pose: &Pose) -> BoundingCapsule {
        BoundingCapsule { radius: self.reach, ..self.core.at(pose) }
    }

    /// Returns a capsule that contains the solid without the clearance; `pose` is the pose of the carrier
    /// frame.
    pub(super) fn bare_capsule(&self, pose: &Pose) -> BoundingCapsule {
        let radius = if self.reach.is_finite() { self.core.radius } else { f64::INFINITY };
        BoundingCapsule { radius, ..self.core.at(pose) }
    }

    /// Returns the height (m) of the lowest point of all bodies of the solid. The bodies are enlarged by the
    /// clearance plus [`TOUCHING`].
    ///
    /// `pose` is the pose of the carrier frame in the world, and `capsule` is [`Self::capsule`] at that pose.
    pub(super) fn lowest(&self, capsule: &BoundingCapsule, pose: &Pose) -> f64 {
        if self.core.is_solid {
            return capsule.bounds().0.z;
        }
        let low = |b: &CollisionBody| b.shape.compute_aabb(&b.pose_in(pose)).mins.z;
        self.bodies.iter().map(low).fold(f64::INFINITY, f64::min)
    }

    /// Returns whether two solids of the robot touch; no clearance is required between them.
    ///
    /// `frame` and `other_frame` are the poses of the frames that carry the two solids.
    pub(super) fn touches(&self, frame: &Pose, other: &RobotSolid, other_frame: &Pose) -> bool {
        self.is_near(&self.capsule(frame), other, &other.capsule(other_frame))
            && self.touches_near(frame, other, other_frame)
    }

    /// Returns whether the bounding capsules of two robot solids, without the clearance, share a point
    /// (broad phase).
    pub(super) fn is_near(
        &self,
        capsule: &BoundingCapsule,
        other: &RobotSolid,
        other_capsule: &BoundingCapsule,
    ) -> bool {
        let room = self.core.radius + other.core.radius;
        segments_apart_squared(&capsule.a, &capsule.b, &other_capsule.a, &other_capsule.b) <= room * room
    }

    /// Returns whether two robot solids touch, given that their bounding capsules intersect (narrow phase).
    pub(super) fn touches_near(&self, frame: &Pose, other: &RobotSolid, other_frame: &Pose) -> bool {
        if self.core.is_solid && other.core.is_solid {
            return true;
        }
        let reached = |b: &CollisionBody| {
            let there = b.pose_in(other_frame);
            self.bare.iter().any(|a| {
                let relative = a.pose_in(frame).inv_mul(&there);
                b.bounds_in(&relative).intersects(&a.bounds) && touching(a, &relative, b)
            })
        };
        other.bare.iter().any(reached)
            || self.swallows(frame, other, other_frame)
            || other.swallows(other_frame, self, frame)
    }

    /// Returns whether the closed mesh of this solid contains the point [`CollisionBody::inside`] of any body
    /// of `other`.
    pub(super) fn swallows(&self, frame: &Pose, other: &RobotSolid, other_frame: &Pose) -> bool {
        let Some(shell) = &self.shell else { return false };
        let inside = |b: &CollisionBody| {
            let point = b.pose_in(other_frame) * b.inside;
            shell.holds(&(shell.pose_in(frame).inverse() * point))
        };
        other.bare.iter().any(inside)
    }
}
