//! Reader of the operations of a cell: surface, place on it, tool attitude, sense and limit.

use super::{attitude, place, teach, tool};
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::cell::cell;
use crate::files::keys::equipment::obstacle;
use crate::files::keys::operation::operation;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Entry, Node, Value};
use std::collections::HashMap;

const PICKED: &str = "name the operation in which the part was picked";

/// Reads every `[operation.NAME]`.
pub fn read_all(t: &mut Table, equipment: &[Equipment], senses: &[Sense]) -> Vec<Operation> {
    let operations = t.get(&cell::OPERATION);
    if let Some(node) = operations
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        t.error(node.at, "the cell has no operation", cell::OPERATION.remedy);
    }
    let standing = [cell::EQUIPMENT, cell::OBSTACLE].map(|key| t.get(&key));
    let named = t.get(&cell::SENSE);
    let is_table = |node: &&Node| matches!(node.value, Value::Table(_));
    let complete = !t.partial && standing.iter().chain([&named]).flatten().all(is_table);
    let around = References {
        complete,
        equipment,
        entries: standing
            .into_iter()
            .flatten()
            .flat_map(|node| node.value.entries())
            .filter(has_own_body)
            .collect(),
        senses: senses.iter().map(|sense| (sense.name.as_str(), sense)).collect(),
        sense_names: names(named),
        sense_entries: entries_of(named),
        operation_names: names(operations),
        operations: entries_of(operations),
    };
    t.named(&cell::OPERATION, |name, t| read(name, t, &around))
}

/// Parts of the cell that an operation may name.
struct References<'c> {
    /// Whether every table could be read. If not, unknown names are not reported as faults.
    complete: bool,
    /// Equipment that could be read.
    equipment: &'c [Equipment],
    /// Senses that could be read, by name.
    senses: HashMap<&'c str, &'c Sense>,
    /// Entries of equipment, then of obstacles without floor plans, in the order of [`Self::equipment`].
    entries: Vec<&'c Entry>,
    sense_names: Places<'c>,
    sense_entries: &'c [Entry],
    operation_names: Places<'c>,
    operations: &'c [Entry],
}

/// Returns whether an entry is one obstacle or piece of equipment, not a floor plan with several obstacles.
fn has_own_body((_, _, node): &&Entry) -> bool {
    node.value.get(obstacle::PLAN.name).is_none()
}

/// Indices of entries by their names.
type Places<'c> = HashMap<&'c str, usize>;

fn entries_of(node: Option<&Node>) -> &[Entry] {
    node.map_or(&[], |node| node.value.entries())
}

fn names(node: Option<&Node>) -> Places<'_> {
    entries_of(node).iter().enumerate().map(|(k, (name, ..))| (name.as_str(), k)).collect()
}

fn read(name: &str, t: &mut Table, around: &References<'_>) -> Option<Operation> {
    let on = read_surface_choice(t, around);
    let surface = on.and_then(|k| around.surface(k));
    let place = place::read(t, surface);
    let standoff = t.number(&operation::STANDOFF);
    let attitude = attitude::read(t);
    let sense = read_sense(t, around);
    let limit = read_limit(t, sense.as_ref());
    let relative_to = t.if_given(&operation::RELATIVE_TO, |t, _| read_relative(name, t, around));
    let teach = t.if_given(&operation::TEACH, |t, _| teach::read(t, surface));
    let (approach, retract) = (t.number(&operation::APPROACH), t.number(&operation::RETRACT));
    let dwell = t.number(&operation::DWELL);
    let line_speed = t.if_given(&operation::LINE_SPEED, Table::number);
    let weight = t.number(&operation::WEIGHT);
    let held = t.table_or(&operation::HELD, HeldPart::default(), tool::read_held);
    let ((place, over), (attitude, angles)) = (place?, attitude?);
    Some(Operation {
        name: name.to_string(),
        equipment: on?,
        place,
        over,
        standoff: standoff?,
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
        dwell: dwell?,
        line_speed: line_speed?,
    })
}

impl References<'_> {
    /// Returns the work surface of entry `k` of [`Self::entries`], if it could be read.
    fn surface(&self, k: usize) -> Option<Rectangle> {
        let (name, ..) = self.entries.get(k)?;
        self.equipment.iter().find(|e| e.name == *name)?.surface
    }
}

/// Reads `on = "NAME"`; returns the index of that equipment or obstacle, which must have a work surface.
fn read_surface_choice(t: &mut Table, around: &References<'_>) -> Option<usize> {
    let node = t.get(&operation::ON)?;
    let name = t.text(&operation::ON)?;
    let has_surface = |part: &Node| part.value.get("surface").is_some();
    let Some(index) = around.entries.iter().position(|(n, ..)| *n == name) else {
        let fitting = || around.entries.iter().filter(|e| has_surface(&e.2)).map(|e| e.0.as_str());
        let help = match did_you_mean(&name, fitting()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("equipment with a work surface: {}", listed(fitting())),
        };
        if around.complete {
            t.error(node.at, format!("there is no equipment `{}`", shown(&name)), help);
        }
        return None;
    };
    if around.equipment.iter().any(|e| e.name == name) && !has_surface(&around.entries[index].2) {
        let message = format!("`{}` has no work surface", shown(&name));
        t.error(node.at, message, "add a surface, for example surface = { size_mm = [1500, 700] }");
    }
    Some(index)
}

/// Reads `sense = "WORD"`: a built-in sense, or a sense that the cell defines.
fn read_sense(t: &mut Table, around: &References<'_>) -> Option<Sense> {
    let node = t.get(&operation::SENSE)?;
    let word = t.text(&operation::SENSE)?;
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
        t.error(node.at, format!("`sense` cannot be \"{}\"", shown(&word)), help);
    }
    around.senses.get(word.as_str()).map(|sense| (*sense).clone())
}

/// Reads `limit_mm` or `limit_deg`, depending on the unit of the sense; returns Some(None) if there is no
/// limit.
fn read_limit(t: &mut Table, sense: Option<&Sense>) -> Option<Option<f64>> {
    let mut limit = Some(None);
    for (key, unit) in [(operation::LIMIT_MM, Unit::Length), (operation::LIMIT_DEG, Unit::Angle)] {
        let Some(node) = t.get(&key) else { continue };
        // A flag sets the limit of every operation. An operation whose sense has the other unit ignores this
        // limit.
        let sense_node = t.get(&operation::SENSE);
        let by_flag = t.lib.is_flag(node.at) || sense_node.is_some_and(|sense| t.lib.is_flag(sense.at));
        if by_flag && sense.is_some_and(|sense| sense.unit != unit) {
            continue;
        }
        let value = t.number(&key);
        if let Some(sense) = sense.filter(|sense| sense.unit != unit) {
            let word = sense.unit.word();
            let name = key.name;
            let message =
                format!("`{name}` does not fit the sense `{}`, which is measured in {word}", sense.name);
            t.error(node.at, message, format!("write limit_{word}, or choose another sense"));
        } else {
            limit = value.map(Some);
        }
    }
    limit
}

/// Reads `relative_to = "NAME"`; returns the index of the named operation.
///
/// The named operation must precede the operation that is being read. The named operation must also have a
/// single spot, and must not be relative to another operation.
fn read_relative(name: &str, t: &mut Table, around: &References<'_>) -> Option<usize> {
    let node = t.get(&operation::RELATIVE_TO)?;
    let other = t.text(&operation::RELATIVE_TO)?;
    let place = |wanted: &str| around.operation_names.get(wanted).copied();
    let found = place(&other);
    let (message, help) = match found {
        _ if other == name => ("an operation cannot be relative to itself".to_string(), PICKED.to_string()),
        None => {
            let others = || around.operations.iter().map(|(n, ..)| n.as_str()).filter(|n| *n != name);
            let help = match did_you_mean(&other, others()) {
                Some(near) => format!("did you mean \"{}\"?", shown(near)),
                None => format!("the other operations are: {}", listed(others())),
            };
            (format!("there is no operation `{}`", shown(&other)), help)
        }
        Some(k) if Some(k) > place(name) => {
            let message =
                format!("`{}` must come before the operation that is relative to it", shown(&other));
            (message, format!("write [operation.{}] above [operation.{}]", shown(&other), shown(name)))
        }
        Some(k) if around.operations[k].2.value.get("relative_to").is_some() => {
            let message = format!("`{}` is itself relative to an operation", shown(&other));
            (message, PICKED.to_string())
        }
        Some(k) if is_everywhere(&around.operations[k].2) => {
            let message = format!(
                "`relative_to` needs an operation with one spot, but `{}` happens at all its nodes",
                shown(&other)
            );
            (message, "name an operation with one spot, for example with over = \"best\"".to_string())
        }
        Some(k) => return Some(k),
    };
    if found.is_some() || around.complete {
        t.error(node.at, message, help);
    }
    None
}

/// Returns whether an operation happens at every node.
fn is_everywhere(node: &Node) -> bool {
    match node.value.get("over").map(|over| &over.value) {
        Some(Value::Text(word)) => word != "best",
        _ => node.value.get("points_mm").is_some(),
    }
}
