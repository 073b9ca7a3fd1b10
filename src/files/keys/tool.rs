//! Tools, held parts, and which solids of a robot may touch each other.

use super::solid;
use super::solid::Carrier;
use crate::cell::Held;
use crate::cell::Solid;
use crate::cell::{LinkSolid, SelfCollision};
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::Must;
use crate::pose::Pose;
use nalgebra::Vector3;

/// A tool in the frame of the mechanical interface.
pub struct Tool {
    /// Of the TCP.
    pub pose: Pose,
    /// Working direction in the frame of the TCP, unit length.
    pub axis: Vector3<f64>,
    solids: Vec<Solid>,
    at: At,
}

/// `[tool]`, or the file that it is `from`: `position_mm`, `rpy_deg` of the TCP in the mechanical
/// interface, the tool `axis`, and `solid`s in the frame of the mechanical interface.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Tool> {
    let node = t.need("tool", "add tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }")?;
    Table::read(node, "`tool`", lib, |t, lib| {
        crate::files::header::header(t, "tool", lib)?;
        t.text_or("name", "", lib);
        t.text_or("source", "", lib);
        let pose = t.pose("position_mm", lib);
        let solids = solid::read_all(t, Carrier::Link, lib, |_, solid, _| solid);
        let node = t.need("axis", "add axis = [1, 0, 0], the working direction of the tool")?;
        let axis = value::numbers(node, "`axis`", 3, Must::BeFinite, lib)?;
        let unit = Vector3::from_iterator(axis).try_normalize(1e-9);
        if unit.is_none() {
            let help = "write the working direction of the tool, for example axis = [1, 0, 0]";
            lib.error(node.at, "the tool `axis` has no direction".into(), help);
        }
        Some(Tool { pose: pose?, axis: unit?, solids, at: t.at })
    })
}

/// Puts the solids of the tool behind those of the links; the mechanical interface is at `tip` in the
/// frame after the last row.
pub fn mount(
    tool: &Option<Tool>,
    (interface, tip): (usize, &Pose),
    solids: &mut Vec<LinkSolid>,
    lib: &mut Library<'_>,
) {
    let Some(tool) = tool else { return };
    for solid in &tool.solids {
        if solids.iter().any(|s| s.solid.name == solid.name) {
            let message = format!("a solid of the tool has the name of one of the robot: `{}`", solid.name);
            lib.error(tool.at, message, "give each a name of its own: reasons name the solids");
        }
        let Solid { name, shape } = solid.clone();
        solids.push(LinkSolid { link: interface, solid: Solid { name, shape: shape.seen_from(tip) } });
    }
}

/// `held` of an operation: `solid`s in the frame of the TCP, `touches_surface`.
pub fn read_held(node: &Node, lib: &mut Library<'_>) -> Option<Held> {
    Table::read(node, "`held`", lib, |t, lib| {
        t.need(
            "solid",
            "add solid = [{ name = \"part\", box = { centre_mm = [0, 0, 0], size_mm = [50, 50, 50] } }]",
        );
        let solids = solid::read_all(t, Carrier::Link, lib, |_, solid, _| solid);
        let touches_surface = t.boolean_or("touches_surface", false, lib);
        Some(Held { solids, touches_surface: touches_surface? })
    })
}

/// `self_collision = false`, or `{ allowed = [["NAME", "NAME"], ...] }`: pairs that may touch.
pub fn read_self_collision(
    t: &mut Table<'_>,
    solids: &[LinkSolid],
    lib: &mut Library<'_>,
) -> Option<SelfCollision> {
    let Some(node) = t.get("self_collision") else { return Some(SelfCollision::default()) };
    if let Value::Boolean(checked) = node.value {
        return Some(SelfCollision { checked, allowed: Vec::new() });
    }
    Table::read(node, "`self_collision`", lib, |t, lib| {
        let node =
            t.need("allowed", "add allowed = [[\"NAME\", \"NAME\"]], pairs of solids that may touch")?;
        let Value::Array(pairs) = &node.value else {
            let message = format!("`allowed` must be a list of pairs, not {}", node.value.kind());
            lib.error(
                node.at,
                message,
                "write allowed = [[\"NAME\", \"NAME\"]], pairs of solids that may touch",
            );
            return None;
        };
        let pairs: Vec<_> = pairs.iter().map(|pair| read_pair(pair, solids, lib)).collect();
        Some(SelfCollision { checked: true, allowed: pairs.into_iter().collect::<Option<_>>()? })
    })
}

fn read_pair(pair: &Node, solids: &[LinkSolid], lib: &mut Library<'_>) -> Option<(usize, usize)> {
    match &pair.value {
        Value::Array(names) if names.len() == 2 => {
            let first = read_name(&names[0], solids, lib);
            first.zip(read_name(&names[1], solids, lib))
        }
        _ => {
            let message = "a pair of `allowed` must be a list of 2 names".to_string();
            lib.error(pair.at, message, "write [\"NAME\", \"NAME\"], two solids that may touch");
            None
        }
    }
}

fn read_name(node: &Node, solids: &[LinkSolid], lib: &mut Library<'_>) -> Option<usize> {
    let name = value::text(node, "allowed", lib)?;
    let found = solids.iter().position(|s| s.solid.name == name);
    if found.is_none() {
        let names = || solids.iter().map(|s| s.solid.name.as_str());
        let help = match did_you_mean(&name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        lib.error(node.at, format!("the robot has no solid `{}`", shown(&name)), help);
    }
    found
}
