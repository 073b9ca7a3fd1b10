//! Error sets of a robot, errors of an equipment.

use super::parts::*;
use super::solid::vector;
use crate::cell::{Distribution, MAX_JOINTS, PER_FRAME, Spread};
use crate::files::toml::value::Must;
use serde_json::{Map, Value, json};

const KINDS: [&str; 2] = ["signed", "tolerance"];

/// The rows of an error set: one number for each joint.
const ROWS: [(&str, &str); 6] = [
    (
        "dq_deg",
        "Errors of the joint coordinates that turn, degrees: one for each joint, 0 for one that slides.",
    ),
    ("dq_mm", "Errors of the joint coordinates that slide, mm: one for each joint, 0 for one that turns."),
    ("dr_mm", "Errors of the axial offsets r, mm: one for each joint."),
    ("dl_mm", "Errors of the common normals l, mm: one for each joint."),
    ("dalpha_deg", "Errors of the twists alpha, degrees: one for each joint."),
    ("dbeta_deg", "Errors of the fifth parameter, for parallel axes, degrees: one for each joint."),
];

fn row(says: &str) -> Value {
    numbers(says, (1, MAX_JOINTS), Must::BeFinite)
}

fn kind() -> Value {
    word(
        "signed: one sample, the signs are part of it. tolerance: plus-or-minus, what any of a series may have.",
        &KINDS,
    )
}

fn position() -> Value {
    default(vector("Errors along x, y and z, mm.", Must::BeFinite), json!([0, 0, 0]))
}

fn rotation() -> Value {
    default(vector("Errors about x, y and z, degrees.", Must::BeFinite), json!([0, 0, 0]))
}

fn frame(says: &str) -> Value {
    table(says, [("position_mm", position()), ("rotation_deg", rotation())], &[])
}

/// `[errors.NAME]` of a robot.
pub fn set() -> Value {
    let joint = table(
        "The error of one joint's frame, in itself.",
        [
            (
                "joint",
                any(
                    "The joint, by its name or by its number from 1.",
                    [json!({ "type": "string" }), integer("From 1.", (1, MAX_JOINTS as u64))],
                ),
            ),
            ("position_mm", position()),
            ("rotation_deg", rotation()),
        ],
        &["joint"],
    );
    let rows = ROWS.map(|(key, says)| (key, row(says)));
    let more = table(
        "What is wrong with the robot: one signed sample, or tolerances.",
        [
            ("base", frame("Error of the frame that the robot stands on.")),
            ("tool", frame("Error of the TCP.")),
            (
                "joints",
                list(
                    "Errors of joint frames, through which everything from the joint on is moved.",
                    joint,
                    (0, Some(MAX_JOINTS)),
                ),
            ),
            ("distribution", distribution()),
            ("sigmas", sigmas()),
            ("covariance", covariance()),
        ],
        &["source", "kind"],
    );
    let about = [("source", text("Where every number comes from.")), ("kind", kind())];
    let set = with_keys(about, with_keys(rows, more));
    let needed = unless("joints", json!({ "required": ["dr_mm", "dl_mm", "dalpha_deg"] }));
    let rules = [
        when("kind", &["signed"], without(&["distribution", "sigmas", "covariance"])),
        when("kind", &["tolerance"], json!({ "properties": not_negative() })),
    ];
    whole(with_rules(set, rules), [needed])
}

/// Half the width of a tolerance has no sign.
fn not_negative() -> Value {
    let list = json!({ "items": { "minimum": 0 } });
    let frame = json!({ "properties": { "position_mm": list, "rotation_deg": list } });
    let mut keys: Map<_, _> = ROWS.iter().map(|(key, _)| (key.to_string(), list.clone())).collect();
    keys.extend(["base", "tool"].map(|key| (key.to_string(), frame.clone())));
    keys.insert("joints".into(), json!({ "items": frame }));
    Value::Object(keys)
}

/// `errors` of an equipment.
pub fn of_equipment() -> Value {
    let list = json!({ "items": { "minimum": 0 } });
    let rules = [
        when("kind", &["signed"], without(&["distribution", "sigmas"])),
        when("kind", &["tolerance"], json!({ "properties": { "position_mm": list, "rotation_deg": list } })),
    ];
    let says = "How they spread: one word, or a list of six for x, y, z and the turns about them.";
    let table = table(
        "Errors of its placement or fixture, in its frame.",
        [
            ("kind", kind()),
            ("position_mm", position()),
            ("rotation_deg", rotation()),
            ("distribution", default(words(says, (PER_FRAME, PER_FRAME)), Distribution::Normal.name())),
            ("sigmas", sigmas()),
        ],
        &["kind"],
    );
    with_rules(table, rules)
}

fn spread() -> Value {
    json!({ "type": "string", "enum": Distribution::ALL.map(Distribution::name) })
}

/// One word for all, or a list.
fn words(says: &str, (min, max): (usize, usize)) -> Value {
    any(says, [spread(), json!({ "type": "array", "items": spread(), "minItems": min, "maxItems": max })])
}

fn distribution() -> Value {
    let row =
        |of: &str| words(&format!("Of {of}: one word, or a list with one for each joint."), (1, MAX_JOINTS));
    let frame = |of: &str| {
        words(
            &format!("Of {of}: one word, or a list of six for x, y, z and the turns about them."),
            (PER_FRAME, PER_FRAME),
        )
    };
    let each = table(
        "By rows and frames.",
        [
            (
                "default",
                default(
                    with(spread(), json!({ "description": "Of all that is not named." })),
                    Distribution::Normal.name(),
                ),
            ),
            ("dq", row("dq_deg and dq_mm")),
            ("dr", row("dr_mm")),
            ("dl", row("dl_mm")),
            ("dalpha", row("dalpha_deg")),
            ("dbeta", row("dbeta_deg")),
            ("base", frame("the base frame")),
            ("tool", frame("the TCP")),
            ("joints", frame("every joint frame")),
        ],
        &[],
    );
    let says = "How plus-or-minus values spread: one word for all, or a table by rows and frames.";
    default(any(says, [spread(), each]), Distribution::Normal.name())
}

fn sigmas() -> Value {
    let says = "How many standard deviations of a normal distribution its plus-or-minus is.";
    default(number(says, Must::BePositive), Spread::SIGMAS)
}

fn covariance() -> Value {
    let rows =
        json!({ "type": "array", "items": row("A row, one number for each parameter."), "minItems": 1 });
    let mut rows = with(
        json!({ "description": "Covariances, a row for each of `parameters`; mm and degrees, squared or multiplied." }),
        rows,
    );
    rows["items"] = json!({ "type": "array", "items": { "type": "number" }, "minItems": 1 });
    let says = "What the rows belong to: dq, dr, dl, dalpha or dbeta and a joint (dl2), or base, tool or a joint and x, y, z, rx, ry or rz (joint2 x).";
    let parameters = json!({
        "description": says, "type": "array", "items": { "type": "string" }, "minItems": 1, "uniqueItems": true,
        "examples": [["dl2", "dalpha3", "base x"]],
    });
    table(
        "The covariance of a calibration: normal parameters that vary together; their plus-or-minus is 0.",
        [("parameters", parameters), ("matrix", rows)],
        &["parameters", "matrix"],
    )
}
