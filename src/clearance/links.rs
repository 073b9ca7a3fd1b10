//! What the robot moves, ready for parry: links, tool and held parts.

use super::bodies::{Body, body, link_bodies, parry_pose, touching};
use super::decomposition::{Remember, hulls};
use super::hit::SolidRef;
use crate::cell::{Cell, Shape, Solid, extent};
use crate::pose::Pose;
use nalgebra::Vector3;

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
    /// A ball in the frame that holds the bare solid, m.
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
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
        let mut bodies = link_bodies(&solid.shape, &parts, by);
        bodies.iter_mut().for_each(|b| b.local = *mount * b.local);
        bodies
    };
    let shell = match &solid.shape {
        Shape::Mesh { closed: true, .. } if parts.len() > 1 => {
            let mesh = body(&solid.shape);
            Some(Body { local: *mount * mesh.local, ..mesh })
        }
        _ => None,
    };
    let (low, high) = extent(&solid.shape);
    let bare = bodies(TOUCHING);
    let slack = bare.iter().map(|b| b.unswollen.as_ref().map_or(TOUCHING, |(_, by)| *by));
    Link {
        id,
        frame,
        operation: None,
        spared: None,
        bodies: bodies(clearance + TOUCHING),
        shell,
        centre: mount.transform(&((low + high) / 2.0)),
        radius: (high - low).norm() / 2.0 + slack.fold(TOUCHING, f64::max),
        bare,
    }
}

impl Link {
    /// Whether the robot has it during an operation (None: with empty hands).
    pub(super) fn is_there(&self, operation: Option<usize>) -> bool {
        self.operation.is_none() || self.operation == operation
    }

    /// Whether two links (in the poses of their frames) touch, the clearance aside.
    pub(super) fn touches(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        let apart = frame.transform(&self.centre) - other_frame.transform(&other.centre);
        if apart.norm_squared() > (self.radius + other.radius).powi(2) {
            return false;
        }
        let posed = |b: &Body, frame: &Pose| parry_pose(&(*frame * b.local));
        let reached = |b: &Body| {
            let there = posed(b, other_frame);
            self.bare.iter().any(|a| touching(a, &posed(a, frame).inv_mul(&there), b))
        };
        other.bare.iter().any(reached)
            || self.swallows(frame, other, other_frame)
            || other.swallows(other_frame, self, frame)
    }

    /// Whether a point of the other link lies in the closed mesh of this one.
    fn swallows(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        let Some(shell) = &self.shell else { return false };
        let inside = |b: &Body| {
            let point = parry_pose(&(*other_frame * b.local)) * b.inside;
            shell.holds(&(parry_pose(&(*frame * shell.local)).inverse() * point))
        };
        other.bare.iter().any(inside)
    }
}
