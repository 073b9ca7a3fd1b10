//! Solids of links and equipment: reading them, and how far they extend.

use super::document::{At, Library, Node, Value};
use super::fault::shown;
use super::mesh;
use super::model::{Rectangle, Shape, Solid};
use super::reader::{Must, Table};
use crate::pose::Pose;
use crate::units;
use nalgebra::Vector3;

/// Which shapes a carrier may have besides box, sphere, capsule and cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    Link,
    Equipment,
}

const SHAPES: [&str; 6] = ["box", "sphere", "capsule", "cylinder", "leg", "mesh"];

/// The list of solids under `key` (missing: none), each with its place and its table for the
/// carrier's own keys.
pub fn list<'n>(table: &mut Table<'n>, lib: &mut Library<'_>) -> Vec<&'n Node> {
    match table.get("solid").map(|n| (&n.value, n.at)) {
        Some((Value::Array(items), _)) => items.iter().collect(),
        Some((other, at)) => {
            let message = format!("`solid` must be a list of tables, not {}", other.kind());
            lib.error(at, message, "write [[solid]] before each one");
            Vec::new()
        }
        None => Vec::new(),
    }
}

/// Reads one solid: `name` and exactly one shape.
pub fn read(table: &mut Table<'_>, carrier: Carrier, lib: &mut Library<'_>) -> Option<Solid> {
    let name = table.text("name", lib);
    let name = name.and_then(|n| checked_name(n, table.at, lib));
    let given: Vec<_> = SHAPES.iter().filter_map(|&s| table.get(s).map(|node| (s, node))).collect();
    let [(kind, node)] = given[..] else {
        let message = match given.len() {
            0 => "a solid needs a shape".to_string(),
            n => format!("a solid has one shape, not {n}"),
        };
        lib.error(table.at, message, format!("give one of: {}", SHAPES.join(", ")));
        return None;
    };
    if carrier == Carrier::Link && (kind == "leg" || kind == "mesh") {
        lib.error(node.at, format!("a link cannot be a {kind}"), "use capsules, boxes, spheres or cylinders");
        return None;
    }
    let mut t = Table::of(node, kind, lib)?;
    let shape = match kind {
        "box" => read_box(&mut t, lib),
        "sphere" => {
            let centre = t.vector("centre_mm", Must::BeFinite, lib);
            let radius = t.length("radius_mm", Must::BePositive, lib);
            centre.zip(radius).map(|(centre, radius)| Shape::Sphere { centre, radius })
        }
        "leg" => read_leg(&mut t, lib),
        "mesh" => mesh::read(&mut t, lib),
        _ => read_bar(kind, &mut t, lib),
    };
    t.finish(lib);
    Some(Solid { name: name?, shape: shape? })
}

fn read_box(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let pose = read_pose(t, "centre_mm", lib);
    let size = t.vector("size_mm", Must::BePositive, lib);
    Some(Shape::Box { pose: pose?, size: size? })
}

fn read_leg(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let at = t.numbers("centre_mm", 2, Must::BeFinite, lib);
    let size = t.numbers("size_mm", 2, Must::BePositive, lib);
    let top = t.length("top_mm", Must::BeFinite, lib);
    let (at, size) = (at?.into_iter().map(units::m_from_mm), size?.into_iter().map(units::m_from_mm));
    let (at, size): (Vec<_>, Vec<_>) = (at.collect(), size.collect());
    Some(Shape::Leg { x: at[0], y: at[1], size: (size[0], size[1]), top: top? })
}

fn read_bar(kind: &str, t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let a = t.vector("a_mm", Must::BeFinite, lib);
    let b = t.vector("b_mm", Must::BeFinite, lib);
    let radius = t.length("radius_mm", Must::BePositive, lib);
    let (a, b, radius) = (a?, b?, radius?);
    if a == b {
        lib.error(t.at, format!("the ends a_mm and b_mm of the {kind} are the same point"), "use a sphere");
        return None;
    }
    Some(if kind == "capsule" { Shape::Capsule { a, b, radius } } else { Shape::Cylinder { a, b, radius } })
}

/// A pose: a position under `key` (mm) and an optional `rpy_deg`.
pub fn read_pose(t: &mut Table<'_>, key: &'static str, lib: &mut Library<'_>) -> Option<Pose> {
    let position = t.vector(key, Must::BeFinite, lib);
    let rpy = t.numbers_or_zero("rpy_deg", 3, lib);
    let rpy = rpy.map(|v| Vector3::new(v[0], v[1], v[2]).map(units::rad_from_deg));
    Some(Pose::from_translation_rpy(position?, rpy?))
}

/// Names are shown and written to files: short, printable, not blank.
pub fn checked_name(name: String, at: At, lib: &mut Library<'_>) -> Option<String> {
    let printable = name.chars().count() <= 60 && shown(&name) == name;
    if printable && !name.trim().is_empty() {
        return Some(name);
    }
    let message = format!("`{}` cannot be a name", shown(&name));
    lib.error(at, message, "names have 1 to 60 printable characters");
    None
}

/// Extent of a shape in the frame of its carrier: low and high corner, m. A leg has no bottom of
/// its own: its low z is its top.
pub fn extent(shape: &Shape) -> (Vector3<f64>, Vector3<f64>) {
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
pub fn extent_of<'s>(shapes: impl IntoIterator<Item = &'s Shape>) -> Option<(Vector3<f64>, Vector3<f64>)> {
    shapes.into_iter().map(extent).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
}

/// Reads `footprint`, or takes the plan extent of what stands on it; a fault if something sticks out.
pub fn read_footprint(
    t: &mut Table<'_>,
    extent: Option<(Vector3<f64>, Vector3<f64>)>,
    lib: &mut Library<'_>,
) -> Option<Rectangle> {
    let around = extent.map(|(lo, hi)| Rectangle {
        centre: ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0),
        size: (hi.x - lo.x, hi.y - lo.y),
    });
    let Some(node) = t.get("footprint") else {
        if around.is_none() {
            lib.error(
                t.at,
                "no footprint, solids or surface".into(),
                "add footprint = { size_mm = [600, 600] }",
            );
        }
        return around;
    };
    let given = read_rectangle(node, "footprint", lib)?;
    let Some((lo, hi)) = extent else { return Some(given) };
    let (cx, cy) = given.centre;
    let out = (cx - given.size.0 / 2.0 - lo.x)
        .max(hi.x - cx - given.size.0 / 2.0)
        .max(cy - given.size.1 / 2.0 - lo.y)
        .max(hi.y - cy - given.size.1 / 2.0);
    if out > 1e-9 {
        let message = format!("a solid sticks out of the footprint by {:.1} mm", units::mm_from_m(out));
        lib.error(
            node.at,
            message,
            "the footprint is the floor space that nothing else may use: make it larger",
        );
        return None;
    }
    Some(given)
}

/// A rectangle `{ size_mm, centre_mm }`.
pub fn read_rectangle(node: &Node, what: &str, lib: &mut Library<'_>) -> Option<Rectangle> {
    let mut t = Table::of(node, what, lib)?;
    let size = t.numbers("size_mm", 2, Must::BePositive, lib);
    let centre = t.numbers_or_zero("centre_mm", 2, lib);
    t.finish(lib);
    let (size, centre) = (size?, centre?);
    let m = units::m_from_mm;
    Some(Rectangle { centre: (m(centre[0]), m(centre[1])), size: (m(size[0]), m(size[1])) })
}
