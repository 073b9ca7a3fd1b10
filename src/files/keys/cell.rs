//! Cell files: robot, equipment, obstacles, operations, search settings.

use super::misplacement;
use super::{constraints, equipment, operation, robot, sense};
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::{Table, read_named};
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, is_name, text};
use crate::units;

/// Reads a whole cell; good only if no fault was recorded. `stem` names it by default.
pub fn read(stem: &str, root: &Node, lib: &mut Library<'_>) -> Option<Cell> {
    Table::read(root, "a cell", lib, |t, lib| {
        crate::files::header::header(t, "cell", lib)?;
        let name = match t.get("name") {
            Some(_) => t.name(lib),
            None => Some(if is_name(stem) { stem } else { "cell" }.to_string()),
        };
        t.text_or("source", "", lib);
        let robot = read_robot(t, lib);
        let errors = read_error_choice(t, lib);
        let question = read_question(t, lib);
        let mut equipment = read_equipment(t, lib);
        equipment::tie(t, &mut equipment, lib);
        let keep_out = read_named(t, "keep_out", lib, equipment::read_keep_out);
        let senses = sense::read_all(t, lib);
        let operations = operation::read_all(t, &equipment, &senses, lib);
        let collision = t.boolean_or("collision", true, lib);
        let clearance = t.number_or("clearance_mm", 0.0, Must::NotBeNegative, lib);
        let floor = t.number_or("floor_mm", 0.0, Must::BeFinite, lib);
        let built = robot.as_ref().map(|(robot, ..)| robot);
        let margins = constraints::read_margins(t.get("margins"), built, lib);
        let transfer = constraints::read_transfer(t.get("transfer"), built, margins, lib);
        let fence = constraints::read_fence(t.get("fence"), lib);
        let search = read_search(t, lib);
        let ((robot, base, base_tolerance), question) = (robot?, question?);
        let mut cell = Cell {
            name: name?,
            robot,
            base,
            base_tolerance,
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
            margins: margins?,
            transfer: transfer?,
            fence: fence?,
            search: search?,
        };
        refuse_nothing_to_withstand(t, &cell, lib);
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

type Based = (Robot, [Coordinate; 4], PlacementTolerance);

fn read_robot(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Based> {
    let node = t.need("robot", "add robot = { from = \"robots/NAME.toml\" }")?;
    Table::read(node, "`robot`", lib, |t, lib| {
        let base = match t.get("base") {
            Some(node) => read_base(node, lib),
            None => Some([(); 4].map(|()| Coordinate::Fixed(0.0))),
        };
        let tolerance = match t.get("base_tolerance") {
            Some(node) => misplacement::read(node, "`base_tolerance`", Role::Equipment, lib),
            None => Some(PlacementTolerance::default()),
        };
        Some((robot::read(t, lib)?, base?, tolerance?))
    })
}

/// A robust search needs something that may be misplaced.
fn refuse_nothing_to_withstand(t: &mut Table<'_>, cell: &Cell, lib: &mut Library<'_>) {
    if let Some(node) = t.get("search").and_then(|search| search.value.get("robust"))
        && cell.search.robust
        && !cell.has_placement_tolerance()
    {
        let help = "add placement_tolerance = { x_mm = 2, y_mm = 2 } to an equipment";
        lib.error(node.at, "`robust`, but everything is placed exactly".into(), help);
    }
}

fn read_base(node: &Node, lib: &mut Library<'_>) -> Option<[Coordinate; 4]> {
    Table::read(node, "`base`", lib, |t, lib| equipment::read_coordinates(t, Role::Equipment, lib))
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
        read_named(t, "equipment", lib, |n, node, lib| equipment::read(n, node, Role::Equipment, lib));
    all.extend(read_named(t, "obstacle", lib, |n, node, lib| {
        if taken.is_some_and(|t| t.value.get(n).is_some()) {
            let message = format!("the name `{}` is already that of an equipment", shown(n));
            lib.error(node.at, message, "give the obstacle a name of its own");
        }
        equipment::read(n, node, Role::Obstacle, lib)
    }));
    all
}

fn read_search(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<SearchSettings> {
    let default = SearchSettings::default();
    let Some(node) = t.get("search") else { return Some(default) };
    Table::read(node, "`search`", lib, |t, lib| {
        let solver = t.choice("solver", &Solver::ALL, Solver::name, Some(default.solver), lib);
        let objective = t.choice("objective", &Objective::ALL, Objective::name, Some(default.objective), lib);
        let indifference = t.number_or("indifference_percent", 1.0, Must::BePositive, lib);
        let budget = t.integer_or("budget", default.budget, (1, 1_000_000_000), lib);
        let seed = t.integer_or("seed", default.seed, (0, u64::MAX), lib);
        let robust = t.boolean_or("robust", false, lib);
        let gap = match t.get("gap") {
            Some(_) => t.number("gap", Must::NotBeNegative, lib).map(Some),
            None => Some(None),
        };
        let stagnation = match t.get("stagnation") {
            Some(_) => t.integer_or("stagnation", 1, (1, 1_000_000_000), lib).map(Some),
            None => Some(None),
        };
        let (pareto, keep) =
            (read_pareto(t.get("pareto"), lib), t.integer_or("keep", 0, (1, MOST_KEPT as u64), lib));
        Some(SearchSettings {
            solver: solver?,
            objective: objective?,
            indifference: units::share_from_percent(indifference?),
            budget: budget?,
            seed: seed?,
            robust: robust?,
            gap: gap?,
            stagnation: stagnation?,
            pareto: pareto?,
            keep: keep? as usize,
        })
    })
}

/// `pareto = ["error", "clearance"]`: two goals or more.
fn read_pareto(node: Option<&Node>, lib: &mut Library<'_>) -> Option<Goals> {
    let Some(node) = node else { return Some(Goals::default()) };
    let Value::Array(items) = &node.value else {
        let message = format!("`pareto` must be a list of goals, not {}", node.value.kind());
        lib.error(node.at, message, "write pareto = [\"error\", \"clearance\"]");
        return None;
    };
    let named = items.iter().map(|item| read_goal(item, lib));
    let named: Option<Vec<Goal>> = named.collect::<Vec<_>>().into_iter().collect();
    let named = named?;
    let goals = Goals::of(&named).filter(|goals| goals.count() > 1);
    if goals.is_none() {
        let names = listed(Goal::ALL.map(Goal::name));
        lib.error(
            node.at,
            "`pareto` must name two goals or more, each once".into(),
            format!("there are: {names}"),
        );
    }
    goals
}

fn read_goal(node: &Node, lib: &mut Library<'_>) -> Option<Goal> {
    let word = text(node, "pareto", lib)?;
    let found = Goal::ALL.into_iter().find(|goal| goal.name() == word);
    if found.is_none() {
        let help = match did_you_mean(&word, Goal::ALL.map(Goal::name)) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("there are: {}", listed(Goal::ALL.map(Goal::name))),
        };
        lib.error(node.at, format!("\"{}\" is no goal", shown(&word)), help);
    }
    found
}
