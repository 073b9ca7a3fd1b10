//! Cell files: robot, equipment, obstacles, operations, search settings.

use super::document::{Library, Node, Value};
use super::fault::{did_you_mean, shown};
use super::model::*;
use super::reader::{Must, Table, integer, text};
use super::{equipment_file, robot_file, solid};
use crate::units;

/// Most nodes of one grid: a map of more is no picture, and takes hours and gigabytes.
pub const MAX_NODES: u64 = 1_000_000;

/// Reads a whole cell; None with the faults recorded.
pub fn read(name: &str, root: &Node, lib: &mut Library<'_>) -> Option<Cell> {
    let mut t = Table::of(root, "a cell", lib)?;
    super::header(&mut t, "cell", lib);
    let name = t.text_or("name", name, lib).and_then(|n| solid::checked_name(n, t.at, lib));
    t.text_or("source", "", lib);
    let robot = read_robot(&mut t, lib);
    let errors = read_error_choice(&mut t, robot.as_ref().map(|(r, _)| r), lib);
    let model = t.choice("model", &Model::ALL, Model::name, Some(Model::Nonlinear), lib);
    let equipment = read_equipment(&mut t, lib);
    let keep_out = read_named(&mut t, "keep_out", lib, equipment_file::read_keep_out);
    let operations = read_operations(&mut t, equipment.as_deref(), lib);
    let collision = t.boolean_or("collision", true, lib);
    let clearance = t.number_or("clearance_mm", 0.0, Must::NotBeNegative, lib);
    let floor = t.number_or("floor_mm", 0.0, Must::BeFinite, lib);
    let search = read_search(&mut t, lib);
    t.finish(lib);
    let (robot, base) = robot?;
    Some(Cell {
        name: name?,
        robot,
        base,
        errors: errors?,
        model: model?,
        equipment: equipment?,
        keep_out: keep_out?,
        operations: operations?,
        collision: collision?,
        clearance: units::m_from_mm(clearance?),
        floor: units::m_from_mm(floor?),
        search: search?,
    })
}

fn read_robot(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(Robot, Placement)> {
    let node = t.need("robot", lib)?;
    let mut t = Table::of(node, "`robot`", lib)?;
    let base = match t.get("base") {
        Some(node) => read_base(node, lib),
        None => Some(Placement { x: 0.0, y: 0.0, z: 0.0, yaw: 0.0 }),
    };
    let robot = robot_file::read(&mut t, lib);
    t.finish(lib);
    robot.zip(base)
}

fn read_base(node: &Node, lib: &mut Library<'_>) -> Option<Placement> {
    let mut t = Table::of(node, "`base`", lib)?;
    let x = t.length("x_mm", Must::BeFinite, lib);
    let y = t.length("y_mm", Must::BeFinite, lib);
    let z = t.length("z_mm", Must::BeFinite, lib);
    let yaw = t.number_or("yaw_deg", 0.0, Must::BeFinite, lib);
    t.finish(lib);
    Some(Placement { x: x?, y: y?, z: z?, yaw: units::rad_from_deg(yaw?) })
}

/// `errors = "NAME"`: one of the robot's sets.
fn read_error_choice(t: &mut Table<'_>, robot: Option<&Robot>, lib: &mut Library<'_>) -> Option<usize> {
    let node = t.need("errors", lib)?;
    let name = text(node, "errors", lib)?;
    let sets = &robot?.errors;
    let found = sets.iter().position(|e| e.name == name);
    if found.is_none() {
        let names: Vec<_> = sets.iter().map(|e| e.name.as_str()).collect();
        let help = match did_you_mean(&name, names.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("the robot has: {}", names.join(", ")),
        };
        lib.error(node.at, format!("the robot has no error set `{}`", shown(&name)), help);
    }
    found
}

/// Reads a table of named tables; a missing one is empty.
fn read_named<'n, T>(
    t: &mut Table<'n>,
    key: &'static str,
    lib: &mut Library<'_>,
    mut read: impl FnMut(&'n str, &'n Node, &mut Library<'_>) -> Option<T>,
) -> Option<Vec<T>> {
    let Some(node) = t.get(key) else { return Some(Vec::new()) };
    let named = Table::of(node, &format!("`{key}`"), lib)?;
    let all: Vec<_> = named.named().map(|(name, _, node)| read(name, node, lib)).collect();
    all.into_iter().collect()
}

fn read_equipment(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Vec<Equipment>> {
    let movable =
        read_named(t, "equipment", lib, |n, node, lib| equipment_file::read(n, node, Role::Equipment, lib));
    let mut taken = Vec::new();
    if let Some(node) = t.get("equipment")
        && let Value::Table(entries) = &node.value
    {
        taken.extend(entries.iter().map(|(k, ..)| k.as_str()));
    }
    let fixed = read_named(t, "obstacle", lib, |n, node, lib| {
        if taken.contains(&n) {
            let message = format!("the name `{}` is already that of an equipment", shown(n));
            lib.error(node.at, message, "give the obstacle a name of its own");
            return None;
        }
        equipment_file::read(n, node, Role::Obstacle, lib)
    });
    let mut all = movable?;
    all.extend(fixed?);
    Some(all)
}

fn read_operations(
    t: &mut Table<'_>,
    equipment: Option<&[Equipment]>,
    lib: &mut Library<'_>,
) -> Option<Vec<Operation>> {
    let read = read_named(t, "operation", lib, |name, node, lib| read_operation(name, node, equipment, lib))?;
    if read.is_empty() {
        lib.error(t.at, "no operation".into(), "add [operation.NAME] with on, grid, bend_deg and sense");
        return None;
    }
    Some(read)
}

fn read_operation(
    name: &str,
    node: &Node,
    equipment: Option<&[Equipment]>,
    lib: &mut Library<'_>,
) -> Option<Operation> {
    let mut t = Table::of(node, "an operation", lib)?;
    let named = solid::checked_name(name.to_string(), node.at, lib);
    let on = read_surface_choice(&mut t, equipment, lib);
    let grid = read_grid(&mut t, lib);
    let standoff = t.number_or("standoff_mm", 0.0, Must::NotBeNegative, lib);
    let bend_at = t.get("bend_deg").map_or(t.at, |n| n.at);
    let bend = t.number("bend_deg", Must::BeFinite, lib);
    let sense = t.choice("sense", &Sense::ALL, Sense::name, None, lib);
    let weight = t.number_or("weight", 1.0, Must::BePositive, lib);
    t.finish(lib);
    let bend = bend?;
    if bend.abs() > 90.0 {
        let message = format!("`bend_deg` {bend} is no elevation");
        lib.error(bend_at, message, "from -90 (tool pointing down) over 0 (horizontal) to 90 (up)");
        return None;
    }
    Some(Operation {
        name: named?,
        equipment: on?,
        grid: grid?,
        standoff: units::m_from_mm(standoff?),
        bend: units::rad_from_deg(bend),
        sense: sense?,
        weight: weight?,
    })
}

/// `on = "NAME"`: an equipment with a work surface.
fn read_surface_choice(
    t: &mut Table<'_>,
    equipment: Option<&[Equipment]>,
    lib: &mut Library<'_>,
) -> Option<usize> {
    let node = t.need("on", lib)?;
    let name = text(node, "on", lib)?;
    let all = equipment?;
    let with_surface = || all.iter().filter(|e| e.surface.is_some()).map(|e| e.name.as_str());
    match all.iter().position(|e| e.name == name) {
        Some(index) if all[index].surface.is_some() => Some(index),
        Some(_) => {
            let message = format!("`{}` has no work surface", shown(&name));
            lib.error(node.at, message, "add surface = { size_mm = [1500, 700] } to it");
            None
        }
        None => {
            let help = match did_you_mean(&name, with_surface()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => {
                    format!("equipment with a surface: {}", with_surface().collect::<Vec<_>>().join(", "))
                }
            };
            lib.error(node.at, format!("there is no equipment `{}`", shown(&name)), help);
            None
        }
    }
}

/// `grid = [m, n]`: divisions along x and y, (m + 1)(n + 1) nodes.
fn read_grid(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(usize, usize)> {
    let node = t.need("grid", lib)?;
    let divisions: Vec<_> = match &node.value {
        Value::Array(items) if items.len() == 2 => {
            items.iter().map(|n| integer(n, "grid", (1, u64::from(u32::MAX)), lib)).collect()
        }
        _ => {
            lib.error(node.at, "`grid` must be the two numbers of divisions".into(), "write grid = [10, 8]");
            return None;
        }
    };
    let (m, n) = (divisions[0]?, divisions[1]?);
    let nodes = (m + 1).saturating_mul(n + 1);
    if nodes > MAX_NODES {
        // Measured on the shipped cells: about 2 us and 500 bytes a node for a full map.
        let (hours, gigabytes) = (nodes as f64 * 2e-6 / 3600.0, nodes as f64 * 500.0 / 1e9);
        let message =
            format!("a grid of {nodes} nodes: about {hours:.1} hours and {gigabytes:.1} GB for one map");
        lib.error(node.at, message, format!("at most {MAX_NODES} nodes; [10, 8] makes 99"));
        return None;
    }
    Some((m as usize, n as usize))
}

fn read_search(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<SearchSettings> {
    let default =
        SearchSettings { solver: Solver::CmaEs, objective: Objective::WeightedSum, budget: 20_000, seed: 1 };
    let Some(node) = t.get("search") else { return Some(default) };
    let mut t = Table::of(node, "`search`", lib)?;
    let solver = t.choice("solver", &Solver::ALL, Solver::name, Some(default.solver), lib);
    let objective = t.choice("objective", &Objective::ALL, Objective::name, Some(default.objective), lib);
    let budget = t.integer_or("budget", default.budget, (1, 1_000_000_000), lib);
    let seed = t.integer_or("seed", default.seed, (0, u64::MAX), lib);
    t.finish(lib);
    Some(SearchSettings { solver: solver?, objective: objective?, budget: budget?, seed: seed? })
}
