//! Tests hostile numbers in every numeric key of the files, in every number of a URDF and in mesh
//! coordinates.
//!
//! The keys come from the tables of keys, through their schemas. A new key is therefore tested without a
//! change in this file.

use crate::common::{document, root};
use crate::schema::{shipped, toml_of, validators};
use crate::schema_keys::{TableKey, keys_of, pointers};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use sweetspot::files;
use sweetspot::files::{Fault, FileKind, schema};
use sweetspot::mesh::{from_obj, from_stl};

/// Values that no number of any file may have, as TOML.
const REFUSED: [&str; 7] = ["nan", "-nan", "inf", "-inf", "1e308", "-1e308", "\"1\""];

/// Values at the limits of numbers, as TOML. The schema of a key states whether the key may have them.
const EDGES: [&str; 3] = ["1e-320", "-0.0", "-0"];

/// Keys that refuse a value of [`EDGES`] although their schema accepts it, with the reason, which a schema
/// cannot state.
const BEYOND_SCHEMA: [(&str, &str); 5] = [
    ("a direction or an axis has no length", "axis b_mm"),
    ("a covariance matrix or a coupling contradicts itself", "matrix coupling"),
    ("a range is reversed or has no length", "limits_deg limits_mm max max_mm min start"),
    ("the joint turns and cannot be off by a length", "dq_mm"),
    ("a whole number has no point", "link seed"),
];

/// Returns whether a schema describes a number, or lists of numbers.
fn is_numeric(schema: &Value) -> bool {
    let ways = schema["anyOf"].as_array().into_iter().flatten();
    let is_number = matches!(schema["type"].as_str(), Some("number" | "integer"));
    is_number || schema.get("items").is_some_and(is_numeric) || ways.into_iter().any(is_numeric)
}

/// Returns the pointers to the first and the last number in a value that is a number or a list.
fn numbers(value: &Value, pointer: &str) -> Vec<String> {
    match value {
        Value::Number(_) => vec![pointer.to_string()],
        Value::Array(items) => {
            let below = |i: usize| numbers(&items[i], &format!("{pointer}/{i}"));
            let mut all: Vec<String> = (0..items.len()).flat_map(below).collect();
            if all.len() > 2 {
                all = vec![all[0].clone(), all[all.len() - 1].clone()];
            }
            all
        }
        _ => Vec::new(),
    }
}

/// Returns a document as TOML in which `text` replaces one value, with the line and the column of this text.
fn with(document: &Value, pointer: &str, text: &str) -> (String, usize, usize) {
    let mut changed = document.clone();
    *changed.pointer_mut(pointer).unwrap() = json!("HOSTILE");
    let toml = toml_of(&changed);
    let at = toml.find("\"HOSTILE\"").unwrap();
    let line = toml[..at].matches('\n').count() + 1;
    let column = toml[..at].chars().rev().take_while(|c| *c != '\n').count() + 1;
    (toml.replace("\"HOSTILE\"", text), line, column)
}

/// Checks that a value is refused with its place in the file.
fn is_refused_at(faults: &[Fault], (line, column): (usize, usize), what: &str) {
    let here = |f: &&Fault| f.is_error() && f.line == line && f.column <= column;
    let fault = faults.iter().find(here).unwrap_or_else(|| panic!("{what}: {line}:{column}: {faults:#?}"));
    assert!(!fault.help.is_empty(), "{what}: {fault}");
}

/// Returns the messages of the errors of a file.
fn errors(kind: &str, path: &str, toml: &str) -> BTreeSet<String> {
    let faults = crate::schema::read(kind, path, toml).err().unwrap_or_default();
    faults.into_iter().filter(Fault::is_error).map(|fault| fault.message).collect()
}

#[test]
fn every_numeric_key_refuses_hostile_numbers() {
    let mut untried = BTreeSet::new();
    FileKind::ALL.into_iter().for_each(|kind| keys_of(&schema(kind), &mut untried));
    untried.retain(|(of, _)| is_numeric(&serde_json::from_str(of).unwrap()));
    let (keys, mut values, mut beyond_schema) = (untried.len(), 0, BTreeSet::new());
    let validators = validators();
    let data = ["every_key.toml", "every_other_key.toml", "every_rate_key.toml"].map(|name| {
        let text = std::fs::read_to_string(root().join("tests/data").join(name)).unwrap();
        (format!("cells/{name}"), text, "cell".to_string())
    });
    for (path, text, kind) in data.into_iter().chain(shipped()) {
        let document = document(&text).unwrap();
        let kind_of_file = FileKind::ALL.into_iter().find(|k| k.name() == kind).unwrap();
        let before = errors(&kind, &path, &toml_of(&document));
        let validator = &validators[kind.as_str()];
        let schema_faults = |of: &Value| -> BTreeSet<String> {
            validator.iter_errors(of).map(|e| e.instance_path().to_string()).collect()
        };
        let mut all: Vec<(String, TableKey)> = Vec::new();
        pointers(&document, vec![&schema(kind_of_file)], "", &mut all);
        for (pointer, key) in all {
            let places = numbers(document.pointer(&pointer).unwrap(), &pointer);
            if !untried.contains(&key) || places.is_empty() {
                continue;
            }
            for place in &places {
                for value in REFUSED {
                    let (toml, line, column) = with(&document, place, value);
                    let faults = crate::schema::read(&kind, &path, &toml).err().unwrap_or_default();
                    is_refused_at(&faults, (line, column), &format!("{path} {place} = {value}"));
                }
                for value in EDGES {
                    let (toml, ..) = with(&document, place, value);
                    let mut changed = document.clone();
                    *changed.pointer_mut(place).unwrap() =
                        if value == "-0" { json!(0) } else { json!(value.parse::<f64>().unwrap()) };
                    let is_valid = schema_faults(&changed).is_subset(&schema_faults(&document));
                    let is_accepted = errors(&kind, &path, &toml).is_subset(&before);
                    assert!(is_valid || !is_accepted, "{path} takes {place} = {value}");
                    if is_valid != is_accepted {
                        beyond_schema.insert(key.1.clone());
                    }
                }
                values += REFUSED.len() + EDGES.len();
            }
            untried.remove(&key);
        }
    }
    assert!(untried.is_empty(), "no file gives these keys a number: {untried:#?}");
    assert!(keys > 60 && values > 900, "{keys} keys, {values} values");
    let known = BEYOND_SCHEMA.iter().flat_map(|(_, keys)| keys.split(' ')).map(String::from).collect();
    assert_eq!(beyond_schema, known);
}

/// Attributes of a URDF whose numbers are used, by the tag of their element.
const USED: [(&str, &str); 14] = [
    ("origin", "xyz"),
    ("origin", "rpy"),
    ("axis", "xyz"),
    ("limit", "lower"),
    ("limit", "upper"),
    ("limit", "velocity"),
    ("mimic", "multiplier"),
    ("mimic", "offset"),
    ("box", "size"),
    ("cylinder", "radius"),
    ("cylinder", "length"),
    ("sphere", "radius"),
    ("mesh", "scale"),
    ("mass", "value"),
];

/// Loads the robot of tests/fuzz with this URDF.
fn load_urdf(urdf: &str) -> Result<(), Vec<Fault>> {
    let robot = std::fs::read(root().join("tests/fuzz/robot_of_urdf.toml")).unwrap();
    let loaded = files::load_robot("robot.toml", &mut |path| match path {
        "robot.toml" => Ok(robot.clone()),
        "arm.urdf" => Ok(urdf.into()),
        _ => Ok(crate::fuzz::STL.into()),
    });
    loaded.map(drop)
}

#[test]
fn every_number_of_a_urdf_refuses_hostile_numbers() {
    let urdf = std::fs::read_to_string(root().join("tests/fuzz/arm.urdf")).unwrap();
    load_urdf(&urdf).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let mut tried = BTreeSet::new();
    for (at, _) in urdf.match_indices("=\"") {
        let is_in_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let name = urdf[..at].rsplit(|c| !is_in_name(c)).next().unwrap();
        let tag = urdf[..at].rsplit('<').next().unwrap().split(|c| !is_in_name(c)).next().unwrap();
        let value = urdf[at + 2..].split('"').next().unwrap();
        if value.split_ascii_whitespace().any(|word| word.parse::<f64>().is_err()) || tag.is_empty() {
            continue;
        }
        let Some((tag, name)) = USED.into_iter().find(|known| *known == (tag, name)) else {
            assert!(name == "effort", "{tag} {name}");
            continue;
        };
        tried.insert((tag, name));
        let words: Vec<&str> = value.split_ascii_whitespace().collect();
        for k in 0..words.len() {
            for hostile in ["nan", "inf", "-inf", "1e308", "-1e308", "one", "1e-320", "-0"] {
                let mut changed = words.clone();
                changed[k] = hostile;
                let text =
                    format!("{}{}{}", &urdf[..at + 2], changed.join(" "), &urdf[at + 2 + value.len()..]);
                let loaded = load_urdf(&text);
                let what = format!("{tag} {name} number {k} = {hostile}");
                let is_size = ["size", "radius", "length"].contains(&name);
                let is_unused = tag == "mass";
                match hostile {
                    _ if is_unused => assert!(loaded.is_ok(), "{what}: {loaded:#?}"),
                    "1e-320" | "-0" if !is_size => {}
                    _ => {
                        let line = urdf[..at].matches('\n').count() + 1;
                        is_refused_at(&loaded.expect_err(&what), (line, usize::MAX), &what);
                    }
                }
            }
        }
    }
    assert_eq!(tried, USED.into_iter().collect());
}

#[test]
fn the_coordinates_of_meshes_refuse_hostile_numbers() {
    let coordinates = ["nan", "inf", "-inf", "1e308", "-1e308", "one"];
    let of = |text: &str, place: usize, word: &str| {
        let mut words: Vec<String> = text.split_inclusive([' ', '\n']).map(String::from).collect();
        let numbers: Vec<usize> = (0..words.len()).filter(|k| words[*k].trim_end() == "100").collect();
        let end = words[numbers[place]].trim_start_matches("100").to_string();
        words[numbers[place]] = format!("{word}{end}");
        words.concat()
    };
    for place in 0..2 {
        for word in coordinates {
            let obj = of(crate::fuzz::OBJ, place, word);
            assert!(from_obj(&obj, 1e-3).is_err(), "{obj}");
            let stl = of(crate::fuzz::STL, place, word);
            assert!(from_stl(stl.as_bytes(), 1e-3).is_err(), "{stl}");
        }
        // A tiny coordinate is accepted.
        let obj = of(crate::fuzz::OBJ, place, "1e-320");
        let (vertices, _) = from_obj(&obj, 1.0).unwrap();
        assert!(vertices.iter().all(|v| v.iter().all(|c| c.is_finite())), "{vertices:?}");
    }
}
