//! Solids of the cell as parry's shapes.

use super::decomposition::{Hull, convex};
use crate::cell::Shape;
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::Aabb;
use parry3d::math as pm;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::{Ball, Shape as ParryShape, SharedShape, TriMesh, TriMeshFlags};

/// A solid ready for parry, convex but for the meshes of equipment: its shape, and its pose in the frame of its carrier.
pub(super) struct Body {
    pub(super) shape: SharedShape,
    pub(super) local: Pose,
    /// A point inside the solid, for tests against closed meshes.
    pub(super) inside: pm::Vector,
    /// Shorter capsules that together are the capsule, for tests against meshes: the bounds of a
    /// long one that lies askew take in most triangles of a mesh. Empty: the shape itself.
    pub(super) pieces: Vec<SharedShape>,
    /// A rounded solid before it was rounded, and by how much (m): parry finds it apart from a ball up
    /// to 4e-5 m too early, where swelling the ball instead is exact.
    pub(super) unswollen: Option<(SharedShape, f64)>,
    /// In the frame of the shape.
    pub(super) bounds: Aabb,
    /// Of many vertices: its bounds are turned, for to find them anew takes longer.
    pub(super) is_hull: bool,
    /// Whether `local` is the identity.
    is_at_origin: bool,
}

impl Body {
    /// The same, with the frame in which it was given at `mount`.
    pub(super) fn mounted(self, mount: &Pose) -> Self {
        let local = *mount * self.local;
        Self { is_at_origin: local == Pose::identity(), local, ..self }
    }

    /// Its pose if that of its carrier is `frame`.
    pub(super) fn pose_in(&self, frame: &Pose) -> pm::Pose {
        if self.is_at_origin { parry_pose(frame) } else { parry_pose(&(*frame * self.local)) }
    }

    /// Bounds in another frame.
    pub(super) fn bounds_in(&self, pose: &pm::Pose) -> Aabb {
        if self.is_hull { self.bounds.transform_by(pose) } else { self.shape.compute_aabb(pose) }
    }

    /// Whether a point (in the frame of the shape) lies inside.
    pub(super) fn holds(&self, point: &pm::Vector) -> bool {
        self.bounds.contains_local_point(*point) && self.shape.contains_local_point(*point)
    }
}

/// Whether two convex solids share a point; `relative`: the pose of `b` in the frame of `a`.
pub(super) fn touching(a: &Body, relative: &pm::Pose, b: &Body) -> bool {
    let swelled = |ball: &Ball, by: f64| Ball::new(ball.radius + by);
    if let Some((shape, by)) = &b.unswollen
        && let Some(ball) = a.shape.as_ball()
    {
        return intersecting(&swelled(ball, *by), relative, &**shape);
    }
    if let Some((shape, by)) = &a.unswollen
        && let Some(ball) = b.shape.as_ball()
    {
        return intersecting(&**shape, relative, &swelled(ball, *by));
    }
    intersecting(&*a.shape, relative, &*b.shape)
}

/// parry answers every pair of the shapes built here; should it not, a collision is the safe answer.
pub(super) fn intersecting(a: &dyn ParryShape, b_in_a: &pm::Pose, b: &dyn ParryShape) -> bool {
    DefaultQueryDispatcher.intersection_test(b_in_a, a, b).map_or(true, |answer| answer.intersecting)
}

/// An equipment solid: fixed in shape, or a leg that is cut to length by the placement.
pub(super) enum Part {
    Convex(Body),
    Mesh { body: Body, closed: bool },
    Leg { x: f64, y: f64, half: (f64, f64), top: f64 },
}

/// The bodies of a link solid, every point within `by` (m) of it: one, or those of a mesh's `parts`.
pub(super) fn link_bodies(shape: &Shape, parts: &[Hull], by: f64) -> Vec<Body> {
    let Shape::Mesh { pose, .. } = shape else { return vec![swollen(shape, by)] };
    let body = |hull: &Hull| {
        let (shape, unswollen) = hull.swollen(by);
        Body { unswollen, inside: hull.inside, is_hull: true, ..centred(shape, *pose) }
    };
    parts.iter().map(body).collect()
}

/// The shape of a link solid with every point within `by` (m) of it: exact, for a ball swept over a
/// convex solid is one of parry's shapes.
fn swollen(shape: &Shape, by: f64) -> Body {
    let rounded = |shape: &Shape, round: SharedShape| {
        let plain = body(shape);
        Body { unswollen: Some((plain.shape, by)), ..centred(round, plain.local) }
    };
    match shape {
        Shape::Box { size, .. } if by > 0.0 => {
            let half = size / 2.0;
            rounded(shape, SharedShape::round_cuboid(half.x, half.y, half.z, by))
        }
        Shape::Sphere { centre, radius } => ball(centre, radius + by),
        Shape::Capsule { a, b, radius } => capsule(a, b, radius + by),
        Shape::Cylinder { a, b, radius } if by > 0.0 => {
            rounded(shape, SharedShape::round_cylinder((b - a).norm() / 2.0, *radius, by))
        }
        other => body(other),
    }
}

/// The shape as it is. A leg gets its length from the placement and never comes here.
pub(super) fn body(shape: &Shape) -> Body {
    match shape {
        Shape::Box { pose, size } => {
            let half = size / 2.0;
            centred(SharedShape::cuboid(half.x, half.y, half.z), *pose)
        }
        Shape::Sphere { centre, radius } => ball(centre, *radius),
        Shape::Capsule { a, b, radius } => capsule(a, b, *radius),
        Shape::Cylinder { a, b, radius } => {
            centred(SharedShape::cylinder((b - a).norm() / 2.0, *radius), along_y(a, b))
        }
        Shape::Leg { x, y, top, .. } => ball(&Vector3::new(*x, *y, *top), 0.0),
        Shape::Mesh { pose, vertices, triangles, closed } => {
            centred(mesh(vertices, triangles, *closed), *pose)
        }
    }
}

pub(super) fn part(shape: &Shape) -> Part {
    match shape {
        Shape::Leg { x, y, size, top } => {
            Part::Leg { x: *x, y: *y, half: (size.0 / 2.0, size.1 / 2.0), top: *top }
        }
        Shape::Mesh { pose, vertices, triangles, closed } => {
            match convex(vertices, triangles).filter(|_| *closed) {
                Some(solid) => Part::Convex(Body { is_hull: true, ..centred(solid, *pose) }),
                None => Part::Mesh { body: body(shape), closed: *closed },
            }
        }
        _ => Part::Convex(body(shape)),
    }
}

fn centred(shape: SharedShape, local: Pose) -> Body {
    let bounds = shape.compute_local_aabb();
    let (inside, pieces, unswollen) = (pm::Vector::ZERO, Vec::new(), None);
    let is_at_origin = local == Pose::identity();
    Body { shape, local, inside, pieces, unswollen, bounds, is_hull: false, is_at_origin }
}

fn ball(centre: &Vector3<f64>, radius: f64) -> Body {
    centred(SharedShape::ball(radius), Pose { translation: *centre, ..Pose::identity() })
}

fn capsule(a: &Vector3<f64>, b: &Vector3<f64>, radius: f64) -> Body {
    let count = ((b - a).norm() / (2.0 * radius)).ceil().clamp(1.0, 64.0);
    let point = |k: f64| vector(&a.lerp(b, k / count));
    let pieces =
        (0..count as usize).map(|k| SharedShape::capsule(point(k as f64), point(k as f64 + 1.0), radius));
    let shape = SharedShape::capsule(vector(a), vector(b), radius);
    Body { inside: vector(a), pieces: pieces.collect(), ..centred(shape, Pose::identity()) }
}

/// The pose of a bar whose axis is y in parry and runs from `a` to `b` here.
fn along_y(a: &Vector3<f64>, b: &Vector3<f64>) -> Pose {
    let turn = nalgebra::Rotation3::rotation_between(&Vector3::y(), &(b - a));
    // Opposite directions have no unique turn between them: half a turn about x is one.
    let turn = turn
        .unwrap_or_else(|| nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Pose { rotation: turn.into_inner(), translation: (a + b) / 2.0 }
}

/// Oriented if closed, so that a point inside can be told from one outside. What parry refuses (the
/// cell has refused empty meshes before) is taken as the box round it.
fn mesh(vertices: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> SharedShape {
    let flags = if closed { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
    let points: Vec<_> = vertices.iter().map(vector).collect();
    let reach = points.iter().fold(pm::Vector::ZERO, |m, p| m.max(p.abs()));
    let built = TriMesh::with_flags(points, triangles.to_vec(), flags);
    built.map_or_else(|_| SharedShape::cuboid(reach.x, reach.y, reach.z), SharedShape::new)
}

pub(super) fn vector(v: &Vector3<f64>) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}

pub(super) fn plain(v: pm::Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

pub(super) fn parry_pose(pose: &Pose) -> pm::Pose {
    let column =
        |i: usize| pm::Vector::new(pose.rotation[(0, i)], pose.rotation[(1, i)], pose.rotation[(2, i)]);
    let matrix = pm::Matrix::from_cols(column(0), column(1), column(2));
    pm::Pose::from_parts(vector(&pose.translation), pm::Rotation::from_mat3(&matrix))
}
