//! Reference of the fields of a written document in Markdown, made from its JSON Schema.

use serde_json::Value;
use std::fmt::Write;

/// Returns the reference of a kind of document, in Markdown.
pub fn markdown(name: &str, schema: &Value) -> String {
    let mut text = format!("# Fields of {name}\n\n{}\n", paragraph(schema));
    add_fields(&mut text, schema);
    let definitions = schema["definitions"].as_object();
    for (name, definition) in definitions.into_iter().flatten() {
        let _ = writeln!(text, "\n## {name}\n\n{}", paragraph(definition));
        add_fields(&mut text, definition);
        for variant in definition["oneOf"].as_array().into_iter().flatten() {
            let _ = write!(text, "\n- {}", value(variant));
            let about = line(variant);
            let _ = write!(text, "{}", if about.is_empty() { String::new() } else { format!(": {about}") });
        }
        if definition.get("oneOf").is_some() {
            text.push('\n');
        } else if definition.get("properties").is_none() {
            let _ = writeln!(text, "\n{}", value(definition));
        }
    }
    text
}

/// Appends the table of the fields of an object to `text`.
fn add_fields(text: &mut String, schema: &Value) {
    let Some(fields) = schema["properties"].as_object() else { return };
    *text += "\n| Field | Value | Meaning |\n|---|---|---|\n";
    let is_required =
        |name: &str| schema["required"].as_array().is_some_and(|all| all.iter().any(|n| n == name));
    for (name, field) in fields {
        let optional = if is_required(name) { "" } else { "; may be missing" };
        let value = value(field).replace('|', "\\|");
        let _ = writeln!(text, "| `{name}` | {value}{optional} | {} |", line(field).replace('|', "\\|"));
    }
}

/// Returns the kind of value that a schema describes, with links to the definitions of named types.
fn value(schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.strip_prefix("#/definitions/")) {
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(word) = schema.get("const") {
        return format!("`{word}`");
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
    }
    for key in ["allOf", "anyOf", "oneOf"] {
        if let Some(ways) = schema[key].as_array() {
            return ways.iter().map(value).collect::<Vec<_>>().join(" or ");
        }
    }
    let named = |name: &str| match name {
        "array" => match schema.get("items") {
            Some(Value::Array(items)) => {
                format!("list: {}", items.iter().map(value).collect::<Vec<_>>().join(", "))
            }
            Some(items) => format!("list of {}", value(items)),
            None => "list".to_string(),
        },
        "object" => match schema.get("additionalProperties").filter(|v| v.is_object()) {
            Some(values) => format!("object with values of {}", value(values)),
            None => fields_in_words(schema),
        },
        other => other.to_string(),
    };
    match &schema["type"] {
        Value::String(name) => named(name),
        Value::Array(names) => {
            names.iter().filter_map(Value::as_str).map(named).collect::<Vec<_>>().join(" or ")
        }
        _ => "any value".into(),
    }
}

/// Describes an unnamed object by the names of its fields and the kinds of their values.
fn fields_in_words(schema: &Value) -> String {
    let fields = schema["properties"].as_object().into_iter().flatten();
    let fields: Vec<_> = fields.map(|(name, field)| format!("`{name}` ({})", value(field))).collect();
    format!("object {}", fields.join(", ")).trim_end().to_string()
}

/// Returns the description of a schema as a paragraph.
fn paragraph(schema: &Value) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// Returns the description of a schema on one line.
fn line(schema: &Value) -> String {
    paragraph(schema).split_whitespace().collect::<Vec<_>>().join(" ")
}
