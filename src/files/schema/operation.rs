//! Operations, and senses that a cell defines.

use super::equipment::MOST;
use super::parts::*;
use super::solid::{rectangle, vector};
use super::tool;
use crate::cell::{Frame, Over, PLAIN};
use crate::files::keys::attitude::{MAX_BEND, MAX_SPINS, MAX_TOLERANCE};
use crate::files::keys::operation::MAX_NODES;
use crate::files::toml::value::Must;
use serde_json::{Value, json};

/// `[operation.NAME]`.
pub fn operation() -> Value {
    let optional = |says: &str| default(number(says, Must::NotBeNegative), 0);
    let [grid, region, points, over] = place();
    let [bend, azimuth, spin, tolerance] = attitude();
    let keys = [
        ("on", example(text("The equipment on whose work surface it happens."), "worktable")),
        grid,
        region,
        points,
        over,
        ("standoff_mm", optional("How far the TCP is above the surface, mm.")),
        bend,
        azimuth,
        spin,
        tolerance,
        ("sense", sense_word()),
        (
            "limit_mm",
            number("The requirement: how large an error of length still succeeds, mm.", Must::BePositive),
        ),
        ("limit_deg", number("The requirement of a sense of rotation, degrees.", Must::BePositive)),
        (
            "relative_to",
            text("An operation above, whose part is placed here: the errors that both share cancel."),
        ),
        ("teach_mm", teach()),
        ("approach_mm", optional("How far the tool comes in straight along its axis, mm.")),
        ("retract_mm", optional("How far the tool goes out straight along its axis, mm.")),
        ("weight", default(number("How much its error counts in the objective.", Must::BePositive), 1)),
        ("held", tool::held()),
    ];
    let table = table(
        "A precision operation: where, how the tool points, which error matters.",
        keys,
        &["on", "bend_deg", "sense"],
    );
    let not_both = json!({ "dependencies": { "points_mm": without(&["grid", "region"]) } });
    let senses =
        |turns: bool| -> Vec<String> { plain_senses().filter(|s| turns == s.starts_with('r')).collect() };
    let limits = [(true, "limit_mm"), (false, "limit_deg")]
        .map(|(turns, limit)| when("sense", &senses(turns), without(&[limit])));
    whole(with_rules(table, limits.into_iter().chain([not_both])), [one_of(&["grid", "points_mm"])])
}

fn place() -> [(&'static str, Value); 4] {
    let grid = json!({
        "description": "Divisions along x and y of the surface: [10, 8] makes 11 x 9 nodes.",
        "type": "array", "items": { "type": "integer", "minimum": 1, "maximum": MAX_NODES / 2 - 1 },
        "minItems": 2, "maxItems": 2, "examples": [[10, 8]],
    });
    let point = numbers("x and y on the surface, mm.", (2, 2), Must::BeFinite);
    let points = list(
        "Points of the surface at which it happens, in place of a grid, mm.",
        point,
        (1, Some(MAX_NODES as usize)),
    );
    let over = word(
        "best: it happens at the best node. max, mean, p95: it happens at every node, and this of their errors counts; left out: best of a grid, max of points.",
        &Over::ALL.map(Over::name),
    );
    [
        ("grid", grid),
        ("region", rectangle("The part of the surface that the grid covers; left out: all of it.")),
        ("points_mm", points),
        ("over", over),
    ]
}

fn attitude() -> [(&'static str, Value); 4] {
    let bend = any(
        "Elevation of the tool axis, degrees: -90 points down, 0 is horizontal; a number, a range or a list.",
        coordinate((-MAX_BEND, MAX_BEND), MOST),
    );
    let words = |words: &[&str]| json!({ "type": "string", "enum": words });
    let azimuth = any(
        "Heading of the tool axis (or, of a tool that points up or down, of its x axis) in the surface, degrees: a number, a range, a list, \"radial\" (away from the robot) or \"free\".",
        coordinate(ANYWHERE, MOST).into_iter().chain([words(&["radial", "free"])]),
    );
    let [number, range, _] = coordinate(ANYWHERE, MOST);
    let turns = json!({
        "description": "All are tried.",
        "type": "array", "items": { "type": "number" }, "minItems": 1, "maxItems": MAX_SPINS,
    });
    let spin = any(
        "Turn about the tool axis, degrees: a number, a range to search, a list of turns that all do, or \"free\" (every 30 degrees is tried).",
        [number, range, turns, words(&["free"])],
    );
    let mut tolerance =
        default(self::number("So far the tool axis may be tilted, degrees.", Must::NotBeNegative), 0);
    tolerance["maximum"] = json!(MAX_TOLERANCE);
    [
        ("bend_deg", example(bend, -90)),
        ("azimuth_deg", default(azimuth, "free")),
        ("spin_deg", default(spin, "free")),
        ("tolerance_deg", tolerance),
    ]
}

/// The senses that need no definition.
fn plain_senses() -> impl Iterator<Item = String> {
    let framed = PLAIN.iter().flat_map(|p| Frame::ALL.map(|f| format!("{p}@{}", f.name())));
    PLAIN.iter().map(|p| p.to_string()).chain(framed)
}

/// A plain sense, in one of the frames, or one that the cell defines.
fn sense_word() -> Value {
    let known: Vec<String> = plain_senses().collect();
    let own = json!({ "description": "A sense of the cell, [sense.NAME].", "type": "string", "pattern": "^[^@]*$" });
    let says = "The sense in which its error is measured: x, y, z, xy, xyz, rx, ry, rz or rotation, with @surface or @tool in other axes, or a sense of the cell.";
    example(any(says, [json!({ "type": "string", "enum": known }), own]), "xy")
}

fn teach() -> Value {
    let point = numbers("x and y on the surface, mm.", (2, 2), Must::BeFinite);
    list(
        "Three points of the surface, mm, that teach its frame when the registration is taught.",
        point,
        (3, Some(3)),
    )
}

/// `[sense.NAME]`.
pub fn sense() -> Value {
    let ways = ["of", "direction", "plane", "axis"];
    let term = with_rules(
        table("A term of a sense.", term_keys(), &[]),
        not_two_of(&ways).into_iter().chain([one_of(&ways)]).chain(lever_rules()),
    );
    let more = [
        (
            "frame",
            default(
                word("The frame that directions are given in.", &Frame::ALL.map(Frame::name)),
                Frame::World.name(),
            ),
        ),
        (
            "point_mm",
            default(
                vector("The point whose error is meant, from the TCP in the tool frame, mm.", Must::BeFinite),
                json!([0, 0, 0]),
            ),
        ),
        ("term", list("Several terms that make one sense together.", term, (1, None))),
    ];
    let table = with_keys(more, table("A sense: what of the error matters.", term_keys(), &[]));
    let alone = json!({ "dependencies": { "term": without(&["of", "direction", "plane", "axis", "weight", "mm_per_deg"]) } });
    let rules = not_two_of(&ways).into_iter().chain(lever_rules()).chain([alone]);
    whole(with_rules(table, rules), [one_of(&["of", "direction", "plane", "axis", "term"])])
}

fn term_keys() -> [(&'static str, Value); 6] {
    [
        ("of", word("The error along or about axes of the frame.", &PLAIN)),
        ("direction", direction(vector("The error along this vector.", Must::BeFinite))),
        ("plane", direction(vector("The error in the plane across this vector.", Must::BeFinite))),
        ("axis", direction(vector("The rotation about this vector.", Must::BeFinite))),
        ("weight", default(number("How much it counts.", Must::BePositive), 1)),
        (
            "mm_per_deg",
            number(
                "The length that one degree of a rotation counts as, mm, so that it can be added to lengths.",
                Must::BePositive,
            ),
        ),
    ]
}

/// `mm_per_deg` is of rotations, and in place of a weight.
fn lever_rules() -> [Value; 2] {
    let lengths = when("of", &["x", "y", "z", "xy", "xyz"], without(&["mm_per_deg"]));
    let never = without(&["weight", "direction", "plane"]);
    [lengths, json!({ "dependencies": { "mm_per_deg": never } })]
}
