//! What the robot moves, ready for parry: links, tool and held parts.

use super::bodies::{Body, body, link_bodies, touching};
use super::decomposition::{Remember, hulls};
use super::hit::SolidRef;
use crate::cell::{Cell, MAX_JOINTS, Shape, Solid, extent};
use crate::pose::Pose;
use nalgebra::Vector3;
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
    /// A capsule in the frame that holds the bare solid.
    core: Core,
}

/// All within `radius` of the segment from `a` to `b`, m.
struct Core {
    a: Vector3<f64>,
    b: Vector3<f64>,
    radius: f64,
    /// Whether it is the solid and not only holds it.
    is_solid: bool,
}

impl Core {
    /// The core of a shape, with what its bodies are swollen by.
    fn new(shape: &Shape, mount: &Pose, slack: f64) -> Self {
        let new = |a: &Vector3<f64>, b: &Vector3<f64>, radius: f64, is_solid| {
            let (a, b) = (mount.transform(a), mount.transform(b));
            Self { a, b, radius: radius + slack, is_solid }
        };
        match shape {
            Shape::Sphere { centre, radius } => new(centre, centre, *radius, true),
            Shape::Capsule { a, b, radius } => new(a, b, *radius, true),
            other => {
                // Along the longest side of the bounds, as thick as their diagonal across it.
                let (low, high) = extent(other);
                let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
                let mut along = Vector3::zeros();
                along[half.imax()] = half.max();
                new(&(middle - along), &(middle + along), (half - along).norm(), false)
            }
        }
    }

    /// Whether two cores (in the poses of their frames) share a point.
    fn meets(&self, frame: &Pose, other: &Self, other_frame: &Pose) -> bool {
        let (a, b) = (frame.transform(&self.a), frame.transform(&self.b));
        let (c, d) = (other_frame.transform(&other.a), other_frame.transform(&other.b));
        segments_apart_squared(&a, &b, &c, &d) <= (self.radius + other.radius).powi(2)
    }
}

/// Squared distance of the segments ab and cd, m2: the nearest points of their lines, held to the
/// segments in turn (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
fn segments_apart_squared(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv, uw, vw) = (u.dot(&u), v.dot(&v), u.dot(&v), u.dot(&w), v.dot(&w));
    let held = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    let s = held(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = held(uv * s + vw, vv);
    // With t held at an end, the nearest s changes.
    let s = held(uv * t - uw, uu);
    (w + u * s - v * t).norm_squared()
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
    Link {
        id,
        frame,
        operation: None,
        spared: None,
        bodies: bodies(clearance + TOUCHING),
        shell,
        core: Core::new(&solid.shape, mount, slack.fold(TOUCHING, f64::max)),
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

    /// Whether two links (in the poses of their frames) touch, the clearance aside.
    pub(super) fn touches(&self, frame: &Pose, other: &Link, other_frame: &Pose) -> bool {
        if !self.core.meets(frame, &other.core, other_frame) {
            return false;
        }
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
