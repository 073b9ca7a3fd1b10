//! Tests `schema`: the command prints the files of cells/schemas, to which every shipped file refers.

use crate::cli::sandbox::*;
use crate::common::root;
use serde_json::Value;
use sweetspot::record::DocumentKind;

const KINDS: [&str; 4] = ["cell", "robot", "equipment", "tool"];

#[test]
fn the_committed_schemas_equal_the_printed_ones() {
    let shop = Sandbox::new();
    for kind in KINDS {
        let committed = shop.text(&format!("cells/schemas/{kind}.schema.json"));
        let ran = shop.done(&["schema", kind]);
        assert!(ran.out == committed, "run: sweetspot schema --out cells/schemas ({kind} differs)");
        assert_eq!(ran.err, "next: sweetspot schema --out schemas\n");
    }
    assert_eq!(shop.done(&["schema"]).out, shop.text("cells/schemas/cell.schema.json"));
}

#[test]
fn all_schemas_are_written_into_a_folder_and_rewritten() {
    let shop = Sandbox::new();
    shop.done(&["schema", "--out", "mine/schemas"]);
    shop.write("mine/schemas/robot.schema.json", "of another version");
    let ran = shop.done(&["schema", "--out", "mine/schemas"]);
    assert!(
        ran.out.is_empty() && ran.err.contains("#:schema ./mine/schemas/cell.schema.json"),
        "{}",
        ran.err
    );
    assert_eq!(shop.files("mine/schemas").len(), KINDS.len() + DocumentKind::ALL.len());
    for kind in KINDS {
        let name = format!("schemas/{kind}.schema.json");
        assert_eq!(shop.read(&format!("mine/{name}")), shop.read(&format!("cells/{name}")), "{kind}");
    }
}

#[test]
fn the_reference_of_keys_is_printed_and_written() {
    let shop = Sandbox::new();
    let cell = shop.done(&["schema", "--markdown"]).out;
    assert!(
        cell.starts_with("# Keys of cell files\n") && cell.contains("\n| `budget` | whole number"),
        "{cell}"
    );
    shop.done(&["schema", "--markdown", "--out", "reference"]);
    assert_eq!(shop.files("reference").len(), KINDS.len() + DocumentKind::ALL.len());
    for kind in KINDS.into_iter().chain(DocumentKind::ALL.map(DocumentKind::name)) {
        let written = shop.text(&format!("reference/{kind}.md"));
        assert_eq!(written, shop.done(&["schema", kind, "--markdown"]).out);
    }
}

/// The reference page of a document names every field of its schema, and every link leads to a heading.
#[test]
fn the_reference_of_a_document_has_every_field() {
    let shop = Sandbox::new();
    for kind in DocumentKind::ALL {
        let text = shop.done(&["schema", kind.name(), "--markdown"]).out;
        let schema = kind.schema();
        let definitions = schema["definitions"].as_object().into_iter().flat_map(|all| all.iter());
        for (name, definition) in definitions.chain([(&"".to_string(), &schema)]) {
            assert!(name.is_empty() || text.contains(&format!("\n## {name}\n")), "{}: {name}", kind.name());
            for field in definition["properties"].as_object().into_iter().flat_map(|all| all.keys()) {
                assert!(text.contains(&format!("\n| `{field}` | ")), "{}: {name}.{field}", kind.name());
            }
        }
        for link in text.split("](#").skip(1).map(|rest| rest.split(')').next().unwrap()) {
            let headings = text.lines().filter_map(|line| line.strip_prefix("## "));
            assert!(
                headings.map(str::to_lowercase).any(|heading| heading == link),
                "{}: {link}",
                kind.name()
            );
        }
    }
}

#[test]
fn bad_usage_of_schema_is_reported() {
    let shop = Sandbox::new();
    for args in [&["schema", "cells"][..], &["schema", "robot", "--out", "x"], &["schema", "--out"]] {
        assert_eq!(shop.run(args).code, Some(2), "{args:?}");
    }
    shop.write("file", "");
    assert_eq!(shop.run(&["schema", "--out", "file/schemas"]).code, Some(3));
    assert!(shop.done(&["schema", "--help"]).out.starts_with("Example: sweetspot schema "));
}

/// The first line of every shipped file gives a path that leads to the schema of its kind.
#[test]
fn every_shipped_file_names_its_schema() {
    let mut count = 0;
    for folder in ["cells", "cells/robots", "cells/equipment"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let named = text.lines().next().unwrap().strip_prefix("#:schema ");
            let named = named.unwrap_or_else(|| panic!("{} names no schema", path.display()));
            assert!(path.parent().unwrap().join(named).is_file(), "{}: {named}", path.display());
            let kind =
                KINDS.into_iter().find(|kind| text.contains(&format!("\nschema = \"sweetspot/{kind}/1\"")));
            let kind = kind.unwrap_or(if folder == "cells" { "cell" } else { "robot" });
            assert!(named.ends_with(&format!("/{kind}.schema.json")), "{}: {named}", path.display());
            count += 1;
        }
    }
    assert!(count >= 42, "{count} files");
}

/// Asserts that a document is valid against the schema that the command prints.
fn validates(shop: &Sandbox, kind: DocumentKind, document: &Value) {
    let schema: Value = serde_json::from_str(&shop.done(&["schema", kind.name()]).out).unwrap();
    let validator = jsonschema::draft7::new(&schema).unwrap();
    let faults: Vec<_> =
        validator.iter_errors(document).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(faults.is_empty(), "{}: {faults:#?}", kind.name());
    let mut unknown = document.clone();
    unknown["unknown_field"] = Value::Null;
    assert!(!validator.is_valid(&unknown), "{}: an unknown field is accepted", kind.name());
}

#[test]
fn documents_of_commands_validate_against_the_printed_schemas() {
    let shop = Sandbox::new();
    let found = shop.json(&["search", CELL, "--budget", "60", "--seed", "2", "--out", "found"]);
    validates(&shop, DocumentKind::SearchResult, &found);
    validates(&shop, DocumentKind::SearchResult, &shop.document("found/search.json"));
    let manifest = shop.document("found/manifest.json");
    validates(&shop, DocumentKind::Manifest, &manifest);
    assert_eq!((&manifest["resolved"]["budget"], &manifest["resolved"]["seed"]), (&60.into(), &2.into()));
    // Values that the cell file leaves out are in the manifest, too.
    assert_eq!(manifest["resolved"]["clearance_mm"], 10.0);
    assert_eq!(manifest["resolved"]["margins"]["joint_deg"], 2.0);
    let worktable = &manifest["resolved"]["placement_tolerances"]["worktable"];
    assert_eq!((&worktable["x_mm"], &worktable["yaw_deg"]), (&2.0.into(), &0.2.into()));
    let told = shop.done(&["search", CELL, "--budget", "60", "--progress", "json", "--out", "told"]).err;
    let line = told.lines().rfind(|line| line.starts_with('{')).expect("a line of progress");
    validates(&shop, DocumentKind::Progress, &serde_json::from_str(line).unwrap());
    let report = shop.run(&["report", "found", "--json"]);
    validates(&shop, DocumentKind::Report, &report.document());
    let sweep = ["sweep", PAPER, "--map", "--set", "errors=table-2,table-3", "--out", "swept"];
    validates(&shop, DocumentKind::Sweep, &shop.json(&sweep));
    validates(&shop, DocumentKind::SweepPlan, &shop.document("swept/plan.json"));
    validates(&shop, DocumentKind::SweepRow, &shop.document("swept/0001.json"));
    validates(&shop, DocumentKind::SweepStatus, &shop.json(&["sweep", "--status", "swept"]));
    validates(&shop, DocumentKind::Manifest, &shop.document("swept/manifest.json"));
    validates(&shop, DocumentKind::Check, &shop.json(&["check", "cells/hitachi_urdf.toml"]));
    validates(&shop, DocumentKind::Robots, &shop.json(&["robots"]));
    validates(&shop, DocumentKind::RobotSheet, &shop.json(&["robot", "hitachi_pw10"]));
    validates(&shop, DocumentKind::Envelope, &shop.json(&["envelope", "hitachi_pw10"]));
}

/// The settings of the manifest are used, not its command line.
#[test]
fn a_result_folder_is_read_by_its_settings_and_not_by_its_command() {
    let shop = Sandbox::new();
    let args = ["search", CELL, "--budget", "60", "--limit", "30", "--sense", "xyz", "--out", "found"];
    let code = shop.run(&args).code;
    let manifest = shop.text("found/manifest.json");
    let other = manifest.replace("\"--limit\"", "\"--a-flag-of-another-version\"");
    shop.write("found/manifest.json", &resealed(&other));
    let ran = shop.run(&["report", "found", "--json"]);
    assert_eq!(ran.code, code, "{}", ran.err);
    assert_ne!(ran.document()["requirement"], "none");
    // If the settings differ from the settings of the search, the folder is refused.
    shop.write("found/manifest.json", &resealed(&manifest.replace("\"budget\": 60", "\"budget\": 61")));
    let ran = shop.run(&["report", "found"]);
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.err.contains("manifest.json: the settings that this program reads from inputs/ differ"),
        "{}",
        ran.err
    );
}
