//! Reader of robot files: D-H rows, joint coupling, tool, solids, error sets.

use super::error_set;
use super::header::header;
use super::joint;
use super::rate;
use super::solid;
use super::tool;
use super::tool::Tool;
use crate::cell::*;
use crate::files::keys::robot::robot;
use crate::files::keys::solid::link_solid;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::urdf;
use crate::files::urdf::{Named, RosPackages, UrdfChain};
use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Joints of a robot, from rows or from a URDF. A field is None if it could not be read.
struct Mechanism {
    axes: Option<usize>,
    convention: Option<Convention>,
    mount: Pose,
    joints: Option<Vec<Joint>>,
    coupling: Option<Vec<Vec<f64>>>,
    joint_frames: Vec<Pose>,
}

/// Reads the keys of a robot from a table that may have other keys, such as the base placement in a cell.
pub fn read(t: &mut Table) -> Option<Robot> {
    header(t, &robot::SCHEMA)?;
    let urdf = t.get(&robot::URDF);
    let before = t.lib.errors();
    let mut arm = urdf.and_then(|node| read_urdf(t, node));
    let is_read = t.lib.errors() == before;
    let (name, source) = read_names(t, urdf.is_some(), arm.as_ref());
    let drawn = arm.as_mut().map(|arm| std::mem::take(&mut arm.solids)).unwrap_or_default();
    let origin = arm.as_ref().map(|arm| arm.origin.clone());
    let mut from = match urdf {
        Some(node) => read_derived(t, node, arm),
        None => read_rows(t),
    };
    if let Some(joints) = &mut from.joints {
        rate::read_list(t, joints);
    }
    let full_speed_after = t.if_given(&robot::FULL_SPEED_AFTER, Table::number);
    let home = from.joints.as_deref().and_then(|joints| joint::read_home(t, joints));
    let tool = tool::read(t);
    let before = t.lib.errors();
    let n = from.axes.unwrap_or(MAX_JOINTS);
    let mut solids = joined(drawn, read_solids(t, n));
    let tip = origin.as_ref().map_or(Pose::identity(), |origin| origin.tip);
    let own_solids = solids.len();
    tool::mount(&tool, (n, &tip), &mut solids, t);
    let masses = tool::read_masses(t, n);
    let tool_mass = tool.as_ref().and_then(|tool| tool.link_mass((n, &tip)));
    let base = solids.iter().filter(|s| s.link == 0).map(|s| &s.solid.shape);
    let needed: &[_] = if is_read && t.lib.errors() == before { &["footprint"] } else { &[] };
    let footprint = solid::read_footprint(t, &robot::FOOTPRINT, extent_of(base), needed);
    let self_collision = tool::read_self_collision(t, &solids);
    let errors =
        error_set::read_all(t, from.axes, from.joints.as_deref(), from.convention, from.coupling.as_deref());
    let (Tool { pose: tool, axis: tool_axis, .. }, footprint) = (tool?, footprint?);
    let Mechanism { mut mount, joint_frames, .. } = from;
    let (convention, mut joints, coupling) = (from.convention?, from.joints?, from.coupling?);
    let mut masses = masses?;
    if convention == Convention::Modified {
        onto_standard_rows(&mut solids, &joints);
        masses_onto_standard_rows(&mut masses, &joints);
        mount = standard_rows(&mut joints);
    }
    Some(Robot {
        name: name?,
        source: source?,
        convention,
        mount,
        joints,
        coupling,
        joint_frames,
        home: home?,
        tool: tip * tool,
        tool_axis,
        tool_solids: solids.len() - own_solids,
        masses: masses.into_iter().chain(tool_mass).collect(),
        solids,
        self_collision: self_collision?,
        full_speed_after: full_speed_after?,
        footprint,
        errors,
        urdf: origin,
    })
}

/// Reads the URDF that a robot file names, with its keys `base_link`, `tip_link` and `packages`.
fn read_urdf(t: &mut Table, node: &Node) -> Option<urdf::UrdfRobot> {
    let packages = read_packages(t);
    let [base, tip] = [robot::BASE_LINK, robot::TIP_LINK].map(|key| {
        let at = t.get(&key)?.at;
        t.text(&key).map(|name| Named { name, at })
    });
    let file = Named { name: t.text(&robot::URDF)?, at: node.at };
    urdf::read(UrdfChain { file, base, tip, packages }, t.lib)
}

/// Reads `packages = { NAME = "FOLDER" }` of a robot. Folders are relative to the file that names them.
fn read_packages(t: &mut Table) -> RosPackages {
    let key = robot::PACKAGES;
    let Some(node) = t.get(&key) else { return RosPackages::default() };
    if !matches!(node.value, Value::Table(_)) {
        let message = format!("`packages` must be a TOML table, not {}", node.value.kind());
        t.error(node.at, message, format!("write packages = {}", key.example));
    }
    let mut folders = Vec::new();
    for (name, _, node) in node.value.entries() {
        let folder = value::text(node, key.name, t.lib);
        let folder = folder.and_then(|folder| t.lib.relative(folder.trim_end_matches('/'), node.at));
        folders.extend(folder.map(|folder| (name.clone(), folder)));
    }
    RosPackages(folders)
}

/// Reads `name` and `source`, which a URDF robot may omit.
fn read_names(
    t: &mut Table,
    is_urdf: bool,
    arm: Option<&urdf::UrdfRobot>,
) -> (Option<String>, Option<String>) {
    if !is_urdf {
        return (t.name(&robot::NAME), t.text(&robot::SOURCE));
    }
    let named = arm.and_then(|arm| arm.name.clone());
    let name = t.if_given(&robot::NAME, Table::name);
    let file = arm.map_or("", |arm| &arm.origin.file);
    let source = t.text_or(&robot::SOURCE, &format!("the URDF {file}"));
    (name.map(|name| name.unwrap_or(named.unwrap_or("robot".into()))), source)
}

fn read_rows(t: &mut Table) -> Mechanism {
    let convention = t.word(&robot::CONVENTION);
    let rows = t.items(&robot::JOINT);
    let joints = rows.and_then(|_| joint::read_all(t));
    let coupling = rows.and_then(|rows| joint::read_coupling(t, rows.len()));
    if let (Some(rows), Some(joints), Some(coupling)) = (rows, &joints, &coupling) {
        joint::refuse_idle(rows, joints, coupling, t);
    }
    let axes = rows.map(<[_]>::len);
    let joint_frames = vec![Pose::identity(); axes.unwrap_or(0)];
    Mechanism { axes, convention, mount: Pose::identity(), joints, coupling, joint_frames }
}

/// Returns the joints with the rows derived from a URDF. Records a fault if the robot file has rows, too.
fn read_derived(t: &mut Table, node: &Node, arm: Option<urdf::UrdfRobot>) -> Mechanism {
    for key in [robot::JOINT, robot::COUPLING, robot::CONVENTION] {
        if t.get(&key).is_some() {
            let message = format!("`urdf` and `{}` cannot be given together: both define the rows", key.name);
            t.error(node.at, message, format!("remove `{}`, or name another robot file in `from`", key.name));
        }
    }
    let mount = arm.as_ref().map_or(Pose::identity(), |arm| arm.mount);
    let axes = arm.as_ref().map(|arm| arm.joints.len());
    let (joints, coupling, joint_frames) =
        arm.map(|arm| (Some(arm.joints), Some(arm.coupling), arm.joint_frames)).unwrap_or_default();
    Mechanism { axes, convention: Some(Convention::Standard), mount, joints, coupling, joint_frames }
}

/// Joins the solids of a URDF and the solids of the robot file.
///
/// Solids of the URDF are renamed if necessary, because messages need unique names.
fn joined(mut drawn: Vec<LinkSolid>, own: Vec<LinkSolid>) -> Vec<LinkSolid> {
    let mut names: HashSet<String> = own.iter().map(|s| s.solid.name.clone()).collect();
    for solid in &mut drawn {
        while !names.insert(solid.solid.name.clone()) {
            solid.solid.name.push('\'');
        }
    }
    drawn.extend(own);
    drawn
}

/// Converts modified D-H rows to standard rows; returns the mount, which is the pose of frame 0 in the base.
///
/// The common normal and twist of a row move to the preceding row. The common normal and twist of the first
/// row become the mount. The conversion is exact, because a translation along x and a rotation about x
/// commute.
fn standard_rows(joints: &mut [Joint]) -> Pose {
    let mount = common_normal(&joints[0]);
    for i in 0..joints.len() {
        (joints[i].l, joints[i].alpha) = joints.get(i + 1).map_or((0.0, 0.0), |next| (next.l, next.alpha));
    }
    mount
}

/// Converts the solids of every link from the frame after its modified row to the frame after its
/// standard row. The position of the solids on the robot does not change.
///
/// The two frames differ by the common normal and twist of the next row.
fn onto_standard_rows(solids: &mut [LinkSolid], rows: &[Joint]) {
    for solid in solids.iter_mut().filter(|s| s.link > 0 && s.link < rows.len()) {
        let shape = solid.solid.shape.clone();
        solid.solid.shape = shape.seen_from(&common_normal(&rows[solid.link]).inverse());
    }
}

/// Converts the masses of every link from the frame after its modified row to the frame after its standard
/// row.
fn masses_onto_standard_rows(masses: &mut [LinkMass], rows: &[Joint]) {
    for mass in masses.iter_mut().filter(|m| m.link < rows.len()) {
        mass.centre = common_normal(&rows[mass.link]).inverse().transform(&mass.centre);
    }
}

/// Returns the transform `Tx(l) Rx(alpha)` of a row: a rotation about x by alpha, then a translation along x
/// by l.
fn common_normal(row: &Joint) -> Pose {
    Pose::from_translation_rpy(Vector3::new(row.l, 0.0, 0.0), Vector3::new(row.alpha, 0.0, 0.0))
}

fn read_solids(t: &mut Table, n: usize) -> Vec<LinkSolid> {
    solid::read_each(t, &robot::SOLID, |t, solid| {
        let link = value::whole(t.get(&link_solid::LINK)?, "`link`", (0, n as u64), t.lib)?;
        Some(LinkSolid { link: link as usize, solid: solid? })
    })
}
