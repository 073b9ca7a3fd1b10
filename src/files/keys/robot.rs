//! Robot files: D-H rows, joint coupling, tool, solids, error sets.

use super::error_set;
use super::solid;
use super::solid::Carrier;
use super::tool;
use super::tool::Tool;
use crate::cell::*;
use crate::files::fault::{Severity, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::files::urdf;
use crate::pose::Pose;
use crate::units;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Limits of at most so many degrees on every joint look like radians.
const RADIANS: f64 = 7.0;

/// A passive joint turns with others, by the coupling alone.
pub const KINDS: [&str; 3] = ["revolute", "prismatic", "passive"];

const STANDARD: Option<Convention> = Some(Convention::Standard);

/// The joints of a robot, from rows or from a URDF; None is what could not be read.
struct Mechanism {
    axes: Option<usize>,
    convention: Option<Convention>,
    mount: Pose,
    joints: Option<Vec<Joint>>,
    coupling: Option<Vec<Vec<f64>>>,
    joint_frames: Vec<Pose>,
}

/// Reads the robot part of a table that may hold more (the cell's base pose).
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Robot> {
    crate::files::header::header(t, "robot", lib)?;
    let urdf = t.get("urdf");
    let before = lib.errors();
    let mut arm = urdf.and_then(|node| urdf::read(t, node, lib));
    let is_read = lib.errors() == before;
    let (name, source) = read_names(t, urdf.is_some(), arm.as_ref(), lib);
    let drawn = arm.as_mut().map(|arm| std::mem::take(&mut arm.solids)).unwrap_or_default();
    let origin = arm.as_ref().map(|arm| arm.origin.clone());
    let from = match urdf {
        Some(node) => read_derived(t, node, arm, lib),
        None => read_rows(t, lib),
    };
    let home = t.get("home");
    let home = from.joints.as_deref().and_then(|joints| read_home(home, joints, lib));
    let tool = tool::read(t, lib);
    let before = lib.errors();
    let n = from.axes.unwrap_or(MAX_JOINTS);
    let mut solids = joined(drawn, read_solids(t, n, lib));
    let tip = origin.as_ref().map_or(Pose::identity(), |origin| origin.tip);
    let own_solids = solids.len();
    tool::mount(&tool, (n, &tip), &mut solids, lib);
    let base = solids.iter().filter(|s| s.link == 0).map(|s| &s.solid.shape);
    let needed: &[_] = if is_read && lib.errors() == before { &["footprint"] } else { &[] };
    let footprint = solid::read_footprint(t, extent_of(base), needed, lib);
    let self_collision = tool::read_self_collision(t, &solids, lib);
    let errors = error_set::read_all(t, from.axes, from.joints.as_deref(), from.convention, lib);
    let (Tool { pose: tool, axis: tool_axis, .. }, footprint) = (tool?, footprint?);
    let Mechanism { mut mount, joint_frames, .. } = from;
    let (convention, mut joints, coupling) = (from.convention?, from.joints?, from.coupling?);
    if convention == Convention::Modified {
        onto_standard_rows(&mut solids, &joints);
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
        solids,
        self_collision: self_collision?,
        footprint,
        errors,
        urdf: origin,
    })
}

/// `name` and `source`; those of a URDF robot may be missing.
fn read_names(
    t: &mut Table<'_>,
    is_urdf: bool,
    arm: Option<&urdf::Arm>,
    lib: &mut Library<'_>,
) -> (Option<String>, Option<String>) {
    if !is_urdf {
        return (t.name(lib), t.text("source", lib));
    }
    let named = arm.and_then(|arm| arm.name.clone());
    let name = t.get("name").is_some().then(|| t.name(lib));
    let file = arm.map_or("", |arm| &arm.origin.file);
    let source = t.text_or("source", &format!("the URDF {file}"), lib);
    (name.unwrap_or_else(|| Some(named.unwrap_or("robot".into()))), source)
}

fn read_rows(t: &mut Table<'_>, lib: &mut Library<'_>) -> Mechanism {
    let convention = t.choice("convention", &Convention::ALL, Convention::name, STANDARD, lib);
    let rows = joint_rows(t, lib);
    let joints = rows.and_then(|rows| read_joints(rows, t.get("joint")?, lib));
    let coupling = t.get("coupling");
    let coupling = rows.and_then(|rows| read_coupling(coupling, rows.len(), lib));
    if let (Some(rows), Some(joints), Some(coupling)) = (rows, &joints, &coupling) {
        refuse_idle(rows, joints, coupling, lib);
    }
    let axes = rows.map(<[_]>::len);
    let joint_frames = vec![Pose::identity(); axes.unwrap_or(0)];
    Mechanism { axes, convention, mount: Pose::identity(), joints, coupling, joint_frames }
}

/// The rows derived from a URDF: beside it there are none of the file.
fn read_derived(t: &mut Table<'_>, node: &Node, arm: Option<urdf::Arm>, lib: &mut Library<'_>) -> Mechanism {
    for key in ["joint", "coupling", "convention"].into_iter().filter(|key| t.get(key).is_some()) {
        let message = format!("`urdf` and `{key}` together: the rows come from one of them");
        lib.error(node.at, message, format!("remove `{key}`, or name another robot file in `from`"));
    }
    let mount = arm.as_ref().map_or(Pose::identity(), |arm| arm.mount);
    let axes = arm.as_ref().map(|arm| arm.joints.len());
    let (joints, coupling, joint_frames) =
        arm.map(|arm| (Some(arm.joints), Some(arm.coupling), arm.joint_frames)).unwrap_or_default();
    Mechanism { axes, convention: STANDARD, mount, joints, coupling, joint_frames }
}

/// The solids of a URDF and those of the file; reasons name them, so that names differ.
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

/// Makes standard rows of modified ones: a row's common normal and twist go to the row before it, for
/// `Tx Rx` commute; those of the first are where the chain stands on the base.
fn standard_rows(joints: &mut [Joint]) -> Pose {
    let mount = common_normal(&joints[0]);
    for i in 0..joints.len() {
        (joints[i].l, joints[i].alpha) = joints.get(i + 1).map_or((0.0, 0.0), |next| (next.l, next.alpha));
    }
    mount
}

/// The solids of link k are drawn in the frame after row k of the file, from which the standard one is
/// the next common normal away.
fn onto_standard_rows(solids: &mut [LinkSolid], rows: &[Joint]) {
    for solid in solids.iter_mut().filter(|s| s.link > 0 && s.link < rows.len()) {
        let shape = solid.solid.shape.clone();
        solid.solid.shape = shape.seen_from(&common_normal(&rows[solid.link]).inverse());
    }
}

/// `Tx(l) Rx(alpha)` of a row.
fn common_normal(row: &Joint) -> Pose {
    Pose::from_translation_rpy(Vector3::new(row.l, 0.0, 0.0), Vector3::new(row.alpha, 0.0, 0.0))
}

/// A passive joint that nothing moves is none.
fn refuse_idle(rows: &[Node], joints: &[Joint], coupling: &[Vec<f64>], lib: &mut Library<'_>) {
    for (i, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.is_passive()) {
        let meant = rows[i].value.get("kind").is_some();
        if meant && coupling[i][..i].iter().all(|&c| c == 0.0) {
            let message = format!("nothing moves the passive joint `{}`", shown(&joint.name));
            lib.error(rows[i].at, message, "say in its row of `coupling` which actuators it follows");
        }
    }
}

fn joint_rows<'n>(t: &mut Table<'n>, lib: &mut Library<'_>) -> Option<&'n [Node]> {
    let node = t.need("joint", "add a [[joint]] for every D-H row, with its limits")?;
    let Value::Array(rows) = &node.value else {
        let message = format!("`joint` must be a list of D-H rows, not {}", node.value.kind());
        lib.error(node.at, message, "write [[joint]] above the keys of each row");
        return None;
    };
    if rows.is_empty() || rows.len() > MAX_JOINTS {
        let message = format!("a robot has 1 to {MAX_JOINTS} joints, not {}", rows.len());
        lib.error(node.at, message, "write one [[joint]] for each moving axis");
        return None;
    }
    Some(rows)
}

fn read_joints(rows: &[Node], node: &Node, lib: &mut Library<'_>) -> Option<Vec<Joint>> {
    let joints: Vec<_> = rows.iter().map(|row| read_joint(row, lib)).collect();
    let joints: Vec<Joint> = joints.into_iter().collect::<Option<_>>()?;
    let mut names = HashSet::new();
    for (joint, row) in joints.iter().zip(rows) {
        if !names.insert(&joint.name) {
            let message = format!("two joints are named `{}`", joint.name);
            lib.error(row.at, message, "give each a name of its own: reasons name the joints");
        }
    }
    let turns = |j: &&Joint| j.kind == JointKind::Revolute && !j.is_passive();
    let mut turning = joints.iter().filter(turns).peekable();
    let small = |j: &Joint| j.limits.0.abs().max(j.limits.1.abs()) <= units::rad_from_deg(RADIANS);
    if turning.peek().is_some() && turning.all(small) {
        let message = format!("no joint may turn more than {RADIANS} degrees");
        lib.fault(node.at, Severity::Warning, message, "are the limits in radians? they are read in degrees");
    }
    Some(joints)
}

fn read_joint(row: &Node, lib: &mut Library<'_>) -> Option<Joint> {
    Table::read(row, "a joint", lib, |t, lib| {
        let name = t.name(lib);
        let r = t.length("r_mm", Must::BeFinite, lib);
        let l = t.length("l_mm", Must::BeFinite, lib);
        let alpha = t.angle("alpha_deg", lib);
        let Some(word) = t.choice("kind", &KINDS, |k| k, Some(KINDS[0]), lib) else {
            // Which other keys it should have is not known.
            t.give_up();
            return None;
        };
        let (revolute, passive) = (word != "prismatic", word == "passive");
        let kind = if revolute { JointKind::Revolute } else { JointKind::Prismatic };
        let theta = t.angle(if revolute { "q_offset_deg" } else { "theta_deg" }, lib);
        let limits = if passive { Some((0.0, 0.0)) } else { read_limits(t, revolute, lib) };
        let (name, theta, limits) = (name?, theta?, limits?);
        Some(Joint { name, kind, theta, r: r?, l: l?, alpha: alpha?, limits })
    })
}

fn read_limits(t: &mut Table<'_>, revolute: bool, lib: &mut Library<'_>) -> Option<(f64, f64)> {
    let (key, si): (_, fn(f64) -> f64) =
        if revolute { ("limits_deg", units::rad_from_deg) } else { ("limits_mm", units::m_from_mm) };
    let node = t.need(key, format!("add {key} = [-90, 90]"))?;
    let limits = value::numbers(node, &format!("`{key}`"), 2, Must::BeFinite, lib)?;
    let (low, high) = (plain(limits[0]), plain(limits[1]));
    if limits[0] > limits[1] {
        let message = format!("`{key}` reversed: {low} is above {high}");
        lib.error(node.at, message, format!("write {key} = [{high}, {low}]"));
    } else if limits[0] == limits[1] {
        let message = format!("`{key}` leave no travel: both are {low}");
        lib.error(node.at, message, "a fixed axis is no joint: put it into the offset of another row");
    }
    Some((si(limits[0]), si(limits[1])))
}

/// Row i of `coupling` says how the D-H coordinate i follows the actuators; missing: as they are.
fn read_coupling(node: Option<&Node>, n: usize, lib: &mut Library<'_>) -> Option<Vec<Vec<f64>>> {
    let Some(node) = node else {
        let unit = |i| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        return Some((0..n).map(unit).collect());
    };
    let rows = match &node.value {
        Value::Array(rows) if rows.len() == n => rows,
        _ => {
            let help = "row i gives the D-H coordinate i as a sum of the actuators";
            lib.error(node.at, format!("`coupling` must be {n} rows of {n} numbers"), help);
            return None;
        }
    };
    let rows: Vec<_> = rows.iter().enumerate().map(|(i, row)| read_coupling_row(row, i, n, lib)).collect();
    rows.into_iter().collect()
}

fn read_coupling_row(row: &Node, i: usize, n: usize, lib: &mut Library<'_>) -> Option<Vec<f64>> {
    let what = format!("row {} of `coupling`", i + 1);
    let values = value::numbers(row, &what, n, Must::BeFinite, lib)?;
    if values[i] != 1.0 || values[i + 1..].iter().any(|&v| v != 0.0) {
        let message = format!("{what} must have 1 as its number {}, and after it only 0", i + 1);
        lib.error(row.at, message, "a coordinate follows its own actuator and those before it");
    }
    Some(values)
}

/// One number for each joint, in its unit; missing: 0, where that is outside the limits their middle.
fn read_home(node: Option<&Node>, joints: &[Joint], lib: &mut Library<'_>) -> Option<JointVector> {
    let mut home = [0.0; MAX_JOINTS];
    let Some(node) = node else {
        for (q, joint) in home.iter_mut().zip(joints) {
            let (low, high) = joint.limits;
            *q = if (low..=high).contains(&0.0) { 0.0 } else { (low + high) / 2.0 };
        }
        return Some(home);
    };
    let given = value::numbers(node, "`home`", joints.len(), Must::BeFinite, lib)?;
    for (i, (joint, &q)) in joints.iter().zip(&given).enumerate() {
        let turns = joint.kind == JointKind::Revolute;
        home[i] = if turns { units::rad_from_deg(q) } else { units::m_from_mm(q) };
        let (low, high) = joint.limits;
        if !(low..=high).contains(&home[i]) {
            let shown_limit = |v| plain(if turns { units::deg_from_rad(v) } else { units::mm_from_m(v) });
            let (low, high, name) = (shown_limit(low), shown_limit(high), shown(&joint.name));
            let message = format!("number {} of `home` is outside the limits of joint `{name}`", i + 1);
            let at = if let Value::Array(items) = &node.value { items[i].at } else { node.at };
            lib.error(at, message, format!("choose it from {low} to {high}, not {}", plain(q)));
        }
    }
    Some(home)
}

fn read_solids(t: &mut Table<'_>, n: usize, lib: &mut Library<'_>) -> Vec<LinkSolid> {
    solid::read_all(t, Carrier::Link, lib, |t, solid, lib| {
        let link = t.need("link", "add link = 0 for the base, k for the frame after row k")?;
        let link = value::integer(link, "`link`", (0, n as u64), lib)?;
        Some(LinkSolid { link: link as usize, solid: solid? })
    })
}
