//! JSON Schema of the files.
//!
//! The schemas use draft 7. Draft 7 is the oldest draft with `if`. The schemas of joints and of files with
//! `from` use `if`. Draft 7 is also the newest draft that TOML editors support fully. There is no `$ref`, so
//! that every key shows its description.
//!
//! Only the reader decides whether a file is valid. A schema sees a single file: it knows keys, types, ranges
//! and words. A schema knows neither the keys that another file contributes nor what a name refers to.

use super::FileKind;
use super::merging::{WHOLE, add_rule, separated, unless};
use crate::files::keys::key::{
    Key, KeyTable, KeyUnit, LARGEST, MAX_NAME, MAX_VALUES, Need, NumberRange, Rule, SMALLEST, UNBOUNDED,
    ValueKind,
};
use crate::files::keys::parts::range;
use crate::files::toml::tree::{Value as Toml, parse};
use serde_json::{Map, Value, json};

/// Characters that [`crate::files::shown`] escapes, as ranges in a regular expression.
///
/// The Unicode tag characters beyond U+FFFF are left out, because not every validator can express them.
const HIDDEN: &str = "\\u0000-\\u001f\\u007f-\\u009f\\u00ad\\u061c\\u180e\\u200b-\\u200f\\u2028-\\u202e\\u2060-\\u206f\\ufeff\\ufff9-\\ufffb";

/// Returns the JSON Schema (draft 7) of a kind of file.
pub fn schema(kind: FileKind) -> Value {
    let mut table = of_table(kind.keys());
    let mut required = vec![json!("schema"), json!("units")];
    if kind == FileKind::Equipment {
        // The cell may state the placement and the other required keys.
        table[WHOLE] = json!([]);
    } else {
        required.extend(table["required"].as_array().cloned().unwrap_or_default());
    }
    table["required"] = json!(required);
    let whole = separated(&mut table, true);
    let head = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": format!("sweetspot {} file", kind.name()),
    });
    let mut schema = with(head, table);
    if let (Some(whole), Value::Object(keys)) = (whole, &mut schema) {
        add_rule(keys, whole);
    }
    schema
}

/// Merges the second schema into the first. Keys of the second schema replace equal keys of the first. If
/// both values are objects, they are merged.
fn with(mut schema: Value, more: Value) -> Value {
    if let (Value::Object(keys), Value::Object(more)) = (&mut schema, more) {
        for (key, value) in more {
            let merged = match keys.get_mut(&key).map(Value::take) {
                Some(old @ Value::Object(_)) => with(old, value),
                _ => value,
            };
            keys.insert(key, merged);
        }
    }
    schema
}

/// Returns the schema of a table. The schema allows only the keys of the table.
fn of_table(table: &'static KeyTable) -> Value {
    let keys: Map<_, _> = table.keys().map(|key| (key.name.to_string(), of_key(key))).collect();
    let mut schema = json!({
        "description": table.help, "type": "object", "properties": keys, "additionalProperties": false,
    });
    let required = names(table, |need| matches!(need, Need::Required));
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    let mut whole = Vec::new();
    let mut others: Vec<_> = table.keys().filter_map(|key| other_key(key.need)).collect();
    others.dedup();
    for other in others {
        let needed = names(table, |need| other_key(need) == Some(other));
        whole.push(unless(other, json!({ "required": needed })));
    }
    for rule in table.rules_of_keys() {
        let (for_whole, always) = of_rule(rule, table);
        whole.extend(for_whole);
        if let Value::Object(keys) = &mut schema {
            always.into_iter().for_each(|rule| add_rule(keys, rule));
        }
    }
    if !whole.is_empty() {
        schema[WHOLE] = json!(whole);
    }
    schema
}

/// Returns the other key that [`Need::Unless`] names: if the other key is missing, this key is required.
/// Returns None for every other `need`.
fn other_key(need: Need) -> Option<&'static str> {
    if let Need::Unless(other) = need { Some(other) } else { None }
}

fn names(table: &'static KeyTable, which: impl Fn(Need) -> bool) -> Vec<&'static str> {
    table.keys().filter(|key| which(key.need)).map(|key| key.name).collect()
}

/// Returns the schema of a key, with its help, default and example.
fn of_key(key: &Key) -> Value {
    let help = match key.unit() {
        KeyUnit::None => key.help.to_string(),
        unit => format!("{} Unit: {}.", key.help, unit.name()),
    };
    let mut schema = with(json!({ "description": help }), of_kind(&key.kind));
    schema["description"] = json!(help);
    if let Need::Default(value) = key.need {
        schema["default"] = value.json();
    }
    if let Some(example) = example(key) {
        schema["examples"] = json!([example]);
    }
    schema
}

/// Returns the example of a key as JSON; None if the key states no example.
fn example(key: &Key) -> Option<Value> {
    let entries = parse(0, &format!("example = {}", key.example)).ok()?;
    entries.first().and_then(|(.., node)| of_toml(&node.value))
}

fn of_toml(value: &Toml) -> Option<Value> {
    Some(match value {
        Toml::Text(text) => json!(text),
        Toml::Integer(whole) => json!(i64::try_from(*whole).ok()?),
        Toml::Float(number) => json!(number),
        Toml::Boolean(given) => json!(given),
        Toml::Array(items) => {
            Value::Array(items.iter().map(|item| of_toml(&item.value)).collect::<Option<_>>()?)
        }
        Toml::Table(entries) => {
            let entries = entries.iter().map(|(key, _, node)| Some((key.clone(), of_toml(&node.value)?)));
            Value::Object(entries.collect::<Option<_>>()?)
        }
        Toml::Datetime | Toml::Unread => return None,
    })
}

fn of_kind(kind: &ValueKind) -> Value {
    match kind {
        ValueKind::Number(range) => of_number(*range),
        ValueKind::Whole(least, u64::MAX) => json!({ "type": "integer", "minimum": least }),
        ValueKind::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        ValueKind::Boolean => json!({ "type": "boolean" }),
        ValueKind::Text => json!({ "type": "string" }),
        ValueKind::Name => with(json!({ "type": "string" }), printable()),
        ValueKind::Path => json!({ "type": "string", "pattern": "^[^/\\\\:]([^\\\\:]*[^/\\\\:])?$" }),
        ValueKind::Word(words) => json!({ "type": "string", "enum": words() }),
        ValueKind::Exactly(word) => json!({ "type": "string", "enum": [word] }),
        ValueKind::Coordinate(low, high) => json!({ "anyOf": of_coordinate(*low, *high) }),
        ValueKind::Table(table) => of_table(table),
        ValueKind::Named(kind, least) => {
            let named = json!({
                "type": "object", "additionalProperties": of_kind(kind), "propertyNames": printable(),
            });
            if *least > 0 { with(named, json!({ "minProperties": least })) } else { named }
        }
        ValueKind::List(kind, (least, most), _) => {
            let list = json!({ "type": "array", "items": of_kind(kind), "minItems": least });
            if *most == UNBOUNDED { list } else { with(list, json!({ "maxItems": most })) }
        }
        ValueKind::Either(kinds) => {
            let mut ways = Vec::new();
            for kind in *kinds {
                match of_kind(kind) {
                    Value::Object(mut way) if way.len() == 1 && way.contains_key("anyOf") => {
                        ways.extend(way["anyOf"].as_array_mut().into_iter().flatten().map(Value::take));
                    }
                    way => ways.push(way),
                }
            }
            json!({ "anyOf": ways })
        }
        ValueKind::Checked(kind, more) => with(of_kind(kind), more()),
    }
}

fn of_number(range: NumberRange) -> Value {
    let (least, most) = match range {
        NumberRange::Finite => (-LARGEST, LARGEST),
        NumberRange::Positive => (SMALLEST, LARGEST),
        NumberRange::NotNegative | NumberRange::PlusMinus | NumberRange::Below(_) => (0.0, LARGEST),
        NumberRange::UpTo(most) => (0.0, most),
    };
    let mut schema = json!({ "type": "number", "minimum": least, "maximum": most });
    if let NumberRange::Below(end) = range {
        schema["exclusiveMaximum"] = json!(end);
    }
    schema
}

/// Returns the schemas of a coordinate, which may be a fixed number, a range or a list of allowed values.
fn of_coordinate(low: f64, high: f64) -> [Value; 3] {
    let number = json!({ "type": "number", "minimum": low, "maximum": high });
    let mut table = of_table(&range::TABLE);
    for (_, key) in table["properties"].as_object_mut().into_iter().flatten() {
        *key = with(key.take(), number.clone());
    }
    let values = json!({
        "description": "Allowed values; the start layout uses the first value.",
        "type": "array", "items": number, "minItems": 1, "maxItems": MAX_VALUES, "uniqueItems": true,
    });
    [with(json!({ "description": "Fixed value." }), number), table, values]
}

/// Returns the schema of a name: short, printable, not blank.
fn printable() -> Value {
    let pattern = format!("^[^\\s{HIDDEN}]([^{HIDDEN}]*[^\\s{HIDDEN}])?$");
    json!({ "minLength": 1, "maxLength": MAX_NAME, "pattern": pattern })
}

/// Returns the schemas of a rule. The optional schema applies only to tables that take no keys from another
/// file. The schemas in the list apply to all tables.
fn of_rule(rule: &Rule, table: &'static KeyTable) -> (Option<Value>, Vec<Value>) {
    match rule {
        Rule::AnyOf(keys) => {
            let ways: Vec<_> = keys.iter().map(|key| json!({ "required": [key] })).collect();
            (Some(json!({ "anyOf": ways })), Vec::new())
        }
        Rule::OneAtMost(keys) => {
            let two = |i: usize, j: usize| json!({ "not": { "required": [keys[i], keys[j]] } });
            let pairs = (0..keys.len()).flat_map(|i| (i + 1..keys.len()).map(move |j| (i, j)));
            (None, pairs.map(|(i, j)| two(i, j)).collect())
        }
        Rule::Excludes(key, others) => (None, vec![json!({ "dependencies": { *key: without(others) } })]),
        Rule::OnlyWith(key, others) => (Some(unless(key, without(others))), Vec::new()),
        Rule::Needs(key, other) => (Some(json!({ "dependencies": { *key: [other] } })), Vec::new()),
        Rule::When { key, words, needs, never } => {
            let mut then = without(never);
            if !needs.is_empty() {
                then["required"] = json!(needs);
            }
            let words = words();
            let mut rules = vec![when(key, &words, then.clone())];
            let default = table.key(key).map(|key| key.need);
            if let Some(Need::Default(value)) = default
                && words.iter().any(|word| value.json() == json!(word))
            {
                rules.push(unless(key, then));
            }
            (None, rules)
        }
        Rule::NotNegativeWhen(key, word) => {
            let then = json!({ "properties": not_negative(table) });
            (None, vec![when(key, &[word.to_string()], then)])
        }
    }
}

/// Returns a schema that applies `then` to tables in which a key has one of these words.
fn when(key: &str, words: &[String], then: Value) -> Value {
    json!({ "if": { "properties": { key: { "enum": words } }, "required": [key] }, "then": then })
}

/// Returns the schema of a table that has none of `keys`.
fn without(keys: &[&str]) -> Value {
    let none: Map<_, _> = keys.iter().map(|key| (key.to_string(), json!(false))).collect();
    json!({ "properties": none })
}

/// Returns the property schemas that forbid negative numbers in lists of numbers, including the lists in
/// nested tables. Returns None if the table has no such list.
fn not_negative(table: &'static KeyTable) -> Option<Value> {
    let list = json!({ "items": { "minimum": 0 } });
    let rules = table.keys().filter_map(|key| {
        let rule = match key.kind {
            ValueKind::List(ValueKind::Number(_), ..) => list.clone(),
            ValueKind::Table(inner) => not_negative(inner).map(|rules| json!({ "properties": rules }))?,
            ValueKind::List(ValueKind::Table(inner), ..) => {
                not_negative(inner).map(|rules| json!({ "items": { "properties": rules } }))?
            }
            _ => return None,
        };
        Some((key.name.to_string(), rule))
    });
    let rules: Map<_, _> = rules.collect();
    (!rules.is_empty()).then_some(Value::Object(rules))
}
