//! Cell files: robot, equipment, obstacles, operations, search settings.

use super::choices::*;
use super::document::Library;
use super::fault::{did_you_mean, listed, shown};
use super::model::*;
use super::reader::{Table, read_named};
use super::robot_model::*;
use super::tree::Node;
use super::value::{self, Must, is_name, text};
use super::{equipment_file, operation_file, robot_file, sense_file};
use crate::units;

/// Reads a whole cell; good only if no fault was recorded. `stem` names it by default.
pub fn read(stem: &str, root: &Node, lib: &mut Library<'_>) -> Option<Cell> {
    Table::read(root, "a cell", lib, |t, lib| {
        super::header(t, "cell", lib)?;
        let name = match t.get("name") {
            Some(_) => t.name(lib),
            None => Some(if is_name(stem) { stem } else { "cell" }.to_string()),
        };
        t.text_or("source", "", lib);
        let robot = read_robot(t, lib);
        let errors = read_error_choice(t, lib);
        let question = read_question(t, lib);
        let equipment = read_equipment(t, lib);
        let keep_out = read_named(t, "keep_out", lib, equipment_file::read_keep_out);
        let senses = sense_file::read_all(t, lib);
        let operations = operation_file::read_all(t, &equipment, &senses, lib);
        let collision = t.boolean_or("collision", true, lib);
        let clearance = t.number_or("clearance_mm", 0.0, Must::NotBeNegative, lib);
        let floor = t.number_or("floor_mm", 0.0, Must::BeFinite, lib);
        let search = read_search(t, lib);
        let ((robot, base), question) = (robot?, question?);
        let mut cell = Cell {
            name: name?,
            robot,
            base,
            errors: errors?,
            model: question.model,
            reading: question.reading.unwrap_or(Reading::Signed),
            quantity: question.quantity,
            registration: question.registration,
            guard: question.guard,
            equipment,
            keep_out,
            operations,
            senses,
            collision: collision?,
            clearance: units::m_from_mm(clearance?),
            floor: units::m_from_mm(floor?),
            search: search?,
        };
        if question.reading.is_none() {
            cell.reading = cell.default_reading();
        }
        Some(cell)
    })
}

/// How the errors are judged.
struct Question {
    model: Model,
    /// None: it follows from the errors.
    reading: Option<Reading>,
    quantity: Quantity,
    registration: Registration,
    guard: f64,
}

fn read_question(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Question> {
    let model = t.choice("model", &Model::ALL, Model::name, Some(Model::Nonlinear), lib);
    let reading = match t.get("reading") {
        Some(node) => value::choice(node, "reading", &Reading::ALL, Reading::name, lib).map(Some),
        None => Some(None),
    };
    let quantity = t.choice("quantity", &Quantity::ALL, Quantity::name, Some(Quantity::P95), lib);
    let none = Some(Registration::None);
    let registration = t.choice("registration", &Registration::ALL, Registration::name, none, lib);
    let guard = t.number_or("guard_percent", 1.0, Must::BePositive, lib).map(units::share_from_percent);
    Some(Question {
        model: model?,
        reading: reading?,
        quantity: quantity?,
        registration: registration?,
        guard: guard?,
    })
}

fn read_robot(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(Robot, Placement)> {
    let node = t.need("robot", "add robot = { from = \"robots/NAME.toml\" }")?;
    Table::read(node, "`robot`", lib, |t, lib| {
        let base = match t.get("base") {
            Some(node) => read_base(node, lib),
            None => Some(Placement { x: 0.0, y: 0.0, z: 0.0, yaw: 0.0 }),
        };
        robot_file::read(t, lib).zip(base)
    })
}

fn read_base(node: &Node, lib: &mut Library<'_>) -> Option<Placement> {
    Table::read(node, "`base`", lib, |t, lib| {
        let x = t.length("x_mm", Must::BeFinite, lib);
        let y = t.length("y_mm", Must::BeFinite, lib);
        let z = t.length("z_mm", Must::BeFinite, lib);
        let yaw = t.number_or("yaw_deg", 0.0, Must::BeFinite, lib);
        Some(Placement { x: x?, y: y?, z: z?, yaw: units::rad_from_deg(yaw?) })
    })
}

/// `errors = "NAME"`: one of the robot's sets, by the names in its file.
fn read_error_choice(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<usize> {
    let node = t.need("errors", "add errors = \"NAME\", one of the error sets of the robot")?;
    let name = text(node, "errors", lib)?;
    let robot = t.get("robot")?;
    let sets = robot.value.get("errors")?.value.entries();
    let found = sets.iter().position(|(k, ..)| *k == name);
    if found.is_none() && !robot.value.is_partial() {
        let names = || sets.iter().map(|(k, ..)| k.as_str());
        let help = match did_you_mean(&name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        lib.error(node.at, format!("the robot has no error set `{}`", shown(&name)), help);
    }
    found
}

/// The equipment, then the obstacles: no two of the same name.
fn read_equipment(t: &mut Table<'_>, lib: &mut Library<'_>) -> Vec<Equipment> {
    let taken = t.get("equipment");
    let mut all =
        read_named(t, "equipment", lib, |n, node, lib| equipment_file::read(n, node, Role::Equipment, lib));
    all.extend(read_named(t, "obstacle", lib, |n, node, lib| {
        if taken.is_some_and(|t| t.value.get(n).is_some()) {
            let message = format!("the name `{}` is already that of an equipment", shown(n));
            lib.error(node.at, message, "give the obstacle a name of its own");
        }
        equipment_file::read(n, node, Role::Obstacle, lib)
    }));
    all
}

fn read_search(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<SearchSettings> {
    let default = SearchSettings {
        solver: Solver::CmaEs,
        objective: Objective::WeightedSum,
        budget: 20_000,
        seed: 1,
        gap: None,
        stagnation: None,
    };
    let Some(node) = t.get("search") else { return Some(default) };
    Table::read(node, "`search`", lib, |t, lib| {
        let solver = t.choice("solver", &Solver::ALL, Solver::name, Some(default.solver), lib);
        let objective = t.choice("objective", &Objective::ALL, Objective::name, Some(default.objective), lib);
        let budget = t.integer_or("budget", default.budget, (1, 1_000_000_000), lib);
        let seed = t.integer_or("seed", default.seed, (0, u64::MAX), lib);
        let gap = match t.get("gap") {
            Some(_) => t.number("gap", Must::NotBeNegative, lib).map(Some),
            None => Some(None),
        };
        let stagnation = match t.get("stagnation") {
            Some(_) => t.integer_or("stagnation", 1, (1, 1_000_000_000), lib).map(Some),
            None => Some(None),
        };
        let (solver, objective, budget, seed) = (solver?, objective?, budget?, seed?);
        Some(SearchSettings { solver, objective, budget, seed, gap: gap?, stagnation: stagnation? })
    })
}
