//! Tests `allocate`: the cheapest tolerances, their document, and the tables to paste into files.

use super::sandbox::{CELL, PAPER, Sandbox};
use serde_json::Value;

/// Command of the reference values: the seed paper's robot with Table 3 as tolerances, the linear model and
/// the sense xy.
const REFERENCE: [&str; 8] =
    ["allocate", PAPER, "--errors", "table-3-tolerance", "--model", "linear", "--sense", "xy"];

fn items<'v>(document: &'v Value, key: &str) -> &'v [Value] {
    document[key].as_array().unwrap()
}

fn near(value: &Value, want: f64, off: f64) -> bool {
    (value.as_f64().unwrap() - want).abs() <= off
}

#[test]
fn the_document_holds_the_reference() {
    let shop = Sandbox::new();
    let document = shop.json(&[&REFERENCE[..], &["--limit", "10", "--at", "5,8"]].concat());
    assert_eq!(
        (&document["schema"], &document["status"]),
        (&"sweetspot/allocation/1".into(), &"cheapest".into())
    );
    assert!(
        near(&document["cost_before"], 12.0, 1e-9) && near(&document["cost"], 11.243127, 1e-6),
        "{document}"
    );
    assert!(near(&document["uniform"]["cost"], 12.0 * 1.403314, 1e-4), "{document}");
    assert!(document["lower_bound"].as_f64() <= document["cost"].as_f64());
    assert!(document["duality_gap"].as_f64().unwrap() < 1e-7);
    let [requirement] = items(&document, "requirements") else { panic!("{document}") };
    assert!(near(&requirement["before"], 14.03314, 1e-5) && near(&requirement["after"], 10.0, 1e-6));
    assert_eq!(
        (&requirement["is_binding"], &requirement["node"]),
        (&true.into(), &serde_json::json!([5, 8]))
    );
    let sum: f64 = items(&document, "parameters").iter().map(|p| p["cost"].as_f64().unwrap()).sum();
    assert!(near(&document["cost"], sum, 1e-6));
    // The shadow price is the slope of the cost.
    let more = shop.json(&[&REFERENCE[..], &["--limit", "10.001", "--at", "5,8"]].concat());
    let slope = (document["cost"].as_f64().unwrap() - more["cost"].as_f64().unwrap()) / 0.001;
    assert!(near(&requirement["shadow_price"], slope, 1e-3 * slope), "{slope}: {requirement}");
    let all = shop.json(&[&REFERENCE[..], &["--limit", "10", "--nodes"]].concat());
    assert!(near(&all["cost"], 11.325751, 1e-6) && items(&all, "requirements").len() == 80);
}

/// The cheapest node is not the node of least error: 10.223 at (5, 4) instead of 11.243 at (5, 8).
#[test]
fn the_cheapest_node_is_found() {
    let shop = Sandbox::new();
    let document = shop.json(&[&REFERENCE[..], &["--limit", "10", "--cheapest"]].concat());
    assert!(near(&document["cost"], 10.223, 5e-4), "{document}");
    assert_eq!(items(&document, "requirements")[0]["node"], serde_json::json!([5, 4]));
}

#[test]
fn the_text_tells_costs_limits_and_what_to_do_next() {
    let shop = Sandbox::new();
    let ran = shop.done(&["allocate", CELL, "--limit", "20"]);
    for part in [
        "the worst case of assembly at most 20 mm at node",
        "cost 11.000000 now",
        "uniform tightening (scale",
        "the cheapest tolerances save",
        "raising this limit by 0.1 mm would save",
        "according to the nonlinear model",
        "may be loosened: ",
        "duality gap at most",
    ] {
        assert!(ran.out.contains(part), "no {part:?}: {}", ran.out);
    }
    assert!(ran.err.contains("note: the errors are interpreted as worst-case tolerances"), "{}", ran.err);
    assert!(
        ran.err.contains("next: sweetspot allocate cells/hitachi_cell.toml --limit 20 --toml"),
        "{}",
        ran.err
    );
}

#[test]
fn an_infeasible_limit_exits_1_and_names_the_bounds() {
    let shop = Sandbox::new();
    let ran = shop.run(&["allocate", CELL, "--limit", "1"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.out.contains("even the tightest tolerances give 1.79"), "{}", ran.out);
    assert!(
        ran.out.contains("in the way: dalpha3 (at least 0.1 deg; without this error 1.16"),
        "{}",
        ran.out
    );
    let document = shop.run(&["allocate", CELL, "--limit", "1", "--json"]).document();
    assert_eq!((&document["status"], &document["cost"]), (&"infeasible".into(), &Value::Null));
    let shortfall = &items(&document, "shortfalls")[0];
    let number = |key: &str| shortfall[key].as_f64().unwrap();
    assert!((number("least") - number("limit") - number("excess")).abs() < 1e-8 && number("excess") > 0.0);
}

#[test]
fn questions_without_an_answer_exit_2() {
    let shop = Sandbox::new();
    for (args, said) in [
        (&["allocate", CELL][..], "no operation has a limit"),
        (&["allocate", CELL, "--limit", "9", "--reading", "signed"], "a signed sample has no tolerances"),
        (&["allocate", CELL, "--limit", "9", "--operation", "welding"], "welding"),
        (&["allocate", CELL, "--limit", "9", "--at", "1,1", "--nodes"], "--nodes"),
        (&["allocate", CELL, "--limit", "9", "--yield", "1"], "below 1"),
        (&["allocate", CELL, "--limit", "-1"], "greater than 0"),
        (
            &["allocate", "cells/ur_cell.toml", "--limit", "9"],
            "in the calibrated arm, these errors compensate each other",
        ),
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{args:?}: {}", ran.err);
    }
    assert_eq!(shop.run(&["allocate", CELL, "--limit", "9", "--at", "0,0"]).code, Some(1));
}

/// With the printed error set, another command confirms that the limit is just kept.
#[test]
fn the_tables_keep_the_limit_when_pasted() {
    let shop = Sandbox::new();
    let robot = shop.text("cells/robots/hitachi_pw10.toml");
    for flags in [&["--reading", "worst-case"][..], &["--quantity", "p95"]] {
        let args = [&["allocate", CELL, "--limit", "12", "--operation", "picking"], flags].concat();
        let pasted = shop.done(&[&args[..], &["--toml"]].concat()).out;
        assert!(pasted.starts_with("[errors.allocated]\nkind = \"tolerance\"\n"), "{pasted}");
        let document = shop.json(&args);
        let node = &items(&document, "requirements")[0]["node"];
        shop.write("cells/robots/ordered.toml", &format!("{robot}\n{pasted}"));
        let cell = shop.text(CELL).replace("robots/hitachi_pw10.toml", "robots/ordered.toml");
        shop.write("cells/ordered.toml", &cell.replace("errors = \"table-2\"", "errors = \"allocated\""));
        let at = format!("{},{}", node[0], node[1]);
        let budget = ["budget", "cells/ordered.toml", "--operation", "picking", "--at", &at];
        let budget = shop.json(&[&budget[..], flags].concat());
        let figure = if flags[1] == "p95" { "p95" } else { "worst" };
        let judged = budget["operations"][0]["total"][figure].as_f64().unwrap();
        assert!((judged - 12.0).abs() < 0.012, "{figure} {judged} of 12");
    }
}

/// A cell with costs in the robot file and in the errors of the equipment.
const COSTLY: &str = r#"
from = "hitachi_cell.toml"
errors = "ours"
reading = "worst-case"

[robot.errors.ours]
kind = "tolerance"
source = "made up"
dr_mm = [1, 1, 1, 1]
dl_mm = [1, 1, 1, 1]
dalpha_deg = [0.05, 0.03, 0.05, 0.05]
cost = [
    { kind = "reciprocal", at = 2, scale_range = [0.2, 2] },
    { parameters = ["dl2", "dl3"], kind = "iso-286", nominal_mm = 850, it_grades = [9, 10, 11, 12, 13, 14], at = 3 },
    { parameters = ["dalpha2"], kind = "grades", grades = [
        { name = "milled", plus_minus_deg = 0.06, cost = 1 },
        { name = "ground", plus_minus_deg = 0.02, cost = 4 },
        { name = "lapped", scale = 0.3, cost = 9 },
    ] },
]

[equipment.worktable.errors]
kind = "tolerance"
position_mm = [1, 1, 0]
rotation_deg = [0, 0, 0.1]
cost = [{ parameters = ["x"], kind = "exponential", at = 0.5, rate = 2 }]

[operation.assembly]
limit_mm = 6
"#;

#[test]
fn costs_and_grades_of_the_files_count() {
    let shop = Sandbox::new();
    shop.write("cells/costly.toml", COSTLY);
    let document = shop.json(&["allocate", "cells/costly.toml"]);
    let entry = |name: &str| {
        let found = items(&document, "parameters").iter().find(|p| p["parameter"] == name);
        found.unwrap_or_else(|| panic!("no {name}: {document}"))
    };
    assert_eq!(entry("dl2")["cost_kind"], "grades");
    assert!(entry("dl2")["grade"].as_str().unwrap().starts_with("IT"));
    assert!(["milled", "ground", "lapped"].contains(&entry("dalpha2")["grade"].as_str().unwrap()));
    assert_eq!(
        (&entry("dr1")["cost_before"], &entry("dr1")["scale_range"]),
        (&2.0.into(), &serde_json::json!([0.2, 2.0]))
    );
    assert_eq!(
        (&entry("worktable x")["cost_kind"], &entry("worktable x")["cost_before"]),
        (&"exponential".into(), &0.5.into())
    );
    assert_eq!(entry("worktable rz")["cost_before"], 1.0);
    assert_eq!(document["status"], "cheapest");
    let requirement = &items(&document, "requirements")[0];
    assert!(requirement["after"].as_f64().unwrap() <= 6.0 * (1.0 + 1e-6));
    // Half of IT11 for 850 mm is 0.28 mm. Every chosen grade must be a grade of the standard.
    let halves = [0.115, 0.18, 0.28, 0.45, 0.7, 1.15];
    let after = entry("dl3")["after"].as_f64().unwrap();
    assert!(halves.iter().any(|half| (half - after).abs() < 1e-9), "{after}");
    let pasted = shop.done(&["allocate", "cells/costly.toml", "--toml"]).out;
    assert!(
        pasted.contains("[equipment.\"worktable\".errors]\nkind = \"tolerance\"\nposition_mm = ["),
        "{pasted}"
    );
    assert!(shop.done(&["allocate", "cells/costly.toml"]).out.contains("grade"));
}

/// A limit with a yield is the limit of a percentile. Samples of the nonlinear model confirm the yield.
#[test]
fn a_yield_is_kept_by_the_samples() {
    let shop = Sandbox::new();
    let args = ["allocate", CELL, "--limit", "9", "--quantity", "yield"];
    let costs = ["0.9", "0.99", "0.999"].map(|share| {
        let document = shop.json(&[&args[..], &["--yield", share]].concat());
        assert_eq!(document["status"], "cheapest", "{document}");
        document["cost"].as_f64().unwrap()
    });
    assert!(costs.is_sorted() && costs[0] < costs[2], "{costs:?}");
    let p99 = shop.json(&["allocate", CELL, "--limit", "9", "--quantity", "p99"]);
    assert!(near(&p99["cost"], costs[1], 1e-4 * costs[1]), "{} and {}", p99["cost"], costs[1]);
}

#[test]
fn a_result_folder_is_judged_at_its_best_layout() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "300", "--reading", "worst-case", "--out", "found"]);
    let args = |of| ["allocate", of, "--limit", "15"];
    let [folder, file] = ["found", "found/best.toml"].map(|of| shop.json(&args(of)));
    assert_eq!(folder, file);
    assert_eq!(folder["status"], "cheapest");
}

#[test]
fn the_chart_has_a_bar_for_each_tolerance() {
    let shop = Sandbox::new();
    shop.done(&[&REFERENCE[..], &["--limit", "10", "--at", "5,8", "--svg", "chart.svg"]].concat());
    let svg = shop.text("chart.svg");
    for part in [
        "Cheapest tolerances",
        "cost 12 now, 11.243 with the cheapest",
        "the cheapest tolerances save 33.2 %",
        "dl2 \u{b1}1 \u{2192} 1.7584 mm",
    ] {
        assert!(svg.contains(part), "no {part:?}: {svg}");
    }
    assert!(svg.matches("fill-green").count() >= 9 && svg.matches("fill-vermilion").count() == 2, "{svg}");
}

/// Measured errors are known, so only the tolerances of the fixture are allocated.
const MEASURED: &str = r#"
from = "hitachi_cell.toml"
errors = "known"
reading = "worst-case"

[robot.errors.known]
kind = "measured"
source = "made up"
dr_mm = [0.1, 0, 0, 0]
dl_mm = [0, 0, 0, 0]
dalpha_deg = [0, 0, 0, 0]
covariance = { parameters = ["dl2", "dl3"], matrix = [[0.01, 0.002], [0.002, 0.02]] }

[equipment.worktable.errors]
kind = "tolerance"
position_mm = [1, 1, 0]
rotation_deg = [0, 0, 0.1]

[operation.assembly]
limit_mm = 2.5
"#;

#[test]
fn measured_errors_stay_as_they_are() {
    let shop = Sandbox::new();
    shop.write("cells/measured.toml", MEASURED);
    for flags in [&[][..], &["--quantity", "rms"]] {
        let args = [&["allocate", "cells/measured.toml"], flags].concat();
        let document = shop.json(&args);
        let names: Vec<&str> =
            items(&document, "parameters").iter().map(|p| p["parameter"].as_str().unwrap()).collect();
        assert_eq!(names, ["worktable x", "worktable y", "worktable rz"]);
        assert_eq!(document["fixed"], serde_json::json!(["dr1", "dl2", "dl3"]));
        let requirement = &items(&document, "requirements")[0];
        assert!(requirement["after"].as_f64().unwrap() <= 2.5 * (1.0 + 1e-6), "{requirement}");
        assert!(document["duality_gap"].as_f64().unwrap() < 1e-6, "{document}");
    }
    let ran = shop.done(&["allocate", "cells/measured.toml"]);
    assert!(
        ran.out.contains("not allocated, because they are measured or correlated: dr1, dl2, dl3"),
        "{}",
        ran.out
    );
    shop.write(
        "cells/known.toml",
        &MEASURED.replace("[equipment.worktable.errors]", "[equipment.conveyor.errors]"),
    );
    let ran = shop.run(&["allocate", "cells/known.toml"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.err.contains("no parameter has a tolerance to allocate"), "{}", ran.err);
}
