//! Tests the JSON Schemas against the reader. Shipped files are valid and broken files are not. Schema and
//! reader accept the same keys.

use crate::common::{document, root};
use jsonschema::Validator;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use sweetspot::files;
use sweetspot::files::{Fault, FileKind, schema};

fn validator(kind: FileKind) -> Validator {
    let schema = schema(kind);
    assert!(jsonschema::draft7::meta::is_valid(&schema), "{}", kind.name());
    jsonschema::draft7::new(&schema).unwrap()
}

pub fn validators() -> BTreeMap<&'static str, Validator> {
    FileKind::ALL.map(|kind| (kind.name(), validator(kind))).into_iter().collect()
}

fn told(validator: &Validator, document: &Value) -> Vec<String> {
    validator.iter_errors(document).map(|e| format!("{}: {e}", e.instance_path())).collect()
}

/// Returns the name and the text of every .toml file of a folder.
fn files(folder: &str) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let paths = entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_string();
    let mut all: Vec<_> = paths.map(|p| (name(&p), std::fs::read_to_string(&p).unwrap())).collect();
    all.sort();
    all
}

/// Returns the kind that a file states, or the kind cell if it states none.
fn kind_of(document: &Value) -> String {
    let word = document["schema"].as_str().unwrap_or("sweetspot/cell/1");
    word.split('/').nth(1).unwrap().to_string()
}

/// Returns every shipped file with its kind.
pub fn shipped() -> Vec<(String, String, String)> {
    let mut all = Vec::new();
    for folder in ["cells", "cells/robots", "cells/equipment"] {
        for (name, text) in files(folder) {
            let document = document(&text).unwrap();
            // If a file does not state its kind, the folder determines the kind.
            let kind = match folder {
                "cells/robots" => "robot".to_string(),
                _ => kind_of(&document),
            };
            all.push((format!("{folder}/{name}"), text, kind));
        }
    }
    all
}

#[test]
fn every_shipped_file_validates_against_its_schema() {
    let (validators, shipped) = (validators(), shipped());
    for (path, text, kind) in &shipped {
        let told = told(&validators[kind.as_str()], &document(text).unwrap());
        assert!(told.is_empty(), "{path}: {told:#?}");
    }
    for kind in FileKind::ALL {
        let count = shipped.iter().filter(|(.., k)| k == kind.name()).count();
        assert!(count >= 2, "{count} files of {}", kind.name());
    }
    let every_key = std::fs::read_to_string(root().join("tests/data/every_key.toml")).unwrap();
    assert_eq!(told(&validators["cell"], &document(&every_key).unwrap()), [""; 0]);
}

/// A schema of one kind refuses the files of another.
#[test]
fn the_schemas_distinguish_the_file_kinds() {
    let validators = validators();
    for (path, text, kind) in shipped().iter().filter(|(_, text, _)| text.contains("\nschema = ")) {
        for (other, validator) in &validators {
            assert_eq!(validator.is_valid(&document(text).unwrap()), other == kind, "{path} as {other}");
        }
    }
}

/// Faults that a schema cannot detect, with the files of tests/broken that have them.
const BEYOND: [(&str, &str); 6] = [
    (
        "another file gives it, or should",
        "covariance_incomplete cyclic_from cyclic_from_itself equipment_of_nothing error_set_without_kind fence_without_polygon file_without_schema held_of_nothing mesh_empty mesh_file_missing mesh_open mesh_with_lost_vertex mesh_with_nan mesh_with_words missing_keys missing_reference missing_robot missing_similar_key part_in_metres path_leaves_folder placement_missing_z plan_block_in_itself plan_crosses_itself plan_cut_off plan_of_lines_only plan_of_other_content plan_with_nan plan_without_unit robot_where_equipment_is_wanted sense_of_nothing tool_without_axis",
    ),
    (
        "a name refers to nothing, or to the wrong thing",
        "error_set_unknown joint_errors_twice joints_of_same_name obstacle_named_like_equipment operation_on_no_surface operation_on_unknown_equipment operation_with_misspelt_sense operation_with_unknown_sense plan_with_unknown_layer relative_to_everywhere relative_to_itself relative_to_later relative_to_relative relative_to_unknown solids_of_same_name stands_on_in_a_circle stands_on_itself",
    ),
    (
        "the robot has so many joints, of such a kind, with such limits",
        "coupling_without_diagonal coupling_wrong_shape elastic_joint_slides error_set_in_mm_for_turning_joint home_outside home_wrong_count margin_leaves_nothing periodic_of_coupled_joints solid_of_unknown_link via_in_the_margin via_outside via_wrong_count",
    ),
    (
        "numbers contradict each other",
        "capsule_of_no_length costs_do_not_suit covariance_besides_plus_minus covariance_beyond_one covariance_negative_variance covariance_not_definite covariance_not_symmetric covariance_wrong_rows covariance_wrong_shape fence_corner_twice fence_crosses_itself fence_in_metres fence_runs_back footprint_too_small keep_out_empty limits_reversed limits_without_travel placement_reversed placement_start_outside plan_in_another_unit sense_mixed_units sense_too_many_rows teach_in_line teach_off_the_surface",
    ),
    (
        "the question has no answer",
        "equipment_tolerance_read_signed pareto_time_without_speeds robust_against_nothing robust_and_ideal senses_of_two_units tolerance_cost_of_a_sample tolerance_cost_without_limits tolerance_read_signed yield_without_limit",
    ),
    (
        "it is odd, not wrong",
        "compliance_in_wrong_unit compliance_without_masses equipment_in_metres equipment_too_large keep_out_in_metres limits_in_radians plan_with_open_lines rates_in_radians robot_in_metres tolerance_in_metres tolerance_too_large",
    ),
];

/// The schema refuses all other files of tests/broken because of their structure.
#[test]
fn the_schema_refuses_broken_files() {
    let validator = validator(FileKind::Cell);
    let mut beyond: Vec<String> =
        BEYOND.iter().flat_map(|(_, names)| names.split(' ')).map(|name| format!("{name}.toml")).collect();
    let (mut refused, mut no_toml) = (0, 0);
    for (name, text) in files("tests/broken") {
        let Some(document) = document(&text) else {
            no_toml += 1;
            continue;
        };
        let told = told(&validator, &document);
        let known = beyond.iter().position(|other| *other == name).map(|k| beyond.remove(k));
        assert_eq!(told.is_empty(), known.is_some(), "{name}: {told:#?}\n{text}");
        refused += usize::from(!told.is_empty());
    }
    assert!(beyond.is_empty(), "{beyond:?} are not there");
    assert!(refused >= 120 && no_toml <= 5, "{refused} refused, {no_toml} are no TOML");
}

/// Returns a document as TOML with one line per top-level key and inline tables.
pub fn toml_of(document: &Value) -> String {
    fn value(v: &Value) -> String {
        match v {
            Value::Array(items) => format!("[{}]", items.iter().map(value).collect::<Vec<_>>().join(", ")),
            Value::Object(t) => {
                format!(
                    "{{ {} }}",
                    t.iter()
                        .map(|(k, v)| format!("{} = {}", json!(k), value(v)))
                        .collect::<Vec<_>>()
                        .join(", ")
                )
            }
            other => other.to_string(),
        }
    }
    document.as_object().unwrap().iter().map(|(k, v)| format!("{} = {}\n", json!(k), value(v))).collect()
}

/// Collects the paths of every table and list of a document.
fn places(value: &Value, path: &str, all: &mut Vec<String>) {
    match value {
        Value::Object(t) if !t.is_empty() => {
            all.push(path.to_string());
            t.iter().for_each(|(k, v)| {
                places(v, &format!("{path}/{}", k.replace('~', "~0").replace('/', "~1")), all)
            });
        }
        Value::Array(items) if !items.is_empty() => {
            all.push(path.to_string());
            items.iter().enumerate().for_each(|(i, v)| places(v, &format!("{path}/{i}"), all));
        }
        _ => {}
    }
}

/// Makes one random change: a key is renamed or removed, or a value is replaced or added.
fn mutate(document: &mut Value, rng: &mut ChaCha8Rng) {
    let others = [
        json!("x"),
        json!(-7),
        json!(0),
        json!(1e9),
        json!(true),
        json!([]),
        json!({}),
        json!([1, 2]),
        json!({ "x": 1 }),
    ];
    let other = others[rng.random_range(0..others.len())].clone();
    let mut all = Vec::new();
    places(document, "", &mut all);
    let place = &all[rng.random_range(0..all.len())];
    match document.pointer_mut(place).unwrap() {
        Value::Object(t) => {
            let key = t.keys().nth(rng.random_range(0..t.len())).unwrap().clone();
            match rng.random_range(0..5) {
                0 | 1 => {
                    let value = t.remove(&key).unwrap();
                    t.insert(format!("{key}x"), value);
                }
                2 => drop(t.remove(&key)),
                3 => drop(t.insert(key, other)),
                _ => drop(t.insert(
                    ["from", "name", "solid", "kind", "limit_mm", "term"][rng.random_range(0..6)].into(),
                    other,
                )),
            }
        }
        Value::Array(items) => {
            let at = rng.random_range(0..items.len());
            if rng.random_range(0..2) == 0 { items[at] = other } else { items.push(other) }
        }
        _ => unreachable!(),
    }
}

/// Number of random changes of every shipped file.
const MUTATIONS: usize = 100;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Returns the faults that the reader reports if a text replaces a shipped file of this kind.
pub fn read(kind: &str, path: &str, text: &str) -> Result<(), Vec<Fault>> {
    let path = path.trim_start_matches("cells/");
    let round = match kind {
        "equipment" => format!(
            "from = \"hitachi_cell.toml\"\nobstacle.it = {{ from = \"{path}\", placement = {{ x_mm = 5000, y_mm = 0, z_mm = 600 }} }}\n"
        ),
        "tool" => format!("from = \"hitachi_cell.toml\"\nrobot.tool = {{ from = \"{path}\" }}\n"),
        _ => String::new(),
    };
    let mut file = |asked: &str| match asked {
        "round.toml" => Ok(round.clone().into_bytes()),
        _ if asked == path => Ok(text.as_bytes().to_vec()),
        _ if asked.ends_with(".obj") => Ok(CUBE.into()),
        _ => std::fs::read(root().join("cells").join(asked)).map_err(|_| "no such file".to_string()),
    };
    match kind {
        "cell" => files::load(path, &mut file).map(drop),
        "robot" => files::load_robot(path, &mut file).map(drop),
        _ => files::load("round.toml", &mut file).map(drop),
    }
}

/// The schema refuses a key that the reader does not know, and accepts every file that the reader accepts.
#[test]
fn the_schema_and_the_reader_agree_on_changed_files() {
    let (validators, mut rng) = (validators(), ChaCha8Rng::seed_from_u64(2026));
    let (mut unknown, mut taken, mut refused, mut both) = (0, 0, 0, 0);
    for (path, text, kind) in shipped()
        .iter()
        .filter(|(path, ..)| !path.ends_with("_stl.toml") && !path.ends_with("wrist_cell.toml"))
    {
        let document = document(text).unwrap();
        assert!(read(kind, path, &toml_of(&document)).is_ok(), "{path} as written here");
        for _ in 0..MUTATIONS {
            let mut changed = document.clone();
            mutate(&mut changed, &mut rng);
            let toml = toml_of(&changed);
            let told = told(&validators[kind.as_str()], &changed);
            match read(kind, path, &toml) {
                Ok(()) => {
                    assert!(told.is_empty(), "{path}: the reader accepts\n{toml}\n{told:#?}");
                    taken += 1;
                }
                Err(faults) => {
                    refused += 1;
                    both += usize::from(!told.is_empty());
                    if faults.iter().any(|f| f.message.starts_with("unknown key")) {
                        assert!(!told.is_empty(), "{path}: the reader says {faults:#?} of\n{toml}");
                        unknown += 1;
                    }
                }
            }
        }
    }
    // A schema cannot detect the remaining faults: unknown names and wrong numbers of joints.
    assert!(taken > 200 && unknown > 1000, "{taken} taken, {unknown} with an unknown key");
    assert!(both * 20 > refused * 19, "{both} of {refused} that the reader refuses");
}
