//! Outline of a URDF: the chain to a guessed or stated tip link, and the meshes of the links. The outline
//! requires no robot file.

use super::fault_list::Faults;
use super::model::{Geometry, Named, Urdf};
use super::tree::Tree;
use super::{dh, motion, parse, solids, tip};
use crate::files::fault::Severity;
use crate::files::toml::document::Library;
use nalgebra::Vector3;

/// Outline of a URDF, read without its meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOutline {
    /// Name of the robot, if it is a valid name.
    pub name: Option<String>,
    pub base_link: String,
    pub tip_link: String,
    /// Whether the tip link is a guess.
    pub is_guessed: bool,
    /// Name of the last moving joint before the tip link.
    pub last_joint: String,
    /// Number of moving joints from base to tip link.
    pub joints: usize,
    /// Guessed working direction of the tool in the frame of the tip link.
    pub direction: Vector3<f64>,
    /// Links of the chain, and links that are fixed to the chain.
    pub links: Vec<String>,
    /// Moving joints that are not on the chain, such as the joints of a gripper.
    pub joints_off: Vec<String>,
    /// Collision shapes of the links in `links`; each entry holds a number and a text. The number states how
    /// many moving joints are between base and link. The text is the name of the mesh file in the URDF; None
    /// for a shape without a mesh.
    pub shapes: Vec<(usize, Option<String>)>,
}

/// Reads the outline of the URDF at `path`. `tip` names the tip link. If `tip` is None, the tip link is
/// guessed.
pub fn outline(path: &str, tip: Option<&str>, lib: &mut Library<'_>) -> Option<UrdfOutline> {
    let file = lib.text(path, None)?;
    let urdf = parsed(file, lib)?;
    let tree = Tree::new(&urdf, lib)?;
    let base = tree.root(urdf.at, lib)?;
    let end = match tip {
        Some(name) => tree.link(&Named { name: name.into(), at: urdf.at }, lib)?,
        None => tip::guess(&urdf, &tree, base),
    };
    let way = tree.way(Some(Some(base)), Some(Some(end)), urdf.at, lib)?;
    let motion = motion::read(&urdf, &way, lib)?;
    let derived = dh::derive(&motion.axes, &motion.flange);
    motion::warn_of_slants(&urdf, &way, &motion, &derived, lib);
    let carried = solids::carried(&urdf, &tree, &way, lib);
    super::tell_ignored(&solids::ignored(&urdf, &carried, &motion), urdf.at, lib);
    let name = |link: usize| urdf.links[link].name.name.clone();
    let moving = |j: &usize| urdf.joints[*j].kind != super::model::UrdfJointKind::Fixed;
    let off = (0..urdf.joints.len()).filter(|j| moving(j) && !way.joints.contains(j));
    let shapes = carried.iter().flat_map(|c| {
        urdf.links[c.link].collisions.iter().map(|collision| {
            let mesh = match &collision.geometry {
                Geometry::Mesh { file, .. } => Some(file.name.clone()),
                _ => None,
            };
            (c.frame, mesh)
        })
    });
    Some(UrdfOutline {
        name: urdf.name.clone(),
        base_link: name(base),
        tip_link: name(end),
        is_guessed: tip.is_none(),
        last_joint: motion.movers.last().map_or(String::new(), |mover| mover.name.clone()),
        joints: motion.axes.len(),
        direction: tip::working_direction(&motion),
        links: carried.iter().map(|c| name(c.link)).collect(),
        joints_off: off.map(|j| urdf.joints[j].name.name.clone()).collect(),
        shapes: shapes.collect(),
    })
}

/// Parses the URDF with index `file`, and warns of angles that are read as right angles.
pub fn parsed(file: usize, lib: &mut Library<'_>) -> Option<Urdf> {
    let mut faults = Faults::new(file);
    let urdf = parse::parse(lib.sources[file].text(), &mut faults).filter(|_| faults.is_empty());
    let (count, largest) = faults.snapped;
    faults.tell(lib);
    let urdf = urdf?;
    if count > 0 {
        let message = match count {
            1 => "1 angle is a rounded right angle, and is read as an exact right angle".to_string(),
            _ => format!("{count} angles are rounded right angles, and are read as exact right angles"),
        };
        let help = format!(
            "the largest change is {largest:.1e} rad; for example, 1.5708 is read as exactly 90 degrees"
        );
        lib.fault(urdf.at, Severity::Warning, message, help);
    }
    Some(urdf)
}
