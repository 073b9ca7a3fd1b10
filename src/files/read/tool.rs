//! Readers of tools, held parts, masses, and pairs of solids of a robot that may touch each other.

use super::header::header;
use super::solid;
use crate::cell::{HeldPart, LinkMass, LinkSolid, SelfCollision, Solid};
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::robot::{held, mass, robot, self_collision, tool};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node, Value};
use crate::files::toml::value;
use crate::pose::Pose;
use nalgebra::Vector3;

/// Tool in the frame of the mechanical interface.
pub struct Tool {
    /// Pose of the TCP.
    pub pose: Pose,
    /// Working direction in the frame of the TCP, unit length.
    pub axis: Vector3<f64>,
    solids: Vec<Solid>,
    /// Mass (kg) and its centre (m).
    mass: (f64, Vector3<f64>),
    at: At,
}

/// Reads `[tool]`: TCP, working direction and solids.
///
/// The TCP and the solids are in the frame of the mechanical interface.
pub fn read(t: &mut Table) -> Option<Tool> {
    t.table(&robot::TOOL, |t| {
        header(t, &tool::SCHEMA)?;
        t.if_given(&tool::NAME, Table::text);
        t.if_given(&tool::SOURCE, Table::text);
        let pose = t.pose(&tool::POSITION, &tool::RPY);
        let solids = solid::read_all(t, &tool::SOLID);
        let (mass, centre) = (t.number(&tool::MASS), t.vector(&tool::CENTRE));
        let node = t.get(&tool::AXIS)?;
        let unit = t.vector(&tool::AXIS)?.try_normalize(1e-9);
        if unit.is_none() {
            let help = "write the working direction of the tool, for example axis = [1, 0, 0]";
            t.error(node.at, "the tool `axis` has no direction", help);
        }
        Some(Tool { pose: pose?, axis: unit?, solids, mass: (mass?, centre?), at: t.at })
    })
}

/// Appends the solids of the tool to the solids of the links.
///
/// `interface` is the index of the last link, which carries the tool. `tip` is the pose of the mechanical
/// interface in the frame after the last row.
pub fn mount(
    tool: &Option<Tool>,
    (interface, tip): (usize, &Pose),
    solids: &mut Vec<LinkSolid>,
    t: &mut Table,
) {
    let Some(tool) = tool else { return };
    for solid in &tool.solids {
        if solids.iter().any(|s| s.solid.name == solid.name) {
            let message =
                format!("a solid of the tool has the same name as a solid of the robot: `{}`", solid.name);
            t.error(
                tool.at,
                message,
                "give each solid a unique name, because messages refer to a solid by its name",
            );
        }
        let Solid { name, shape } = solid.clone();
        solids.push(LinkSolid { link: interface, solid: Solid { name, shape: shape.seen_from(tip) } });
    }
}

/// Reads `mass` of a robot: the masses of its links, in the frames of the file.
pub fn read_masses(t: &mut Table, n: usize) -> Option<Vec<LinkMass>> {
    if t.get(&robot::MASS).is_none() {
        return Some(Vec::new());
    }
    let masses = t.tables(&robot::MASS, |t| {
        let (kg, centre) = (t.number(&mass::MASS), t.vector(&mass::CENTRE));
        let link = value::whole(t.get(&mass::LINK)?, "`link`", (1, n as u64), t.lib)?;
        Some(LinkMass { link: link as usize, mass: kg?, centre: centre? })
    });
    masses?.into_iter().collect()
}

impl Tool {
    /// Returns the mass of the tool as a mass of the last link; None if the tool has no mass.
    ///
    /// `interface` is the index of the last link, which carries the tool. `tip` is the pose of the mechanical
    /// interface in the frame after the last row.
    pub fn link_mass(&self, (interface, tip): (usize, &Pose)) -> Option<LinkMass> {
        let (mass, centre) = self.mass;
        (mass > 0.0).then(|| LinkMass { link: interface, mass, centre: tip.transform(&centre) })
    }
}

/// Reads `held` of an operation: solids in the frame of the TCP.
pub fn read_held(t: &mut Table) -> Option<HeldPart> {
    let solids = solid::read_all(t, &held::SOLID);
    let touches_surface = t.boolean(&held::TOUCHES);
    let (mass, centre) = (t.number(&held::MASS), t.vector(&held::CENTRE));
    Some(HeldPart { solids, touches_surface: touches_surface?, mass: mass?, centre: centre? })
}

/// Reads `self_collision`: true or false, or `{ allowed = [["NAME", "NAME"], ...] }`, the pairs that may
/// touch.
pub fn read_self_collision(t: &mut Table, solids: &[LinkSolid]) -> Option<SelfCollision> {
    let key = robot::SELF_COLLISION;
    let Some(node) = t.get(&key) else { return Some(SelfCollision::default()) };
    if let Value::Boolean(checked) = node.value {
        return Some(SelfCollision { checked, allowed: Vec::new() });
    }
    t.table(&key, |t| {
        let pairs = t.items(&self_collision::ALLOWED)?;
        let pairs: Vec<_> = pairs.iter().map(|pair| read_pair(pair, solids, t)).collect();
        Some(SelfCollision { checked: true, allowed: pairs.into_iter().collect::<Option<_>>()? })
    })
}

fn read_pair(pair: &Node, solids: &[LinkSolid], t: &mut Table) -> Option<(usize, usize)> {
    let Some([first, second]) = pair.value.items() else {
        let message = "a pair of `allowed` must be a list of 2 names";
        t.error(pair.at, message, "write [\"NAME\", \"NAME\"], two solids that may touch each other");
        return None;
    };
    let first = read_name(first, solids, t);
    first.zip(read_name(second, solids, t))
}

fn read_name(node: &Node, solids: &[LinkSolid], t: &mut Table) -> Option<usize> {
    let name = value::text(node, self_collision::ALLOWED.name, t.lib)?;
    let found = solids.iter().position(|s| s.solid.name == name);
    if found.is_none() {
        let names = || solids.iter().map(|s| s.solid.name.as_str());
        let help = match did_you_mean(&name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        t.error(node.at, format!("the robot has no solid `{}`", shown(&name)), help);
    }
    found
}
