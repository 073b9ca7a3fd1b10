//! What the robot moves, ready for parry: links, tool and held parts.

use super::bodies::{Body, body, link_bodies, touching};
use super::decomposition::{Remember, hulls};
use super::hit::SolidRef;
use super::rod::{Rod, segments_apart_squared};
use crate::cell::{Cell, MAX_JOINTS, Shape, Solid};
use crate::pose::Pose;
use parry3d::bounding_volume::BoundingVolume;

/// Solids nearer than this touch, m: more than parry's rounding, so that every contact is one.
const TOUCHING: f64 = 1e-7;

/// One solid that moves with a frame of the robot.
pub(super) struct Link {
    pub(super) id: SolidRef,
    /// 0: the base, k: the frame after row k.
    pub(super) frame: usize,
    /// The operation that alone holds it.
    pub(super) operation: Option<usize>,
    /// The equipment that it may touch.
    pub(super) spared: Option<usize>,
    /// Together the solid, swollen by the clearance: one, or the convex parts of a mesh.
    pub(super) bodies: Vec<Body>,
    /// The same, not swollen but by rounding: the clearance is kept from others.
    pub(super) bare: Vec<Body>,
    /// A closed mesh of several parts, to tell what lies wholly inside.
    pub(super) shell: Option<Body>,
    /// In the frame, holds the bare solid.
    pub(super) core: Rod,
    /// With this radius (m) the core holds every body.
    reach: f64,
}

/// Links and tool as the robot has them, then what each operation holds.
pub(super) fn all(cell: &Cell, remember: &mut Remember<'_>) -> Vec<Link> {
    let mut links = Vec::new();
    for (k, s) in cell.robot.solids.iter().enumerate() {
        links.push(link(SolidRef::Robot(k), s.link, &Pose::identity(), &s.solid, cell.clearance, remember));
    }
    for (operation, o) in cell.operations.iter().enumerate() {
        for (k, solid) in o.held.solids.iter().enumerate() {
            let id = SolidRef::Held(operation, k);
            let carried = link(id, cell.robot.axes(), &cell.robot.tool, solid, cell.clearance, remember);
            let spared = o.held.touches_surface.then_some(o.equipment);
            links.push(Link { operation: Some(operation), spared, ..carried });
        }
    }
    links
}

/// `mount`: the frame of the solid's file in the frame of the robot.
fn link(
    id: SolidRef,
    frame: usize,
    mount: &Pose,
    solid: &Solid,
    clearance: f64,
    remember: &mut Remember<'_>,
) -> Link {
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
    let core = Rod::new(&solid.shape, mount, slack.fold(TOUCHING, f64::max));
    // Points of which parry makes no hull become a ball wherever it lies.
    let is_held = core.is_solid || bare.iter().all(|b| b.shape.as_ball().is_none());
    Link {
        id,
        frame,
        operation: None,
        spared: None,
        bodies: bodies(clearance + TOUCHING),
        shell,
        reach: if is_held { core.radius + clearance } else { f64::INFINITY },
        core,
        bare,
    }
}

impl Link {
    /// The frame that the solid moves with, in the robot base; frame 0 of the chain may stand elsewhere
    /// on it.
    pub(super) fn carrier<'f>(&self, frames: &'f [Pose; MAX_JOINTS + 1]) -> &'f Pose {
        if self.frame == 0 { &Pose::IDENTITY } else { &frames[self.frame] }
    }

    /// Whether the robot has it during an operation (None: with empty hands).
    pub(super) fn is_there(&self, operation: Option<usize>) -> bool {
        self.operation.is_none() || self.operation == operation
    }

    /// What holds every body, with the frame at `pose`.
    pub(super) fn rod(&self, pose: &Pose) -> Rod {
        Rod { radius: self.reach, ..self.core.at(pose) }
    }

    /// Height of its lowest point (m), swollen, with the frame at `pose`.
    pub(super) fn lowest(&self, rod: &Rod, pose: &Pose) -> f64 {
        if self.core.is_solid {
            return rod.bounds().0.z;
        }
        let low = |b: &Body| b.shape.compute_aabb(&b.pose_in(pose)).mins.z;
        self.bodies.iter().map(low).fold(f64::INFINITY, f64::min)
    }

    /// Whether two links (in the poses of their frames) touch, the clearance aside.
    pub(super) fn touches(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        self.is_near(&self.rod(frame), other, &other.rod(other_frame))
            && self.touches_near(frame, other, other_frame)
    }

    /// Whether the cores of two links (with the rods posed) share a point.
    pub(super) fn is_near(&self, rod: &Rod, other: &Link, other_rod: &Rod) -> bool {
        let room = self.core.radius + other.core.radius;
        segments_apart_squared(&rod.a, &rod.b, &other_rod.a, &other_rod.b) <= room * room
    }

    /// Whether two links that are near touch.
    pub(super) fn touches_near(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        if self.core.is_solid && other.core.is_solid {
            return true;
        }
        let reached = |b: &Body| {
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

    /// Whether a point of the other link lies in the closed mesh of this one.
    pub(super) fn swallows(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        let Some(shell) = &self.shell else { return false };
        let inside = |b: &Body| {
            let point = b.pose_in(other_frame) * b.inside;
            shell.holds(&(shell.pose_in(frame).inverse() * point))
        };
        other.bare.iter().any(inside)
    }
}
