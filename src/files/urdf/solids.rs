//! Collision shapes, in D-H frames, of the links of the chain and of the links that are fixed to the chain.

use super::dh::Derived;
use super::model::*;
use super::motion::{Motion, TOO_LONG};
use super::packages::RosPackages;
use super::tree::{LinkChain, Tree};
use crate::cell::{self, LinkSolid, Shape, Solid};
use crate::files::fault::shown;
use crate::files::mesh;
use crate::files::toml::document::Library;
use crate::files::toml::value;
use crate::pose::Pose;
use nalgebra::Vector3;

/// Link that moves with a D-H frame.
pub struct Carried {
    pub link: usize,
    /// Index of the D-H frame with which the link moves: the number of moving joints between base and link.
    pub frame: usize,
    /// Pose of the link in the base-link frame with all joint coordinates at 0.
    pose: Pose,
}

/// Returns the links of the chain, and the links that are fixed to the chain.
pub fn carried(urdf: &Urdf, tree: &Tree<'_>, way: &LinkChain, lib: &mut Library<'_>) -> Vec<Carried> {
    let mut open = vec![Carried { link: way.base, frame: 0, pose: Pose::identity() }];
    let mut all = Vec::new();
    while let Some(at) = open.pop() {
        for &j in &tree.below[at.link] {
            let joint = &urdf.joints[j];
            let moves = joint.kind != UrdfJointKind::Fixed;
            if moves && !way.joints.contains(&j) {
                continue;
            }
            let Some(link) = tree.link(&joint.child, lib) else { continue };
            let frame = at.frame + usize::from(moves);
            open.push(Carried { link, frame, pose: at.pose * joint.origin });
        }
        all.push(at);
    }
    all.sort_by_key(|c| (c.frame, c.link));
    all
}

/// Reads the collision shapes of the carried links; each solid is named after its link.
pub fn read(
    urdf: &Urdf,
    carried: &[Carried],
    derived: &Derived,
    packages: &RosPackages,
    lib: &mut Library<'_>,
) -> Vec<LinkSolid> {
    let mut solids = Vec::new();
    for c in carried {
        let link = &urdf.links[c.link];
        let Some(name) = value::checked_name(&link.name.name, link.name.at, lib) else { continue };
        // Solids of link 0 are in the frame of the base link, other solids in the D-H frame of their link.
        let frame = if c.frame == 0 { Pose::identity() } else { derived.frames[c.frame].inverse() };
        let frame = frame * c.pose;
        for (k, collision) in link.collisions.iter().enumerate() {
            let pose = frame * collision.pose;
            let Some(shape) = shape(&name, collision, pose, packages, lib) else { continue };
            let name = if k == 0 { name.clone() } else { format!("{name} #{}", k + 1) };
            solids.push(LinkSolid { link: c.frame, solid: Solid { name, shape } });
        }
    }
    solids
}

fn shape(
    link: &str,
    collision: &Collision,
    pose: Pose,
    packages: &RosPackages,
    lib: &mut Library<'_>,
) -> Option<Shape> {
    let size = match &collision.geometry {
        Geometry::Box(size) => size.amax(),
        Geometry::Cylinder { radius, length } => radius.max(*length),
        Geometry::Sphere(radius) => *radius,
        Geometry::Mesh { .. } => 0.0,
    };
    if size.max(collision.pose.translation.amax()) > TOO_LONG {
        let message = format!("a collision shape of link `{}` is larger than {TOO_LONG} m", shown(link));
        lib.error(collision.at, message, "a URDF states lengths in m: is this shape in mm?");
        return None;
    }
    Some(match &collision.geometry {
        Geometry::Box(size) => Shape::Box { pose, size: *size },
        Geometry::Sphere(radius) => Shape::Sphere { centre: pose.translation, radius: *radius },
        Geometry::Cylinder { radius, length } => {
            let end = |half: f64| pose.transform(&Vector3::new(0.0, 0.0, half));
            Shape::Cylinder { a: end(-length / 2.0), b: end(length / 2.0), radius: *radius }
        }
        Geometry::Mesh { file, scale } => return read_mesh(file, scale, &pose, packages, lib),
    })
}

/// Reads a collision mesh. `scale` converts its coordinates to m.
fn read_mesh(
    file: &Named,
    scale: &Vector3<f64>,
    pose: &Pose,
    packages: &RosPackages,
    lib: &mut Library<'_>,
) -> Option<Shape> {
    let path = packages.path(file, lib)?;
    if scale.iter().any(|s| *s == 0.0) {
        lib.error(
            file.at,
            "a mesh scaled by 0 is flat".into(),
            "give it a scale other than 0, for example 0.001 for a mesh in mm",
        );
        return None;
    }
    let before = lib.faults.len();
    let is_mesh = mesh::is_mesh(&file.name, file.at, lib);
    let mut shape = if is_mesh { mesh::load(&path, file.at, scale, *pose, lib) } else { None };
    let size = shape.as_ref().map_or(0.0, |shape| {
        let extent = cell::extent(shape);
        (extent.1 - extent.0).amax()
    });
    if size > TOO_LONG {
        let message = format!("the mesh `{}` is {size:.0} m long", shown(&file.name));
        lib.error(
            file.at,
            message,
            "a URDF states lengths in m: give a mesh in mm the scale 0.001 0.001 0.001",
        );
        shape = None;
    }
    lib.faults[before..].iter_mut().for_each(|fault| fault.mesh = Some(path.clone()));
    shape
}

/// Counts the elements that are not used, including links and joints outside the chain.
pub fn ignored(urdf: &Urdf, carried: &[Carried], motion: &Motion) -> Vec<(String, usize)> {
    let links = urdf.links.len() - carried.len();
    let fixed = carried.len().saturating_sub(motion.axes.len() + 1);
    let joints = urdf.joints.len().saturating_sub(motion.axes.len() + fixed);
    let off = [("links off the chain", links), ("joints off the chain", joints)];
    let off = off.into_iter().filter(|(_, n)| *n > 0).map(|(what, n)| (what.to_string(), n));
    off.chain(urdf.ignored.iter().map(|(what, n)| (what.clone(), *n))).collect()
}
