//! Operations of a cell: on which surface, where on it, which way the tool points.

use super::{attitude, place, teach, tool};
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::{Table, read_named};
use crate::files::toml::tree::{Entry, Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;
use std::collections::HashMap;

/// Most nodes of one grid: a map of more is no picture, and takes hours and gigabytes.
pub const MAX_NODES: u64 = 1_000_000;

const PICKED: &str = "name the operation in which the part was picked";

/// What `map --json` takes a node, s and bytes: measured with a quarter of a million nodes on hitachi_cell.
const NODE_COST: (f64, f64) = (1.2e-4, 1600.0);

/// Reads every `[operation.NAME]`.
pub fn read_all(
    t: &mut Table<'_>,
    equipment: &[Equipment],
    senses: &[Sense],
    lib: &mut Library<'_>,
) -> Vec<Operation> {
    let help = "add [operation.NAME] with on, grid, bend_deg and sense";
    let operations = t.need("operation", help);
    if let Some(node) = operations
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        lib.error(node.at, "no operation".into(), help);
    }
    let standing = ["equipment", "obstacle"].map(|key| t.get(key));
    let named = t.get("sense");
    let is_table = |node: &&Node| matches!(node.value, Value::Table(_));
    let complete = !t.partial && standing.iter().chain([&named]).flatten().all(is_table);
    let around = Around {
        complete,
        equipment,
        entries: standing.into_iter().flatten().flat_map(|node| node.value.entries()).collect(),
        senses: senses.iter().map(|sense| (sense.name.as_str(), sense)).collect(),
        sense_names: names(named),
        sense_entries: entries_of(named),
        operation_names: names(operations),
        operations: entries_of(operations),
    };
    read_named(t, "operation", lib, |name, node, lib| read(name, node, &around, lib))
}

/// What an operation may name.
struct Around<'c> {
    /// Whether nothing was lost with a file.
    complete: bool,
    /// Equipment and senses that could be read.
    equipment: &'c [Equipment],
    senses: HashMap<&'c str, &'c Sense>,
    /// What is named: what stands, equipment first; senses; operations.
    entries: Vec<&'c Entry>,
    sense_names: Places<'c>,
    sense_entries: &'c [Entry],
    operation_names: Places<'c>,
    operations: &'c [Entry],
}

/// Places of entries by their names.
type Places<'c> = HashMap<&'c str, usize>;

fn entries_of(node: Option<&Node>) -> &[Entry] {
    node.map_or(&[], |node| node.value.entries())
}

fn names(node: Option<&Node>) -> Places<'_> {
    entries_of(node).iter().enumerate().map(|(k, (name, ..))| (name.as_str(), k)).collect()
}

fn read(name: &str, node: &Node, around: &Around<'_>, lib: &mut Library<'_>) -> Option<Operation> {
    Table::read(node, "an operation", lib, |t, lib| {
        let on = read_surface_choice(t, around, lib);
        let place = place::read(t, on.and_then(|k| around.surface(k)), lib);
        let standoff = t.number_or("standoff_mm", 0.0, Must::NotBeNegative, lib);
        let attitude = attitude::read(t, lib);
        let sense = read_sense(t, around, lib);
        let limit = read_limit(t, sense.as_ref(), lib);
        let relative_to = match t.get("relative_to") {
            Some(node) => read_relative(name, node, around, lib).map(Some),
            None => Some(None),
        };
        let teach = match t.get("teach_mm") {
            Some(node) => teach::read(node, on.and_then(|k| around.surface(k)), lib).map(Some),
            None => Some(None),
        };
        let approach = t.number_or("approach_mm", 0.0, Must::NotBeNegative, lib).map(units::m_from_mm);
        let retract = t.number_or("retract_mm", 0.0, Must::NotBeNegative, lib).map(units::m_from_mm);
        let weight = t.number_or("weight", 1.0, Must::BePositive, lib);
        let held = match t.get("held") {
            Some(node) => tool::read_held(node, lib),
            None => Some(Held::default()),
        };
        let ((place, over), (attitude, angles)) = (place?, attitude?);
        Some(Operation {
            name: name.to_string(),
            equipment: on?,
            place,
            over,
            standoff: units::m_from_mm(standoff?),
            attitude,
            angles,
            sense: sense?,
            limit: limit?,
            relative_to: relative_to?,
            teach: teach?,
            weight: weight?,
            held: held?,
            approach: approach?,
            retract: retract?,
        })
    })
}

impl Around<'_> {
    /// The surface of what stands at a place of `entries`, if it could be read.
    fn surface(&self, k: usize) -> Option<Rectangle> {
        let (name, ..) = self.entries.get(k)?;
        self.equipment.iter().find(|e| e.name == *name)?.surface
    }
}

/// `on = "NAME"`: something with a work surface, by the names in the cell.
fn read_surface_choice(t: &mut Table<'_>, around: &Around<'_>, lib: &mut Library<'_>) -> Option<usize> {
    let node = t.need("on", "add on = \"NAME\" of an equipment with a work surface")?;
    let name = value::text(node, "on", lib)?;
    let has_surface = |part: &Node| part.value.get("surface").is_some();
    let Some(index) = around.entries.iter().position(|(n, ..)| *n == name) else {
        let fitting = || around.entries.iter().filter(|e| has_surface(&e.2)).map(|e| e.0.as_str());
        let help = match did_you_mean(&name, fitting()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("equipment with a work surface: {}", listed(fitting())),
        };
        if around.complete {
            lib.error(node.at, format!("there is no equipment `{}`", shown(&name)), help);
        }
        return None;
    };
    if around.equipment.iter().any(|e| e.name == name) && !has_surface(&around.entries[index].2) {
        let message = format!("`{}` has no work surface", shown(&name));
        lib.error(node.at, message, "add to it for example surface = { size_mm = [1500, 700] }");
    }
    Some(index)
}

/// `sense = "WORD"`: a plain one or one of the cell.
fn read_sense(t: &mut Table<'_>, around: &Around<'_>, lib: &mut Library<'_>) -> Option<Sense> {
    let node = t.need("sense", format!("add sense = \"xy\", or another of {}", listed(PLAIN)))?;
    let word = value::text(node, "sense", lib)?;
    if let Some(plain) = Sense::plain(&word) {
        return Some(plain);
    }
    let defined = || around.sense_entries.iter().map(|(name, ..)| name.as_str());
    if !around.sense_names.contains_key(word.as_str()) && around.complete {
        let frames = Frame::ALL.map(Frame::name);
        let framed: Vec<_> = PLAIN.iter().flat_map(|p| frames.map(|f| format!("{p}@{f}"))).collect();
        let known = || PLAIN.into_iter().chain(defined());
        let candidates = framed.iter().map(String::as_str).chain(known());
        let help = match did_you_mean(&word, candidates) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("known: {}", listed(known())),
        };
        lib.error(node.at, format!("`sense` cannot be \"{}\"", shown(&word)), help);
    }
    around.senses.get(word.as_str()).map(|sense| (*sense).clone())
}

/// `limit_mm` or `limit_deg`, whichever the sense is measured in.
fn read_limit(t: &mut Table<'_>, sense: Option<&Sense>, lib: &mut Library<'_>) -> Option<Option<f64>> {
    let mut limit = Some(None);
    let lengths: (_, _, fn(f64) -> f64) = ("limit_mm", Unit::Length, units::m_from_mm);
    for (key, unit, si) in [lengths, ("limit_deg", Unit::Angle, units::rad_from_deg)] {
        let Some(node) = t.get(key) else { continue };
        // A flag speaks of every operation at once: a limit in the other unit does not apply to this one.
        let by_flag = lib.is_flag(node.at) || t.get("sense").is_some_and(|sense| lib.is_flag(sense.at));
        if by_flag && sense.is_some_and(|sense| sense.unit != unit) {
            continue;
        }
        let value = value::number(node, &format!("`{key}`"), Must::BePositive, lib);
        if let Some(sense) = sense.filter(|sense| sense.unit != unit) {
            let word = sense.unit.word();
            let message = format!("`{key}` is no limit of the sense `{}`, which is in {word}", sense.name);
            lib.error(node.at, message, format!("write limit_{word}, or choose another sense"));
        } else {
            limit = value.map(|value| Some(si(value)));
        }
    }
    limit
}

/// `relative_to = "NAME"`: an operation before this one, itself relative to none.
fn read_relative(name: &str, node: &Node, around: &Around<'_>, lib: &mut Library<'_>) -> Option<usize> {
    let other = value::text(node, "relative_to", lib)?;
    let place = |wanted: &str| around.operation_names.get(wanted).copied();
    let found = place(&other);
    let (message, help) = match found {
        _ if other == name => ("an operation is not relative to itself".to_string(), PICKED.to_string()),
        None => {
            let others = || around.operations.iter().map(|(n, ..)| n.as_str()).filter(|n| *n != name);
            let help = match did_you_mean(&other, others()) {
                Some(near) => format!("did you mean \"{}\"?", shown(near)),
                None => format!("the cell has besides this: {}", listed(others())),
            };
            (format!("there is no operation `{}`", shown(&other)), help)
        }
        Some(k) if Some(k) > place(name) => {
            let message = format!("`{}` comes after what is relative to it", shown(&other));
            (message, format!("write [operation.{}] above [operation.{}]", shown(&other), shown(name)))
        }
        Some(k) if around.operations[k].2.value.get("relative_to").is_some() => {
            let message = format!("`{}` is itself relative to an operation", shown(&other));
            (message, PICKED.to_string())
        }
        Some(k) if is_everywhere(&around.operations[k].2) => {
            let message = format!("`{}` happens at every one of its nodes", shown(&other));
            (message, "name an operation with one spot: over = \"best\"".to_string())
        }
        Some(k) => return Some(k),
    };
    if found.is_some() || around.complete {
        lib.error(node.at, message, help);
    }
    None
}

/// Whether an operation happens at every node.
fn is_everywhere(node: &Node) -> bool {
    match node.value.get("over").map(|over| &over.value) {
        Some(Value::Text(word)) => word != "best",
        _ => node.value.get("points_mm").is_some(),
    }
}

/// `grid = [m, n]`: divisions along x and y, (m + 1)(n + 1) nodes.
pub fn read_grid(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<(usize, usize)> {
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
