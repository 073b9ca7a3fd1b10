//! Shapes of solids, and their bounding boxes, m.

use crate::pose::Pose;
use nalgebra::Vector3;

/// Shape of a solid, in the frame of the link or equipment that carries it, m.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box with full edge lengths `size`; `pose` is the pose of its centre and axes.
    Box {
        pose: Pose,
        size: Vector3<f64>,
    },
    Sphere {
        centre: Vector3<f64>,
        radius: f64,
    },
    /// Capsule: all points within `radius` of the segment from `a` to `b`.
    Capsule {
        a: Vector3<f64>,
        b: Vector3<f64>,
        radius: f64,
    },
    /// Circular cylinder with flat ends, whose axis runs from `a` to `b`.
    Cylinder {
        a: Vector3<f64>,
        b: Vector3<f64>,
        radius: f64,
    },
    /// Upright rectangular leg from the floor up to `top`.
    ///
    /// The length of the leg depends on the height at which the equipment is placed.
    Leg {
        x: f64,
        y: f64,
        size: (f64, f64),
        top: f64,
    },
    /// Triangle mesh with its vertices in the frame `pose`; `closed` states whether the mesh bounds a solid.
    Mesh {
        pose: Pose,
        vertices: Vec<Vector3<f64>>,
        triangles: Vec<[u32; 3]>,
        closed: bool,
    },
}

impl Shape {
    /// Returns the shape in another frame; `pose` is the pose of the present frame in the new frame.
    ///
    /// A leg stays unchanged, since it stands on the floor.
    pub fn seen_from(self, pose: &Pose) -> Self {
        let at = |p: Vector3<f64>| pose.transform(&p);
        match self {
            Self::Box { pose: own, size } => Self::Box { pose: *pose * own, size },
            Self::Sphere { centre, radius } => Self::Sphere { centre: at(centre), radius },
            Self::Capsule { a, b, radius } => Self::Capsule { a: at(a), b: at(b), radius },
            Self::Cylinder { a, b, radius } => Self::Cylinder { a: at(a), b: at(b), radius },
            Self::Mesh { pose: own, vertices, triangles, closed } => {
                Self::Mesh { pose: *pose * own, vertices, triangles, closed }
            }
            leg @ Self::Leg { .. } => leg,
        }
    }
}

/// Shape with the name that the cell file gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    pub name: String,
    pub shape: Shape,
}

/// Rectangle in plan: centre and full side lengths, m, in the frame of the object to which it belongs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    pub centre: (f64, f64),
    pub size: (f64, f64),
}

/// Axis-aligned box: the corner of least x, y and z, then the corner of greatest x, y and z, m.
pub type Extent = (Vector3<f64>, Vector3<f64>);

/// Returns the axis-aligned bounding box of a shape in the frame of its carrier, m.
///
/// The box of a leg is flat and lies at the height of the top of the leg. The lower end of the leg is not
/// known here, because it depends on the placement.
pub fn extent(shape: &Shape) -> Extent {
    match shape {
        Shape::Box { pose, size } => {
            let half = pose.rotation.abs() * (size / 2.0);
            (pose.translation - half, pose.translation + half)
        }
        Shape::Sphere { centre, radius } => (centre.add_scalar(-radius), centre.add_scalar(*radius)),
        Shape::Capsule { a, b, radius } => (a.inf(b).add_scalar(-radius), a.sup(b).add_scalar(*radius)),
        Shape::Cylinder { a, b, radius } => {
            let axis = (b - a).normalize();
            let disc = axis.map(|c| radius * (1.0 - c * c).max(0.0).sqrt());
            (a.inf(b) - disc, a.sup(b) + disc)
        }
        Shape::Leg { x, y, size, top } => (
            Vector3::new(x - size.0 / 2.0, y - size.1 / 2.0, *top),
            Vector3::new(x + size.0 / 2.0, y + size.1 / 2.0, *top),
        ),
        Shape::Mesh { pose, vertices, .. } => {
            let none = Vector3::repeat(f64::INFINITY);
            let placed = vertices.iter().map(|v| pose.transform(v));
            placed.fold((none, -none), |(lo, hi), v| (lo.inf(&v), hi.sup(&v)))
        }
    }
}

/// Returns the common bounding box of several shapes; None if `shapes` is empty.
pub fn extent_of<'s>(shapes: impl IntoIterator<Item = &'s Shape>) -> Option<Extent> {
    shapes.into_iter().map(extent).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
}
