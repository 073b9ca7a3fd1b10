//! Tests exit codes and streams, the JSON contract, the files of a search, and hostile input.

use crate::cli::sandbox::*;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

// --- exit codes and streams ---------------------------------------------------------------------

#[test]
fn success_exits_0_with_data_on_stdout_and_notes_on_stderr() {
    let shop = Sandbox::new();
    let search = ["search", CELL, "--budget", "2000", "--out", "found"];
    for args in [
        &["check", CELL][..],
        &["map", CELL],
        &search,
        &["compare", CELL, "found"],
        &["budget", CELL],
        &["explain", CELL],
        &["readings", CELL],
    ] {
        let ran = shop.done(args);
        assert!(!ran.out.is_empty() && !ran.out.contains("next: "), "{args:?}: {}", ran.out);
        assert!(ran.err.contains("next: sweetspot "), "{args:?}: {}", ran.err);
    }
    // The search reports the best layout and the folder of the result.
    let again = shop.done(&["search", CELL, "--budget", "2000", "--out", "again"]);
    assert!(again.out.contains("% lower than that of the start"), "{}", again.out);
    assert!(again.err.contains("wrote again: "), "{}", again.err);
}

#[test]
fn json_output_is_exactly_one_document() {
    let shop = Sandbox::new();
    let search = ["search", CELL, "--budget", "500", "--out", "found", "--json"];
    for (args, schema) in [
        (&["check", CELL, "--json"][..], "check"),
        (&["map", PAPER, "--json", "--svg", "map.svg", "--out", "mapped"], "map"),
        (&search, "search"),
        (&["compare", CELL, "found", "--json"], "compare"),
        (&["budget", CELL, "--json"], "budget"),
        (&["explain", CELL, "--json"], "explain"),
        (&["readings", CELL, "--json", "--out", "read"], "readings"),
    ] {
        let document = shop.done(args).document();
        assert_eq!(document["schema"], format!("sweetspot/{schema}/1"), "{args:?}");
    }
    // A cell with faults still gives a document, but the exit code reports the faults.
    shop.write("cells/bad.toml", "schema = \"sweetspot/cell/1\"\n");
    let ran = shop.run(&["check", "cells/bad.toml", "--json"]);
    assert_eq!((ran.code, &ran.document()["valid"]), (Some(2), &Value::Bool(false)));
}

#[test]
fn no_feasible_layout_exits_1_and_writes_no_best_toml() {
    let shop = Sandbox::new();
    shop.write("cells/far.toml", BEYOND_REACH);
    let ran = shop.run(&["search", "cells/far.toml", "--budget", "300", "--out", "far", "--json"]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    let document = ran.document();
    assert_eq!((&document["status"], &document["objective_mm"]), (&"none".into(), &Value::Null));
    let reasons = format!("{}", document["reasons"]);
    assert!(reasons.contains("assembly has no usable node: 99 out of reach"), "{reasons}");
    shop.has("far", &["manifest.json", "map.csv", "map.svg", "search.json"]);
    assert!(!shop.path("far/best.toml").exists(), "there is no best layout");
    let plain = shop.run(&["search", "cells/far.toml", "--budget", "300", "--out", "again"]);
    assert_eq!(plain.code, Some(1));
    assert!(plain.out.contains("no feasible layout found"), "{}", plain.out);
}

#[test]
fn bad_usage_exits_2() {
    let shop = Sandbox::new();
    for args in [
        &[][..],
        &["fly"],
        &["map"],
        &["compare"],
        &["map", CELL, "--speed", "9"],
        &["map", CELL, "--sense", "w"],
        &["map", CELL, "--model", "cubic"],
        &["search", CELL, "--solver", "luck"],
        &["search", CELL, "--budget", "0"],
        &["search", CELL, "--threads", "0"],
        &["search", CELL, "--seed", "-1"],
    ] {
        let ran = shop.run(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.err);
        assert!(ran.out.is_empty() && !ran.err.is_empty(), "{args:?}: {}", ran.out);
    }
    let sense = shop.run(&["map", CELL, "--sense", "w"]);
    assert!(sense.err.contains("x, y, z, xy, xyz"), "{}", sense.err);
    assert!(!shop.path("results").exists(), "a refused search left a folder");
}

#[test]
fn an_unknown_error_set_exits_2_with_a_suggestion() {
    let shop = Sandbox::new();
    for command in ["map", "search", "compare", "budget", "explain", "readings"] {
        let ran = shop.run(&[command, PAPER, "--errors", "table-33"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}");
        assert!(ran.err.contains("--errors table-33: error: the robot has no error set"), "{}", ran.err);
        assert!(ran.err.contains("did you mean \"table-3\"?"), "{}", ran.err);
        let ran = shop.run(&[command, PAPER, "--errors", "nobody's"]);
        assert!(ran.err.contains("table-2, table-3"), "{}", ran.err);
    }
    assert!(!shop.path("results").exists());
}

#[test]
fn a_bad_cell_exits_2_with_every_fault_and_its_place() {
    let shop = Sandbox::new();
    let bad =
        shop.text(CELL).replace("bend_deg = -90 #", "bent_deg = -90 #").replace("seed = 1", "seed = -1");
    shop.write("cells/bad.toml", &bad);
    for command in ["check", "map", "search", "compare", "budget", "explain", "readings"] {
        let ran = shop.run(&[command, "cells/bad.toml"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}");
        let line = 1 + bad.lines().position(|l| l.starts_with("bent_deg")).unwrap();
        assert!(ran.err.contains(&format!("cells/bad.toml:{line}:1: error: ")), "{}", ran.err);
        assert!(ran.err.contains("did you mean `bend_deg`?"), "{}", ran.err);
        assert!(ran.err.contains("`seed` must be"), "{}", ran.err);
        assert!(ran.err.contains("2 errors; nothing was done"), "{}", ran.err);
    }
    assert!(!shop.path("results").exists());
}

#[test]
fn a_missing_cell_file_exits_3() {
    let shop = Sandbox::new();
    for args in [
        &["check", "nowhere.toml"][..],
        &["check", "nowhere.toml", "--json"],
        &["map", "cells/nowhere.toml"],
        &["search", "nowhere/cell.toml"],
        &["compare", CELL, "nowhere.toml"],
        &["budget", "nowhere.toml"],
        &["explain", "nowhere.toml"],
        &["readings", "nowhere.toml"],
    ] {
        let ran = shop.run(args);
        assert_eq!(ran.code, Some(3), "{args:?}: {}", ran.err);
    }
    // A folder without a search is rejected, even if it can be read.
    std::fs::create_dir(shop.path("empty")).unwrap();
    for args in [["compare", "empty"], ["report", "empty"], ["view", "empty"]] {
        let ran = shop.run(&args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.err);
        assert!(ran.err.contains("that sweetspot search has written"), "{}", ran.err);
    }
    let ran = shop.run(&["map", "cells/nowhere.toml"]);
    assert!(ran.err.contains("cells/nowhere.toml") && ran.err.contains("no such file"), "{}", ran.err);
    // A missing file that the cell names is a fault of the cell.
    shop.write(
        "cells/part.toml",
        "from = \"hitachi_cell.toml\"\nrobot = { from = \"robots/nobody.toml\" }\n",
    );
    let part = shop.run(&["map", "cells/part.toml"]);
    assert_eq!(part.code, Some(2));
    assert!(part.err.contains("cells/part.toml:2:"), "{}", part.err);
}

/// Root may write anywhere, so the parent of the unwritable path is a file.
#[test]
fn an_unwritable_output_exits_3() {
    let shop = Sandbox::new();
    shop.write("file", "a file, not a folder");
    for args in [
        &["search", CELL, "--budget", "500", "--out", "file/found"][..],
        &["search", CELL, "--budget", "500", "--out", "file"],
        &["map", PAPER, "--out", "file/mapped"],
        &["readings", PAPER, "--out", "file/read"],
        &["map", PAPER, "--svg", "file/map.svg"],
        &["map", PAPER, "--svg", "nowhere/map.svg"],
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains("error: cannot "), "{args:?}: {}", ran.err);
    }
    shop.write("results", "a file where the default folder should be");
    assert_eq!(shop.run(&["search", CELL, "--budget", "500"]).code, Some(3));
    assert_eq!(shop.text("results"), "a file where the default folder should be");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stdout_exits_3() {
    let shop = Sandbox::new();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let ran = ran(shop.command(&["map", PAPER, "--json"]).stdout(full).output().unwrap());
    assert_eq!(ran.code, Some(3), "{}", ran.err);
    ran.no_panic();
}

/// In `sweetspot ... | head`, the closed reader causes neither an error nor a panic.
#[test]
fn a_closed_stdout_ends_the_run_quietly() {
    let shop = Sandbox::new();
    for args in [
        &["map", CELL, "--json"][..],
        &["map", CELL],
        &["compare", CELL, CELL],
        &["map", "--help"],
        &["budget", CELL],
        &["explain", CELL, "--json"],
        &["readings", PAPER],
    ] {
        let mut child = shop.command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let ran = ran(child.wait_with_output().unwrap());
        ran.no_panic();
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
    }
}

/// Ctrl-C ends a search early, and the best layout so far is kept.
#[cfg(unix)]
#[test]
fn an_interrupt_exits_130_and_keeps_the_best_layout() {
    let shop = Sandbox::new();
    let args = ["search", CELL, "--budget", "1000000000", "--out", "found", "--json"];
    let child = shop.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The folder is created before the search begins. Then the test waits for some thousand layouts.
    for _ in 0..600 {
        if shop.path("found").exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let ran = ran(child.wait_with_output().unwrap());
    ran.no_panic();
    assert_eq!(ran.code, Some(130), "{}", ran.err);
    assert_eq!(
        (&ran.document()["ended"], &ran.document()["status"]),
        (&"interrupted".into(), &"found".into())
    );
    let (best, found) = (shop.json(&["map", "found/best.toml"]), shop.document("found/search.json"));
    assert_eq!(best["objective_mm"], found["objective_mm"]);
}

#[test]
fn help_of_every_command_begins_with_an_example() {
    let shop = Sandbox::new();
    for args in [
        &["--help"][..],
        &["check", "-h"],
        &["map", "--help"],
        &["search", "--help"],
        &["compare", "-h"],
        &["budget", "--help"],
        &["allocate", "-h"],
        &["explain", "-h"],
        &["readings", "-h"],
        &["robots", "--help"],
        &["robot", "-h"],
        &["envelope", "--help"],
        &["figures", "-h"],
        &["report", "--help"],
        &["errors", "-h"],
        &["correct", "--help"],
    ] {
        let ran = shop.done(args);
        let first = ran.out.lines().next().unwrap();
        assert!(first.starts_with("Example: sweetspot "), "{args:?}: {first}");
        assert!(args.len() == 1 || first.contains(args[0]), "{args:?}: {first}");
        assert!(ran.out.contains("Usage:") && ran.err.is_empty(), "{args:?}");
    }
    assert_eq!(shop.done(&["help"]).out, shop.done(&["--help"]).out);
    assert_eq!(shop.done(&["help", "search"]).out, shop.done(&["search", "--help"]).out);
    assert_eq!(shop.run(&["help", "serch"]).code, Some(2));
    assert_eq!(shop.done(&["--version"]).out, format!("sweetspot {}\n", env!("CARGO_PKG_VERSION")));
}

/// The examples of the help run as printed, in the folder that contains cells/.
#[test]
fn the_examples_of_the_help_run() {
    let shop = Sandbox::new();
    for command in [
        "check", "map", "search", "compare", "report", "budget", "explain", "readings", "robots", "robot",
        "envelope", "errors", "correct", "allocate",
    ] {
        let help = shop.done(&[command, "--help"]);
        let example = help.out.lines().next().unwrap().trim_start_matches("Example: sweetspot ");
        let mut args: Vec<&str> = example.split(' ').collect();
        if command == "search" {
            args.extend(["--budget", "500"]);
        }
        if command == "compare" {
            shop.done(&["search", CELL, "--budget", "500"]);
        }
        shop.done(&args);
    }
}

// --- the JSON contract --------------------------------------------------------------------------

const STATUSES: [&str; 4] = ["ok", "out-of-reach", "joint-limit", "collision"];

/// Checks the presence and the form of every field of a node. `null` is allowed only without a posture.
fn check_node(node: &Value) {
    assert_eq!(numbers(field(node, "position_mm")).len(), 3);
    let status = text(field(node, "status"));
    assert!(STATUSES.contains(&status), "{status}");
    let reason = text(field(node, "reason"));
    assert_eq!(reason.is_empty(), status == "ok", "{node}");
    for (key, len) in [("joints_deg", 4), ("error_mm", 3), ("rotation_deg", 3), ("linear_error_mm", 3)] {
        let value = field(node, key);
        let told = !value.is_null();
        assert!(told || status == "out-of-reach" || status == "joint-limit", "{key}: {node}");
        assert!(!told || numbers(value).len() == len, "{key}: {node}");
    }
    assert_eq!(field(node, "error_sense_mm").is_null(), node["error_mm"].is_null());
}

#[test]
fn map_json_has_every_documented_field() {
    let shop = Sandbox::new();
    for cell in [PAPER, CELL] {
        let map = shop.json(&["map", cell]);
        assert_eq!(map["schema"], "sweetspot/map/1");
        for operation in items(field(&map, "operations")) {
            for key in ["name", "equipment", "sense", "model", "errors"] {
                assert!(!text(field(operation, key)).is_empty(), "{key}");
            }
            let nodes = items(field(operation, "nodes"));
            nodes.iter().for_each(check_node);
            let best = field(operation, "best");
            let usable = |n: &&Value| n["status"] == "ok";
            let least = |a: &&Value, b: &&Value| {
                number(&a["error_sense_mm"]).total_cmp(&number(&b["error_sense_mm"]))
            };
            assert_eq!(Some(best), nodes.iter().filter(usable).min_by(least));
        }
    }
    shop.write("cells/far.toml", BEYOND_REACH);
    let far = shop.json(&["map", "cells/far.toml"]);
    assert_eq!(field(&far["operations"][0], "best"), &Value::Null);
}

#[test]
fn map_json_of_the_paper_cell_has_the_numbers_of_the_paper() {
    let map = Sandbox::new().json(&["map", PAPER]);
    let operation = &map["operations"][0];
    assert_eq!(items(&map["operations"]).len(), 1);
    let named = ["name", "equipment", "sense", "model", "errors"].map(|key| text(&operation[key]));
    assert_eq!(named, ["mapping", "worktable", "xyz", "nonlinear", "table-3"]);
    let nodes = items(&operation["nodes"]);
    assert_eq!(nodes.len(), 99);
    assert_eq!(nodes.iter().filter(|n| n["status"] == "ok").count(), 80);
    for (k, node) in nodes.iter().enumerate() {
        // The nodes run along x and then along y, from the lower corner of a table of 1500 x 700 mm centred
        // at (0, 1250).
        let (i, j) = (k % 11, k / 11);
        assert_eq!((number(&node["i"]), number(&node["j"])), (i as f64, j as f64));
        let corner = [-750.0 + 150.0 * i as f64, 900.0 + 87.5 * j as f64, 1350.0];
        assert!(near(&numbers(&node["position_mm"]), &corner, 1e-9), "{node}");
        let reason = text(&node["reason"]);
        let names_why = match text(&node["status"]) {
            "ok" => true,
            "joint-limit" => reason.starts_with("joint q") && reason.contains("limit is"),
            _ => reason.starts_with("out of reach by ") && reason.ends_with(" mm"),
        };
        assert!(names_why, "{node}");
    }
    let middle = nodes.iter().find(|n| n["i"] == 5 && n["j"] == 4).unwrap();
    assert!(near(&numbers(&middle["joints_deg"]), &[0.0; 4], 1e-9), "{middle}");
    assert!(near(&numbers(&middle["error_mm"]), &[1.689215, 2.993310, 1.999417], 1e-6), "{middle}");
    assert!(near(&numbers(&middle["linear_error_mm"]), &[1.691003, 3.0, 2.0], 1e-6), "{middle}");
}

#[test]
fn a_collision_reason_names_both_solids() {
    let map = Sandbox::new().json(&["map", CELL]);
    let nodes = items(&map["operations"][0]["nodes"]);
    let hits: Vec<_> = nodes.iter().filter(|n| n["status"] == "collision").collect();
    assert!(!hits.is_empty());
    for hit in hits {
        let reason = text(&hit["reason"]);
        assert!(["tool", "forearm", "upper arm"].iter().any(|s| reason.starts_with(s)), "{reason}");
        assert!(reason.contains(" touches "), "{reason}");
    }
}

#[test]
fn search_json_has_every_documented_field() {
    let shop = Sandbox::new();
    let found = shop.json(&["search", CELL, "--budget", "2000", "--out", "found"]);
    assert_eq!((&found["schema"], &found["status"]), (&"sweetspot/search/1".into(), &"found".into()));
    assert!(number(field(&found, "seconds")) >= 0.0);
    assert!((1.0..=2000.0).contains(&number(field(&found, "evaluations"))));
    let layout = field(&found, "layout").as_object().unwrap();
    // A layout does not contain obstacles.
    assert_eq!(layout.keys().collect::<Vec<_>>(), ["worktable", "conveyor"]);
    for place in layout.values() {
        ["x_mm", "y_mm", "z_mm", "yaw_deg"].iter().for_each(|key| assert!(field(place, key).is_f64()));
    }
    let operations = items(field(&found, "operations"));
    assert_eq!(operations.iter().map(|o| text(&o["name"])).collect::<Vec<_>>(), ["assembly", "picking"]);
    let mut sum = 0.0;
    for operation in operations {
        assert_eq!(numbers(field(operation, "position_mm")).len(), 3);
        assert_eq!(numbers(field(operation, "joints_deg")).len(), 4);
        let e = numbers(field(operation, "error_mm"));
        let sense = number(field(operation, "error_sense_mm"));
        assert!((e[0].hypot(e[1]) - sense).abs() < 1e-8, "sense xy: {operation}");
        sum += sense;
    }
    assert!((sum - number(field(&found, "objective_mm"))).abs() < 1e-8);
    // The file equals the printed document without the duration, which differs from run to run.
    let mut file = shop.document("found/search.json");
    assert!(file.get("seconds").is_none());
    file["seconds"] = found["seconds"].clone();
    assert_eq!(file, found);
}

#[test]
fn compare_json_shows_the_change() {
    let shop = Sandbox::new();
    shop.json(&["search", CELL, "--budget", "2000", "--out", "found"]);
    let compared = shop.json(&["compare", CELL, "found", "found/best.toml"]);
    let layouts = items(&compared["layouts"]);
    let objective = layouts.iter().map(|l| number(&l["objective_mm"])).collect::<Vec<_>>();
    assert!(objective[1] < objective[0] && objective[1] == objective[2]);
    let change = (objective[1] - objective[0]) / objective[0] * 100.0;
    assert!((number(&layouts[1]["change_percent"]) - change).abs() < 1e-6);
    assert_eq!(layouts[0]["change_percent"], Value::Null);
    assert_eq!((&layouts[0]["name"], &layouts[1]["name"]), (&"hitachi_cell".into(), &"found".into()));
}

// --- the files of a search ----------------------------------------------------------------------

#[test]
fn best_toml_gives_the_objective_of_search_json() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "2000", "--out", "found"]);
    shop.has("found", &["best.toml", "search.json", "map.csv", "map.svg", "manifest.json"]);
    let [map, compare, search] = objectives(&shop, "found");
    assert!((map - search).abs() < 1e-9 && (compare - search).abs() < 1e-9, "{map} {compare} {search}");
    // The folder is complete: it also works without the original cell.
    copy_folder(&shop.path("found"), &shop.path("mailed"));
    std::fs::remove_dir_all(shop.path("cells")).unwrap();
    std::fs::remove_dir_all(shop.path("found")).unwrap();
    assert_eq!(objectives(&shop, "mailed"), [search; 3]);
}

/// A search can start from a best.toml. Its folder then contains the inputs of the earlier search.
#[test]
fn best_toml_made_from_a_best_toml_runs() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "500", "--out", "first"]);
    shop.done(&["search", "first/best.toml", "--out", "second"]);
    let [map, compare, search] = objectives(&shop, "second");
    assert_eq!([map, compare], [search, search]);
    assert_eq!(search, number(&shop.document("first/search.json")["objective_mm"]));
}

/// A fixed coordinate with more digits than the rounding of the search stays unchanged.
#[test]
fn best_toml_keeps_fixed_coordinates_to_the_last_digit() {
    let shop = Sandbox::new();
    let fine = shop
        .text(CELL)
        .replace("x_mm = { min = -1800, max = 1800, start = 300 }", "x_mm = 646.4671234")
        .replace("y_mm = { min = -1800, max = 1800, start = 1000 }", "y_mm = -517.15234567")
        .replace("yaw_deg = { min = -90, max = 90, start = 10 }", "yaw_deg = 64.7559123");
    shop.write("cells/fine.toml", &fine);
    shop.done(&["search", "cells/fine.toml", "--budget", "2000", "--out", "found"]);
    let [map, compare, search] = objectives(&shop, "found");
    assert!((map - search).abs() < 1e-9 && (compare - search).abs() < 1e-9, "{map} {compare} {search}");
    // If the start layout is the best layout, it keeps its digits.
    let drawn = shop.text(CELL).replace("start = 300 }", "start = 300.1234567 }");
    shop.write("cells/drawn.toml", &drawn);
    shop.done(&["search", "cells/drawn.toml", "--budget", "1", "--out", "drawn"]);
    let [map, compare, search] = objectives(&shop, "drawn");
    assert!((map - search).abs() < 1e-9 && (compare - search).abs() < 1e-9, "{map} {compare} {search}");
}

#[cfg(unix)]
#[test]
fn best_toml_runs_whatever_the_cell_file_is_called() {
    let shop = Sandbox::new();
    let names =
        ["two words", "=1+1", "quo\"te", "it's", "a:b", "back\\slash", "new\nline", "caf\u{e9}", "{}#"];
    for (k, name) in names.iter().enumerate() {
        let cell = format!("cells/{name}.toml");
        std::fs::copy(shop.path(PAPER), shop.path(&cell)).unwrap();
        let folder = format!("found-{k}");
        shop.done(&["search", &cell, "--out", &folder]);
        let ran = shop.run(&["map", &format!("{folder}/best.toml")]);
        assert_eq!(ran.code, Some(0), "{name:?}: {}", ran.err);
        // The default folder is created and named after the cell.
        shop.done(&["search", &cell]);
    }
    assert_eq!(std::fs::read_dir(shop.path("results")).unwrap().count(), names.len());
}

/// A path that is not UTF-8 must not make a search panic at its end.
#[cfg(target_os = "linux")]
#[test]
fn paths_may_be_other_than_utf8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let shop = Sandbox::new();
    let odd = OsStr::from_bytes(b"caf\xe9");
    copy_folder(&shop.path("cells"), &shop.dir.path().join(odd));
    let cell = Path::new(odd).join("hitachi_paper.toml");
    let run = |args: &[&str]| ran(shop.command(args).arg(&cell).output().unwrap());
    let plain = ["check", "map", "search", "compare", "budget", "explain", "readings"].map(|c| [c]);
    let plain = plain.iter().map(|args| &args[..]);
    for args in plain.chain([&["map", "--out", "mapped"][..], &["readings", "--out", "read"]]) {
        let ran = run(args);
        ran.no_panic();
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
    }
}

#[test]
fn default_result_folders_are_numbered() {
    let shop = Sandbox::new();
    for _ in 0..2 {
        shop.done(&["search", PAPER]);
    }
    shop.done(&["search", CELL, "--budget", "500"]);
    std::fs::create_dir(shop.path("results/hitachi_paper-003")).unwrap();
    shop.done(&["search", PAPER]);
    let mut folders: Vec<_> =
        std::fs::read_dir(shop.path("results")).unwrap().map(|e| e.unwrap().file_name()).collect();
    folders.sort();
    let numbers = ["hitachi_cell-001"];
    let papers = ["hitachi_paper-001", "hitachi_paper-002", "hitachi_paper-003", "hitachi_paper-004"];
    assert_eq!(folders, [&numbers[..], &papers].concat());
    assert!(shop.files("results/hitachi_paper-003").is_empty(), "a taken folder was used");
    assert!(shop.path("results/hitachi_paper-004/search.json").exists());
}

#[test]
fn a_folder_with_something_in_it_is_refused() {
    let shop = Sandbox::new();
    std::fs::create_dir_all(shop.path("taken/deep")).unwrap();
    shop.write("taken/best.toml", "mine");
    for args in [
        &["search", CELL, "--budget", "500", "--out", "taken"][..],
        &["map", PAPER, "--out", "taken"],
        &["readings", PAPER, "--out", "taken"],
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}");
        assert!(ran.err.contains("not empty") && ran.err.contains("--out"), "{}", ran.err);
    }
    assert_eq!(
        (shop.files("taken"), shop.text("taken/best.toml")),
        (vec!["best.toml".into()], "mine".into())
    );
    // The note about --gap follows the proof of a bound, which begins only after the refusal.
    let goals = ["search", CELL, "--pareto", "error,clearance", "--gap", "1", "--budget", "500", "--out"];
    let ran = shop.run(&[&goals[..], &["taken"]].concat());
    assert_eq!((ran.code, ran.err.contains("--gap")), (Some(2), false), "{}", ran.err);
    let ran = shop.run(&[&goals[..], &["other"]].concat());
    assert_eq!((ran.code, ran.err.contains("note: --gap is ignored")), (Some(0), true), "{}", ran.err);
    std::fs::create_dir(shop.path("empty")).unwrap();
    shop.done(&["search", PAPER, "--out", "empty"]);
    shop.done(&["map", PAPER, "--out", "new/and/deep"]);
    shop.has("new/and/deep", &["manifest.json", "map.csv", "map.json", "map.svg"]);
}

#[test]
fn the_manifest_records_inputs_version_and_seed() {
    let shop = Sandbox::new();
    let args = ["search", CELL, "--budget", "500", "--seed", "7", "--out", "found"];
    shop.done(&args);
    let manifest = shop.document("found/manifest.json");
    assert_eq!(manifest["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(manifest["seed"], 7);
    assert_eq!(items(&manifest["command"]).iter().map(text).collect::<Vec<_>>(), args);
    let inputs = items(&manifest["inputs"]);
    let paths: Vec<_> = inputs.iter().map(|i| text(&i["path"])).collect();
    assert_eq!(paths[0], "hitachi_cell.toml");
    for part in ["robots/hitachi_pw10.toml", "equipment/worktable.toml", "equipment/machine.obj"] {
        assert!(paths.contains(&part), "{part}");
    }
    for input in inputs {
        let bytes = shop.read(&format!("cells/{}", text(&input["path"])));
        assert_eq!(text(&input["sha256"]), sha256(&bytes), "{input}");
        assert_eq!(bytes, shop.read(&format!("found/inputs/{}", text(&input["path"]))));
    }
    let outputs = items(&manifest["outputs"]);
    let told: Vec<_> = outputs.iter().map(|o| text(&o["path"])).collect();
    // The manifest lists every file except itself and the inputs.
    let mut files = shop.files("found");
    files.retain(|f| f != "manifest.json" && !f.starts_with("inputs/"));
    assert!(files.iter().all(|f| told.contains(&f.as_str())) && files.len() == told.len(), "{told:?}");
    for output in outputs {
        let bytes = shop.read(&format!("found/{}", text(&output["path"])));
        assert_eq!(text(&output["sha256"]), sha256(&bytes), "{output}");
    }
    // The command of the manifest gives the same files in another folder.
    let other = Sandbox::new();
    let command: Vec<_> = items(&manifest["command"]).iter().map(text).collect();
    other.done(&command);
    assert_eq!(other.document("found/manifest.json")["outputs"], manifest["outputs"]);
}

#[test]
fn one_seed_gives_the_same_bytes_for_any_number_of_threads() {
    let shop = Sandbox::new();
    let search = |folder: &str, more: &[&str]| {
        shop.done(&[&["search", CELL, "--budget", "2000", "--out", folder], more].concat());
    };
    search("one", &["--threads", "1"]);
    search("two", &["--threads", "2"]);
    search("again", &[]);
    search("other", &["--seed", "2"]);
    for name in ["best.toml", "search.json", "map.csv", "map.svg"] {
        let one = shop.read(&format!("one/{name}"));
        assert_eq!(one, shop.read(&format!("two/{name}")), "{name}, 1 and 2 threads");
        assert_eq!(one, shop.read(&format!("again/{name}")), "{name}, again");
    }
    assert_ne!(shop.read("one/search.json"), shop.read("other/search.json"));
    assert_ne!(shop.document("one/search.json")["layout"], shop.document("other/search.json")["layout"]);
}

#[test]
fn map_csv_has_the_nodes_of_map_json() {
    let shop = Sandbox::new();
    let map = shop.json(&["map", CELL, "--out", "mapped"]);
    assert_eq!(shop.document("mapped/map.json"), map);
    let bytes = shop.read("mapped/map.csv");
    let mut reader = csv::Reader::from_reader(&*bytes).into_deserialize();
    for operation in items(&map["operations"]) {
        for node in items(&operation["nodes"]) {
            let row: std::collections::HashMap<String, String> = reader.next().unwrap().unwrap();
            assert_eq!(row["operation"], text(&operation["name"]));
            assert_eq!(
                (row["i"].parse().ok(), row["j"].parse().ok()),
                (node["i"].as_u64(), node["j"].as_u64())
            );
            assert_eq!(
                (&row["status"], &row["reason"]),
                (&text(&node["status"]).into(), &text(&node["reason"]).into())
            );
            let q4 = node["joints_deg"].get(3).map(number);
            assert_eq!(row["q4_deg"].parse::<f64>().ok(), q4);
            assert_eq!(row["error_y_mm"].parse::<f64>().ok(), node["error_mm"].get(1).map(number));
            assert_eq!(row["error_sense_mm"].parse::<f64>().ok(), node["error_sense_mm"].as_f64());
            assert_eq!(row["best"] == "1", *node == operation["best"]);
        }
    }
    assert!(reader.next().is_none(), "more rows than nodes");
}

// --- hostile input ------------------------------------------------------------------------------

const HOSTILE: [&str; 9] = [
    "=1+1",
    "@x",
    "+cmd",
    "-2",
    "<b onload=\"x\">&amp;</b>",
    "a.b.c",
    "quo\"te's, and, commas",
    "back\\slash\\n",
    "]]> [table] # {}",
];

fn toml_text(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Returns a cell whose equipment, solids and operations have hostile names. They overlap if collision is on.
fn hostile_cell(collision: bool) -> String {
    let mut cell = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nname = {}\n\
         errors = \"table-2\"\ncollision = {collision}\nrobot = {{ from = \"robots/hitachi_pw10.toml\" }}\n",
        toml_text("<i>=cell</i>")
    );
    for name in HOSTILE.map(toml_text) {
        cell += &format!(
            "[equipment.{name}]\nsurface = {{ size_mm = [300, 300] }}\n\
             solid = [{{ name = {name}, box = {{ centre_mm = [0, 0, -10], size_mm = [300, 300, 20] }} }}]\n\
             placement = {{ x_mm = {{ min = -100, max = 100 }}, y_mm = 1000, z_mm = 700 }}\n\
             [operation.{name}]\non = {name}\ngrid = [1, 1]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n"
        );
    }
    cell
}

/// Returns whether a spreadsheet would interpret the text as a formula. A plain number is not a formula.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err()
}

#[test]
fn hostile_names_are_printed_as_text() {
    let shop = Sandbox::new();
    shop.write("cells/free.toml", &hostile_cell(false));
    shop.write("cells/crowded.toml", &hostile_cell(true));
    let found = shop.json(&["search", "cells/free.toml", "--budget", "500", "--out", "free"]);
    assert_eq!(found["layout"].as_object().unwrap().keys().collect::<Vec<_>>(), HOSTILE);
    // best.toml still loads with the same value.
    let [map, compare, search] = objectives(&shop, "free");
    assert_eq!([map, compare], [search, search]);
    let crowded = shop.json(&["map", "cells/crowded.toml", "--out", "crowded"]);
    let reason = text(&crowded["operations"][0]["nodes"][0]["reason"]);
    assert!(reason.starts_with("=1+1 overlaps "), "{reason}");
    for folder in ["free", "crowded"] {
        let bytes = shop.read(&format!("{folder}/map.csv"));
        let rows: Vec<_> = csv::Reader::from_reader(&*bytes).into_records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 4 * HOSTILE.len());
        for (row, name) in rows.iter().zip(HOSTILE.iter().flat_map(|n| [n; 4])) {
            for (k, cell) in row.iter().enumerate() {
                // `-2` is a number, but as a name it is text. Only number columns may contain numbers.
                let runs = if k < 2 { cell.starts_with(['=', '+', '-', '@']) } else { is_formula(cell) };
                assert!(!runs, "{cell}");
            }
            assert_eq!(row[0].trim_start_matches('\''), *name);
        }
        let svg = shop.text(&format!("{folder}/map.svg"));
        let said = texts_of_xml(&svg);
        for name in HOSTILE.iter().chain(&["<i>=cell</i>: "]) {
            assert!(said.iter().any(|t| t.starts_with(name)), "{name} is not in the picture");
        }
    }
    // The terminal output and the other commands are also checked.
    shop.done(&["check", "cells/free.toml"]);
    shop.done(&["budget", "cells/free.toml"]);
    let name = format!("--operation={}", HOSTILE[6]);
    let explained = shop.done(&["explain", "cells/free.toml", &name]);
    assert!(explained.err.contains("--operation 'quo\"te'\\''s, and, commas'"), "{}", explained.err);
    shop.done(&["readings", "cells/free.toml", "--out", "read"]);
    assert!(shop.text("read/readings.csv").lines().all(|l| !l.starts_with(['=', '+', '-', '@'])));
    shop.done(&["compare", "cells/free.toml", "free"]);
}

/// Returns the texts between the tags of a document, with entities resolved. Panics if the document is not
/// well formed.
fn texts_of_xml(document: &str) -> Vec<String> {
    let mut open: Vec<String> = Vec::new();
    let mut texts = Vec::new();
    let mut rest = document.trim_end();
    while let Some(start) = rest.find('<') {
        texts.push(resolved(&rest[..start]));
        let end = end_of_tag(&rest[start..]) + start;
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "closed in the wrong order");
            assert!(!open.is_empty() || rest.is_empty(), "more than one root");
        } else {
            let whole = tag.strip_suffix('/');
            let name = check_tag(whole.unwrap_or(tag));
            if whole.is_none() {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty() && rest.is_empty(), "never closed: {open:?} {rest}");
    texts
}

/// Returns the end of a tag: the first `>` outside quotes.
fn end_of_tag(tag: &str) -> usize {
    let mut quote = None;
    for (k, c) in tag.char_indices() {
        match (c, quote) {
            ('>', None) => return k,
            ('<', None) if k > 0 => panic!("`<` in a tag: {tag:.60}"),
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(q)) if c == q => quote = None,
            _ => {}
        }
    }
    panic!("a tag without end: {tag:.60}")
}

/// Checks that attributes have the form `key="value"` and that none occurs twice. Returns the name of the
/// tag.
fn check_tag(tag: &str) -> String {
    let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
    let mut keys = Vec::new();
    while !rest.trim().is_empty() {
        let (key, value) = rest.split_once("=\"").unwrap_or_else(|| panic!("no attribute: {rest}"));
        let (value, after) = value.split_once('"').unwrap();
        let key = key.trim();
        assert!(key.chars().all(|c| c.is_ascii_alphanumeric() || "-:".contains(c)), "{key}");
        assert!(!keys.contains(&key), "{key} twice");
        keys.push(key);
        assert!(!value.contains('<'), "{value}");
        resolved(value);
        assert!(after.is_empty() || after.starts_with(' '), "{after}");
        rest = after;
    }
    assert!(!name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric()), "{name}");
    name.to_string()
}

/// Returns a text with its entities resolved. Panics at a `&` that starts no entity.
fn resolved(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find('&') {
        out += &rest[..start];
        let (entity, after) = rest[start + 1..].split_once(';').unwrap_or_else(|| panic!("a bare &: {text}"));
        out += match entity {
            "lt" => "<",
            "gt" => ">",
            "amp" => "&",
            "quot" | "#34" => "\"",
            "apos" | "#39" => "'",
            other => panic!("&{other};"),
        };
        rest = after;
    }
    out + rest
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_out_of_the_cell_folder_is_refused() {
    use std::os::unix::fs::symlink;
    let shop = Sandbox::new();
    let outside = Sandbox::new();
    let cell = |name: &str, part: &str| {
        let text = format!("from = \"hitachi_paper.toml\"\n[equipment.worktable]\nfrom = \"{part}\"\n");
        shop.write(&format!("cells/{name}.toml"), &text);
    };
    symlink(outside.path("cells/equipment/worktable.toml"), shop.path("cells/equipment/out.toml")).unwrap();
    symlink(outside.path("cells"), shop.path("cells/out")).unwrap();
    symlink("worktable.toml", shop.path("cells/equipment/in.toml")).unwrap();
    cell("file", "equipment/out.toml");
    cell("folder", "out/equipment/worktable.toml");
    cell("dots", "../cells/equipment/worktable.toml");
    cell("absolute", &outside.path("cells/equipment/worktable.toml").to_string_lossy());
    cell("inside", "equipment/in.toml");
    for name in ["file", "folder"] {
        let ran = shop.run(&["map", &format!("cells/{name}.toml")]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{name}: {}", ran.err);
        assert!(ran.err.contains("is outside the folder"), "{name}: {}", ran.err);
    }
    for name in ["dots", "absolute"] {
        assert_eq!(shop.run(&["map", &format!("cells/{name}.toml")]).code, Some(2), "{name}");
    }
    shop.done(&["map", "cells/inside.toml"]);
    // A folder of cells behind a symbolic link is accepted.
    symlink(outside.path("cells"), shop.path("linked")).unwrap();
    shop.done(&["map", "linked/hitachi_paper.toml"]);
}

#[test]
fn binary_files_are_refused() {
    let shop = Sandbox::new();
    std::fs::write(shop.path("cells/bytes.toml"), b"name = \"\xff\xfe\"").unwrap();
    std::fs::create_dir(shop.path("cells/folder.toml")).unwrap();
    for (cell, code, why) in
        [("cells/bytes.toml", 2, "it is not UTF-8 text"), ("cells/folder.toml", 3, "cannot read")]
    {
        let ran = shop.run(&["map", cell]);
        ran.no_panic();
        assert_eq!(ran.code, Some(code), "{cell}: {}", ran.err);
        assert!(ran.err.contains(why), "{}", ran.err);
    }
}

// --- compare ------------------------------------------------------------------------------------

#[test]
fn compare_refuses_layouts_of_another_question() {
    let shop = Sandbox::new();
    let variant = |name: &str, from: &str, to: &str| {
        let cell = shop.text(CELL);
        assert!(cell.contains(from), "{from}");
        shop.write(&format!("cells/{name}.toml"), &cell.replacen(from, to, 1));
    };
    variant("sense", "sense = \"xy\"", "sense = \"z\"");
    variant("grid", "grid = [10, 8]", "grid = [10, 9]");
    variant("weight", "grid = [10, 8]", "grid = [10, 8]\nweight = 2");
    variant("objective", "objective = \"sum\"", "objective = \"max\"");
    variant("operation", "[operation.picking]", "[operation.packing]");
    let why = [
        ("sense", "sense xy", "sense z"),
        ("grid", "grid 10 by 8", "grid 10 by 9"),
        ("weight", "weight 1", "weight 2"),
        ("objective", "first is sum", "second is max"),
        ("operation", "picking", "packing"),
    ];
    for (name, one, other) in why {
        let cell = format!("cells/{name}.toml");
        for json in [&[][..], &["--json"]] {
            let ran = shop.run(&[&["compare", CELL, &cell], json].concat());
            assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{name}");
            assert!(ran.err.contains("cannot be compared"), "{}", ran.err);
            assert!(ran.err.contains(one) && ran.err.contains(other), "{}", ran.err);
        }
        // A cell with another interpretation is also refused as the third of three cells.
        assert_eq!(shop.run(&["compare", CELL, CELL, &cell]).code, Some(2), "{name}");
    }
    // With a common sense, the cells can be compared again.
    shop.done(&["compare", CELL, "cells/sense.toml", "--sense", "xyz"]);
}
