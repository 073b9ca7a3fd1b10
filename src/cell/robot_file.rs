//! Robot files: D-H rows, joint coupling, tool, solids, error sets.

use super::document::{Library, Node, Value};
use super::fault::{Severity, shown};
use super::model::*;
use super::reader::{Must, Table};
use super::solid;
use crate::pose::Pose;
use crate::units;
use nalgebra::Vector3;

/// Reads the robot part of a table that may hold more (the cell's base pose); the caller finishes it.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Robot> {
    super::header(t, "robot", lib);
    let name = t.text("name", lib).and_then(|n| solid::checked_name(n, t.at, lib));
    let source = t.text("source", lib);
    let joints = read_joints(t, lib)?;
    let n = joints.len();
    let coupling = read_coupling(t, n, lib);
    let tool = read_tool(t, lib);
    let solids = read_solids(t, n, lib);
    let base: Vec<_> = solids.iter().flatten().filter(|s| s.link == 0).map(|s| &s.solid.shape).collect();
    let footprint = solid::read_footprint(t, solid::extent_of(base), lib);
    let errors = read_errors(t, &joints, lib);
    let (tool, tool_axis) = tool?;
    let (name, source, coupling) = (name?, source?, coupling?);
    Some(Robot {
        name,
        source,
        joints,
        coupling,
        tool,
        tool_axis,
        solids: solids?,
        footprint: footprint?,
        errors: errors?,
    })
}

fn read_joints(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Vec<Joint>> {
    let node = t.need("joint", lib)?;
    let Value::Array(rows) = &node.value else {
        lib.error(node.at, "`joint` must be a list of D-H rows".into(), "write [[joint]] before each one");
        return None;
    };
    if rows.is_empty() || rows.len() > MAX_JOINTS {
        lib.error(node.at, format!("{} joints; a robot has 1 to {MAX_JOINTS}", rows.len()), "");
        return None;
    }
    let joints: Vec<_> = rows.iter().map(|row| read_joint(row, lib)).collect();
    let joints: Vec<Joint> = joints.into_iter().collect::<Option<_>>()?;
    let revolute = || joints.iter().filter(|j| j.kind == JointKind::Revolute);
    let radians = |j: &Joint| j.limits.0.abs().max(j.limits.1.abs()) <= units::rad_from_deg(7.0);
    if revolute().count() > 0 && revolute().all(radians) {
        let message = "no joint may turn more than 7 degrees".to_string();
        lib.fault(node.at, Severity::Warning, message, "are the limits in radians? they are read in degrees");
    }
    Some(joints)
}

fn read_joint(row: &Node, lib: &mut Library<'_>) -> Option<Joint> {
    let mut t = Table::of(row, "a joint", lib)?;
    let name = t.text("name", lib).and_then(|n| solid::checked_name(n, t.at, lib));
    let kinds = [JointKind::Revolute, JointKind::Prismatic];
    let word = |k| if k == JointKind::Revolute { "revolute" } else { "prismatic" };
    let kind = t.choice("kind", &kinds, word, Some(JointKind::Revolute), lib)?;
    let revolute = kind == JointKind::Revolute;
    let theta = t.angle(if revolute { "q_offset_deg" } else { "theta_deg" }, lib);
    let r = t.length("r_mm", Must::BeFinite, lib);
    let l = t.length("l_mm", Must::BeFinite, lib);
    let alpha = t.angle("alpha_deg", lib);
    let (key, si): (_, fn(f64) -> f64) =
        if revolute { ("limits_deg", units::rad_from_deg) } else { ("limits_mm", units::m_from_mm) };
    let place = t.get(key).map_or(t.at, |n| n.at);
    let limits = t.numbers(key, 2, Must::BeFinite, lib);
    t.finish(lib);
    let limits = limits?;
    if limits[0] >= limits[1] {
        let help = format!("write {key} = [{}, {}]", limits[1].min(limits[0]), limits[0].max(limits[1]));
        lib.error(place, format!("limits reversed: {} is not below {}", limits[0], limits[1]), help);
        return None;
    }
    Some(Joint {
        name: name?,
        kind,
        theta: theta?,
        r: r?,
        l: l?,
        alpha: alpha?,
        limits: (si(limits[0]), si(limits[1])),
    })
}

/// Row i of `coupling` says how the D-H coordinate i follows the actuators.
fn read_coupling(t: &mut Table<'_>, n: usize, lib: &mut Library<'_>) -> Option<Vec<Vec<f64>>> {
    let Some(node) = t.get("coupling") else {
        let unit = |i| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        return Some((0..n).map(unit).collect());
    };
    let help = "row i gives the D-H coordinate i as a sum of the actuators 1 to i, itself with factor 1";
    let rows = match &node.value {
        Value::Array(rows) if rows.len() == n => rows,
        _ => {
            lib.error(node.at, format!("`coupling` must be {n} rows of {n} numbers"), help);
            return None;
        }
    };
    let mut matrix = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let values = match &row.value {
            Value::Array(items) if items.len() == n => {
                let values: Vec<_> = items
                    .iter()
                    .map(|x| super::reader::number(x, "a coupling factor", Must::BeFinite, lib))
                    .collect();
                values.into_iter().collect::<Option<Vec<f64>>>()?
            }
            _ => {
                lib.error(row.at, format!("row {} of `coupling` must have {n} numbers", i + 1), help);
                return None;
            }
        };
        if values[i] != 1.0 || values[i + 1..].iter().any(|&v| v != 0.0) {
            lib.error(
                row.at,
                format!("row {} of `coupling` does not end with a 1 on the diagonal", i + 1),
                help,
            );
            return None;
        }
        matrix.push(values);
    }
    Some(matrix)
}

/// `[tool]`: `position_mm`, `rpy_deg` of the TCP in the mechanical interface, and the tool `axis`.
fn read_tool(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(Pose, Vector3<f64>)> {
    let node = t.need("tool", lib)?;
    let mut t = Table::of(node, "`tool`", lib)?;
    let pose = solid::read_pose(&mut t, "position_mm", lib);
    let place = t.get("axis").map_or(t.at, |n| n.at);
    let axis = t.numbers("axis", 3, Must::BeFinite, lib);
    t.finish(lib);
    let axis = axis.map(|v| Vector3::new(v[0], v[1], v[2]))?;
    let Some(unit) = axis.try_normalize(1e-9) else {
        lib.error(place, "the tool axis has no direction".into(), "for example axis = [1, 0, 0]");
        return None;
    };
    Some((pose?, unit))
}

fn read_solids(t: &mut Table<'_>, n: usize, lib: &mut Library<'_>) -> Option<Vec<LinkSolid>> {
    let nodes = solid::list(t, lib);
    let mut solids: Vec<LinkSolid> = Vec::new();
    let mut sound = true;
    for node in nodes {
        let Some(mut t) = Table::of(node, "a solid", lib) else {
            sound = false;
            continue;
        };
        let link = match t.need("link", lib) {
            Some(link) => super::reader::integer(link, "link", (0, n as u64), lib),
            None => None,
        };
        let read = solid::read(&mut t, solid::Carrier::Link, lib);
        t.finish(lib);
        match link.zip(read) {
            Some((_, s)) if solids.iter().any(|k| k.solid.name == s.name) => {
                super::duplicate_solid(&s.name, node.at, lib);
                sound = false;
            }
            Some((link, solid)) => solids.push(LinkSolid { link: link as usize, solid }),
            None => sound = false,
        }
    }
    sound.then_some(solids)
}

fn read_errors(t: &mut Table<'_>, joints: &[Joint], lib: &mut Library<'_>) -> Option<Vec<SignedErrors>> {
    let node = t.need("errors", lib)?;
    let sets = Table::of(node, "`errors`", lib)?;
    let mut read = Vec::new();
    let mut sound = true;
    for (name, at, node) in sets.named() {
        let set = read_error_set(name, node, joints, lib);
        let named = solid::checked_name(name.to_string(), at, lib).is_some();
        sound &= set.is_some() && named;
        read.extend(set);
    }
    if read.is_empty() && sound {
        lib.error(node.at, "no error set".into(), "add for example [errors.table-2]");
        return None;
    }
    sound.then_some(read)
}

fn read_error_set(name: &str, node: &Node, joints: &[Joint], lib: &mut Library<'_>) -> Option<SignedErrors> {
    let n = joints.len();
    let mut t = Table::of(node, "an error set", lib)?;
    t.text("source", lib);
    // A tolerance will be a type of its own; the word keeps the two apart in files from the start.
    t.choice("kind", &["signed"], |k| k, None, lib)?;
    let lengths = |v: Vec<f64>| v.into_iter().map(units::m_from_mm).collect::<Vec<_>>();
    let angles = |v: Vec<f64>| v.into_iter().map(units::rad_from_deg).collect::<Vec<_>>();
    let dq_deg = t.numbers_or_zero("dq_deg", n, lib);
    let dq_mm = t.numbers_or_zero("dq_mm", n, lib);
    let dr = t.numbers("dr_mm", n, Must::BeFinite, lib).map(lengths);
    let dl = t.numbers("dl_mm", n, Must::BeFinite, lib).map(lengths);
    let dalpha = t.numbers("dalpha_deg", n, Must::BeFinite, lib).map(angles);
    let place = t.at;
    t.finish(lib);
    let (dq_deg, dq_mm) = (dq_deg?, dq_mm?);
    for (i, joint) in joints.iter().enumerate() {
        let (wrong, key, right) = match joint.kind {
            JointKind::Revolute => (dq_mm[i], "dq_mm", "dq_deg"),
            JointKind::Prismatic => (dq_deg[i], "dq_deg", "dq_mm"),
        };
        if wrong != 0.0 {
            let message =
                format!("{key}[{i}] of `{}` does not fit the kind of joint `{}`", shown(name), joint.name);
            lib.error(place, message, format!("give it in {right}"));
            return None;
        }
    }
    // One of the two is zero for every joint.
    let dq = angles(dq_deg).iter().zip(lengths(dq_mm)).map(|(a, b)| a + b).collect();
    Some(SignedErrors { name: name.to_string(), dq, dr: dr?, dl: dl?, dalpha: dalpha? })
}
