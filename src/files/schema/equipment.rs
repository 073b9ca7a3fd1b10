//! Equipment, obstacles, keep-out boxes.

use super::errors;
use super::parts::*;
use super::solid::{rectangle, solids, vector};
use crate::files::toml::value::Must;
use serde_json::{Value, json};

/// Most values of one list of a coordinate.
pub const MOST: usize = crate::files::keys::coordinate::MAX_VALUES;

/// What a file of an equipment may hold: where it stands, too, but it need not.
pub fn file() -> Value {
    of_file(equipment(&[]))
}

/// `[equipment.NAME]` of a cell.
pub fn in_cell() -> Value {
    let says = one_of(&["footprint", "solid", "surface"]);
    whole(equipment(&["placement"]), [says, json!({ "dependencies": { "schema": ["units"] } })])
}

fn equipment(required: &[&str]) -> Value {
    let stands_on =
        text("The equipment that it stands on and moves with; its placement is in the frame of that.");
    let tied = [
        ("placement", placement()),
        ("stands_on", example(stands_on, "worktable")),
        (
            "placement_tolerance",
            tolerance("How exactly it will be placed: what robust and search --robust look at."),
        ),
        ("errors", errors::of_equipment()),
    ];
    let says = "Equipment: a work surface, solids, floor space, and where it stands.";
    with_more(tied, body(says, required))
}

/// `[obstacle.NAME]`: it stands still, and no work is done on it.
pub fn obstacle() -> Value {
    let fixed = |says: &str| number(says, Must::BeFinite);
    let placement = table(
        "Where it stands.",
        [
            ("x_mm", fixed("x in the world, mm.")),
            ("y_mm", fixed("y in the world, mm.")),
            ("z_mm", fixed("z in the world, mm.")),
            ("yaw_deg", default(fixed("Turn about z, degrees."), 0)),
        ],
        &["x_mm", "y_mm", "z_mm"],
    );
    let body = body("An obstacle: it stands where it stands.", &["placement"]);
    let rules =
        [one_of(&["footprint", "solid", "surface"]), json!({ "dependencies": { "schema": ["units"] } })];
    whole(with_more([("placement", placement)], body), rules)
}

fn with_more<const N: usize>(keys: [(&str, Value); N], mut body: Value) -> Value {
    if let Some(Value::Object(own)) = body.get_mut("properties") {
        own.extend(keys.into_iter().map(|(key, schema)| (key.to_string(), schema)));
    }
    body
}

fn body(says: &str, required: &[&str]) -> Value {
    let [schema, units] = header("equipment");
    let keys = [
        (
            "from",
            path("The equipment file that it builds on; what stands here wins.", "equipment/worktable.toml"),
        ),
        schema,
        units,
        ("name", text("What the equipment is called in its file.")),
        ("source", text("Where its numbers come from.")),
        ("surface", rectangle("The work surface: a rectangle at height 0 of its frame.")),
        (
            "footprint",
            rectangle(
                "The floor space that nothing else may use; left out: what its solids and surface cover.",
            ),
        ),
        ("solid", solids("Solids, in the frame of the equipment.", true, (0, None))),
    ];
    table(says, keys, required)
}

fn placement() -> Value {
    coordinates("Where it stands: in the world, or in the frame of what it stands on.")
}

/// x, y, z and yaw, each fixed or a search variable.
pub fn coordinates(says: &str) -> Value {
    let one = |says: &str| any(says, coordinate(ANYWHERE, MOST));
    table(
        says,
        [
            (
                "x_mm",
                one("x, mm: a number, { min, max, start } to search it, or a list of the values allowed."),
            ),
            (
                "y_mm",
                one("y, mm: a number, { min, max, start } to search it, or a list of the values allowed."),
            ),
            (
                "z_mm",
                one("z, mm: a number, { min, max, start } to search it, or a list of the values allowed."),
            ),
            (
                "yaw_deg",
                default(
                    one(
                        "Turn about z, degrees: a number, { min, max, start }, or a list of the values allowed.",
                    ),
                    0,
                ),
            ),
        ],
        &["x_mm", "y_mm", "z_mm"],
    )
}

/// Plus-or-minus x, y, z and yaw.
pub fn tolerance(says: &str) -> Value {
    let one = |says: &str| default(number(says, Must::NotBeNegative), 0);
    table(
        says,
        [
            ("x_mm", one("Plus-or-minus of x, mm.")),
            ("y_mm", one("Plus-or-minus of y, mm.")),
            ("z_mm", one("Plus-or-minus of z, mm.")),
            ("yaw_deg", one("Plus-or-minus of the turn about z, degrees.")),
        ],
        &[],
    )
}

/// `[keep_out.NAME]`.
pub fn keep_out() -> Value {
    table(
        "A box of the world that nothing may enter.",
        [
            ("min_mm", vector("Its low corner, mm.", Must::BeFinite)),
            ("max_mm", vector("Its high corner, mm.", Must::BeFinite)),
        ],
        &["min_mm", "max_mm"],
    )
}
