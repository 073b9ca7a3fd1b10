//! Robots: in a file of their own, and in a cell.

use super::parts::*;
use super::solid::{rectangle, solids};
use super::{equipment, errors, tool};
use crate::cell::{Convention, MAX_JOINTS};
use crate::files::keys::robot::KINDS;
use crate::files::toml::value::Must;
use serde_json::{Value, json};

pub fn file() -> Value {
    let file = of_file(robot());
    // `base` is of a cell; it need not be told apart otherwise.
    let required = json!(["schema", "units", "tool", "errors"]);
    with(file, json!({ "required": required }))
}

/// `[robot]` of a cell: a robot, and where it stands.
pub fn in_cell() -> Value {
    let base = equipment::coordinates("Where the robot base stands in the world; left out: at the origin.");
    let says = "How exactly the robot base will be placed.";
    let placed = [("base", base), ("base_tolerance", equipment::tolerance(says))];
    let mut robot = with_keys(placed, robot());
    if let Some(Value::Array(rules)) = robot.get_mut(WHOLE) {
        rules.push(json!({ "dependencies": { "schema": ["units"] } }));
    }
    robot
}

fn robot() -> Value {
    let [schema, units] = header("robot");
    let [urdf, base_link, tip_link, packages] = urdf();
    let home = numbers(
        "The posture at rest, one number for each joint, degrees or mm; left out: 0, where that is outside the limits their middle.",
        (1, MAX_JOINTS),
        Must::BeFinite,
    );
    let link =
        integer("What the solid moves with: 0 is the base, k the frame after row k.", (0, MAX_JOINTS as u64));
    let keys = [
        (
            "from",
            path("The robot file that it builds on; what stands here wins.", "robots/hitachi_pw10.toml"),
        ),
        schema,
        units,
        ("name", name("What the robot is called.")),
        ("source", text("Where its numbers come from.")),
        (
            "convention",
            default(
                word(
                    "How the rows are meant: Rz Tz Tx Rx (standard) or Tx Rx Rz Tz (modified, Craig).",
                    &Convention::ALL.map(Convention::name),
                ),
                Convention::Standard.name(),
            ),
        ),
        (
            "joint",
            list("D-H rows, from the base on: one for each moving axis.", joint(), (1, Some(MAX_JOINTS))),
        ),
        ("coupling", coupling()),
        ("home", home),
        urdf,
        base_link,
        tip_link,
        packages,
        ("tool", tool::tool()),
        ("footprint", rectangle("The floor space of the base; left out: what the solids of link 0 cover.")),
        ("solid", solids("Solids on the links.", false, (0, Some(link)))),
        ("self_collision", self_collision()),
        (
            "errors",
            with(named("Error sets, [errors.NAME] each.", errors::set()), json!({ "minProperties": 1 })),
        ),
    ];
    let table = table("The robot: D-H rows or a URDF, tool, solids, error sets.", keys, &["tool", "errors"]);
    let rows = unless(
        "urdf",
        with(
            json!({ "required": ["name", "source", "joint"] }),
            without(&["base_link", "tip_link", "packages"]),
        ),
    );
    let not_both = json!({ "dependencies": { "urdf": without(&["joint", "coupling", "convention"]) } });
    whole(with_rules(table, [not_both]), [rows])
}

fn joint() -> Value {
    let limits = |says: &str| example(numbers(says, (2, 2), Must::BeFinite), json!([-90, 90]));
    let row = table(
        "A D-H row: a moving axis. A = Rz(q_offset + q) Tz(r) Tx(l) Rx(alpha).",
        [
            ("name", name("What reasons call the joint.")),
            (
                "kind",
                default(
                    word("It turns, it slides, or it follows others by the coupling alone.", &KINDS),
                    KINDS[0],
                ),
            ),
            (
                "q_offset_deg",
                number("The angle theta at coordinate 0 of a joint that turns, degrees.", Must::BeFinite),
            ),
            ("theta_deg", number("The angle theta of a joint that slides, degrees.", Must::BeFinite)),
            (
                "r_mm",
                number(
                    "Axial offset r along z, mm; a joint that slides adds its coordinate.",
                    Must::BeFinite,
                ),
            ),
            ("l_mm", number("Common normal l along x, mm.", Must::BeFinite)),
            ("alpha_deg", number("Twist alpha about x, degrees.", Must::BeFinite)),
            ("limits_deg", limits("Least and largest coordinate of a joint that turns, degrees.")),
            ("limits_mm", limits("Least and largest coordinate of a joint that slides, mm.")),
        ],
        &["name", "r_mm", "l_mm", "alpha_deg"],
    );
    let keys = |needed: &[&str], never: &[&str]| with(json!({ "required": needed }), without(never));
    let turning = keys(&["q_offset_deg", "limits_deg"], &["theta_deg", "limits_mm"]);
    let rules = [
        when("kind", &["revolute"], turning.clone()),
        unless("kind", turning),
        when("kind", &["prismatic"], keys(&["theta_deg", "limits_mm"], &["q_offset_deg", "limits_deg"])),
        when("kind", &["passive"], keys(&["q_offset_deg"], &["theta_deg", "limits_deg", "limits_mm"])),
    ];
    with_rules(row, rules)
}

fn coupling() -> Value {
    let row = numbers("One D-H coordinate.", (1, MAX_JOINTS), Must::BeFinite);
    let says =
        "Row i gives the D-H coordinate i as a sum of the actuators: 1 as its number i, after it only 0.";
    list(says, row, (1, Some(MAX_JOINTS)))
}

fn urdf() -> [(&'static str, Value); 4] {
    let packages = json!({
        "description": "Folders of the ROS packages that the URDF names, from the folder of this file.",
        "type": "object", "additionalProperties": { "type": "string" },
    });
    [
        (
            "urdf",
            example(
                text(
                    "A URDF file (without xacro) in place of D-H rows, its path from the folder of this file.",
                ),
                "robots/arm.urdf",
            ),
        ),
        ("base_link", text("The link of the URDF that stands still; left out: its root.")),
        ("tip_link", text("The link of the URDF that carries the tool; left out: its one end.")),
        ("packages", packages),
    ]
}

fn self_collision() -> Value {
    let pair = json!({ "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2 });
    let allowed = json!({
        "description": "Pairs of solids that may touch, by their names.",
        "type": "array", "items": pair, "examples": [[["hand", "cable"]]],
    });
    let pairs = table("Checked, but for some pairs.", [("allowed", allowed)], &["allowed"]);
    let says = "Whether the robot is checked against itself; or the pairs of solids that may touch.";
    default(any(says, [json!({ "type": "boolean" }), pairs]), true)
}
