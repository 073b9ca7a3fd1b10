//! Tests that the schema has the keys that the reader asks for, each with a description.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use sweetspot::files::keys_asked_by;
use sweetspot::files::{FileKind, load, load_robot, schema};

type Keys = BTreeMap<String, BTreeSet<String>>;

/// Names of tables in the reader, and the places of their keys in the schema of a cell.
const TABLES: [(&str, &[&str]); 37] = [
    ("a cell", &[""]),
    ("`units`", &["units"]),
    ("`robot`", &["robot"]),
    ("`base`", &["robot/base", "robot/errors/*/base"]),
    ("`base_tolerance`", &["robot/base_tolerance"]),
    ("a joint", &["robot/joint"]),
    ("`tool`", &["robot/tool", "robot/errors/*/tool"]),
    ("`self_collision`", &["robot/self_collision"]),
    ("an error set", &["robot/errors/*"]),
    ("a frame error of `joints`", &["robot/errors/*/joints"]),
    ("`distribution`", &["robot/errors/*/distribution"]),
    ("`covariance`", &["robot/errors/*/covariance"]),
    ("an equipment", &["equipment/*"]),
    ("an obstacle", &["obstacle/*"]),
    ("`surface`", &["equipment/*/surface"]),
    ("`footprint`", &["equipment/*/footprint"]),
    ("`placement`", &["equipment/*/placement"]),
    ("`placement_tolerance`", &["equipment/*/placement_tolerance"]),
    ("`errors`", &["equipment/*/errors"]),
    ("a solid", &["equipment/*/solid", "robot/solid"]),
    ("`box`", &["equipment/*/solid/box"]),
    ("`sphere`", &["equipment/*/solid/sphere"]),
    ("`capsule`", &["equipment/*/solid/capsule"]),
    ("`cylinder`", &["equipment/*/solid/cylinder"]),
    ("`mesh`", &["equipment/*/solid/mesh"]),
    ("`leg`", &["equipment/*/solid/leg"]),
    ("x_mm", &["equipment/*/placement/x_mm"]),
    ("a keep-out box", &["keep_out/*"]),
    ("a sense", &["sense/*"]),
    ("a term", &["sense/*/term"]),
    ("an operation", &["operation/*"]),
    ("`region`", &["operation/*/region"]),
    ("`held`", &["operation/*/held"]),
    ("`margins`", &["margins"]),
    ("`transfer`", &["transfer"]),
    ("`fence`", &["fence"]),
    ("`search`", &["search"]),
];

/// Keys that are requested only to refuse them. No editor shall offer them.
const REFUSED: [(&str, &[&str]); 2] =
    [("an obstacle", &["errors", "placement_tolerance", "stands_on"]), ("`errors`", &["covariance"])];

/// Returns the keys of the table at a path of names, through lists and alternatives.
fn keys_at(schema: &Value, path: &str) -> BTreeSet<String> {
    let mut at = vec![schema];
    for name in path.split('/').filter(|name| !name.is_empty()) {
        let tables = at.iter().flat_map(|s| inside(s));
        at =
            tables
                .filter_map(|s| {
                    if name == "*" { s.get("additionalProperties") } else { s["properties"].get(name) }
                })
                .collect();
    }
    let tables = at.iter().flat_map(|s| inside(s));
    let keys = tables.filter_map(|s| s["properties"].as_object()).flat_map(|keys| keys.keys().cloned());
    keys.filter(|key| key != "from").collect()
}

fn inside(schema: &Value) -> Vec<&Value> {
    let ways = schema["anyOf"].as_array().into_iter().flatten();
    [schema].into_iter().chain(schema.get("items")).chain(ways).collect()
}

/// Reads all shipped cells and one with every key. Returns the requested keys by table.
fn asked() -> Keys {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/");
    let mut read = |path: &str| {
        let folder = if path.starts_with("every_") { "tests/data/" } else { "cells/" };
        std::fs::read(format!("{root}{folder}{path}")).map_err(|e| e.to_string())
    };
    let asked = keys_asked_by(|| {
        for cell in [
            "every_key",
            "every_other_key",
            "drilling_cell",
            "wrist_cell",
            "palletizer_cell",
            "hitachi_urdf",
            "scara_cell",
        ] {
            let loaded = load(&format!("{cell}.toml"), &mut read);
            assert!(loaded.is_ok(), "{cell}: {:#?}", loaded.err());
        }
        assert!(load_robot("robots/franka_panda.toml", &mut read).is_ok());
    });
    let named = |(what, keys): (&String, &BTreeSet<&str>)| {
        (what.clone(), keys.iter().map(|key| key.to_string()).collect())
    };
    asked.iter().map(named).collect()
}

#[test]
fn the_schema_has_the_keys_of_the_reader() {
    let (schema, asked) = (schema(FileKind::Cell), asked());
    let mut count = 0;
    for (what, paths) in TABLES {
        let known: BTreeSet<String> = paths.iter().flat_map(|path| keys_at(&schema, path)).collect();
        let mut read = asked.get(what).unwrap_or_else(|| panic!("{what} was not read")).clone();
        let refused = REFUSED.iter().filter(|(of, _)| *of == what).flat_map(|(_, keys)| keys.iter());
        refused.for_each(|key| assert!(read.remove(*key), "{what} is not asked for {key}"));
        assert_eq!(read, known, "{what}: the reader, the schema");
        count += known.len();
    }
    assert!(count > 180, "{count} keys");
    let listed: BTreeSet<&str> = TABLES.iter().map(|(what, _)| *what).collect();
    // A robot file equals the robot of a cell without a placement. Other coordinates equal x_mm.
    let alike = ["a robot", "y_mm", "z_mm", "yaw_deg", "bend_deg", "azimuth_deg", "spin_deg"];
    let new: Vec<_> = asked.keys().filter(|what| !listed.contains(what.as_str())).collect();
    assert!(new.iter().all(|what| alike.contains(&what.as_str())), "{new:?}");
}

/// A file of another kind has the keys of that part of a cell.
#[test]
fn a_part_has_the_same_keys_in_its_file_as_in_a_cell() {
    let cell = schema(FileKind::Cell);
    let parts = [
        (FileKind::Robot, "robot", &["base", "base_tolerance"][..]),
        (FileKind::Tool, "robot/tool", &[]),
        (FileKind::Equipment, "equipment/*", &[]),
    ];
    for (kind, path, of_cell) in parts {
        let mut inside = keys_at(&cell, path);
        of_cell.iter().for_each(|key| assert!(inside.remove(*key)));
        assert_eq!(keys_at(&schema(kind), ""), inside, "{}", kind.name());
    }
}

/// Every key has a description of one sentence and a type or a choice of types.
#[test]
fn every_key_is_described() {
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
