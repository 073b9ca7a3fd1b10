//! Tests `calibrate --plan` and `calibrate --choose`: documents, tables to be filled in, refusals.

use crate::cli::sandbox::{Sandbox, items, number, text};
use crate::common::root;
use sweetspot::record::{DocumentKind, MeasuringPlanDocument};

const CELL: &str = "cells/ur_cell.toml";

#[test]
fn a_plan_is_a_document_that_depends_on_the_seed_alone() {
    let shop = Sandbox::new();
    let asked = ["calibrate", "--plan", "14", CELL, "--candidates", "150", "--tracker", "2500,0,900"];
    let document = shop.json(&asked);
    let validator = jsonschema::draft7::new(&DocumentKind::MeasuringPlan.schema()).unwrap();
    assert!(validator.is_valid(&document), "{document}");
    let read: MeasuringPlanDocument = serde_json::from_value(document.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), document);
    assert_eq!(items(&document["poses"]).len(), 14);
    let expected = |key: &str| number(&document["expected"][key]);
    assert!(expected("after_mm") < expected("evenly_spread_mm"), "{}", document["expected"]);
    assert!(expected("evenly_spread_mm") < expected("before_mm") && expected("nodes") > 10.0);
    assert!(number(&document["tried"]["hidden"]) > 0.0 && number(&document["tried"]["candidates"]) == 150.0);
    assert_eq!(shop.json(&asked), document);
    let other = shop.json(&[&asked[..], &["--seed", "2"]].concat());
    assert_ne!(other["poses"], document["poses"]);
}

/// The test fills in the positions of the nominal arm, so the calibration finds no error.
#[test]
fn a_filled_in_table_is_read_by_the_next_command() {
    let shop = Sandbox::new();
    // The second arm has a prismatic joint.
    for (cell, count) in [(CELL, "16"), ("cells/scara_cell.toml", "12")] {
        let asked = ["calibrate", "--plan", count, cell, "--candidates", "120", "--reflector=40,30,60"];
        let ran = shop.done(&[&asked[..], &["--csv", "plan.csv"]].concat());
        assert!(ran.out.contains("Expected rms error") && ran.err.contains("wrote plan.csv"), "{}", ran.err);
        let document = shop.json(&asked);
        let table = shop.text("plan.csv");
        let printed = shop.done(&[&asked[..], &["--csv", "-"]].concat());
        assert_eq!(printed.out, table);
        let mut lines = table.lines();
        let mut filled = format!("{}\n", lines.next().unwrap());
        assert!(filled.starts_with("pose,q1_deg,q2_deg,q3_") && filled.ends_with(",x_mm,y_mm,z_mm\n"));
        for (line, pose) in lines.zip(items(&document["poses"])) {
            let row = line.strip_suffix(",,,").unwrap();
            let place: Vec<_> = items(&pose["reflector_mm"]).iter().map(|v| number(v).to_string()).collect();
            filled += &format!("{row},{}\n", place.join(","));
        }
        shop.write("plan.csv", &filled);
        let next = ran.err.lines().last().unwrap().strip_prefix("next: sweetspot ").unwrap();
        assert!(next.starts_with("calibrate cells/robots/") && next.ends_with(" plan.csv"), "{next}");
        let words: Vec<_> = next.split(' ').collect();
        let calibrated = shop.json(&words);
        let session = &items(&calibrated["sessions"])[0];
        assert!(number(&session["before"]["max_mm"]) < 1e-5, "{session}");
    }
}

#[test]
fn a_plan_that_cannot_be_is_refused_in_words() {
    let shop = Sandbox::new();
    let refused = |args: &[&str], code: i32, said: &[&str]| {
        let ran = shop.run(&[&["calibrate"][..], args].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(code), ""), "{args:?}: {}", ran.err);
        ran.no_panic();
        for words in said {
            assert!(ran.err.contains(words), "{args:?}: no {words:?} in {}", ran.err);
        }
    };
    let tracker_in = |place: &'static str| ["--plan", "20", CELL, "--tracker", place];
    refused(&tracker_in("0,850,740"), 2, &["the tracker is inside worktable", "world frame"]);
    refused(&tracker_in("3000,0,-5"), 2, &["the tracker is inside the floor"]);
    refused(&tracker_in("3000,0"), 2, &["three numbers"]);
    refused(&["--plan", "8", CELL], 2, &["24 coordinates", "unknowns", "at least 9 poses"]);
    refused(&["--plan", "0", CELL], 2, &["--plan"]);
    refused(&["--plan", "30", CELL, "--candidates", "25"], 1, &["only 25 postures", "fewer than 30"]);
    refused(&["--plan", "20", CELL, "ur10.csv"], 2, &["--plan"]);
    refused(&["ur10"], 2, &["DATA"]);
    refused(&["--plan", "20", "cells/nowhere.toml"], 3, &["no such file"]);
    refused(&["--plan", "20", "ur10"], 3, &["no such file"]);
    let opening = ["--plan", "20", CELL, "--tracker=3000,0,800", "--opening=0,0,0"];
    refused(&opening, 2, &["--opening has length 0"]);
    let empty = shop.text(CELL).split("[operation.").next().unwrap().to_string();
    shop.write("cells/empty.toml", &empty);
    refused(&["--plan", "20", "cells/empty.toml"], 2, &["`operation` is missing"]);
    let far = shop.text(CELL).replace("standoff_mm = 100", "standoff_mm = 5000");
    shop.write("cells/far.toml", &far);
    refused(&["--plan", "20", "cells/far.toml"], 1, &["reaches no node", "sweetspot search"]);
    let series = root().join("tests/data/ipa_ur10/D.csv.gz").to_string_lossy().into_owned();
    refused(&["ur10", &series, "--choose", "700"], 2, &["632 rows, fewer than 700"]);
    refused(&["ur10", &series, "--choose", "5"], 2, &["at least"]);
    refused(
        &["ur10", &series, "--choose", "40", "--for", "cells/scara_cell.toml"],
        2,
        &["numbers of joints"],
    );
}

#[test]
fn the_choice_of_measured_rows_is_repeatable_and_follows_the_cell() {
    let shop = Sandbox::new();
    let series = root().join("tests/data/ipa_ur10/D.csv.gz").to_string_lossy().into_owned();
    let chosen = shop.json(&["calibrate", "ur10", &series, "--choose", "30", "--reflector", "0,0,109"]);
    let session = &items(&chosen["sessions"])[0];
    assert_eq!((number(&session["poses"]), text(&session["file"])), (30.0, "D.csv.gz"));
    let again = shop.json(&["calibrate", "ur10", &series, "--choose", "30", "--reflector", "0,0,109"]);
    assert_eq!(again["parameters"], chosen["parameters"]);
    let of_cell = shop.json(&["calibrate", "ur10", &series, "--choose", "30", "--for", CELL]);
    assert_ne!(of_cell["parameters"], chosen["parameters"]);
}
