//! Pieces of schemas: numbers, texts, words, tables, coordinates.

use crate::files::toml::value::{LARGEST, LONGEST_NAME, Must, SMALLEST};
use serde_json::{Map, Value, json};

/// Of a table: what holds where no other file lies under it. No keyword of JSON Schema; taken out when all
/// is put together.
pub const WHOLE: &str = "whole";

/// What [`crate::files::shown`] escapes, but for the tags beyond U+FFFF, which not every validator can name.
const HIDDEN: &str = "\\u0000-\\u001f\\u007f-\\u009f\\u00ad\\u061c\\u180e\\u200b-\\u200f\\u2028-\\u202e\\u2060-\\u206f\\ufeff\\ufff9-\\ufffb";

/// The keys of the second laid over those of the first.
pub fn with(mut schema: Value, more: Value) -> Value {
    if let (Value::Object(keys), Value::Object(more)) = (&mut schema, more) {
        keys.extend(more);
    }
    schema
}

/// Adds what must hold besides.
pub fn rule(schema: &mut Value, rule: Value) {
    if let Value::Object(keys) = schema {
        rule_of(keys, rule);
    }
}

/// [`rule`], of the keys of a schema.
pub fn rule_of(keys: &mut Map<String, Value>, rule: Value) {
    if let Value::Array(rules) = keys.entry("allOf").or_insert_with(|| json!([])) {
        rules.push(rule);
    }
}

pub fn with_rules(mut schema: Value, rules: impl IntoIterator<Item = Value>) -> Value {
    rules.into_iter().for_each(|one| rule(&mut schema, one));
    schema
}

/// What holds of a table without this key.
pub fn unless(key: &str, then: Value) -> Value {
    json!({ "if": { "not": { "required": [key] } }, "then": then })
}

/// What holds of a table in which a key has one of these words.
pub fn when<S: AsRef<str>>(key: &str, words: &[S], then: Value) -> Value {
    let words: Vec<&str> = words.iter().map(S::as_ref).collect();
    json!({ "if": { "properties": { key: { "enum": words } }, "required": [key] }, "then": then })
}

/// A table that has none of these keys.
pub fn without(keys: &[&str]) -> Value {
    let none: Map<_, _> = keys.iter().map(|key| (key.to_string(), json!(false))).collect();
    json!({ "properties": none })
}

/// A table that has one of these keys, or more.
pub fn one_of(keys: &[&str]) -> Value {
    json!({ "anyOf": keys.iter().map(|key| json!({ "required": [key] })).collect::<Vec<_>>() })
}

/// No two of these keys.
pub fn not_two_of(keys: &[&str]) -> Vec<Value> {
    let two = |i: usize, j: usize| json!({ "not": { "required": [keys[i], keys[j]] } });
    (0..keys.len()).flat_map(|i| (i + 1..keys.len()).map(move |j| two(i, j))).collect()
}

/// A finite number of a believable size.
pub fn number(says: &str, must: Must) -> Value {
    with(json!({ "description": says, "type": "number" }), bounds(must))
}

fn bounds(must: Must) -> Value {
    match must {
        Must::BeFinite => json!({ "minimum": -LARGEST, "maximum": LARGEST }),
        Must::BePositive => json!({ "minimum": SMALLEST, "maximum": LARGEST }),
        Must::NotBeNegative | Must::BePlusMinus => json!({ "minimum": 0, "maximum": LARGEST }),
    }
}

/// A list of `min` to `max` numbers.
pub fn numbers(says: &str, (min, max): (usize, usize), must: Must) -> Value {
    let item = with(json!({ "type": "number" }), bounds(must));
    json!({ "description": says, "type": "array", "items": item, "minItems": min, "maxItems": max })
}

/// A whole number.
pub fn integer(says: &str, (min, max): (u64, u64)) -> Value {
    let schema = json!({ "description": says, "type": "integer", "minimum": min });
    // Beyond what every validator can hold there is no bound to tell.
    if max == u64::MAX { schema } else { with(schema, json!({ "maximum": max })) }
}

pub fn text(says: &str) -> Value {
    json!({ "description": says, "type": "string" })
}

pub fn boolean(says: &str, default: bool) -> Value {
    json!({ "description": says, "type": "boolean", "default": default })
}

/// One of a closed set of words.
pub fn word(says: &str, words: &[&str]) -> Value {
    json!({ "description": says, "type": "string", "enum": words })
}

pub fn default(schema: Value, value: impl Into<Value>) -> Value {
    with(schema, json!({ "default": value.into() }))
}

pub fn example(schema: Value, value: impl Into<Value>) -> Value {
    with(schema, json!({ "examples": [value.into()] }))
}

/// A text that can be shown and written to files.
pub fn name(says: &str) -> Value {
    with(text(says), printable())
}

fn printable() -> Value {
    let pattern = format!("^[^\\s{HIDDEN}]([^{HIDDEN}]*[^\\s{HIDDEN}])?$");
    json!({ "minLength": 1, "maxLength": LONGEST_NAME, "pattern": pattern })
}

/// A table with these keys and no other.
pub fn table<const N: usize>(says: &str, keys: [(&str, Value); N], required: &[&str]) -> Value {
    let keys: Map<_, _> = keys.into_iter().map(|(key, schema)| (key.to_string(), schema)).collect();
    let schema = json!({
        "description": says, "type": "object", "properties": keys, "additionalProperties": false,
    });
    if required.is_empty() { schema } else { with(schema, json!({ "required": required })) }
}

/// More keys of a table, before its own.
pub fn with_keys<const N: usize>(keys: [(&str, Value); N], mut table: Value) -> Value {
    if let Some(Value::Object(own)) = table.get_mut("properties") {
        let mut all: Map<_, _> = keys.into_iter().map(|(key, schema)| (key.to_string(), schema)).collect();
        all.append(own);
        *own = all;
    }
    table
}

/// Tables, each under a name that somebody chooses.
pub fn named(says: &str, of: Value) -> Value {
    json!({ "description": says, "type": "object", "additionalProperties": of, "propertyNames": printable() })
}

/// A list of tables, [[key]] above each.
pub fn list(says: &str, of: Value, (min, max): (usize, Option<usize>)) -> Value {
    let schema = json!({ "description": says, "type": "array", "items": of, "minItems": min });
    max.map_or(schema.clone(), |max| with(schema, json!({ "maxItems": max })))
}

/// One of several kinds of value.
pub fn any(says: &str, ways: impl IntoIterator<Item = Value>) -> Value {
    json!({ "description": says, "anyOf": ways.into_iter().collect::<Vec<_>>() })
}

/// The ways to write a number that may be searched, from `low` to `high`: a number, a range, a list.
pub fn coordinate((low, high): (f64, f64), most: usize) -> [Value; 3] {
    let number =
        |says: &str| json!({ "description": says, "type": "number", "minimum": low, "maximum": high });
    let range = table(
        "A range to search.",
        [
            ("min", number("The low end.")),
            ("max", number("The high end.")),
            ("start", number("Where the layout as drawn has it; left out: the middle.")),
        ],
        &["min", "max"],
    );
    let item = json!({ "type": "number", "minimum": low, "maximum": high });
    let values = json!({
        "description": "The values allowed; it starts at the first.",
        "type": "array", "items": item, "minItems": 1, "maxItems": most, "uniqueItems": true,
    });
    [number("It stays there."), range, values]
}

pub const ANYWHERE: (f64, f64) = (-LARGEST, LARGEST);

/// `schema` and `units`: what every file begins with.
pub fn header(kind: &str) -> [(&'static str, Value); 2] {
    let schema = format!("sweetspot/{kind}/1");
    let unit = |says: &str, word: &str| example(self::word(says, &[word]), word);
    let units = table(
        "The units of all numbers of the file.",
        [("length", unit("Lengths are in mm.", "mm")), ("angle", unit("Angles are in degrees.", "deg"))],
        &["length", "angle"],
    );
    let says = format!("The kind of file, that of {}, and its version.", article(kind));
    [
        ("schema", default(word(&says, &[&schema]), schema.clone())),
        ("units", default(units, json!({ "length": "mm", "angle": "deg" }))),
    ]
}

fn article(kind: &str) -> String {
    if kind == "equipment" { "an equipment".into() } else { format!("a {kind}") }
}

/// What a file without `from` needs besides.
pub fn of_file(table: Value) -> Value {
    let required = table.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
    let all: Vec<Value> = [json!("schema"), json!("units")].into_iter().chain(required).collect();
    with(table, json!({ "required": all }))
}

/// What holds where no other file lies under a table.
pub fn whole(table: Value, rules: impl IntoIterator<Item = Value>) -> Value {
    with(table, json!({ WHOLE: rules.into_iter().collect::<Vec<_>>() }))
}

/// The path of a file beside or below the one that names it.
pub fn path(says: &str, file: &str) -> Value {
    example(with(text(says), json!({ "pattern": "^[^/\\\\:]([^\\\\:]*[^/\\\\:])?$" })), file)
}

/// A vector that has a direction.
pub fn direction(schema: Value) -> Value {
    with(schema, json!({ "not": { "enum": [[0, 0, 0]] } }))
}
