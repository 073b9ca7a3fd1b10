//! Solids of links and equipment: reading them, and how far they extend.

use crate::cell::{Extent, Rectangle, Shape, Solid};
use crate::files::mesh;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value::Must;
use crate::units;
use std::collections::HashSet;

/// What carries a solid: a link, a tool and a held part have no legs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    Link,
    Equipment,
}

/// All but the last are for links, too.
const SHAPES: [&str; 6] = ["box", "sphere", "capsule", "cylinder", "mesh", "leg"];

/// Shortest capsule or cylinder, m.
const SHORTEST_BAR: f64 = 1e-9;

/// Reads the list of solids (missing: none); `read_one` reads what the carrier adds to a solid.
pub fn read_all<T>(
    table: &mut Table<'_>,
    carrier: Carrier,
    lib: &mut Library<'_>,
    mut read_one: impl FnMut(&mut Table<'_>, Option<Solid>, &mut Library<'_>) -> Option<T>,
) -> Vec<T> {
    let Some(node) = table.get("solid") else { return Vec::new() };
    let Value::Array(items) = &node.value else {
        let message = format!("`solid` must be a list of tables, not {}", node.value.kind());
        lib.error(node.at, message, "write [[solid]] above the keys of each");
        return Vec::new();
    };
    let mut names = HashSet::new();
    let read = |item| {
        Table::read(item, "a solid", lib, |t, lib| {
            let solid = read(t, carrier, lib);
            if let Some(s) = &solid
                && !names.insert(s.name.clone())
            {
                let message = format!("two solids are named `{}`", s.name);
                lib.error(t.at, message, "give each a name of its own: reasons name the solids");
            }
            read_one(t, solid, lib)
        })
    };
    items.iter().filter_map(read).collect()
}

/// Reads one solid: `name` and exactly one shape.
fn read(table: &mut Table<'_>, carrier: Carrier, lib: &mut Library<'_>) -> Option<Solid> {
    let name = table.name(lib);
    let known = if carrier == Carrier::Link { &SHAPES[..5] } else { &SHAPES[..] };
    let given: Vec<_> = SHAPES.iter().filter_map(|&s| table.get(s).map(|node| (s, node))).collect();
    let [(kind, node)] = given[..] else {
        if given.is_empty() {
            let help = "add for example box = { centre_mm = [0, 0, 0], size_mm = [100, 100, 100] }";
            table.need_one_of(known, help);
        } else {
            let message = format!("a solid has one shape, not {}", given.len());
            lib.error(table.at, message, "write a [[solid]] for each shape");
        }
        return None;
    };
    if !known.contains(&kind) {
        lib.error(
            node.at,
            format!("what moves cannot be a {kind}"),
            format!("give it one of: {}", known.join(", ")),
        );
        return None;
    }
    let shape = Table::read(node, &format!("`{kind}`"), lib, |t, lib| match kind {
        "box" => read_box(t, lib),
        "sphere" => read_sphere(t, lib),
        "leg" => read_leg(t, lib),
        "mesh" => mesh::read(t, lib),
        _ => read_bar(kind, t, lib),
    });
    Some(Solid { name: name?, shape: shape? })
}

fn read_box(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let pose = t.pose("centre_mm", lib);
    let size = t.vector("size_mm", Must::BePositive, lib);
    Some(Shape::Box { pose: pose?, size: size? })
}

fn read_sphere(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let centre = t.vector("centre_mm", Must::BeFinite, lib);
    let radius = t.length("radius_mm", Must::BePositive, lib);
    Some(Shape::Sphere { centre: centre?, radius: radius? })
}

fn read_leg(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let plan = |v: Vec<f64>| (units::m_from_mm(v[0]), units::m_from_mm(v[1]));
    let at = t.numbers("centre_mm", 2, Must::BeFinite, lib).map(plan);
    let size = t.numbers("size_mm", 2, Must::BePositive, lib).map(plan);
    let top = t.length("top_mm", Must::BeFinite, lib);
    let (x, y) = at?;
    Some(Shape::Leg { x, y, size: size?, top: top? })
}

fn read_bar(kind: &str, t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let a = t.vector("a_mm", Must::BeFinite, lib);
    let b = t.vector("b_mm", Must::BeFinite, lib);
    let radius = t.length("radius_mm", Must::BePositive, lib);
    let (a, b, radius) = (a?, b?, radius?);
    if (b - a).norm() < SHORTEST_BAR {
        let message = format!("the ends a_mm and b_mm of the {kind} are the same point");
        lib.error(t.at, message, "move them apart, or make it a sphere");
        return None;
    }
    Some(if kind == "capsule" { Shape::Capsule { a, b, radius } } else { Shape::Cylinder { a, b, radius } })
}

/// Reads `footprint`, or takes the plan extent of what stands on it; a fault if something sticks out.
/// `needed`: the keys that could give one, if there is none.
pub fn read_footprint(
    t: &mut Table<'_>,
    extent: Option<Extent>,
    needed: &[&'static str],
    lib: &mut Library<'_>,
) -> Option<Rectangle> {
    let Some(node) = t.get("footprint") else {
        if extent.is_none() {
            t.need_one_of(needed, "add footprint = { size_mm = [600, 600] }");
        }
        let (lo, hi) = extent?;
        let centre = ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0);
        return Some(Rectangle { centre, size: (hi.x - lo.x, hi.y - lo.y) });
    };
    let given = read_rectangle(node, "`footprint`", lib)?;
    if let Some((lo, hi)) = extent {
        let (cx, cy) = given.centre;
        let (left, right) = (cx - given.size.0 / 2.0 - lo.x, hi.x - cx - given.size.0 / 2.0);
        let (front, back) = (cy - given.size.1 / 2.0 - lo.y, hi.y - cy - given.size.1 / 2.0);
        let out = units::mm_from_m(left.max(right).max(front).max(back));
        if out > 1e-6 {
            let message = format!("`footprint` is {out:.1} mm too small for what stands on it");
            lib.error(node.at, message, "make it larger: it is the floor space that nothing else may use");
        }
    }
    Some(given)
}

/// A rectangle `{ size_mm, centre_mm }`.
pub fn read_rectangle(node: &Node, what: &str, lib: &mut Library<'_>) -> Option<Rectangle> {
    Table::read(node, what, lib, |t, lib| {
        let plan = |v: Vec<f64>| (units::m_from_mm(v[0]), units::m_from_mm(v[1]));
        let size = t.numbers("size_mm", 2, Must::BePositive, lib).map(plan);
        let centre = t.numbers_or_zero("centre_mm", 2, Must::BeFinite, lib).map(plan);
        Some(Rectangle { centre: centre?, size: size? })
    })
}
