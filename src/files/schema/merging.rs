//! Schema rules for tables that take missing keys from another file.
//!
//! The key `from` names the other file.

use serde_json::{Map, Value, json};

/// Schema key of the rules for complete tables. A complete table takes no keys from another file.
///
/// This key is not a keyword of JSON Schema; [`separated`] removes it.
pub const WHOLE: &str = "whole";

/// Adds a rule to a schema, in its `allOf`.
pub fn add_rule(keys: &mut Map<String, Value>, rule: Value) {
    if let Value::Array(rules) = keys.entry("allOf").or_insert_with(|| json!([])) {
        rules.push(rule);
    }
}

/// Returns a schema that applies `then` to tables without this key.
pub fn unless(key: &str, then: Value) -> Value {
    json!({ "if": { "not": { "required": [key] } }, "then": then })
}

/// Moves the requirements of a schema into a separate schema and returns the separate schema. Returns None if
/// there are no requirements.
///
/// A table that takes keys from another file may lack required keys, because the other file may have them.
/// The returned schema applies only to tables that take no keys from another file.
///
/// `merges` states whether the tables of the schema can take keys from another file. The value is false for
/// items of lists and for ranges. A file replaces lists and ranges of another file as a whole. The schema
/// therefore keeps the requirements of items and ranges.
pub fn separated(schema: &mut Value, merges: bool) -> Option<Value> {
    let keys = schema.as_object_mut()?;
    let mut whole = Map::new();
    let mut needs = keys.remove(WHOLE).and_then(|w| w.as_array().cloned()).unwrap_or_default();
    if merges {
        whole.extend(keys.remove("required").map(|required| ("required".to_string(), required)));
    } else {
        needs.into_iter().for_each(|need| add_rule(keys, need));
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
    Some(if has_from { unless("from", whole) } else { whole })
}
