//! Solids, rectangles and frames.

use super::parts::*;
use crate::files::toml::value::Must;
use serde_json::{Value, json};

/// A point or a size in space.
pub fn vector(says: &str, must: Must) -> Value {
    numbers(says, (3, 3), must)
}

pub fn rpy() -> Value {
    let says = "Turns about the fixed x, y and z axes, in this order: roll, pitch and yaw, degrees.";
    default(vector(says, Must::BeFinite), json!([0, 0, 0]))
}

/// Centre and size in plan.
pub fn rectangle(says: &str) -> Value {
    table(
        says,
        [
            (
                "size_mm",
                example(numbers("Size along x and y, mm.", (2, 2), Must::BePositive), json!([600, 400])),
            ),
            ("centre_mm", default(numbers("Its middle, mm.", (2, 2), Must::BeFinite), json!([0, 0]))),
        ],
        &["size_mm"],
    )
}

/// A list of solids; `of_what` says in which frame they are drawn.
pub fn solids(says: &str, legs: bool, (min, link): (usize, Option<Value>)) -> Value {
    let mut solid = table(
        "A solid: a name and one shape.",
        [
            ("name", name("What messages call it; no two of one robot or equipment have the same.")),
            ("box", cuboid()),
            ("sphere", sphere()),
            ("capsule", bar("A segment swept by a ball.")),
            ("cylinder", bar("A round bar with flat ends.")),
            ("mesh", mesh()),
        ],
        &["name"],
    );
    let mut shapes = vec!["box", "sphere", "capsule", "cylinder", "mesh"];
    if legs {
        solid = with_keys([("leg", leg())], solid);
        shapes.push("leg");
    }
    if let Some(link) = link {
        solid = with_keys([("link", link)], with(solid, json!({ "required": ["name", "link"] })));
    }
    let rules = not_two_of(&shapes).into_iter().chain([one_of(&shapes)]);
    list(says, with_rules(solid, rules), (min, None))
}

fn cuboid() -> Value {
    table(
        "A box.",
        [
            ("centre_mm", vector("Its middle, mm.", Must::BeFinite)),
            ("size_mm", vector("Its full edges along x, y and z, mm.", Must::BePositive)),
            ("rpy_deg", rpy()),
        ],
        &["centre_mm", "size_mm"],
    )
}

fn sphere() -> Value {
    table(
        "A ball.",
        [
            ("centre_mm", vector("Its middle, mm.", Must::BeFinite)),
            ("radius_mm", number("Its radius, mm.", Must::BePositive)),
        ],
        &["centre_mm", "radius_mm"],
    )
}

fn bar(says: &str) -> Value {
    table(
        says,
        [
            ("a_mm", vector("One end of its axis, mm.", Must::BeFinite)),
            ("b_mm", vector("The other end of its axis, mm.", Must::BeFinite)),
            ("radius_mm", number("Its radius, mm.", Must::BePositive)),
        ],
        &["a_mm", "b_mm", "radius_mm"],
    )
}

fn leg() -> Value {
    table(
        "An upright leg from the floor: its length follows the height at which the equipment stands.",
        [
            ("centre_mm", numbers("Its middle in plan, mm.", (2, 2), Must::BeFinite)),
            ("size_mm", numbers("Its size along x and y, mm.", (2, 2), Must::BePositive)),
            ("top_mm", number("The height of its top in the frame of the equipment, mm.", Must::BeFinite)),
        ],
        &["centre_mm", "size_mm", "top_mm"],
    )
}

fn mesh() -> Value {
    let file = path("An STL or OBJ file, its path from the folder of this file.", "machine.stl");
    let ending = json!({ "pattern": "\\.([oO][bB][jJ]|[sS][tT][lL])$" });
    table(
        "Triangles of a mesh file.",
        [
            ("file", with_rules(file, [ending])),
            ("units", word("What one unit of the mesh file is.", &crate::files::mesh::UNITS)),
            ("centre_mm", vector("Where the origin of the mesh lies, mm.", Must::BeFinite)),
            ("rpy_deg", rpy()),
        ],
        &["file", "units", "centre_mm"],
    )
}
