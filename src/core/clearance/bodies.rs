//! Solids of the cell as shapes of the collision library parry3d.

use super::convex_decomposition::{Hull, convex};
use crate::cell::Shape;
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::Aabb;
use parry3d::math as pm;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::{Ball, Shape as ParryShape, SharedShape, TriMesh, TriMeshFlags};

/// One solid as a shape of the collision library parry3d. The shape is convex unless it is a triangle mesh.
pub(super) struct CollisionBody {
    pub(super) shape: SharedShape,
    /// Pose of the shape in the frame that carries it.
    pub(super) local: Pose,
    /// Point of the solid, in the frame of the shape, for the test whether the solid lies wholly inside a
    /// closed mesh.
    pub(super) inside: pm::Vector,
    /// Shorter capsules whose union is this body, for checks against meshes; empty if the body is not a
    /// capsule.
    ///
    /// The bounding box of a long oblique capsule would contain most triangles of a mesh.
    pub(super) pieces: Vec<SharedShape>,
    /// Solid before its rounding, and the radius (m) of the rounding. The field is None for a solid without
    /// rounding.
    ///
    /// A check against a ball uses this solid, and enlarges the ball by the radius. This check is exact. For
    /// the rounded solid, the error of parry3d is up to 4e-5 m.
    pub(super) unswollen: Option<(SharedShape, f64)>,
    /// Bounding box in the frame of the shape.
    pub(super) bounds: Aabb,
    /// Whether the solid has many vertices. For such a solid, rotating `bounds` is faster than computing a
    /// new box.
    pub(super) is_hull: bool,
    /// Whether `local` is the identity.
    is_at_origin: bool,
}

impl CollisionBody {
    /// Returns the body with its pose in the carrier frame.
    ///
    /// `mount` is the pose, in the carrier frame, of the frame in which the file gives the solid.
    pub(super) fn mounted(self, mount: &Pose) -> Self {
        let local = *mount * self.local;
        Self { is_at_origin: local == Pose::identity(), local, ..self }
    }

    /// Converts `frame`, the pose of the carrier frame, to the pose of the shape in the same reference frame.
    pub(super) fn pose_in(&self, frame: &Pose) -> pm::Pose {
        if self.is_at_origin { parry_pose(frame) } else { parry_pose(&(*frame * self.local)) }
    }

    /// Returns the bounding box in a frame in which the shape has the pose `pose`.
    pub(super) fn bounds_in(&self, pose: &pm::Pose) -> Aabb {
        if self.is_hull { self.bounds.transform_by(pose) } else { self.shape.compute_aabb(pose) }
    }

    /// Returns whether a point lies inside the solid. The point is given in the frame of the shape.
    pub(super) fn holds(&self, point: &pm::Vector) -> bool {
        self.bounds.contains_local_point(*point) && self.shape.contains_local_point(*point)
    }
}

/// Returns whether two convex solids share a point. `relative` is the pose of `b` in the frame of `a`.
pub(super) fn touching(a: &CollisionBody, relative: &pm::Pose, b: &CollisionBody) -> bool {
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

/// Returns whether two shapes intersect, as computed by parry3d.
///
/// parry3d supports every pair of the shapes that this module builds. An unsupported pair would count as a
/// collision.
pub(super) fn intersecting(a: &dyn ParryShape, b_in_a: &pm::Pose, b: &dyn ParryShape) -> bool {
    DefaultQueryDispatcher.intersection_test(b_in_a, a, b).map_or(true, |answer| answer.intersecting)
}

/// Solid of a piece of equipment: fixed in shape, or a leg whose length follows from the placement.
pub(super) enum EquipmentSolid {
    Convex(CollisionBody),
    Mesh { body: CollisionBody, closed: bool },
    Leg { x: f64, y: f64, half: (f64, f64), top: f64 },
}

/// Returns the bodies of a link solid, each enlarged by `by` (m).
///
/// A mesh gives one body for each of its convex parts, which are given in `parts`. Any other shape gives one
/// body.
pub(super) fn link_bodies(shape: &Shape, parts: &[Hull], by: f64) -> Vec<CollisionBody> {
    let Shape::Mesh { pose, .. } = shape else { return vec![swollen(shape, by)] };
    let body = |hull: &Hull| {
        let (shape, unswollen) = hull.swollen(by);
        CollisionBody { unswollen, inside: hull.inside, is_hull: true, ..centred(shape, *pose) }
    };
    parts.iter().map(body).collect()
}

/// Returns a box, sphere, capsule or cylinder enlarged by `by` (m) on all sides; other shapes are unchanged.
///
/// The enlarged solid is exact, because parry3d has rounded boxes and cylinders.
fn swollen(shape: &Shape, by: f64) -> CollisionBody {
    let rounded = |shape: &Shape, round: SharedShape| {
        let plain = body(shape);
        CollisionBody { unswollen: Some((plain.shape, by)), ..centred(round, plain.local) }
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

/// Returns the body of a shape without enlargement.
///
/// The shape must not be a leg, whose length follows from the placement.
pub(super) fn body(shape: &Shape) -> CollisionBody {
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
            let inside = first_corner(vertices, triangles);
            CollisionBody { inside, ..centred(mesh(vertices, triangles, *closed), *pose) }
        }
    }
}

/// Converts a shape of a piece of equipment to a solid for collision checking.
///
/// A closed convex mesh with few vertices becomes a convex polyhedron.
pub(super) fn part(shape: &Shape) -> EquipmentSolid {
    match shape {
        Shape::Leg { x, y, size, top } => {
            EquipmentSolid::Leg { x: *x, y: *y, half: (size.0 / 2.0, size.1 / 2.0), top: *top }
        }
        Shape::Mesh { pose, vertices, triangles, closed } => {
            match convex(vertices, triangles).filter(|_| *closed) {
                Some(solid) => {
                    let inside = first_corner(vertices, triangles);
                    EquipmentSolid::Convex(CollisionBody { is_hull: true, inside, ..centred(solid, *pose) })
                }
                None => EquipmentSolid::Mesh { body: body(shape), closed: *closed },
            }
        }
        _ => EquipmentSolid::Convex(body(shape)),
    }
}

/// Returns the first corner of the first triangle, as a point that certainly lies on the mesh.
fn first_corner(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> pm::Vector {
    let corner = triangles.first().and_then(|[first, ..]| vertices.get(*first as usize));
    corner.map_or(pm::Vector::ZERO, vector)
}

/// Returns the body of a shape, with the origin of the shape's frame as [`CollisionBody::inside`].
///
/// If the origin is not a point of the shape, the caller must replace this field.
fn centred(shape: SharedShape, local: Pose) -> CollisionBody {
    let bounds = shape.compute_local_aabb();
    let (inside, pieces, unswollen) = (pm::Vector::ZERO, Vec::new(), None);
    let is_at_origin = local == Pose::identity();
    CollisionBody { shape, local, inside, pieces, unswollen, bounds, is_hull: false, is_at_origin }
}

fn ball(centre: &Vector3<f64>, radius: f64) -> CollisionBody {
    centred(SharedShape::ball(radius), Pose { translation: *centre, ..Pose::identity() })
}

fn capsule(a: &Vector3<f64>, b: &Vector3<f64>, radius: f64) -> CollisionBody {
    let count = ((b - a).norm() / (2.0 * radius)).ceil().clamp(1.0, 64.0);
    let point = |k: f64| vector(&a.lerp(b, k / count));
    let pieces =
        (0..count as usize).map(|k| SharedShape::capsule(point(k as f64), point(k as f64 + 1.0), radius));
    let shape = SharedShape::capsule(vector(a), vector(b), radius);
    CollisionBody { inside: vector(a), pieces: pieces.collect(), ..centred(shape, Pose::identity()) }
}

/// Returns the pose of the frame whose y axis points from `a` to `b` and whose origin is midway between them.
fn along_y(a: &Vector3<f64>, b: &Vector3<f64>) -> Pose {
    let turn = nalgebra::Rotation3::rotation_between(&Vector3::y(), &(b - a));
    // The rotation between opposite directions is not unique; a rotation by 180 degrees about x is one
    // possibility.
    let turn = turn
        .unwrap_or_else(|| nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Pose { rotation: turn.into_inner(), translation: (a + b) / 2.0 }
}

/// Returns a triangle mesh. A closed mesh gets an orientation, which distinguishes inner from outer points.
///
/// A mesh that parry3d refuses is replaced by a box, which contains the mesh and is centred at the origin.
/// Empty meshes do not occur here, because the reader refuses them.
fn mesh(vertices: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> SharedShape {
    let flags = if closed { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
    let points: Vec<_> = vertices.iter().map(vector).collect();
    let reach = points.iter().fold(pm::Vector::ZERO, |m, p| m.max(p.abs()));
    let built = TriMesh::with_flags(points, triangles.to_vec(), flags);
    built.map_or_else(|_| SharedShape::cuboid(reach.x, reach.y, reach.z), SharedShape::new)
}

/// Converts a vector of nalgebra to a vector of parry3d.
pub(super) fn vector(v: &Vector3<f64>) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}

/// Converts a vector of parry3d to a vector of nalgebra.
pub(super) fn plain(v: pm::Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// Converts a pose to a pose of parry3d.
pub(super) fn parry_pose(pose: &Pose) -> pm::Pose {
    let column =
        |i: usize| pm::Vector::new(pose.rotation[(0, i)], pose.rotation[(1, i)], pose.rotation[(2, i)]);
    let matrix = pm::Matrix::from_cols(column(0), column(1), column(2));
    pm::Pose::from_parts(vector(&pose.translation), pm::Rotation::from_mat3(&matrix))
}
