//! Tests options that override keys of the cell file.

use crate::cli::sandbox::*;
use serde_json::Value;

#[test]
fn overrides_of_the_map_take_effect() {
    let shop = Sandbox::new();
    let ok = |map: &Value| -> Vec<Value> {
        let nodes = items(&map["operations"][0]["nodes"]);
        nodes.iter().filter(|n| n["status"] == "ok").cloned().collect()
    };
    let drawn = shop.json(&["map", PAPER]);
    let other = shop.json(&["map", PAPER, "--errors", "table-2"]);
    assert_eq!(other["operations"][0]["errors"], "table-2");
    assert_ne!(ok(&other)[0]["error_mm"], ok(&drawn)[0]["error_mm"]);
    let linear = shop.json(&["map", PAPER, "--model", "linear"]);
    assert_eq!(linear["operations"][0]["model"], "linear");
    for (node, same) in ok(&linear).iter().zip(ok(&drawn)) {
        assert_eq!(node["error_mm"], node["linear_error_mm"]);
        assert_eq!(node["linear_error_mm"], same["linear_error_mm"]);
    }
    type Size = fn(&[f64]) -> f64;
    let of: [(&str, Size); 5] = [
        ("x", |e| e[0].abs()),
        ("y", |e| e[1].abs()),
        ("z", |e| e[2].abs()),
        ("xy", |e| e[0].hypot(e[1])),
        ("xyz", |e| e[0].hypot(e[1]).hypot(e[2])),
    ];
    for (sense, size) in of {
        let map = shop.json(&["map", PAPER, "--sense", sense]);
        assert_eq!(map["operations"][0]["sense"], sense);
        for node in ok(&map) {
            let e = numbers(&node["error_mm"]);
            assert!((size(&e) - number(&node["error_sense_mm"])).abs() < 1e-8, "{sense}: {node}");
        }
    }
}

#[test]
fn overrides_of_the_search_take_effect_and_survive() {
    let shop = Sandbox::new();
    let args = ["--sense", "z", "--errors", "table-3", "--model", "linear", "--seed", "9", "--budget", "700"];
    shop.done(&[&["search", CELL, "--out", "found"], &args[..]].concat());
    let found = shop.document("found/search.json");
    let said = [("errors", "table-3"), ("model", "linear"), ("solver", "cma-es")];
    said.iter().for_each(|(key, want)| assert_eq!(text(&found[key]), *want));
    assert_eq!((&found["seed"], &found["budget"]), (&9.into(), &700.into()));
    assert!(number(&found["evaluations"]) <= 700.0);
    let map = shop.json(&["map", "found/best.toml"]);
    for operation in items(&map["operations"]) {
        let kept = ["sense", "errors", "model"].map(|key| text(&operation[key]));
        assert_eq!(kept, ["z", "table-3", "linear"]);
    }
    let [map, compare, search] = objectives(&shop, "found");
    assert_eq!([map, compare], [search, search]);
}

#[test]
fn every_solver_finds_a_layout() {
    let shop = Sandbox::new();
    for solver in ["cma-es", "particle-swarm", "simulated-annealing"] {
        let found = shop.json(&["search", CELL, "--solver", solver, "--budget", "3000", "--out", solver]);
        assert_eq!((&found["solver"], &found["status"]), (&solver.into(), &"found".into()));
        assert!(number(&found["objective_mm"]) < number(&found["start"]["objective_mm"]), "{solver}");
    }
    let layouts: Vec<_> = ["cma-es", "particle-swarm", "simulated-annealing"]
        .map(|solver| shop.document(&format!("{solver}/search.json"))["layout"].to_string())
        .into();
    assert!(layouts[0] != layouts[1] && layouts[1] != layouts[2], "--solver changes nothing");
}

// --- readings, limits and senses ----------------------------------------------------------------

/// Cell with the same numbers as tolerances, and with a sense and a robot for the tests below.
const TOLERANCE: &str = "from = \"hitachi_paper.toml\"\nerrors = \"table-3-tolerance\"\n\
                         reading = \"statistical\"\n[sense.shear]\nframe = \"surface\"\n\
                         direction = [1, 1, 0]\n";

#[test]
fn statistical_figures_of_a_map_are_ordered() {
    let shop = Sandbox::new();
    for (cell, flags) in [
        (CELL, &[][..]),
        (PAPER, &["--reading", "statistical"]),
        (CELL, &["--reading", "worst-case", "--registration", "best-fit", "--model", "second-order"]),
    ] {
        let map = shop.json(&[&["map", cell], flags].concat());
        for operation in items(&map["operations"]) {
            for node in items(&operation["nodes"]).iter().filter(|n| n["status"] == "ok") {
                let of = |key: &str, sense: &str| number(&node[key][sense]);
                for sense in ["x", "y", "z", "xy", "xyz"] {
                    assert!(of("p99_mm", sense) >= of("p95_mm", sense), "{sense}: {node}");
                    assert!(of("p95_mm", sense) >= of("rms_mm", sense), "{sense}: {node}");
                    assert!(of("rms_mm", sense) >= of("mean_mm", sense), "{sense}: {node}");
                }
                if operation["reading"] == "signed" {
                    // The signed sample is one corner of the tolerance box.
                    let e = numbers(&node["error_mm"]);
                    let size = e[0].hypot(e[1]).hypot(e[2]);
                    assert!(of("worst_mm", "xyz") >= size - 1e-8, "{node}");
                }
            }
        }
    }
}

#[test]
fn a_quantity_option_selects_the_statistical_reading() {
    let shop = Sandbox::new();
    let map = shop.json(&["map", PAPER, "--quantity", "rms"]);
    let operation = &map["operations"][0];
    assert_eq!((text(&operation["reading"]), text(&operation["quantity"])), ("statistical", "rms"));
    assert_eq!(operation["best"]["value"], operation["best"]["rms_mm"]["xyz"]);
    let worst = shop.done(&["map", PAPER, "--quantity", "rms", "--reading", "worst-case", "--json"]);
    assert!(worst.err.contains("--quantity is ignored"), "{}", worst.err);
    assert_eq!(worst.document()["operations"][0]["reading"], "worst-case");
}

#[test]
fn a_tolerance_set_is_read_as_worst_case_unless_requested() {
    let shop = Sandbox::new();
    for command in ["map", "budget", "explain", "compare"] {
        let ran = shop.done(&[command, PAPER, "--errors", "table-3-tolerance"]);
        assert!(
            ran.err.contains("note: table-3-tolerance is a tolerance, so the reading is worst-case"),
            "{}",
            ran.err
        );
        assert!(!ran.out.contains("note:"), "{}", ran.out);
    }
    let map = shop.json(&["map", PAPER, "--errors", "table-3-tolerance"]);
    assert_eq!(map["operations"][0]["reading"], "worst-case");
    // The magnitudes of table-3, used as tolerances, give the same worst case.
    let signed = shop.json(&["map", PAPER, "--reading", "worst-case"]);
    assert_eq!(map["objective_mm"], signed["objective_mm"]);
    let other = shop.done(&["map", PAPER, "--errors", "table-3-tolerance", "--reading", "statistical"]);
    assert!(!other.err.contains("so the reading is worst-case"), "{}", other.err);
    for command in ["map", "search", "compare", "budget", "explain"] {
        let args = [command, PAPER, "--errors", "table-3-tolerance", "--reading", "signed"];
        let ran = shop.run(&args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}");
        assert!(ran.err.contains("is a set of tolerances, not a signed sample"), "{}", ran.err);
        assert!(ran.err.contains("help: choose the reading worst-case or statistical"), "{}", ran.err);
    }
}

#[test]
fn the_yield_quantity_needs_a_limit() {
    let shop = Sandbox::new();
    for command in ["map", "search", "compare", "budget", "explain"] {
        let ran = shop.run(&[command, CELL, "--quantity", "yield"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}");
        assert!(ran.err.contains("needs a limit, but `assembly` has none"), "{}", ran.err);
        assert!(ran.err.contains("help: add limit_mm"), "{}", ran.err);
    }
    assert!(!shop.path("results").exists());
    let map = shop.json(&["map", CELL, "--quantity", "yield", "--limit", "5"]);
    assert_eq!((text(&map["unit"]), &map["objective_mm"]), ("share", &Value::Null));
    for operation in items(&map["operations"]) {
        assert_eq!(number(&operation["limit"]), 5.0);
        let best = &operation["best"];
        assert!((1.0 - number(&best["yield"]) - number(&best["value"])).abs() < 1e-8, "{best}");
        assert!((0.0..1.0).contains(&number(&best["value"])));
    }
    // The limit of a rotation is in degrees.
    let turn = shop.json(&["map", CELL, "--quantity", "yield", "--sense", "rotation", "--limit", "1"]);
    assert_eq!(number(&turn["operations"][0]["limit"]), 1.0);
    assert!((0.0..1.0).contains(&number(&turn["operations"][0]["best"]["yield"])));
}

#[test]
fn bad_limits_and_senses_exit_2() {
    let shop = Sandbox::new();
    for limit in ["-1", "0", "nan", "inf", "-inf", "five", "", "1e-320", "1e8"] {
        for command in ["map", "search", "compare", "budget", "explain", "readings"] {
            let ran = shop.run(&[command, CELL, "--limit", limit]);
            assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command} {limit}: {}", ran.err);
            assert!(ran.err.contains("--limit"), "{command} {limit}: {}", ran.err);
        }
    }
    for command in ["map", "search", "compare", "budget", "explain", "readings"] {
        let ran = shop.run(&[command, CELL, "--sense", "xzy"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}");
        assert!(ran.err.contains("--sense xzy: error: `sense` cannot be \"xzy\""), "{}", ran.err);
        assert!(ran.err.contains("did you mean \"xyz\"?"), "{}", ran.err);
    }
}

#[test]
fn best_toml_carries_how_the_errors_are_read() {
    let shop = Sandbox::new();
    shop.write("cells/tolerance.toml", TOLERANCE);
    // Samples are drawn at every node, so a coarse grid saves much time.
    let coarse = "cells/coarse.toml";
    shop.write(coarse, "from = \"hitachi_paper.toml\"\n[operation.mapping]\ngrid = [4, 3]\n");
    let keys = ["reading", "quantity", "registration", "sense", "limit", "errors", "model"];
    let asked = |document: &Value| keys.map(|key| document["operations"][0][key].clone());
    for (k, (cell, flags)) in [
        (coarse, &["--quantity", "yield", "--limit", "4.25", "--registration", "best-fit"][..]),
        (coarse, &["--sense", "rotation@tool", "--reading", "worst-case"]),
        (coarse, &["--sense", "rx", "--limit", "1.5", "--quantity", "p99"]),
        ("cells/tolerance.toml", &["--sense", "shear", "--quantity", "mean"]),
        (coarse, &["--errors", "table-3-tolerance", "--registration", "taught"]),
    ]
    .iter()
    .enumerate()
    {
        let folder = format!("found-{k}");
        shop.done(&[&["search", cell, "--out", &folder][..], flags].concat());
        let best = shop.json(&["map", &format!("{folder}/best.toml")]);
        let drawn = shop.json(&[&["map", cell][..], flags].concat());
        // The table of the paper's cell is fixed, so the best layout is the start layout.
        assert_eq!(asked(&best), asked(&drawn), "{flags:?}");
        assert_eq!(best["objective"], drawn["objective"], "{flags:?}");
    }
}

/// Monte Carlo samples check statistical figures. Where the samples refute the first-order figures, the
/// figures depend on the seed, so best.toml must state the seed of the search.
#[test]
fn best_toml_states_the_seed_of_a_statistical_search() {
    let shop = Sandbox::new();
    let robot = shop.text("cells/robots/hitachi_pw10.toml");
    let loose = "\n[errors.loose]\nkind = \"tolerance\"\nsource = \"a test\"\ndr_mm = [0, 0, 0, 0]\n\
                 dl_mm = [0, 0, 0, 0]\ndalpha_deg = [60, 60, 60, 60]\n";
    shop.write("cells/robots/hitachi_pw10.toml", &(robot + loose));
    let coarse = "[operation.mapping]\ngrid = [4, 3]\n";
    let cell = "from = \"hitachi_paper.toml\"\nerrors = \"loose\"\nreading = \"statistical\"\n";
    shop.write("cells/loose.toml", &format!("{cell}{coarse}"));
    shop.done(&["search", "cells/loose.toml", "--seed", "7", "--out", "found"]);
    let [own, other] = ["found/best.toml", "cells/loose.toml"].map(|file| shop.json(&["map", file]));
    let of = |map: &Value| map["operations"][0]["monte_carlo"].clone();
    let monte_carlo = of(&own);
    assert_eq!(monte_carlo["first_order_holds"], false);
    assert_ne!(monte_carlo["p95"], of(&other)["p95"], "another seed gives other samples");
    assert_eq!(own["objective"], shop.document("found/search.json")["objective_value"]);
}

/// `from` cannot remove a limit, so best.toml could not record such a search.
#[test]
fn a_search_refuses_options_that_drop_a_limit() {
    let shop = Sandbox::new();
    shop.write("cells/limited.toml", "from = \"hitachi_paper.toml\"\n[operation.mapping]\nlimit_mm = 4\n");
    shop.done(&["map", "cells/limited.toml", "--sense", "rx"]);
    let ran = shop.run(&["search", "cells/limited.toml", "--sense", "rx"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""));
    assert!(ran.err.contains("`mapping`") && ran.err.contains("rx"), "{}", ran.err);
    assert!(!shop.path("results").exists());
    shop.done(&["search", "cells/limited.toml", "--sense", "x"]);
}

#[test]
fn an_untrustworthy_error_model_is_reported_on_both_streams() {
    let shop = Sandbox::new();
    let ran = shop.done(&["map", IDEAL, "--model", "linear"]);
    assert!(ran.out.contains("do NOT trust the linear model at 51 of 51 nodes"), "{}", ran.out);
    assert!(ran.err.contains("warning: assembly: do NOT trust the linear model"), "{}", ran.err);
    let json = shop.done(&["map", CELL, "--model", "linear", "--json"]);
    assert!(json.err.contains("warning: picking: do NOT trust"), "{}", json.err);
    assert_eq!(json.document()["operations"][0]["guard"]["trusted"], false);
    for model in ["nonlinear", "second-order"] {
        assert!(!shop.done(&["map", CELL, "--model", model]).err.contains("warning"));
    }
}

#[test]
fn check_states_which_postures_a_search_judges() {
    let shop = Sandbox::new();
    let judged = |cell: &str| {
        let (text, json) = (shop.done(&["check", cell]), shop.done(&["check", cell, "--json"]));
        (text.out, json.document()["operations"][0].clone())
    };
    let (text, order) = judged("cells/hitachi_cell.toml");
    assert!(text.contains(": a search skips nodes whose lower bound exceeds the best value found"), "{text}");
    assert_eq!((order["judges"].as_str(), order["why"].as_str()), (Some("ranked-nodes"), None));
    let (text, order) = judged("cells/ur_cell.toml");
    assert!(
        text.contains(
            ": a search first excludes nodes by a value field (a table of lower bounds), then skips spin families"
        ),
        "{text}"
    );
    assert_eq!((&order["judges"], &order["why_no_field"]), (&"spin-families".into(), &Value::Null));
    let (text, order) = judged("cells/track_cell.toml");
    let why = "the first joint does not rotate the arm about the z axis of the robot base";
    assert!(
        text.contains(&format!("; it uses no value field (a table of lower bounds), because {why}")),
        "{text}"
    );
    assert_eq!(order["why_no_field"], why);
    let (_, order) = judged("cells/offset_wrist_cell.toml");
    assert_eq!(order["judges"], "spin-families");
    // A seven-axis arm with offsets of 50 mm in shoulder and wrist has no closed form.
    let kinova = shop.text("cells/robots/kinova_gen3.toml");
    let rows: Vec<&str> = kinova.split("l_mm = 0\n").collect();
    let general = format!(
        "{}l_mm = 50\n{}l_mm = 50\n{}",
        rows[..3].join("l_mm = 0\n"),
        rows[3..6].join("l_mm = 0\n"),
        rows[6..].join("l_mm = 0\n")
    );
    shop.write("cells/robots/general.toml", &general);
    shop.write(
        "cells/numeric.toml",
        "from = \"offset_wrist_cell.toml\"\n[robot]\nfrom = \"robots/general.toml\"\n",
    );
    let (text, order) = judged("cells/numeric.toml");
    let why = "the inverse kinematics of the arm is numeric";
    assert!(text.contains(&format!("then judges every posture: {why}")), "{text}");
    assert_eq!((order["judges"].as_str(), order["why"].as_str()), (Some("every-posture"), Some(why)));
}

#[test]
fn check_states_how_the_errors_are_read() {
    let shop = Sandbox::new();
    shop.write("cells/tolerance.toml", TOLERANCE);
    let signed = shop.done(&["check", PAPER]);
    assert!(
        signed.out.contains("3 error sets; chosen: table-3 (a signed sample) with the reading signed"),
        "{}",
        signed.out
    );
    let tolerance = shop.done(&["check", "cells/tolerance.toml"]);
    assert!(
        tolerance.out.contains("chosen: table-3-tolerance (a tolerance) with the reading statistical"),
        "{}",
        tolerance.out
    );
}

#[test]
fn set_changes_any_key_of_the_cell_and_flags_go_through_the_same_validation() {
    let shop = Sandbox::new();
    for command in ["map", "compare", "budget", "explain", "readings", "robust"] {
        let set = "--set=clearance_mm=-1";
        let ran = shop.run(&[command, CELL, set]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}: {}", ran.err);
        assert!(ran.err.contains("--set clearance_mm=-1: error: "), "{}", ran.err);
        let same = shop.run(&[command, CELL, "--limit", "1e-320"]);
        assert!(same.err.contains("--limit 1e-320: error: `limit_mm` must be at least 1e-6"), "{}", same.err);
        let both = shop.run(&[command, CELL, "--set", "errors=table-2", "--errors", "table-3"]);
        assert!(both.err.contains("`errors` is given twice"), "{}", both.err);
        let many = shop.run(&[command, CELL, "--set", "errors=table-2,table-3"]);
        assert!(many.err.contains("sweetspot sweep"), "{}", many.err);
    }
    // The files that these commands write could not state the setting.
    for command in ["search", "view"] {
        let ran = shop.run(&[command, CELL, "--set", "clearance_mm=10"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{command}: {}", ran.err);
        assert!(ran.err.contains("help: ") && ran.err.contains("from = "), "{}", ran.err);
    }
    // A setting, an option and a key of the file have the same effect.
    let set = shop.json(&["map", PAPER, "--set", "errors=table-2", "--set", "operation.mapping.sense=z"]);
    assert_eq!(set, shop.json(&["map", PAPER, "--errors", "table-2", "--sense", "z"]));
    shop.write(
        "cells/same.toml",
        "from = \"hitachi_paper.toml\"\nname = \"hitachi_paper\"\nerrors = \"table-2\"\n[operation.mapping]\nsense = \"z\"\n",
    );
    let file = shop.json(&["map", "cells/same.toml"]);
    assert_eq!(set["operations"], file["operations"]);
}

/// The factory calibration of the UR10e has rows of hundreds of metres, which are not tolerances.
#[test]
fn errors_that_compensate_each_other_are_not_tolerances() {
    let shop = Sandbox::new();
    // The nonlinear worst case at every node would take most of the time.
    let coarse =
        "from = \"ur_cell.toml\"\n[operation.assembly]\ngrid = [2, 2]\n[operation.picking]\ngrid = [2, 1]\n";
    shop.write("cells/coarse.toml", coarse);
    let read = shop.done(&["map", "cells/coarse.toml", "--reading", "worst-case"]);
    assert!(read.err.contains("compensate each other in one calibrated arm"), "{}", read.err);
    let other = shop.done(&["map", "cells/hitachi_cell.toml", "--reading", "worst-case"]);
    assert!(!other.err.contains("compensate"), "{}", other.err);
    for (cell, has_none) in [("ur_cell", true), ("hitachi_cell", false)] {
        shop.done(&["report", &format!("cells/{cell}.toml"), "-o", "report.html"]);
        assert_eq!(
            shop.text("report.html").contains("so neither a worst case nor statistics exist"),
            has_none,
            "{cell}"
        );
        let map = shop.json(&["map", &format!("cells/{cell}.toml")]);
        let nodes = items(&map["operations"][0]["nodes"]);
        let node = nodes.iter().find(|node| node["status"] == "ok").unwrap();
        assert!(node["error_sense_mm"].as_f64().is_some() && node["value"].as_f64().is_some(), "{cell}");
        for figure in ["worst_mm", "rms_mm", "p95_mm", "p99_mm"] {
            assert_eq!(node[figure].is_null(), has_none, "{cell}: {figure}");
        }
    }
    let budget = &shop.json(&["budget", "cells/coarse.toml"])["operations"][0];
    assert!(budget["total"]["error"].as_f64().is_some() && budget["tighten"] == serde_json::json!([]));
    assert!(["worst", "p95"].iter().all(|figure| budget["total"][figure].is_null()), "{budget}");
    assert!(budget["parameters"][0]["share_of_worst"].is_null(), "{budget}");
    let explained = shop.json(&["explain", "cells/coarse.toml"]);
    assert!(explained["worst_corner"].is_null() && explained["total"]["worst"].is_null(), "{explained}");
    let compared = &shop.json(&["readings", "cells/coarse.toml"])["operations"][0];
    for row in items(&compared["readings"]) {
        assert_eq!(row["value"].is_null(), row["reading"] != "signed", "{row}");
        let reason = row["reason"].as_str().unwrap_or_default();
        assert_eq!(reason.contains("cannot be read as tolerances"), row["reading"] != "signed", "{row}");
    }
}
