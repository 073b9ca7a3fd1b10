//! Operations of a cell: on which surface, where on it, which way the tool points.

use super::document::Library;
use super::fault::{did_you_mean, listed, shown};
use super::model::*;
use super::reader::{Table, read_named};
use super::sense::Sense;
use super::tree::{Entry, Node, Value};
use super::value::{self, Must, plain};
use crate::units;

/// Most nodes of one grid: a map of more is no picture, and takes hours and gigabytes.
pub const MAX_NODES: u64 = 1_000_000;

/// What `map --json` takes a node, s and bytes: measured with a million nodes on hitachi_cell.
const NODE_COST: (f64, f64) = (1.4e-5, 700.0);

/// Reads every `[operation.NAME]`.
pub fn read_all(t: &mut Table<'_>, equipment: &[Equipment], lib: &mut Library<'_>) -> Vec<Operation> {
    let help = "add [operation.NAME] with on, grid, bend_deg and sense";
    if let Some(node) = t.need("operation", help)
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        lib.error(node.at, "no operation".into(), help);
    }
    let standing = ["equipment", "obstacle"].map(|key| t.get(key));
    let is_table = |node: &&Node| matches!(node.value, Value::Table(_));
    let complete = !t.partial && standing.iter().flatten().all(is_table);
    let entries = standing.into_iter().flatten().flat_map(|node| node.value.entries());
    let standing = Standing { complete, equipment, entries: entries.collect() };
    read_named(t, "operation", lib, |name, node, lib| read(name, node, &standing, lib))
}

/// What may carry an operation.
struct Standing<'c> {
    /// Whether nothing was lost with a file.
    complete: bool,
    /// What could be read.
    equipment: &'c [Equipment],
    /// What is named, equipment first.
    entries: Vec<&'c Entry>,
}

fn read(name: &str, node: &Node, standing: &Standing<'_>, lib: &mut Library<'_>) -> Option<Operation> {
    Table::read(node, "an operation", lib, |t, lib| {
        let on = read_surface_choice(t, standing, lib);
        let grid = read_grid(t, lib);
        let standoff = t.number_or("standoff_mm", 0.0, Must::NotBeNegative, lib);
        let bend = read_bend(t, lib);
        let sense = t.text("sense", lib).and_then(|word| Sense::plain(&word));
        let weight = t.number_or("weight", 1.0, Must::BePositive, lib);
        Some(Operation {
            name: name.to_string(),
            equipment: on?,
            grid: grid?,
            standoff: units::m_from_mm(standoff?),
            bend: bend?,
            sense: sense?,
            limit: None,
            relative_to: None,
            teach: None,
            weight: weight?,
        })
    })
}

/// `on = "NAME"`: something with a work surface, by the names in the cell.
fn read_surface_choice(t: &mut Table<'_>, standing: &Standing<'_>, lib: &mut Library<'_>) -> Option<usize> {
    let node = t.need("on", "add on = \"NAME\" of an equipment with a work surface")?;
    let name = value::text(node, "on", lib)?;
    let has_surface = |part: &Node| part.value.get("surface").is_some();
    let Some(index) = standing.entries.iter().position(|(n, ..)| *n == name) else {
        let fitting = || standing.entries.iter().filter(|e| has_surface(&e.2)).map(|e| e.0.as_str());
        let help = match did_you_mean(&name, fitting()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("equipment with a work surface: {}", listed(fitting())),
        };
        if standing.complete {
            lib.error(node.at, format!("there is no equipment `{}`", shown(&name)), help);
        }
        return None;
    };
    if standing.equipment.iter().any(|e| e.name == name) && !has_surface(&standing.entries[index].2) {
        let message = format!("`{}` has no work surface", shown(&name));
        lib.error(node.at, message, "add to it for example surface = { size_mm = [1500, 700] }");
    }
    Some(index)
}

/// `grid = [m, n]`: divisions along x and y, (m + 1)(n + 1) nodes.
fn read_grid(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(usize, usize)> {
    let node = t.need("grid", "add grid = [10, 8], the divisions along x and y")?;
    let Value::Array(items) = &node.value else {
        let message = format!("`grid` must be a list of 2 whole numbers, not {}", node.value.kind());
        lib.error(node.at, message, "write the divisions along x and y, for example grid = [10, 8]");
        return None;
    };
    let [along_x, along_y] = &items[..] else {
        let message = format!("`grid` must be a list of 2 whole numbers, not {}", items.len());
        lib.error(node.at, message, "write the divisions along x and y, for example grid = [10, 8]");
        return None;
    };
    let m = value::integer(along_x, "number 1 of `grid`", (1, u64::MAX), lib);
    let n = value::integer(along_y, "number 2 of `grid`", (1, u64::MAX), lib);
    let (m, n) = (m?, n?);
    let nodes = (m as f64 + 1.0) * (n as f64 + 1.0);
    if nodes > MAX_NODES as f64 {
        let (minutes, gigabytes) = (about(nodes * NODE_COST.0 / 60.0), about(nodes * NODE_COST.1 / 1e9));
        let nodes = plain(nodes);
        let message = format!("a grid of {nodes} nodes: about {minutes} minutes and {gigabytes} GB a map");
        lib.error(node.at, message, format!("at most {MAX_NODES} nodes; [10, 8] makes 99"));
        return None;
    }
    Some((m as usize, n as usize))
}

fn about(value: f64) -> String {
    if value < 1e6 { format!("{value:.1}") } else { format!("{value:.1e}") }
}

/// Elevation of the tool, rad.
fn read_bend(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<f64> {
    let bend = t.number("bend_deg", Must::BeFinite, lib)?;
    if bend.abs() > 90.0 {
        let message = format!("`bend_deg` must be from -90 to 90, not {}", plain(bend));
        let help = "-90 is the tool pointing down, 0 horizontal, 90 up";
        lib.error(t.get("bend_deg")?.at, message, help);
    }
    Some(units::rad_from_deg(bend))
}
