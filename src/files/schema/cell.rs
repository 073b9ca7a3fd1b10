//! The cell file.

use super::parts::*;
use super::{equipment, operation, robot};
use crate::cell::{
    Goal, MAX_JOINTS, MOST_KEPT, Model, Objective, PLAIN, Quantity, Reading, Registration, SearchSettings,
    Solver,
};
use crate::files::toml::value::Must;
use serde_json::{Value, json};

pub fn cell() -> Value {
    let [schema, units] = header("cell");
    let says = "A cell: robot and base, equipment and obstacles with placements, operations, search.";
    let about = [
        (
            "from",
            path(
                "The cell file that this one builds on; what stands here wins, lists are replaced whole.",
                "hitachi_cell.toml",
            ),
        ),
        schema,
        units,
        ("name", name("What the cell is called; left out: the name of its file.")),
        ("source", text("Where its numbers come from.")),
        ("errors", example(text("The error set of the robot that counts, by its name."), "placeholder")),
    ];
    let stands = [
        ("robot", robot::in_cell()),
        ("equipment", named("What stands in the cell, [equipment.NAME] each.", equipment::in_cell())),
        ("obstacle", named("What stands in the way, [obstacle.NAME] each.", equipment::obstacle())),
        ("keep_out", named("Boxes that nothing may enter, [keep_out.NAME] each.", equipment::keep_out())),
        ("sense", senses()),
        (
            "operation",
            with(
                named("The operations, [operation.NAME] each.", operation::operation()),
                json!({ "minProperties": 1 }),
            ),
        ),
        ("collision", boolean("Whether collisions are looked at.", true)),
        (
            "clearance_mm",
            default(number("Less distance than this counts as collision, mm.", Must::NotBeNegative), 0),
        ),
        ("floor_mm", default(number("Height of the floor in the world, mm.", Must::BeFinite), 0)),
        ("margins", margins()),
        ("transfer", transfer()),
        ("fence", fence()),
        ("search", search()),
    ];
    let required = ["robot", "errors", "operation"];
    of_file(with_keys(about, with_keys(question(), table(says, stands, &required))))
}

/// How the errors are judged.
fn question() -> [(&'static str, Value); 5] {
    let model = word("How errors of the parameters make that of the TCP.", &Model::ALL.map(Model::name));
    let reading = word(
        "How the errors are read: as one signed sample, as the worst corner of tolerances, or as random variables; left out: signed of a sample, else worst-case.",
        &Reading::ALL.map(Reading::name),
    );
    let quantity = word("What of a random error is made small.", &Quantity::ALL.map(Quantity::name));
    let registration = word(
        "What has been measured with the robot itself: nothing, its base frame, or the frame of each surface.",
        &Registration::ALL.map(Registration::name),
    );
    let guard = number(
        "Where a model is further than this off the nonlinear one, it is said not to be trusted, per cent.",
        Must::BePositive,
    );
    [
        ("model", default(model, Model::Nonlinear.name())),
        ("reading", reading),
        ("quantity", default(quantity, Quantity::P95.name())),
        ("registration", default(registration, Registration::None.name())),
        ("guard_percent", default(guard, 1)),
    ]
}

/// No sense has the name of a plain one, or an @.
fn senses() -> Value {
    let mut all = named("Senses of your own, [sense.NAME] each.", operation::sense());
    let printable = all["propertyNames"].take();
    all["propertyNames"] =
        with(printable, json!({ "not": { "anyOf": [{ "enum": PLAIN }, { "pattern": "@" }] } }));
    all
}

fn margins() -> Value {
    let mut singularity = default(
        number(
            "Least singular value of the Jacobian that postures keep, lengths in reaches; less than 1.",
            Must::NotBeNegative,
        ),
        0,
    );
    singularity["exclusiveMaximum"] = json!(1);
    table(
        "How far postures keep from joint limits and singular postures.",
        [
            (
                "joint_deg",
                default(number("From the limits of joints that turn, degrees.", Must::NotBeNegative), 0),
            ),
            (
                "joint_mm",
                default(number("From the limits of joints that slide, mm.", Must::NotBeNegative), 0),
            ),
            ("singularity", singularity),
        ],
        &[],
    )
}

fn transfer() -> Value {
    let posture =
        numbers("A posture: one number for each joint, degrees or mm.", (1, MAX_JOINTS), Must::BeFinite);
    let several = list("Several postures.", posture.clone(), (0, None));
    table(
        "The ways from operation to operation, and from point to point, must be free.",
        [
            ("check", boolean("Whether the ways are looked at.", true)),
            (
                "lift_mm",
                default(
                    number("How far the tool may be lifted to get round things, mm.", Must::NotBeNegative),
                    0,
                ),
            ),
            (
                "via",
                any(
                    "A posture, or several, by which a way may go; left out: the home posture.",
                    [posture, several],
                ),
            ),
            (
                "cycle",
                boolean("Whether there must be a way from the last operation back to the first.", false),
            ),
        ],
        &[],
    )
}

fn fence() -> Value {
    let corner = numbers("x and y in the world, mm.", (2, 2), Must::BeFinite);
    table(
        "The fence: equipment and robot base stand inside.",
        [
            (
                "polygon_mm",
                list(
                    "Its corners, in the order in which you walk along it, mm; it closes by itself.",
                    corner,
                    (3, None),
                ),
            ),
            (
                "height_mm",
                number(
                    "The height of a wall that the robot must not touch, mm; left out: it is a line on the floor.",
                    Must::BePositive,
                ),
            ),
        ],
        &["polygon_mm"],
    )
}

fn search() -> Value {
    let settings = SearchSettings::default();
    let goals = json!({
        "description": "Find layouts none of which is better than another in all of these goals.",
        "type": "array", "items": { "type": "string", "enum": Goal::ALL.map(Goal::name) },
        "minItems": 2, "uniqueItems": true, "examples": [["error", "clearance"]],
    });
    let count = (1, 1_000_000_000);
    let gap = number(
        "End when the best is so near the proven bound, as a share: 0.01 is 1 %.",
        Must::NotBeNegative,
    );
    let share = number(
        "Values that differ by less count as equally good, of the lexicographic objective, per cent.",
        Must::BePositive,
    );
    table(
        "How the layout is searched.",
        [
            (
                "solver",
                default(word("The global solver.", &Solver::ALL.map(Solver::name)), settings.solver.name()),
            ),
            (
                "objective",
                default(
                    word(
                        "How the weighted errors of the operations make one number.",
                        &Objective::ALL.map(Objective::name),
                    ),
                    settings.objective.name(),
                ),
            ),
            ("indifference_percent", default(share, 1)),
            ("budget", default(integer("How many layouts are evaluated.", count), settings.budget)),
            (
                "seed",
                default(
                    integer("Seed of all randomness: the same seed gives the same bytes.", (0, u64::MAX)),
                    settings.seed,
                ),
            ),
            (
                "robust",
                boolean(
                    "Make the worst over the placement tolerances small, not the value as drawn.",
                    settings.robust,
                ),
            ),
            ("gap", example(gap, 0.01)),
            ("stagnation", integer("End after so many layouts without improvement.", count)),
            ("pareto", goals),
            ("keep", integer("How many of the best layouts that differ are told.", (1, MOST_KEPT as u64))),
        ],
        &[],
    )
}
