//! Keys of a cell file, and of its table `[search]`.

use super::constraints::{fence, margins, transfer};
use super::equipment::{equipment, keep_out, obstacle};
use super::key::*;
use super::operation::operation;
use super::parts::*;
use super::robot::robot_in_cell;
use super::sense::sense;
use super::title_block::title_block;
use crate::cell::*;
use serde_json::{Value, json};

words!(
    Convention,
    Distribution,
    Frame,
    Goal,
    Model,
    Objective,
    NodeAggregation,
    Quantity,
    Reading,
    Registration,
    Solver
);

const DEFAULT_SEARCH: SearchSettings = SearchSettings::DEFAULT;

key_table! {
    search, "search settings", "Settings of the search for a layout.", {
        SOLVER = word::<Solver>("solver", "Global solver that searches for the best layout.").default(Literal::Word(DEFAULT_SEARCH.solver.name()));
        OBJECTIVE = word::<Objective>("objective", "Objective: how the weighted errors of the operations are combined into one number.").default(Literal::Word(DEFAULT_SEARCH.objective.name()));
        INDIFFERENCE = number("indifference_percent", NumberRange::Positive, "Relative difference up to which two objectives count as equally good. The lexicographic objective divides values into steps of this relative width. If the values of an operation in two layouts are in the same step, the next operation decides.").default(Literal::Number(1.0));
        BUDGET = Key::new("budget", BUDGETS, "Largest number of layouts to evaluate.").default(Literal::Whole(DEFAULT_SEARCH.budget));
        SEED = Key::new("seed", ValueKind::Whole(0, u64::MAX), "Seed of the random numbers: the same seed gives identical results.").default(Literal::Whole(DEFAULT_SEARCH.seed));
        IDEAL = boolean("ideal", DEFAULT_SEARCH.ideal, "Whether every piece stands exactly at its placement. If true, placement tolerances are ignored, and no clearance, margin or tolerance is assumed.");
        RESOLUTION_MM = number("resolution_mm", NumberRange::Positive, "Step of lengths: in the layouts that a search finds, x, y and z are multiples of this length. If left out, it is 1, or 0.001 with `ideal`.").example("1");
        RESOLUTION_DEG = number("resolution_deg", NumberRange::Positive, "Step of angles: in the layouts that a search finds, angles are multiples of this angle. If left out, it is 0.1, or 0.0001 with `ideal`.").example("0.1");
        ROBUST = boolean("robust", DEFAULT_SEARCH.robust, "Whether to minimize a proven upper bound of the value over the placement tolerances, instead of the value at the exact placements.");
        GAP = number("gap", NumberRange::NotNegative, "Stop when the objective exceeds the proven lower bound by at most this share: 0.01 is 1 %.").example("0.01");
        STAGNATION = Key::new("stagnation", BUDGETS, "Stop when this number of evaluations in succession has brought no improvement.").example("5000");
        PARETO = Key::new("pareto", ValueKind::Checked(&GOALS, unique), "Goals of a search for the Pareto front. On this front, no goal can be improved without making another goal worse.").example("[\"error\", \"clearance\"]");
        KEEP = Key::new("keep", ValueKind::Whole(1, MAX_KEPT as u64), "Number of layouts to report. The reported layouts are the best ones that clearly differ from each other.").example("5");
    }
}

const BUDGETS: ValueKind = ValueKind::Whole(*SearchSettings::BUDGETS.start(), *SearchSettings::BUDGETS.end());

const GOALS: ValueKind = ValueKind::List(&ValueKind::word::<Goal>(), (2, Goal::ALL.len()), "goals");

/// Returns the JSON Schema of the names of senses that a cell defines.
///
/// Such a name contains no @ and is not the name of a built-in sense.
fn names_of_senses() -> Value {
    json!({ "propertyNames": { "not": { "anyOf": [{ "enum": PLAIN }, { "pattern": "@" }] } } })
}

const OWN_SENSES: ValueKind = ValueKind::Named(&ValueKind::Table(&sense::TABLE), 0);

key_table! {
    cell, "a cell", "Cell: robot with its base, equipment, obstacles, operations, and settings of the search.", {
        FROM = from("\"hitachi_cell.toml\"");
        SCHEMA = schema("sweetspot/cell/1");
        UNITS = super::UNITS;
        NAME = Key::new("name", ValueKind::Name, "Name of the cell; if left out, the name of its file.");
        SOURCE = super::SOURCE;
        ERRORS = text("errors", "Name of the robot's error set to evaluate.").required().example("\"placeholder\"").remedy("add errors = \"NAME\", one of the error sets of the robot");
        MODEL = word::<Model>("model", "Kinematic error model: how errors of the parameters become the error of the TCP.").default(Literal::Word(Model::Nonlinear.name()));
        READING = word::<Reading>("reading", "Interpretation of the errors: one signed sample, the worst corner of tolerances, or random variables. The default is worst-case if an error set in use states tolerances, and signed otherwise.");
        QUANTITY = word::<Quantity>("quantity", "Statistic that a search minimizes in the statistical reading.").default(Literal::Word(Quantity::P95.name()));
        REGISTRATION = word::<Registration>("registration", "Frames that were measured with the robot itself: none, the base frame of the robot, or the frame of each surface. A measured base frame is the least-squares fit to the TCP position errors in all postures within the joint limits.").default(Literal::Word(Registration::None.name()));
        GUARD = number("guard_percent", NumberRange::Positive, "Guard: threshold for the difference between an error model and the nonlinear model. If the difference is greater, reports warn that the error model cannot be trusted.").default(Literal::Number(1.0));
        ROBOT = table("robot", &robot_in_cell::TABLE, "Robot and the placement of its base.").required().remedy("add robot = { from = \"robots/NAME.toml\" }");
        EQUIPMENT = Key::new("equipment", ValueKind::Named(&ValueKind::Table(&equipment::TABLE), 0), "Equipment of the cell: one table [equipment.NAME] for each piece.");
        OBSTACLE = Key::new("obstacle", ValueKind::Named(&ValueKind::Table(&obstacle::TABLE), 0), "Obstacles: one table [obstacle.NAME] for each.");
        KEEP_OUT = Key::new("keep_out", ValueKind::Named(&ValueKind::Table(&keep_out::TABLE), 0), "Keep-out boxes for equipment, robot, tool and held parts: one table [keep_out.NAME] for each box.");
        SENSE = Key::new("sense", ValueKind::Checked(&OWN_SENSES, names_of_senses), "Senses that the cell defines: one table [sense.NAME] for each.");
        OPERATION = Key::new("operation", ValueKind::Named(&ValueKind::Table(&operation::TABLE), 1), "Operations: one table [operation.NAME] for each.").required().remedy("add [operation.NAME] with the keys `on`, `grid`, `bend_deg` and `sense`");
        COLLISION = boolean("collision", true, "Whether collisions are checked.");
        CLEARANCE = number("clearance_mm", NumberRange::NotNegative, "Clearance: a smaller distance counts as a collision. Two floor spaces must be this far apart in height or in plan. The distance in plan is measured parallel to a side of either floor space. Default in a search for layouts to build: 10. Default otherwise: 0.").example("10");
        FLOOR = number_or_zero("floor_mm", NumberRange::Finite, "Height of the floor in the world frame.");
        MARGINS = table("margins", &margins::TABLE, "Least distance of postures from joint limits and singular postures.");
        TRANSFER = table("transfer", &transfer::TABLE, "Collision check of two kinds of motions: from one operation to the next, and from one listed point of an operation to the next.");
        FENCE = table("fence", &fence::TABLE, "Fence around the equipment and the robot base.");
        SEARCH = table("search", &search::TABLE, "Settings of the search for a layout.");
        TITLE_BLOCK = table("title_block", &title_block::TABLE, "Title block of the drawings that `export` makes (ISO 7200).");
    }
}
