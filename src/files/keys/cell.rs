//! Keys of the file of a cell, and of `[search]`.

use super::constraints::{fence, margins, transfer};
use super::equipment::{equipment, keep_out, obstacle};
use super::key::*;
use super::operation::operation;
use super::parts::*;
use super::robot::robot_in_cell;
use super::sense::sense;
use crate::cell::*;
use serde_json::{Value, json};

words!(
    Convention,
    Distribution,
    Frame,
    Goal,
    Model,
    Objective,
    Over,
    Quantity,
    Reading,
    Registration,
    Solver
);

const DEFAULT_SEARCH: SearchSettings = SearchSettings::DEFAULT;

key_table! {
    search, "search settings", "How the layout is searched.", {
        SOLVER = word::<Solver>("solver", "Global solver.").default(Literal::Word(DEFAULT_SEARCH.solver.name()));
        OBJECTIVE = word::<Objective>("objective", "How the weighted errors of the operations make one number.").default(Literal::Word(DEFAULT_SEARCH.objective.name()));
        INDIFFERENCE = number("indifference_percent", NumberRange::Positive, "Values that differ by less count as equally good; for the lexicographic objective.").default(Literal::Number(1.0));
        BUDGET = Key::new("budget", BUDGETS, "Number of layouts to evaluate.").default(Literal::Whole(DEFAULT_SEARCH.budget));
        SEED = Key::new("seed", ValueKind::Whole(0, u64::MAX), "Seed of the random numbers: the same seed gives the same bytes.").default(Literal::Whole(DEFAULT_SEARCH.seed));
        ROBUST = boolean("robust", DEFAULT_SEARCH.robust, "Minimize the worst value over the placement tolerances, not the value as drawn.");
        GAP = number("gap", NumberRange::NotNegative, "Stop when the best layout is so near the proven bound, as a share: 0.01 is 1 %.").example("0.01");
        STAGNATION = Key::new("stagnation", BUDGETS, "Stop after so many layouts without improvement.").example("5000");
        PARETO = Key::new("pareto", ValueKind::Checked(&GOALS, unique), "Find the layouts none of which is better than another in all of these goals.").example("[\"error\", \"clearance\"]");
        KEEP = Key::new("keep", ValueKind::Whole(1, MAX_KEPT as u64), "Number of the best layouts to report, which differ from each other.").example("5");
    }
}

const BUDGETS: ValueKind = ValueKind::Whole(*SearchSettings::BUDGETS.start(), *SearchSettings::BUDGETS.end());

const GOALS: ValueKind = ValueKind::List(&ValueKind::word::<Goal>(), (2, Goal::ALL.len()), "goals");

/// Returns the JSON Schema of the names of own senses: not that of a built-in sense, and without @.
fn names_of_senses() -> Value {
    json!({ "propertyNames": { "not": { "anyOf": [{ "enum": PLAIN }, { "pattern": "@" }] } } })
}

const OWN_SENSES: ValueKind = ValueKind::Named(&ValueKind::Table(&sense::TABLE), 0);

key_table! {
    cell, "a cell", "A cell: robot and base, equipment and obstacles with placements, operations, search.", {
        FROM = from("\"hitachi_cell.toml\"");
        SCHEMA = schema("sweetspot/cell/1");
        UNITS = super::UNITS;
        NAME = Key::new("name", ValueKind::Name, "Name of the cell; if left out, the name of its file.");
        SOURCE = super::SOURCE;
        ERRORS = text("errors", "Name of the error set of the robot that counts.").required().example("\"placeholder\"").remedy("add errors = \"NAME\", one of the error sets of the robot");
        MODEL = word::<Model>("model", "Kinematic error model: how errors of the parameters make the error of the TCP.").default(Literal::Word(Model::Nonlinear.name()));
        READING = word::<Reading>("reading", "How the errors are read: as one signed sample, as the worst corner of tolerances, or as random variables; if left out, signed for a sample, else worst-case.");
        QUANTITY = word::<Quantity>("quantity", "Quantity of a random error that is minimized.").default(Literal::Word(Quantity::P95.name()));
        REGISTRATION = word::<Registration>("registration", "What has been measured with the robot itself: nothing, its base frame, or the frame of each surface.").default(Literal::Word(Registration::None.name()));
        GUARD = number("guard_percent", NumberRange::Positive, "A model that differs from the nonlinear one by more is reported as not trustworthy.").default(Literal::Number(1.0));
        ROBOT = table("robot", &robot_in_cell::TABLE, "Robot, and where its base stands.").required().remedy("add robot = { from = \"robots/NAME.toml\" }");
        EQUIPMENT = Key::new("equipment", ValueKind::Named(&ValueKind::Table(&equipment::TABLE), 0), "Equipment that stands in the cell, [equipment.NAME] each.");
        OBSTACLE = Key::new("obstacle", ValueKind::Named(&ValueKind::Table(&obstacle::TABLE), 0), "Obstacles, [obstacle.NAME] each.");
        KEEP_OUT = Key::new("keep_out", ValueKind::Named(&ValueKind::Table(&keep_out::TABLE), 0), "Boxes that nothing may enter, [keep_out.NAME] each.");
        SENSE = Key::new("sense", ValueKind::Checked(&OWN_SENSES, names_of_senses), "Senses that the cell defines, [sense.NAME] each.");
        OPERATION = Key::new("operation", ValueKind::Named(&ValueKind::Table(&operation::TABLE), 1), "Operations, [operation.NAME] each.").required().remedy("add [operation.NAME] with on, grid, bend_deg and sense");
        COLLISION = boolean("collision", true, "Whether collisions are checked.");
        CLEARANCE = number_or_zero("clearance_mm", NumberRange::NotNegative, "Distances less than this count as collision.");
        FLOOR = number_or_zero("floor_mm", NumberRange::Finite, "Height of the floor in the world.");
        MARGINS = table("margins", &margins::TABLE, "Distance that postures keep from joint limits and singular postures.");
        TRANSFER = table("transfer", &transfer::TABLE, "Motions from operation to operation, and from point to point, must be free of collision.");
        FENCE = table("fence", &fence::TABLE, "Fence inside which the equipment and the robot base stand.");
        SEARCH = table("search", &search::TABLE, "How the layout is searched.");
    }
}
