//! Readers of solids of links and equipment, rectangles and footprints.

use crate::cell::{Extent, Rectangle, Shape, Solid};
use crate::files::keys::key::Key;
use crate::files::keys::solid::{
    EQUIPMENT_SHAPES, MeshUnit, SHAPES, any_solid, bar, cuboid, equipment_solid, leg, mesh, rectangle, sphere,
};
use crate::files::mesh as mesh_file;
use crate::files::toml::reader::Table;
use crate::files::toml::value::text;
use crate::units;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Keys of all shapes.
const KEYS: [Key; 6] = [
    any_solid::BOX,
    any_solid::SPHERE,
    any_solid::CAPSULE,
    any_solid::CYLINDER,
    any_solid::MESH,
    equipment_solid::LEG,
];

/// Shortest capsule or cylinder, m.
const MIN_BAR_LENGTH: f64 = 1e-9;

/// Reads the list of solids; a missing list counts as empty.
pub fn read_all(t: &mut Table, key: &Key) -> Vec<Solid> {
    read_each(t, key, |_, solid| solid)
}

/// Reads the list of solids; a missing list counts as empty.
///
/// `read_one` reads the keys that a solid has besides its name and shape, such as its link.
pub fn read_each<T>(
    t: &mut Table,
    key: &Key,
    mut read_one: impl FnMut(&mut Table, Option<Solid>) -> Option<T>,
) -> Vec<T> {
    if t.get(key).is_none() {
        return Vec::new();
    }
    let mut names = HashSet::new();
    let read = t.tables(key, |t| {
        let solid = read(t);
        if let Some(s) = &solid
            && !names.insert(s.name.clone())
        {
            let message = format!("two solids are named `{}`", s.name);
            t.error(
                t.at,
                message,
                "give each solid a unique name, because messages refer to a solid by its name",
            );
        }
        read_one(t, solid)
    });
    read.into_iter().flatten().flatten().collect()
}

/// Reads one solid: `name` and exactly one shape.
fn read(t: &mut Table) -> Option<Solid> {
    let name = t.name(&any_solid::NAME);
    let given: Vec<_> = KEYS.into_iter().filter(|key| t.get(key).is_some()).collect();
    let [key] = given[..] else {
        if given.is_empty() {
            let help = "add for example box = { centre_mm = [0, 0, 0], size_mm = [100, 100, 100] }";
            let shapes: &[_] = if t.has(&equipment_solid::LEG) { &EQUIPMENT_SHAPES } else { &SHAPES };
            t.miss_one_of(shapes, help);
        } else {
            let message = format!("a solid has one shape, not {}", given.len());
            t.error(t.at, message, "write a [[solid]] for each shape");
        }
        return None;
    };
    let shape = t.table(&key, |t| match key.name {
        "box" => read_box(t),
        "sphere" => read_sphere(t),
        "leg" => read_leg(t),
        "mesh" => read_mesh(t),
        kind => read_bar(kind, t),
    });
    Some(Solid { name: name?, shape: shape? })
}

fn read_box(t: &mut Table) -> Option<Shape> {
    let pose = t.pose(&cuboid::CENTRE, &cuboid::RPY);
    let size = t.vector(&cuboid::SIZE);
    Some(Shape::Box { pose: pose?, size: size? })
}

fn read_sphere(t: &mut Table) -> Option<Shape> {
    let (centre, radius) = (t.vector(&sphere::CENTRE), t.number(&sphere::RADIUS));
    Some(Shape::Sphere { centre: centre?, radius: radius? })
}

fn read_leg(t: &mut Table) -> Option<Shape> {
    let (at, size) = (t.plan(&leg::CENTRE), t.plan(&leg::SIZE));
    let top = t.number(&leg::TOP);
    let (x, y) = at?;
    Some(Shape::Leg { x, y, size: size?, top: top? })
}

/// Reads `mesh = { file, units, centre_mm, rpy_deg }`; `file` is relative to the folder of the file that
/// names the mesh.
fn read_mesh(t: &mut Table) -> Option<Shape> {
    let pose = t.pose(&mesh::CENTRE, &mesh::RPY);
    let unit: Option<MeshUnit> = t.word(&mesh::UNITS);
    let node = t.get(&mesh::FILE)?;
    let name = text(node, mesh::FILE.name, t.lib)?;
    mesh_file::is_mesh(&name, node.at, t.lib).then_some(())?;
    let path = t.lib.relative(&name, node.at)?;
    mesh_file::load(&path, node.at, &Vector3::repeat(unit?.metres()), pose?, t.lib)
}

fn read_bar(kind: &str, t: &mut Table) -> Option<Shape> {
    let (a, b) = (t.vector(&bar::A), t.vector(&bar::B));
    let radius = t.number(&bar::RADIUS);
    let (a, b, radius) = (a?, b?, radius?);
    if (b - a).norm() < MIN_BAR_LENGTH {
        let message = format!("the ends a_mm and b_mm of the {kind} are the same point");
        t.error(t.at, message, "move the ends apart, or use a sphere");
        return None;
    }
    Some(if kind == "capsule" { Shape::Capsule { a, b, radius } } else { Shape::Cylinder { a, b, radius } })
}

/// Reads `footprint`; if it is missing, returns the plan extent of the solids and the surface.
///
/// Records a fault if a solid or the surface reaches beyond the footprint. Also records a fault if nothing
/// defines a footprint and `needed` is not empty. The message of this fault says that one of the keys
/// `needed` must be given.
pub fn read_footprint(
    t: &mut Table,
    key: &Key,
    extent: Option<Extent>,
    needed: &[&'static str],
) -> Option<Rectangle> {
    let Some(node) = t.get(key) else {
        if extent.is_none() && !needed.is_empty() {
            t.miss_one_of(needed, key.remedy_in_words());
        }
        let (lo, hi) = extent?;
        let centre = ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0);
        return Some(Rectangle { centre, size: (hi.x - lo.x, hi.y - lo.y) });
    };
    let given = t.table(key, read_rectangle)?;
    if let Some((lo, hi)) = extent {
        let (cx, cy) = given.centre;
        let (left, right) = (cx - given.size.0 / 2.0 - lo.x, hi.x - cx - given.size.0 / 2.0);
        let (front, back) = (cy - given.size.1 / 2.0 - lo.y, hi.y - cy - given.size.1 / 2.0);
        let out = units::mm_from_m(left.max(right).max(front).max(back));
        if out > 1e-6 {
            let message = format!("`footprint` is {out:.1} mm too small for the solids and the surface");
            t.error(node.at, message, "make it larger: it is the floor space that nothing else may use");
        }
    }
    Some(given)
}

/// Reads a rectangle `{ size_mm, centre_mm }`.
pub fn read_rectangle(t: &mut Table) -> Option<Rectangle> {
    let (size, centre) = (t.plan(&rectangle::SIZE), t.plan(&rectangle::CENTRE));
    Some(Rectangle { centre: centre?, size: size? })
}
