//! Solid objects of a layout in the shapes of ROS: boxes, spheres, cylinders and meshes.

use super::identifiers::Identifiers;
use super::layout_frames::{LayoutFrames, NamedFrame};
use crate::cell::{Cell, Shape};
use crate::drawing::{Drawing, fence_walls, pedestal};
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// Stationary object, with its solids and the named frames on it.
pub struct SceneObject<'a> {
    /// Identifier of the object: letters, digits and `_`.
    pub name: String,
    /// Pose of the frame of the object in the world frame, m.
    pub pose: Pose,
    pub solids: Vec<SceneSolid<'a>>,
    /// Frames of the TCP at the spots on the object, in the frame of the object, m. The names are
    /// identifiers.
    pub spots: Vec<NamedFrame>,
}

/// Solid of an object, in the frame of the object.
pub struct SceneSolid<'a> {
    /// Name of the solid in the cell.
    pub name: &'a str,
    /// Pose of the shape in the frame of the object, m.
    pub pose: Pose,
    pub shape: SceneShape<'a>,
}

/// Shape in its own frame, m. A box, sphere or cylinder is centred at the origin.
pub enum SceneShape<'a> {
    /// Box with its full edge lengths.
    Box(Vector3<f64>),
    Sphere(f64),
    /// Cylinder with its axis along z.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Mesh {
        vertices: &'a [Vector3<f64>],
        triangles: &'a [[u32; 3]],
    },
}

/// Name of the link and frame of the robot base.
pub const ROBOT_BASE: &str = "robot_base";

/// Name of the root link: the world frame of the cell.
pub const WORLD: &str = "world";

/// Returns the pedestal, the equipment and obstacles, the fence and the keep-out boxes of a layout.
///
/// The first object has the name [`ROBOT_BASE`] and the frame of the robot base. Only the pedestal belongs to
/// this object. Without a pedestal, the object has no solids. A capsule becomes a cylinder with two spheres.
/// A [`Shape::Leg`] becomes a box that stands on the floor.
pub fn scene_objects<'a>(drawing: &Drawing<'a>) -> Vec<SceneObject<'a>> {
    let cell: &'a Cell = drawing.cell;
    let mut names = Identifiers::new(60);
    // The names of the root link and of the robot base are reserved.
    names.give("", WORLD);
    let frames = LayoutFrames::new(drawing);
    let object = |name: String, pose: Pose| SceneObject { name, pose, solids: Vec::new(), spots: Vec::new() };
    let mut base = object(names.give("", ROBOT_BASE), drawing.base);
    base.solids.extend(
        pedestal(cell, drawing.layout.base.z).and_then(|(pose, size)| cuboid("pedestal", pose, size)),
    );
    let mut all = vec![base];
    for (equipment, at) in cell.equipment.iter().zip(&drawing.layout.placements) {
        let start =
            if equipment.name.starts_with(|c: char| c.is_ascii_alphabetic()) { "" } else { "object_" };
        let mut placed = object(names.give(start, &equipment.name), at.pose());
        for solid in &equipment.solids {
            placed.solids.extend(solids(&solid.name, &solid.shape, cell.floor - at.z));
        }
        for spot in &frames.spots {
            if frames.equipment[spot.equipment].name == equipment.name {
                let name = names.give("spot_", &spot.operation);
                placed.spots.push(NamedFrame { name, pose: frames.on_equipment(spot) });
            }
        }
        all.push(placed);
    }
    for (k, (pose, size)) in fence_walls(cell).into_iter().enumerate() {
        let mut wall = object(names.give("fence_", &(k + 1).to_string()), pose);
        wall.solids.extend(cuboid("wall", Pose::IDENTITY, size));
        all.push(wall);
    }
    for space in &cell.keep_out {
        let pose = Pose { translation: (space.min + space.max) / 2.0, ..Pose::IDENTITY };
        let mut kept = object(names.give("keep_out_", &space.name), pose);
        kept.solids.extend(cuboid("keep-out", Pose::IDENTITY, space.max - space.min));
        all.push(kept);
    }
    all
}

fn cuboid(name: &str, pose: Pose, size: Vector3<f64>) -> Option<SceneSolid<'_>> {
    (size.min() > 0.0).then_some(SceneSolid { name, pose, shape: SceneShape::Box(size) })
}

/// Returns the solids that make up a shape. `floor` is the height of the floor in the frame of the object.
fn solids<'a>(name: &'a str, shape: &'a Shape, floor: f64) -> Vec<SceneSolid<'a>> {
    let solid = |pose: Pose, shape: SceneShape<'a>| SceneSolid { name, pose, shape };
    let at = |translation: Vector3<f64>| Pose { translation, ..Pose::IDENTITY };
    let bar = |a: &Vector3<f64>, b: &Vector3<f64>, radius: f64| {
        solid(along_z(a, b), SceneShape::Cylinder { radius, length: (b - a).norm() })
    };
    match shape {
        Shape::Box { pose, size } => cuboid(name, *pose, *size).into_iter().collect(),
        Shape::Sphere { centre, radius } => vec![solid(at(*centre), SceneShape::Sphere(*radius))],
        Shape::Cylinder { a, b, radius } => vec![bar(a, b, *radius)],
        Shape::Capsule { a, b, radius } => {
            let end = |p: &Vector3<f64>| solid(at(*p), SceneShape::Sphere(*radius));
            vec![bar(a, b, *radius), end(a), end(b)]
        }
        Shape::Leg { x, y, size, top } => {
            let pose = at(Vector3::new(*x, *y, (top + floor) / 2.0));
            cuboid(name, pose, Vector3::new(size.0, size.1, top - floor)).into_iter().collect()
        }
        Shape::Mesh { pose, vertices, triangles, .. } => {
            vec![solid(*pose, SceneShape::Mesh { vertices, triangles })]
        }
    }
}

/// Returns the pose midway between the points `a` and `b`. The z axis of the pose points from `a` to `b`.
fn along_z(a: &Vector3<f64>, b: &Vector3<f64>) -> Pose {
    let axis = (b - a).try_normalize(0.0).unwrap_or_else(Vector3::z);
    // The coordinate axis that is most nearly perpendicular to the bar determines the first of two
    // perpendicular axes.
    let far = Vector3::ith(axis.iamin(), 1.0);
    let across = axis.cross(&far).normalize();
    let rotation = Matrix3::from_columns(&[across, axis.cross(&across), axis]);
    Pose { rotation, translation: (a + b) / 2.0 }
}
