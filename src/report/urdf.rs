//! Static URDF of a layout. Links for the robot base, the equipment, the obstacles and the spots are joined
//! to the world.
//!
//! Lengths are in m and angles in rad, as in every URDF. The robot itself is not part of the file. The
//! user connects the URDF of the robot to the link [`ROBOT_BASE`] by a fixed joint.

use super::identifiers::Identifiers;
use super::layout_frames::NamedFrame;
use super::scene_objects::{ROBOT_BASE, SceneObject, SceneShape, SceneSolid, WORLD, scene_objects};
use crate::drawing::Drawing;
use crate::mesh::to_stl;
use crate::pose::Pose;
use crate::svg_text::escaped;
use crate::units::rounded;
use nalgebra::Vector3;

/// URDF with the mesh files that it names.
pub struct UrdfExport {
    pub urdf: String,
    /// Names and bytes of the mesh files (binary STL in m), for the folder that the URDF names.
    pub meshes: Vec<(String, Vec<u8>)>,
}

/// Returns the URDF of a layout. The names of the mesh files have the prefix `folder`: a path that ends with
/// `/`, or a URI.
///
/// # Errors
/// Fails if a mesh cannot be written.
pub fn urdf(drawing: &Drawing<'_>, folder: &str) -> Result<UrdfExport, String> {
    let mut meshes = Vec::new();
    let mut files = Identifiers::new(100);
    let cell = escaped(&drawing.cell.name);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <robot name=\"{cell}\">\n  \
         <!-- {}, {}; sweetspot {}. Lengths in m, angles in rad. -->\n  \
         <!-- Join the base link of the robot, {}, to the link {ROBOT_BASE} by a fixed joint. -->\n  \
         <link name=\"{WORLD}\"/>\n",
        commented(&drawing.cell.name),
        commented(&drawing.name),
        env!("CARGO_PKG_VERSION"),
        commented(&drawing.cell.robot.name),
    );
    for object in scene_objects(drawing) {
        text += &link(&object, folder, &mut files, &mut meshes)?;
        text += &fixed_joint(WORLD, &object.name, &object.pose);
        for NamedFrame { name, pose } in &object.spots {
            text += &format!("  <link name=\"{name}\"/>\n");
            text += &fixed_joint(&object.name, name, pose);
        }
    }
    Ok(UrdfExport { urdf: text + "</robot>\n", meshes })
}

/// Returns a link with its solids, each for collision and for display.
fn link(
    object: &SceneObject<'_>,
    folder: &str,
    files: &mut Identifiers,
    meshes: &mut Vec<(String, Vec<u8>)>,
) -> Result<String, String> {
    if object.solids.is_empty() {
        return Ok(format!("  <link name=\"{}\"/>\n", object.name));
    }
    let mut text = format!("  <link name=\"{}\">\n", object.name);
    for SceneSolid { name, pose, shape } in &object.solids {
        let geometry = match shape {
            SceneShape::Box(size) => format!("<box size=\"{}\"/>", triple(size)),
            SceneShape::Sphere(radius) => format!("<sphere radius=\"{}\"/>", plain(*radius)),
            SceneShape::Cylinder { radius, length } => {
                format!("<cylinder radius=\"{}\" length=\"{}\"/>", plain(*radius), plain(*length))
            }
            SceneShape::Mesh { vertices, triangles } => {
                let file = files.give(&format!("{}_", object.name), name) + ".stl";
                let uri = escaped(&format!("{folder}{file}"));
                meshes.push((file, to_stl(vertices, triangles)?));
                format!("<mesh filename=\"{uri}\"/>")
            }
        };
        for role in ["visual", "collision"] {
            text += &format!(
                "    <{role} name=\"{}\">{}<geometry>{geometry}</geometry></{role}>\n",
                escaped(name),
                origin(pose)
            );
        }
    }
    Ok(text + "  </link>\n")
}

fn fixed_joint(parent: &str, child: &str, pose: &Pose) -> String {
    format!(
        "  <joint name=\"{parent}_to_{child}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{}</joint>\n",
        origin(pose)
    )
}

fn origin(pose: &Pose) -> String {
    format!("<origin xyz=\"{}\" rpy=\"{}\"/>", triple(&pose.translation), triple(&pose.roll_pitch_yaw()))
}

fn triple(v: &Vector3<f64>) -> String {
    format!("{} {} {}", plain(v.x), plain(v.y), plain(v.z))
}

/// Returns a number with at most 12 decimals. The last decimal is 1 pm or 1e-12 rad.
fn plain(value: f64) -> String {
    rounded(value, 12).to_string()
}

/// Returns the text for use in an XML comment. The character U+2010 replaces every `-`, because an XML
/// comment must not contain `--`.
fn commented(text: &str) -> String {
    escaped(text).replace('-', "\u{2010}")
}
