//! Tests the command `readings`.

use crate::cli::sandbox::*;
use serde_json::Value;

fn rows(operation: &Value) -> &[Value] {
    items(&operation["readings"])
}

#[test]
fn each_reading_has_its_least_error_at_its_own_best_layout() {
    let shop = Sandbox::new();
    for (cell, flags) in [(PAPER, &[][..]), (CELL, &["--limit", "6"]), (CELL, &["--errors", "table-3"])] {
        let document = shop.json(&[&["readings", cell], flags].concat());
        let mut most = 0f64;
        for operation in items(&document["operations"]) {
            let kinds = if flags.first() == Some(&"--limit") { 4 } else { 3 };
            assert_eq!(rows(operation).len(), 3 * kinds);
            for row in rows(operation) {
                let keys = [
                    "unit",
                    "node",
                    "position_mm",
                    "value",
                    "at_signed_choice",
                    "ratio",
                    "moved_mm",
                    "reason",
                ];
                keys.iter().for_each(|key| {
                    field(row, key);
                });
                let Some(value) = row["value"].as_f64() else {
                    assert!(!text(&row["reason"]).is_empty() && row["node"].is_null(), "{row}");
                    continue;
                };
                assert!(row["reason"].is_null() && numbers(&row["position_mm"]).len() == 3);
                let chosen = number(&row["at_signed_choice"]);
                assert!(value <= chosen + 1e-9, "{row}");
                if let Some(ratio) = row["ratio"].as_f64() {
                    assert!((ratio - chosen / value).abs() < 1e-5 * ratio, "{row}");
                    most = most.max(ratio);
                }
                if row["reading"] == "signed" {
                    assert_eq!((number(&row["moved_mm"]), value), (0.0, chosen), "{row}");
                }
                if row["registration"] == "none" {
                    assert_eq!(row["at_unregistered_choice"], row["value"]);
                }
            }
        }
        assert_eq!(number(&document["largest_regret"]["ratio"]), most);
        assert!(!items(&document["findings"]).is_empty());
    }
}

#[test]
fn the_rows_of_readings_agree_with_map() {
    let shop = Sandbox::new();
    let document = shop.json(&["readings", CELL]);
    for (reading, registration) in
        [("signed", "none"), ("worst-case", "best-fit"), ("statistical", "none"), ("worst-case", "taught")]
    {
        let map = shop.json(&["map", CELL, "--reading", reading, "--registration", registration]);
        for (said, mapped) in items(&document["operations"]).iter().zip(items(&map["operations"])) {
            let same = |r: &&Value| r["reading"] == reading && r["registration"] == registration;
            let row = rows(said).iter().find(same).unwrap();
            assert_eq!(row["value"], mapped["best"]["value"], "{reading} {registration}");
            assert_eq!(row["position_mm"], mapped["best"]["position_mm"]);
        }
    }
}

#[test]
fn readings_of_a_tolerance_set_have_no_signed_rows() {
    let shop = Sandbox::new();
    let ran = shop.done(&["readings", PAPER, "--errors", "table-3-tolerance"]);
    assert!(ran.out.contains("is a set of tolerances without a signed sample"), "{}", ran.out);
    let document = shop.json(&["readings", PAPER, "--errors", "table-3-tolerance"]);
    assert_eq!(document["largest_regret"], Value::Null);
    for row in rows(&document["operations"][0]) {
        assert_ne!(row["reading"], "signed");
        assert!(row["at_signed_choice"].is_null() && row["moved_mm"].is_null(), "{row}");
    }
}

#[test]
fn the_folder_of_readings_is_complete() {
    let shop = Sandbox::new();
    let document = shop.json(&["readings", CELL, "--out", "read"]);
    assert_eq!(shop.files("read"), ["manifest.json", "readings.csv", "readings.json"]);
    assert_eq!(shop.document("read/readings.json"), document);
    let manifest = shop.document("read/manifest.json");
    for output in items(&manifest["outputs"]) {
        let bytes = shop.read(&format!("read/{}", text(&output["path"])));
        assert_eq!(text(&output["sha256"]), sha256(&bytes));
    }
    let bytes = shop.read("read/readings.csv");
    let mut reader = csv::Reader::from_reader(&*bytes).into_deserialize();
    for operation in items(&document["operations"]) {
        for row in rows(operation) {
            let line: std::collections::HashMap<String, String> = reader.next().unwrap().unwrap();
            assert_eq!(line["operation"], text(&operation["name"]));
            for key in ["reading", "quantity", "registration", "unit"] {
                assert_eq!(line[key], text(&row[key]));
            }
            for key in ["value", "at_signed_choice", "at_unregistered_choice", "ratio", "moved_mm"] {
                assert_eq!(line[key].parse::<f64>().ok(), row[key].as_f64(), "{key}: {row}");
            }
            assert_eq!(line["x_mm"].parse::<f64>().ok(), row["position_mm"].get(0).map(number));
            assert_eq!(line["reason"], row["reason"].as_str().unwrap_or(""));
        }
    }
    assert!(reader.next().is_none());
}

#[test]
fn readings_without_a_layout_exit_1() {
    let shop = Sandbox::new();
    let far = "from = \"hitachi_paper.toml\"\n[equipment.worktable.placement]\nx_mm = 6000\n";
    shop.write("cells/far.toml", far);
    let ran = shop.run(&["readings", "cells/far.toml", "--json"]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    let row = &rows(&ran.document()["operations"][0])[0].clone();
    assert!(text(&row["reason"]).contains("99 out of reach"), "{row}");
}
