//! Parser of URDF text: XML to links and joints. The module `tree` finds the faults in the tree of links.

use super::fault_list::Faults;
use super::model::*;
use super::{scan, xml};
use crate::files::fault::{did_you_mean, shown};
use crate::files::toml::value;
use nalgebra::Vector3;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{BTreeMap, HashSet};

/// Largest number of links, of joints and of collision elements.
const MAX_ELEMENTS: usize = 1_000;

/// Largest number of unused tags that are counted by name.
const MAX_UNUSED_TAGS: usize = 20;

/// Least size of a collision shape, m.
const SMALLEST: f64 = 1e-9;

/// Parses the text and records every fault. The result is valid only if no fault was recorded.
pub fn parse(text: &str, faults: &mut Faults) -> Option<Urdf> {
    if let Some(wrong) = scan::refuse(text, faults) {
        faults.push(wrong);
        return None;
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..ParsingOptions::default() };
    let document = match Document::parse_with_options(text, options) {
        Ok(document) => document,
        Err(e) => {
            let message = format!("not XML: {}", shown(&e.to_string()));
            let at = faults.at(offset_of(text, e.pos()));
            faults.error(at, message, "correct the line, or export the URDF again");
            return None;
        }
    };
    read_robot(document.root_element(), faults)
}

/// Returns the byte offset of a position, whose row and column count from 1.
fn offset_of(text: &str, pos: roxmltree::TextPos) -> usize {
    let row = text.split_inclusive('\n').take(pos.row.saturating_sub(1) as usize).map(str::len).sum();
    let line = text.get(row..).unwrap_or("");
    let column = line.char_indices().nth(pos.col.saturating_sub(1) as usize).map_or(line.len(), |(i, _)| i);
    row + column
}

fn read_robot(root: Node<'_, '_>, faults: &mut Faults) -> Option<Urdf> {
    let at = faults.at(root.range().start);
    if !root.has_tag_name("robot") {
        let message = format!("the file is a <{}>, not a <robot>", shown(root.tag_name().name()));
        faults.error(at, message, "a URDF is XML that starts with <robot name=\"...\">");
        return None;
    }
    let is_xacro = |n: &Node<'_, '_>| n.tag_name().namespace().is_some_and(|space| space.contains("xacro"));
    if let Some(macro_call) = root.descendants().find(is_xacro) {
        let message = format!("<xacro:{}> is not expanded here", shown(macro_call.tag_name().name()));
        faults.error(
            faults.at(macro_call.range().start),
            message,
            "run xacro on it, and name the URDF that it writes",
        );
        return None;
    }
    let name = root.attribute("name").filter(|name| value::is_name(name)).map(str::to_string);
    let mut urdf = Urdf { at, name, links: Vec::new(), joints: Vec::new(), ignored: BTreeMap::new() };
    let is = |name| move |c: &Node<'_, '_>| c.has_tag_name(name);
    for (name, plural) in [("link", "links"), ("joint", "joints")] {
        if let Some(extra) = root.children().filter(is(name)).nth(MAX_ELEMENTS) {
            let help = "name the URDF of one robot";
            faults.error(
                faults.at(extra.range().start),
                format!("the URDF has more than {MAX_ELEMENTS} {plural}"),
                help,
            );
            return None;
        }
    }
    urdf.links = root.children().filter(is("link")).filter_map(|e| read_link(e, faults)).collect();
    urdf.joints = root.children().filter(is("joint")).filter_map(|e| read_joint(e, faults)).collect();
    refuse_twins(urdf.links.iter().map(|l| &l.name), "links", faults);
    refuse_twins(urdf.joints.iter().map(|j| &j.name), "joints", faults);
    if urdf.links.iter().map(|l| l.collisions.len()).sum::<usize>() > MAX_ELEMENTS {
        faults.error(
            at,
            format!("the URDF has more than {MAX_ELEMENTS} collision elements"),
            "simplify the shapes of the links",
        );
    }
    urdf.ignored = unused(root);
    Some(urdf)
}

fn refuse_twins<'n>(names: impl Iterator<Item = &'n Named>, what: &str, faults: &mut Faults) {
    let mut known = HashSet::new();
    for name in names.filter(|n| !known.insert(&n.name)).collect::<Vec<_>>() {
        faults.error(name.at, format!("two {what} are named `{}`", shown(&name.name)), "rename one of them");
    }
}

fn read_link(e: Node<'_, '_>, faults: &mut Faults) -> Option<UrdfLink> {
    let name = xml::text(e, "name", faults);
    let collisions = e.children().filter(|c| c.has_tag_name("collision"));
    let collisions = collisions.filter_map(|c| read_collision(c, faults)).collect();
    Some(UrdfLink { name: name?, collisions })
}

fn read_collision(e: Node<'_, '_>, faults: &mut Faults) -> Option<Collision> {
    let at = faults.at(e.range().start);
    let pose = xml::origin(e, faults);
    let shape = xml::only(e, "geometry", faults).and_then(|g| g.first_element_child());
    let Some(shape) = shape else {
        let help = "add <geometry><box size=\"...\"/></geometry>, or remove the <collision>";
        faults.error(at, "<collision> has no shape".into(), help);
        return None;
    };
    Some(Collision { at, pose: pose?, geometry: read_geometry(shape, faults)? })
}

fn read_geometry(e: Node<'_, '_>, faults: &mut Faults) -> Option<Geometry> {
    match e.tag_name().name() {
        "box" => {
            xml::refuse_unknown(e, &["size"], faults);
            Some(Geometry::Box(Vector3::from(positive(e, "size", faults)?)))
        }
        "cylinder" => {
            xml::refuse_unknown(e, &["radius", "length"], faults);
            let (radius, length) = (positive(e, "radius", faults), positive(e, "length", faults));
            let ([radius], [length]) = (radius?, length?);
            Some(Geometry::Cylinder { radius, length })
        }
        "sphere" => {
            xml::refuse_unknown(e, &["radius"], faults);
            positive(e, "radius", faults).map(|[radius]| Geometry::Sphere(radius))
        }
        "mesh" => {
            xml::refuse_unknown(e, &["filename", "scale"], faults);
            let scale = xml::numbers(e, "scale", Some([1.0; 3]), faults);
            let file = xml::text(e, "filename", faults);
            Some(Geometry::Mesh { file: file?, scale: Vector3::from(scale?) })
        }
        other => {
            let message = format!("<{}> is not a collision shape", shown(other));
            let help = "write a box, cylinder, sphere or mesh";
            faults.error(faults.at(e.range().start), message, help);
            None
        }
    }
}

fn positive<const N: usize>(e: Node<'_, '_>, name: &str, faults: &mut Faults) -> Option<[f64; N]> {
    let numbers = xml::numbers(e, name, None, faults)?;
    if numbers.iter().any(|&v| v < SMALLEST) {
        let at = xml::place(e, name, faults);
        faults.error(at, format!("`{name}` must be greater than 0"), "lengths of a URDF are in m");
        return None;
    }
    Some(numbers)
}

fn read_joint(e: Node<'_, '_>, faults: &mut Faults) -> Option<UrdfJoint> {
    let name = xml::text(e, "name", faults);
    let kind = read_kind(e, faults);
    let parent = end(e, "parent", faults);
    let child = end(e, "child", faults);
    let origin = xml::origin(e, faults);
    let at = |tag| e.children().find(|c| c.has_tag_name(tag)).unwrap_or(e).range().start;
    let (origin_at, axis_at) = (faults.at(at("origin")), faults.at(at("axis")));
    let axis = match xml::only(e, "axis", faults) {
        Some(axis) => {
            xml::refuse_unknown(axis, &["xyz"], faults);
            xml::numbers(axis, "xyz", None, faults)
        }
        None => Some([1.0, 0.0, 0.0]), // the default of the format
    };
    let limits = read_limits(e, faults);
    let velocity = read_velocity(e, faults);
    let mimic = match xml::only(e, "mimic", faults) {
        Some(mimic) => read_mimic(mimic, faults).map(Some),
        None => Some(None),
    };
    let (kind, axis) = (kind?, Vector3::from(axis?));
    let unit = axis.try_normalize(1e-9).or_else(|| (kind == UrdfJointKind::Fixed).then(Vector3::x));
    if unit.is_none() {
        faults.error(axis_at, "the axis has no direction".into(), "write for example xyz=\"0 0 1\"");
    }
    let (limits, mimic, axis, origin) = (limits?, mimic?, unit?, origin?);
    let velocity = velocity?;
    Some(UrdfJoint {
        name: name?,
        kind,
        parent: parent?,
        child: child?,
        origin,
        origin_at,
        axis,
        limits,
        velocity,
        mimic,
    })
}

fn read_kind(e: Node<'_, '_>, faults: &mut Faults) -> Option<UrdfJointKind> {
    let word = xml::text(e, "type", faults)?;
    let found = UrdfJointKind::ALL.into_iter().find(|k| k.name() == word.name);
    if found.is_none() {
        let help = match did_you_mean(&word.name, UrdfJointKind::ALL.map(UrdfJointKind::name)) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("the kinds are: {}", UrdfJointKind::ALL.map(UrdfJointKind::name).join(", ")),
        };
        faults.error(word.at, format!("a joint cannot be \"{}\"", shown(&word.name)), help);
    }
    found
}

/// Returns the link that `<parent>` or `<child>` names.
fn end(e: Node<'_, '_>, tag: &str, faults: &mut Faults) -> Option<Named> {
    let Some(end) = xml::only(e, tag, faults) else {
        let at = faults.at(e.range().start);
        faults.error(at, format!("the joint has no <{tag}>"), format!("add <{tag} link=\"...\"/>"));
        return None;
    };
    xml::text(end, "link", faults)
}

/// Returns `lower` and `upper` of `<limit>`; Some(None) if neither is given.
///
/// If only one of the two attributes is missing, its value is 0, which is the default of URDF.
#[allow(clippy::option_option)]
fn read_limits(
    e: Node<'_, '_>,
    faults: &mut Faults,
) -> Option<Option<(f64, f64, crate::files::toml::tree::At)>> {
    let Some(limit) = xml::only(e, "limit", faults) else { return Some(None) };
    if !limit.has_attribute("lower") && !limit.has_attribute("upper") {
        return Some(None);
    }
    let lower = xml::numbers(limit, "lower", Some([0.0]), faults);
    let upper = xml::numbers(limit, "upper", Some([0.0]), faults);
    let ([lower], [upper]) = (lower?, upper?);
    Some(Some((lower, upper, faults.at(limit.range().start))))
}

/// Returns `velocity` of `<limit>`, with its place; Some(None) if it is not given or 0.
///
/// The attribute is required by the format, so 0 stands for an unknown speed in many files.
#[allow(clippy::option_option)]
fn read_velocity(
    e: Node<'_, '_>,
    faults: &mut Faults,
) -> Option<Option<(f64, crate::files::toml::tree::At)>> {
    let Some(limit) = e.children().find(|c| c.has_tag_name("limit")) else { return Some(None) };
    let [velocity] = xml::numbers(limit, "velocity", Some([0.0]), faults)?;
    let at = xml::place(limit, "velocity", faults);
    if velocity < 0.0 {
        let message = format!("`velocity` must be greater than 0, not {velocity}");
        faults.error(at, message, "write the maximum speed of the joint, in rad/s or m/s");
        return None;
    }
    Some((velocity > 0.0).then_some((velocity, at)))
}

fn read_mimic(e: Node<'_, '_>, faults: &mut Faults) -> Option<Mimic> {
    xml::refuse_unknown(e, &["joint", "multiplier", "offset"], faults);
    let joint = xml::text(e, "joint", faults);
    let multiplier = xml::numbers(e, "multiplier", Some([1.0]), faults);
    let offset = xml::numbers(e, "offset", Some([0.0]), faults);
    let ([multiplier], [offset]) = (multiplier?, offset?);
    Some(Mimic { joint: joint?, multiplier, offset })
}

/// Counts the elements that are not used, by their tag.
fn unused(root: Node<'_, '_>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for top in root.children().filter(Node::is_element) {
        let used: &[_] = match top.tag_name().name() {
            "link" => &["collision"],
            "joint" => &["parent", "child", "origin", "axis", "limit", "mimic"],
            other => {
                count(&mut counts, other);
                continue;
            }
        };
        let inside = top.children().filter(|c| c.is_element() && !used.contains(&c.tag_name().name()));
        inside.for_each(|c| count(&mut counts, c.tag_name().name()));
    }
    counts
}

fn count(counts: &mut BTreeMap<String, usize>, name: &str) {
    let name = shown(name);
    let key =
        if counts.len() < MAX_UNUSED_TAGS || counts.contains_key(&name) { name } else { "other".into() };
    *counts.entry(key).or_default() += 1;
}
