//! JSON Schema of the files: what editors and validators are told of their keys.
//!
//! Draft 7: the oldest that has `if`, which the keys of joints and of files with `from` need, and the
//! newest that editors of TOML read whole. There is no `$ref`, so that every key shows its description.
//!
//! The reader stays the judge. A schema sees one file and no name in it: it knows keys, types, ranges and
//! words, and neither what another file brings nor what a name refers to.

mod cell;
mod equipment;
mod errors;
mod operation;
mod parts;
mod robot;
mod solid;
mod tool;

use serde_json::{Map, Value, json};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    Cell,
    Robot,
    Equipment,
    Tool,
}

impl FileKind {
    pub const ALL: [Self; 4] = [Self::Cell, Self::Robot, Self::Equipment, Self::Tool];

    pub fn name(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Robot => "robot",
            Self::Equipment => "equipment",
            Self::Tool => "tool",
        }
    }
}

/// The JSON Schema (draft 7) of a kind of file.
pub fn schema(kind: FileKind) -> Value {
    let mut table = match kind {
        FileKind::Cell => cell::cell(),
        FileKind::Robot => robot::file(),
        FileKind::Equipment => equipment::file(),
        FileKind::Tool => tool::file(),
    };
    let whole = separated(&mut table, true);
    let head = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": format!("sweetspot {} file", kind.name()),
    });
    let mut schema = parts::with(head, table);
    if let Some(whole) = whole {
        parts::rule(&mut schema, whole);
    }
    schema
}

/// Takes out of a schema what must be there, where it need not be there: in a table that may lie over one
/// of another file. Returns it as a schema of its own, for the tables that lie over none.
///
/// Lists and ranges are replaced and never merged, so that what is in them is complete; `merges`: not so.
fn separated(schema: &mut Value, merges: bool) -> Option<Value> {
    let keys = schema.as_object_mut()?;
    let mut whole = Map::new();
    let mut needs = keys.remove(parts::WHOLE).and_then(|w| w.as_array().cloned()).unwrap_or_default();
    if merges {
        whole.extend(keys.remove("required").map(|required| ("required".to_string(), required)));
    } else {
        needs.into_iter().for_each(|need| parts::rule_of(keys, need));
        needs = Vec::new();
    }
    let mut inner = Map::new();
    for (key, below) in keys.get_mut("properties").and_then(Value::as_object_mut).into_iter().flatten() {
        inner.extend(separated(below, merges).map(|needed| (key.clone(), needed)));
    }
    if !inner.is_empty() {
        whole.insert("properties".into(), Value::Object(inner));
    }
    if let Some(needed) = keys.get_mut("additionalProperties").and_then(|named| separated(named, merges)) {
        whole.insert("additionalProperties".into(), needed);
    }
    for list in ["items", "anyOf"] {
        match keys.get_mut(list) {
            Some(Value::Array(ways)) => ways.iter_mut().for_each(|way| drop(separated(way, false))),
            Some(one) => drop(separated(one, false)),
            None => {}
        }
    }
    if !needs.is_empty() {
        whole.insert("allOf".into(), Value::Array(needs));
    }
    if whole.is_empty() {
        return None;
    }
    let has_from = keys.get("properties").is_some_and(|p| p.get("from").is_some());
    let whole = Value::Object(whole);
    Some(if has_from { parts::unless("from", whole) } else { whole })
}
