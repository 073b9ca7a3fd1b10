//! Planning scene of MoveIt: equipment, obstacles, fence and keep-out boxes as collision objects.
//!
//! The text has the format of the scene files that RViz exports and imports. The format is defined by
//! `PlanningScene::saveGeometryToStream` of MoveIt 1 and `shapes::saveAsText` of geometric_shapes. MoveIt 1
//! (Noetic) and MoveIt 2 read this format, which has object poses and subframes:
//!
//! ```text
//! NAME OF THE SCENE
//! * ID OF AN OBJECT
//! x y z                      pose of the object, m
//! qx qy qz qw
//! NUMBER OF SHAPES
//! box                        or sphere, cylinder, mesh
//! SIZES
//! x y z                      pose of the shape in the object
//! qx qy qz qw
//! r g b a                    zeros: no colour
//! NUMBER OF SUBFRAMES
//! NAME OF A SUBFRAME
//! x y z
//! qx qy qz qw
//! .
//! ```
//!
//! The sizes are `x y z` for a box, `radius` for a sphere, and `radius length` for a cylinder. For a mesh,
//! one line states the number of vertices and the number of triangles. One line for each vertex and one line
//! for each triangle follow.

use super::identifiers::ascii;
use super::layout_frames::NamedFrame;
use super::scene_objects::{ROBOT_BASE, SceneObject, SceneShape, SceneSolid, scene_objects};
use crate::drawing::Drawing;
use crate::pose::Pose;
use crate::units::rounded;

/// Returns the planning scene of a layout in the frame of the robot base. Spots are subframes of the
/// equipment.
///
/// MoveIt has no objects without shapes. Equipment without solids is therefore left out, together with its
/// spots.
pub fn scene(drawing: &Drawing<'_>) -> String {
    let (cell, layout) = (ascii(&drawing.cell.name), ascii(&drawing.name));
    let mut text = format!("{cell} ({layout}, in the frame of the robot base)\n");
    let from_world = drawing.base.inverse();
    for SceneObject { name, pose, solids, spots } in scene_objects(drawing) {
        if solids.is_empty() {
            continue;
        }
        let name = if name == ROBOT_BASE { "pedestal" } else { &name };
        text += &format!("* {name}\n{}{}\n", posed(&(from_world * pose)), solids.len());
        for SceneSolid { pose, shape, .. } in &solids {
            text += &format!("{}{}0 0 0 0\n", shaped(shape), posed(pose));
        }
        text += &format!("{}\n", spots.len());
        for NamedFrame { name, pose } in &spots {
            text += &format!("{name}\n{}", posed(pose));
        }
    }
    text + ".\n"
}

fn shaped(shape: &SceneShape<'_>) -> String {
    match shape {
        SceneShape::Box(size) => format!("box\n{}", line(size.as_slice())),
        SceneShape::Sphere(radius) => format!("sphere\n{}", line(&[*radius])),
        SceneShape::Cylinder { radius, length } => format!("cylinder\n{}", line(&[*radius, *length])),
        SceneShape::Mesh { vertices, triangles } => {
            let corners = vertices.iter().map(|v| line(v.as_slice()));
            let faces = triangles.iter().map(|[a, b, c]| format!("{a} {b} {c}\n"));
            let text: String = corners.chain(faces).collect();
            format!("mesh\n{} {}\n{text}", vertices.len(), triangles.len())
        }
    }
}

/// Returns the two lines of a pose: position, then quaternion with the scalar part last.
fn posed(pose: &Pose) -> String {
    let [w, x, y, z] = pose.quaternion();
    line(pose.translation.as_slice()) + &line(&[x, y, z, w])
}

fn line(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|v| rounded(*v, 12).to_string()).collect();
    words.join(" ") + "\n"
}
