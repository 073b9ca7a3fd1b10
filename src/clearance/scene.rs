//! Robot solids against equipment solids, in three dimensions.

use crate::cell::{Cell, Layout, MAX_JOINTS, Shape};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math as pm;
use parry3d::query::intersection_test;
use parry3d::shape::{self, SharedShape, TriMesh, TriMeshFlags};

/// What a robot solid touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hit {
    /// Index into [`crate::cell::Robot::solids`].
    pub solid: usize,
    /// Index into [`Cell::equipment`] and its solids; None for the floor.
    pub other: Option<(usize, usize)>,
}

/// A solid ready for parry: its shape, and its pose in the frame of its carrier.
struct Body {
    shape: SharedShape,
    local: Pose,
    /// A point inside the solid, for tests against closed meshes.
    inside: Vector3<f64>,
}

/// An equipment solid: fixed in shape, or a leg that is cut to length by the placement.
enum Part {
    Rigid { body: Body, closed_mesh: bool },
    Leg { x: f64, y: f64, half: (f64, f64), top: f64 },
}

/// The solids of a cell, made ready once. Robot solids are swollen by the clearance.
pub struct Scene {
    links: Vec<(usize, Body)>,
    parts: Vec<Vec<Part>>,
    base: Pose,
    floor: f64,
    enabled: bool,
}

/// The equipment solids of one layout; reused from layout to layout.
#[derive(Default)]
pub struct Placed {
    bodies: Vec<PlacedBody>,
    /// What the base itself touches, whatever the arm does.
    base_hit: Option<Hit>,
}

struct PlacedBody {
    id: (usize, usize),
    pose: pm::Pose,
    bounds: Aabb,
    /// A leg of this layout; None: the rigid shape of the scene.
    leg: Option<shape::Cuboid>,
}

impl Scene {
    pub fn new(cell: &Cell) -> Self {
        let link = |s: &crate::cell::LinkSolid| (s.link, swollen(&s.solid.shape, cell.clearance));
        let parts = |e: &crate::cell::Equipment| e.solids.iter().map(|s| part(&s.shape)).collect();
        Self {
            links: cell.robot.solids.iter().map(link).collect(),
            parts: cell.equipment.iter().map(parts).collect(),
            base: cell.base.pose(),
            floor: cell.floor,
            enabled: cell.collision,
        }
    }

    /// Poses the equipment of a layout.
    pub fn place(&self, layout: &Layout, placed: &mut Placed) {
        placed.bodies.clear();
        placed.base_hit = None;
        if !self.enabled {
            return;
        }
        for (e, (parts, at)) in self.parts.iter().zip(&layout.placements).enumerate() {
            let frame = at.pose();
            for (s, part) in parts.iter().enumerate() {
                placed.bodies.extend(self.placed_body((e, s), part, &frame));
            }
        }
        let fixed = self.links.iter().enumerate().filter(|(_, (link, _))| *link == 0);
        for (solid, (_, body)) in fixed {
            let pose = parry_pose(&(self.base * body.local));
            let hit = self.first_hit(solid, &pose, &body.shape.compute_aabb(&pose), placed);
            placed.base_hit = placed.base_hit.or(hit);
        }
    }

    fn placed_body(&self, id: (usize, usize), part: &Part, frame: &Pose) -> Option<PlacedBody> {
        match part {
            Part::Rigid { body, .. } => {
                let pose = parry_pose(&(*frame * body.local));
                Some(PlacedBody { id, pose, bounds: body.shape.compute_aabb(&pose), leg: None })
            }
            Part::Leg { x, y, half, top } => {
                let height = frame.translation.z + top - self.floor;
                if height <= 0.0 {
                    return None;
                }
                let centre = Vector3::new(*x, *y, top - height / 2.0);
                let pose = parry_pose(&Pose { translation: frame.transform(&centre), ..*frame });
                let leg = shape::Cuboid::new(pm::Vector::new(half.0, half.1, height / 2.0));
                Some(PlacedBody { id, pose, bounds: leg.aabb(&pose), leg: Some(leg) })
            }
        }
    }

    /// The first contact of the robot with its link frames (in the base) at `frames`, or None.
    pub fn hit(&self, placed: &Placed, frames: &[Pose; MAX_JOINTS + 1]) -> Option<Hit> {
        if !self.enabled {
            return None;
        }
        if placed.base_hit.is_some() {
            return placed.base_hit;
        }
        for (solid, (link, body)) in self.links.iter().enumerate().filter(|(_, (link, _))| *link > 0) {
            let pose = parry_pose(&(self.base * frames[*link] * body.local));
            let bounds = body.shape.compute_aabb(&pose);
            if bounds.mins.z <= self.floor {
                return Some(Hit { solid, other: None });
            }
            if let Some(hit) = self.first_hit(solid, &pose, &bounds, placed) {
                return Some(hit);
            }
        }
        None
    }

    fn first_hit(&self, solid: usize, pose: &pm::Pose, bounds: &Aabb, placed: &Placed) -> Option<Hit> {
        let link = &self.links[solid].1;
        let near = placed.bodies.iter().filter(|b| b.bounds.intersects(bounds));
        near.into_iter()
            .find(|b| {
                let (e, s) = b.id;
                match (&self.parts[e][s], &b.leg) {
                    (_, Some(leg)) => intersecting(pose, &*link.shape, &b.pose, leg),
                    (Part::Rigid { body, closed_mesh }, None) => {
                        intersecting(pose, &*link.shape, &b.pose, &*body.shape)
                            || *closed_mesh
                                && body.shape.contains_point(&b.pose, *pose * vector(&link.inside))
                    }
                    (Part::Leg { .. }, None) => false,
                }
            })
            .map(|b| Hit { solid, other: Some(b.id) })
    }
}

/// parry answers every pair of the shapes built here; should it not, a collision is the safe answer.
fn intersecting(pose_a: &pm::Pose, a: &dyn shape::Shape, pose_b: &pm::Pose, b: &dyn shape::Shape) -> bool {
    intersection_test(pose_a, a, pose_b, b).map_or(true, |answer| answer.intersecting)
}

/// The shape of a link solid with every point within `by` (m) of it.
fn swollen(shape: &Shape, by: f64) -> Body {
    match shape {
        Shape::Box { pose, size } if by > 0.0 => {
            let half = size / 2.0;
            let shape = SharedShape::round_cuboid(half.x, half.y, half.z, by);
            Body { shape, local: *pose, inside: Vector3::zeros() }
        }
        Shape::Sphere { centre, radius } => ball(centre, radius + by),
        Shape::Capsule { a, b, radius } => capsule(a, b, radius + by),
        Shape::Cylinder { a, b, radius } if by > 0.0 => {
            let shape = SharedShape::round_cylinder((b - a).norm() / 2.0, *radius, by);
            Body { shape, local: along_y(a, b), inside: Vector3::zeros() }
        }
        other => body(other),
    }
}

/// The shape as it is.
fn body(shape: &Shape) -> Body {
    match shape {
        Shape::Box { pose, size } => {
            let half = size / 2.0;
            Body {
                shape: SharedShape::cuboid(half.x, half.y, half.z),
                local: *pose,
                inside: Vector3::zeros(),
            }
        }
        Shape::Sphere { centre, radius } => ball(centre, *radius),
        Shape::Capsule { a, b, radius } => capsule(a, b, *radius),
        Shape::Cylinder { a, b, radius } => {
            let shape = SharedShape::cylinder((b - a).norm() / 2.0, *radius);
            Body { shape, local: along_y(a, b), inside: Vector3::zeros() }
        }
        // A leg has no length of its own; see `Part::Leg`.
        Shape::Leg { x, y, size, top } => {
            let shape = SharedShape::cuboid(size.0 / 2.0, size.1 / 2.0, f64::MIN_POSITIVE);
            let translation = Vector3::new(*x, *y, *top);
            Body { shape, local: Pose { translation, ..Pose::identity() }, inside: Vector3::zeros() }
        }
        Shape::Mesh { pose, vertices, triangles, closed } => mesh(pose, vertices, triangles, *closed),
    }
}

fn part(shape: &Shape) -> Part {
    match shape {
        Shape::Leg { x, y, size, top } => {
            Part::Leg { x: *x, y: *y, half: (size.0 / 2.0, size.1 / 2.0), top: *top }
        }
        other => {
            Part::Rigid { body: body(other), closed_mesh: matches!(other, Shape::Mesh { closed: true, .. }) }
        }
    }
}

fn ball(centre: &Vector3<f64>, radius: f64) -> Body {
    let local = Pose { translation: *centre, ..Pose::identity() };
    Body { shape: SharedShape::ball(radius), local, inside: Vector3::zeros() }
}

fn capsule(a: &Vector3<f64>, b: &Vector3<f64>, radius: f64) -> Body {
    Body { shape: SharedShape::capsule(vector(a), vector(b), radius), local: Pose::identity(), inside: *a }
}

/// The pose of a bar whose axis is y in parry and runs from `a` to `b` here.
fn along_y(a: &Vector3<f64>, b: &Vector3<f64>) -> Pose {
    let axis = (b - a).normalize();
    let turn = nalgebra::Rotation3::rotation_between(&Vector3::y(), &axis);
    // Opposite directions have no unique turn between them: half a turn about x is one.
    let turn = turn
        .unwrap_or_else(|| nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Pose { rotation: turn.into_inner(), translation: (a + b) / 2.0 }
}

fn mesh(pose: &Pose, vertices: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> Body {
    let points: Vec<_> = vertices.iter().map(vector).collect();
    // Oriented: a point inside can be told from one outside.
    let flags = if closed { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
    let built = TriMesh::with_flags(points.clone(), triangles.to_vec(), flags);
    // The cell refuses empty meshes; its bounding box stands for anything else parry dislikes.
    let shape = built.map(SharedShape::new).unwrap_or_else(|_| bounding_box(&points));
    Body { shape, local: *pose, inside: Vector3::zeros() }
}

fn bounding_box(points: &[pm::Vector]) -> SharedShape {
    let reach = points.iter().fold(pm::Vector::ZERO, |m, p| m.max(p.abs()));
    SharedShape::cuboid(reach.x, reach.y, reach.z)
}

fn vector(v: &Vector3<f64>) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}

fn parry_pose(pose: &Pose) -> pm::Pose {
    let column =
        |i: usize| pm::Vector::new(pose.rotation[(0, i)], pose.rotation[(1, i)], pose.rotation[(2, i)]);
    let matrix = pm::Matrix::from_cols(column(0), column(1), column(2));
    pm::Pose::from_parts(vector(&pose.translation), pm::Rotation::from_mat3(&matrix))
}
