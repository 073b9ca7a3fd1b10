//! Tests `correct`: spots, nodes and tables of targets, and the messages of refusals.

use crate::cli::sandbox::{Sandbox, items, number, text};
use serde_json::Value;
use sweetspot::record::{CorrectionDocument, DocumentKind};

const UR: &str = "cells/ur_cell.toml";
const HITACHI: &str = "cells/hitachi_cell.toml";

fn states(document: &Value) -> Vec<&str> {
    items(&document["targets"]).iter().map(|target| text(&target["state"])).collect()
}

#[test]
fn the_spots_of_a_cell_are_corrected() {
    let shop = Sandbox::new();
    let document = shop.json(&["correct", UR]);
    let validator = jsonschema::draft7::new(&DocumentKind::Correction.schema()).unwrap();
    assert!(validator.is_valid(&document), "{document}");
    let read: CorrectionDocument = serde_json::from_value(document.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), document);
    let map = shop.json(&["map", UR]);
    for (target, operation) in items(&document["targets"]).iter().zip(items(&map["operations"])) {
        assert_eq!(target["operation"], operation["name"]);
        assert_eq!(target["state"], "corrected");
        let spot = items(&operation["nodes"])
            .iter()
            .find(|node| node["i"] == target["node"][0] && node["j"] == target["node"][1]);
        // The error without correction equals the error in the map.
        let error: f64 =
            items(&spot.unwrap()["error_mm"]).iter().map(|e| number(e).powi(2)).sum::<f64>().sqrt();
        assert!((number(&target["before_mm"]) - error).abs() < 1e-6, "{target}");
        assert!(number(&target["rest_mm"]) < 1e-6 && number(&target["rest_deg"]) < 1e-6, "{target}");
        assert_eq!(target["random_mm"], Value::Null);
    }
    let words = shop.done(&["correct", UR]);
    assert!(words.out.contains("Joint commands") && words.out.contains("Pose commands"), "{}", words.out);
    assert!(words.err.contains("next: sweetspot correct cells/ur_cell.toml --csv"), "{}", words.err);
}

/// The command `explain` confirms that the corrected posture with its error reaches the target.
#[test]
fn explain_finds_the_corrected_posture_on_the_target() {
    let shop = Sandbox::new();
    let document = shop.json(&["correct", UR, "--operation", "assembly"]);
    let target = &items(&document["targets"])[0];
    let joints: Vec<_> = items(&target["joints"]).iter().map(|q| number(q).to_string()).collect();
    let joints = format!("--joints={}", joints.join(","));
    let told = shop.json(&["explain", UR, "--operation", "assembly", &joints]);
    let vector = |value: &Value| items(value).iter().map(number).collect::<Vec<_>>();
    let (nominal, error) = (vector(&told["position_mm"]), vector(&told["nonlinear"]["position_mm"]));
    let wanted = vector(&target["position_mm"]);
    for k in 0..3 {
        assert!((nominal[k] + error[k] - wanted[k]).abs() < 1e-5, "{nominal:?} {error:?} {wanted:?}");
    }
}

#[test]
fn every_usable_node_is_corrected_on_request() {
    let shop = Sandbox::new();
    let args = ["correct", HITACHI, "--errors", "table-2", "--operation", "assembly", "--nodes"];
    let ran = shop.run(&[&args[..], &["--json"]].concat());
    let document: Value = serde_json::from_str(&ran.out).unwrap();
    let map = shop.json(&["map", HITACHI, "--errors", "table-2"]);
    let usable = items(&items(&map["operations"])[0]["nodes"]).iter().filter(|n| n["status"] == "ok").count();
    assert_eq!(states(&document).len(), usable);
    let all = states(&document).iter().all(|state| *state == "corrected");
    assert_eq!(ran.code, Some(if all { 0 } else { 1 }), "{}", ran.err);
    for target in items(&document["targets"]).iter().filter(|t| t["state"] == "corrected") {
        assert!(number(&target["rest_mm"]) < 1e-6, "{target}");
        // Four joints cannot also correct the orientation.
        assert!(number(&target["rest_deg"]) > 0.01, "{target}");
    }
    let csv = shop.run(&[&args[..], &["--csv"]].concat()).out;
    assert!(csv.starts_with("operation,target,state,q1_deg,q2_deg,q3_deg,q4_deg,x_mm,"), "{csv}");
    assert_eq!(csv.lines().count(), usable + 1);
}

#[test]
fn targets_of_a_table_are_corrected_in_each_frame() {
    let shop = Sandbox::new();
    let spot = shop.json(&["correct", UR, "--operation", "assembly"]);
    let spot = &items(&spot["targets"])[0];
    let [x, y, z] = [0, 1, 2].map(|k| number(&spot["position_mm"][k]));
    shop.write("targets.csv", &format!("name,x,y,z\nhere,{x},{y},{z}\nfar,9000,0,0\n"));
    let ran = shop.run(&["correct", UR, "--operation", "assembly", "--targets", "targets.csv", "--json"]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    let document: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(states(&document), ["corrected", "unusable"]);
    let [here, far] = [0, 1].map(|k| &items(&document["targets"])[k]);
    assert_eq!((text(&here["name"]), text(&far["reason"])), ("here", "out of reach"));
    assert!(number(&here["rest_mm"]) < 1e-6);
    // The target is a pose in the base frame: a nominal pose with its rotation, in a table with decimal
    // commas.
    let command = &spot["command"];
    let [rx, ry, rz] = [0, 1, 2].map(|k| number(&command["rpy_deg"][k]));
    let [bx, by, bz] = [0, 1, 2].map(|k| number(&command["position_mm"][k]));
    let row = format!("{bx};{by};{bz};{rx};{ry};{rz}").replace('.', ",");
    shop.write("poses.csv", &format!("x_mm;y_mm;z_mm;rx_deg;ry_deg;rz_deg\n{row}\n"));
    let posed =
        shop.json(&["correct", UR, "--operation", "assembly", "--targets", "poses.csv", "--frame", "base"]);
    let posed = &items(&posed["targets"])[0];
    assert_eq!(posed["state"], "corrected");
    assert!(number(&posed["rest_mm"]) < 1e-6 && number(&posed["rest_deg"]) < 1e-6, "{posed}");
    // The distance of the command from the target is the error that the command corrects.
    let moved = [bx, by, bz].into_iter().zip(items(&posed["command"]["position_mm"]));
    let moved = moved.map(|(target, to)| (number(to) - target).powi(2)).sum::<f64>().sqrt();
    assert!((moved / number(&posed["before_mm"]) - 1.0).abs() < 0.05, "{posed}");
    let surface = shop.run(&[
        "correct",
        UR,
        "--operation",
        "assembly",
        "--targets",
        "targets.csv",
        "--frame",
        "surface",
        "--csv",
    ]);
    surface.no_panic();
    assert_eq!(surface.out.lines().count(), 3, "{}", surface.out);
}

#[test]
fn a_tolerance_or_a_wrong_table_is_refused_in_words() {
    let shop = Sandbox::new();
    let refused = |args: &[&str], words: &[&str]| {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        ran.no_panic();
        words.iter().for_each(|word| assert!(ran.err.contains(word), "{args:?}: no {word:?} in {}", ran.err));
    };
    refused(
        &["correct", UR, "--errors", "placeholder"],
        &["is a tolerance", "--errors (factory)", "sweetspot calibrate"],
    );
    refused(&["correct", UR, "--operation", "asembly"], &["did you mean assembly?"]);
    shop.write("no_z.csv", "x,y\n1,2\n");
    refused(&["correct", UR, "--targets", "no_z.csv"], &["no column `z`", "no_z.csv:1:1"]);
    shop.write("words.csv", "x,y,z\n1,2,far\n1,nan,3\n1,2\n");
    refused(
        &["correct", UR, "--targets", "words.csv"],
        &["words.csv:2:1", "`far`", "words.csv:3:1", "words.csv:4:1"],
    );
    shop.write("part.csv", "x,y,z,rx\n1,2,3,4\n");
    refused(&["correct", UR, "--targets", "part.csv"], &["no column `ry`, `rz`"]);
    shop.write("empty.csv", "x,y,z\n");
    refused(&["correct", UR, "--targets", "empty.csv"], &["no target"]);
    assert_eq!(shop.run(&["correct", UR, "--targets", "missing.csv"]).code, Some(3));
}
