//! Solids of links and equipment: reading them, and how far they extend.

use super::document::Library;
use super::mesh;
use super::model::{Rectangle, Shape, Solid};
use super::reader::Table;
use super::tree::{Node, Value};
use super::value::Must;
use crate::pose::Pose;
use crate::units;
use nalgebra::Vector3;
use std::collections::HashSet;

/// What carries a solid: a link has no legs and meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    Link,
    Equipment,
}

/// The first four are for links, too.
const SHAPES: [&str; 6] = ["box", "sphere", "capsule", "cylinder", "leg", "mesh"];

/// Shortest capsule or cylinder, m.
const SHORTEST_BAR: f64 = 1e-9;

/// Low and high corner.
pub type Extent = (Vector3<f64>, Vector3<f64>);

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
    let known = if carrier == Carrier::Link { &SHAPES[..4] } else { &SHAPES[..] };
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
            format!("a link cannot be a {kind}"),
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
    let pose = read_pose(t, "centre_mm", lib);
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

/// A pose: a position under `key` (mm) and an optional `rpy_deg`.
pub fn read_pose(t: &mut Table<'_>, key: &'static str, lib: &mut Library<'_>) -> Option<Pose> {
    let position = t.vector(key, Must::BeFinite, lib);
    let rpy = t.numbers_or_zero("rpy_deg", 3, lib);
    let rpy = rpy.map(|v| Vector3::from_iterator(v).map(units::rad_from_deg));
    Some(Pose::from_translation_rpy(position?, rpy?))
}

/// Extent of a shape in the frame of its carrier: low and high corner, m. A leg has no bottom of
/// its own: its low z is its top.
pub fn extent(shape: &Shape) -> Extent {
    match shape {
        Shape::Box { pose, size } => {
            let half = pose.rotation.abs() * (size / 2.0);
            (pose.translation - half, pose.translation + half)
        }
        Shape::Sphere { centre, radius } => (centre.add_scalar(-radius), centre.add_scalar(*radius)),
        Shape::Capsule { a, b, radius } => (a.inf(b).add_scalar(-radius), a.sup(b).add_scalar(*radius)),
        Shape::Cylinder { a, b, radius } => {
            let axis = (b - a).normalize();
            let disc = axis.map(|c| radius * (1.0 - c * c).max(0.0).sqrt());
            (a.inf(b) - disc, a.sup(b) + disc)
        }
        Shape::Leg { x, y, size, top } => (
            Vector3::new(x - size.0 / 2.0, y - size.1 / 2.0, *top),
            Vector3::new(x + size.0 / 2.0, y + size.1 / 2.0, *top),
        ),
        Shape::Mesh { pose, vertices, .. } => {
            let none = Vector3::repeat(f64::INFINITY);
            let placed = vertices.iter().map(|v| pose.transform(v));
            placed.fold((none, -none), |(lo, hi), v| (lo.inf(&v), hi.sup(&v)))
        }
    }
}

/// Extent of several shapes together, None if there are none.
pub fn extent_of<'s>(shapes: impl IntoIterator<Item = &'s Shape>) -> Option<Extent> {
    shapes.into_iter().map(extent).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
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
        let centre = t.numbers_or_zero("centre_mm", 2, lib).map(plan);
        Some(Rectangle { centre: centre?, size: size? })
    })
}
