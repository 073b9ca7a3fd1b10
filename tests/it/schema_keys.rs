//! Tests that every key of the tables is read, and that the schema and the reference page describe every key.

use crate::common::{document, root};
use crate::schema::{read, shipped, toml_of};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use sweetspot::files::{FileKind, reference, schema};

/// Description of a table of keys, and one of its keys.
pub type TableKey = (String, String);

/// Returns the tables of a schema, including tables in lists and tables that are one of several forms of a
/// value.
fn inside(schema: &Value) -> Vec<&Value> {
    let ways = schema["anyOf"].as_array().into_iter().flatten();
    [schema].into_iter().chain(schema.get("items")).chain(ways).collect()
}

fn key_of(table: &Value, key: &str) -> TableKey {
    // An entry of the tables of keys has the same schema in every table.
    (table["properties"][key].to_string(), key.to_string())
}

/// Adds every key of every table of a schema to `all`.
pub fn keys_of(schema: &Value, all: &mut BTreeSet<TableKey>) {
    for table in inside(schema) {
        for (key, below) in table["properties"].as_object().into_iter().flatten() {
            all.insert(key_of(table, key));
            keys_of(below, all);
        }
        table.get("additionalProperties").into_iter().for_each(|named| keys_of(named, all));
        if let Some(items) = table.get("items") {
            keys_of(items, all);
        }
    }
}

/// Adds the pointers to all keys of a document to `all`, each with its table of the schema.
pub fn pointers(value: &Value, schemas: Vec<&Value>, path: &str, all: &mut Vec<(String, TableKey)>) {
    let tables: Vec<&Value> = schemas.into_iter().flat_map(inside).flat_map(inside).collect();
    match value {
        Value::Object(entries) => {
            for (name, below) in entries {
                let path = format!("{path}/{}", name.replace('~', "~0").replace('/', "~1"));
                for table in tables.iter().filter(|table| table["properties"].get(name).is_some()) {
                    all.push((path.clone(), key_of(table, name)));
                }
                let keys = tables.iter().filter_map(|table| table["properties"].get(name));
                let named = tables.iter().filter_map(|table| table.get("additionalProperties"));
                pointers(below, keys.chain(named).collect(), &path, all);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                let within = tables.iter().filter_map(|table| table.get("items")).collect();
                pointers(item, within, &format!("{path}/{i}"), all);
            }
        }
        _ => {}
    }
}

/// A key that no reader reads would accept any value. No key accepts a date.
#[test]
fn every_key_of_the_tables_is_read() {
    let mut unread = BTreeSet::new();
    FileKind::ALL.into_iter().for_each(|kind| keys_of(&schema(kind), &mut unread));
    let count = unread.len();
    assert!(count > 180, "{count} keys");
    let data = ["every_key.toml", "every_other_key.toml", "every_rate_key.toml"].map(|name| {
        let text = std::fs::read_to_string(root().join("tests/data").join(name)).unwrap();
        (format!("cells/{name}"), text, "cell".to_string())
    });
    for (path, text, kind) in data.into_iter().chain(shipped()) {
        let document = document(&text).unwrap();
        let kind_of_file = FileKind::ALL.into_iter().find(|k| k.name() == kind).unwrap();
        let schema = schema(kind_of_file);
        let mut all = Vec::new();
        pointers(&document, vec![&schema], "", &mut all);
        for (pointer, key) in all {
            if !unread.contains(&key) {
                continue;
            }
            let mut changed = document.clone();
            *changed.pointer_mut(&pointer).unwrap() = json!("DATE");
            let toml = toml_of(&changed).replace("\"DATE\"", "1979-05-27");
            let faults = read(&kind, &path, &toml).err().unwrap_or_default();
            let is_refused = faults.iter().any(|fault| fault.message.contains("not a date"));
            assert!(is_refused, "{path} accepts a date at {pointer}: {faults:#?}");
            unread.remove(&key);
        }
    }
    assert!(unread.is_empty(), "no file has these keys: {unread:#?}");
}

/// Returns the keys at the top of a schema, or of a table in it.
fn keys_at(schema: &Value, path: &[&str]) -> BTreeSet<String> {
    let at = path.iter().fold(schema, |at, name| &at[*name]);
    at["properties"].as_object().unwrap().keys().cloned().collect()
}

#[test]
fn a_part_has_the_same_keys_in_its_file_as_in_a_cell() {
    let cell = schema(FileKind::Cell);
    let parts: [(_, &[&str], &[&str]); 3] = [
        (FileKind::Robot, &["properties", "robot"], &["base", "base_tolerance", "pedestal"]),
        (FileKind::Tool, &["properties", "robot", "properties", "tool"], &[]),
        (FileKind::Equipment, &["properties", "equipment", "additionalProperties"], &[]),
    ];
    for (kind, path, of_cell) in parts {
        let mut inside = keys_at(&cell, path);
        of_cell.iter().for_each(|key| assert!(inside.remove(*key)));
        assert_eq!(keys_at(&schema(kind), &[]), inside, "{}", kind.name());
    }
}

/// Every key has a description in one sentence, and a type or a choice of types.
#[test]
fn every_key_is_described_in_the_schema() {
    fn look(schema: &Value, path: &str, count: &mut usize) {
        for (key, below) in schema["properties"].as_object().into_iter().flatten() {
            let path = format!("{path}/{key}");
            let says = below["description"].as_str().unwrap_or_else(|| panic!("{path} is not described"));
            assert!(says.ends_with('.') && says.len() < 300, "{path}: {says}");
            assert!(below.get("type").or(below.get("anyOf")).is_some(), "{path} has no type");
            let unit = [("_mm", "mm"), ("_deg", "degree")].into_iter().find(|(end, _)| key.ends_with(end));
            assert!(
                unit.is_none_or(|(_, unit)| says.contains(unit) || below["type"] == "object"),
                "{path}: {says}"
            );
            *count += 1;
            look(below, &path, count);
        }
        for below in [schema.get("items"), schema.get("additionalProperties")].into_iter().flatten() {
            look(below, &format!("{path}/*"), count);
        }
        schema["anyOf"].as_array().into_iter().flatten().for_each(|way| look(way, path, count));
    }
    let mut count = 0;
    FileKind::ALL.into_iter().for_each(|kind| look(&schema(kind), kind.name(), &mut count));
    assert!(count > 500, "{count} keys");
}

/// The reference has a row for every key of the schema, with its values, its meaning and a TOML example.
#[test]
fn the_reference_has_every_key_of_the_schema() {
    for kind in FileKind::ALL {
        let reference = reference(kind);
        let rows: Vec<Vec<&str>> = reference
            .lines()
            .filter(|line| line.starts_with("| `"))
            .map(|line| line.trim_matches(['|', ' ']).split(" | ").collect())
            .collect();
        for row in &rows {
            let [key, value, default, meaning, example] = row[..] else { panic!("{row:?}") };
            assert!(!value.is_empty() && !default.is_empty() && meaning.ends_with('.'), "{row:?}");
            assert!(example.starts_with(&format!("`{} = ", key.trim_matches('`'))), "{row:?}");
        }
        let mut keys = BTreeSet::new();
        keys_of(&schema(kind), &mut keys);
        let described = |name: &str| rows.iter().filter(|row| row[0] == format!("`{name}`")).count();
        let names: BTreeSet<&str> = keys.iter().map(|(_, name)| name.as_str()).collect();
        // The keys of a range { min, max, start } are described together with the range.
        let ranges = ["min", "max", "start"];
        for name in names.into_iter().filter(|name| !ranges.contains(name)) {
            assert!(described(name) > 0, "{}: no row for `{name}`", kind.name());
        }
        assert!(rows.len() > 20, "{}: {} rows", kind.name(), rows.len());
    }
}
