//! Tests `search --pareto` and `search --keep`: files, documents, refusals.

use crate::cli::sandbox::*;
use serde_json::Value;

const PARETO: [&str; 4] = ["--pareto", "error,clearance,footprint", "--budget", "1500"];

#[test]
fn a_pareto_front_is_printed_written_and_loaded_again() {
    let shop = Sandbox::new();
    let document = shop.json(&[&["search", CELL, "--out", "found"][..], &PARETO].concat());
    assert_eq!(document["pareto"], serde_json::json!(["error", "clearance", "footprint"]));
    assert_eq!(document["keep"], Value::Null);
    let front = items(&document["front"]);
    assert!(front.len() > 3, "{} layouts", front.len());
    let mut named = vec!["front.csv", "front.svg", "best.toml", "search.json", "manifest.json"];
    named.extend(front.iter().map(|l| text(&l["file"])));
    shop.has("found", &named);
    let table = shop.text("found/front.csv");
    assert_eq!(table.lines().count(), front.len() + 1);
    assert!(
        table.starts_with(
            "layout,error,clearance_mm,joint_limits_percent,singularity,travel_deg,footprint_m2,"
        )
    );
    assert_eq!(shop.text("found/front.svg").matches("<circle").count(), front.len());
    // No layout is at least as good as another layout in every goal.
    let losses = |l: &Value| {
        let goal = |key: &str| number(&l["goals"][key]);
        [goal("error"), -goal("clearance_mm"), goal("footprint_m2")]
    };
    for (k, a) in front.iter().enumerate() {
        for b in front.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, b)| b) {
            let (a, b) = (losses(a), losses(b));
            assert!(a.iter().zip(b).any(|(a, b)| *a < b), "{a:?} {b:?}");
        }
    }
    // The cell file of each layout gives the objective of this layout.
    for layout in [&front[0], &front[front.len() - 1]] {
        let file = format!("found/{}", text(&layout["file"]));
        let compared = shop.json(&["compare", &file]);
        let objective = number(&compared["layouts"][0]["objective"]);
        assert!((objective - number(&layout["objective_value"])).abs() < 1e-6, "{file}: {objective}");
    }
    let plain = shop.done(&[&["search", CELL, "--out", "again"][..], &PARETO].concat());
    assert!(plain.out.contains("layouts for the goals error, clearance, footprint:\n"), "{}", plain.out);
    assert!(plain.out.contains("best layout: clearance "), "{}", plain.out);
    assert_eq!(shop.read("found/front.csv"), shop.read("again/front.csv"));
    assert_eq!(shop.read("found/search.json"), shop.read("again/search.json"));
}

#[test]
fn the_requested_number_of_layouts_is_kept() {
    let shop = Sandbox::new();
    let document =
        shop.json(&["search", CELL, "--budget", "1500", "--keep", "3", "--threads", "1", "--out", "found"]);
    let kept = items(&document["front"]);
    let objectives: Vec<f64> = kept.iter().map(|l| number(&l["objective_value"])).collect();
    assert_eq!(objectives.len(), 3);
    // The best layout comes first. Among the layouts with nearly the least objective, it has the most room.
    assert_eq!(objectives[0], number(&document["objective_value"]));
    assert!(objectives[0] <= 1.01 * number(&document["least_value"]), "{objectives:?}");
    assert!(objectives[1..].windows(2).all(|w| w[0] <= w[1]), "{objectives:?}");
    assert_eq!(shop.read("found/best.toml").len() > 100, shop.path("found/layout-03.toml").exists());
    assert!(!shop.path("found/layout-04.toml").exists() && !shop.path("found/front.svg").exists());
    // The options can be combined, and the cell file can request both.
    let cell = shop
        .text(CELL)
        .replace("[search]\n", "[search]\npareto = [\"error\", \"travel\", \"footprint\"]\nkeep = 4\n");
    shop.write("cells/front.toml", &cell);
    let document = shop.json(&["search", "cells/front.toml", "--budget", "1500", "--out", "few"]);
    assert_eq!((items(&document["front"]).len(), &document["keep"]), (4, &Value::from(4)));
    assert!(shop.path("few/front.svg").exists());
    // Without these options, the document has none of these fields.
    let document = shop.json(&["search", CELL, "--budget", "300", "--out", "none"]);
    assert_eq!(
        (&document["front"], &document["pareto"], &document["keep"]),
        (&Value::Null, &Value::Null, &Value::Null)
    );
    assert!(number(&document["goals"]["footprint_m2"]) > 1.0);
    assert!(!shop.path("none/front.csv").exists() && !shop.path("none/layout-01.toml").exists());
}

#[test]
fn invalid_pareto_goals_are_refused() {
    let shop = Sandbox::new();
    for (wrong, said) in [
        ("--pareto=error", "2 to 8 goals"),
        ("--pareto=error,error", "must not name a goal twice"),
        ("--pareto=error,price", "invalid value 'price'"),
        ("--pareto=error,clearence", "'clearance'"),
        ("--keep=0", "0"),
        ("--keep=101", "101"),
    ] {
        let ran = shop.run(&["search", CELL, wrong]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{wrong}: {}", ran.err);
        assert!(ran.err.contains(said), "{wrong}: {}", ran.err);
    }
    assert!(!shop.path("results").exists(), "a refused search left a folder");
}

/// With the goals error and cost, the front states both values, and `allocate` finds the same cost.
#[test]
fn a_front_of_error_and_cost_states_what_allocate_finds() {
    let shop = Sandbox::new();
    shop.write("cost.toml", &format!("from = \"{CELL}\"\n{PRICED}model = \"linear\"\n{LIMITS}"));
    let asked = ["search", "cost.toml", "--pareto", "error,cost", "--budget", "800", "--out", "found"];
    let document = shop.json(&asked);
    let front = items(&document["front"]);
    assert!(!front.is_empty() && shop.text("found/front.csv").contains(",footprint_m2,cost,"), "{document}");
    let layout = &front[front.len() - 1];
    let found = shop.json(&["allocate", &format!("found/{}", text(&layout["file"]))]);
    let (want, cost) = (number(&found["cost"]), number(&layout["goals"]["cost"]));
    assert!((cost / want - 1.0).abs() < 1e-5, "{cost} instead of {want}");
    // Without limits, the cost of tolerances is not defined.
    let refused = shop.run(&["search", CELL, "--pareto", "error,cost"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("no limit that the tolerances must meet"), "{}", refused.err);
}

const PRICED: &str = "reading = \"worst-case\"\n";
const LIMITS: &str = "[operation.assembly]\nlimit_mm = 12\n[operation.picking]\nlimit_mm = 12\n";

/// A search for the least cost states the cost and its unit. It also states that even the tightest tolerances
/// exceed a limit.
#[test]
fn a_search_by_cost_states_the_cost_of_the_tolerances() {
    let shop = Sandbox::new();
    let cell = |limits: &str| {
        format!("from = \"{CELL}\"\n{PRICED}{limits}[search]\nobjective = \"tolerance-cost\"\nbudget = 800\n")
    };
    shop.write("cost.toml", &cell(LIMITS));
    let document = shop.json(&["search", "cost.toml", "--out", "found"]);
    assert_eq!((&document["unit"], &document["quantity"]), (&"cost".into(), &"tolerance cost".into()));
    let cost = number(&document["objective_value"]);
    let found = shop.json(&["allocate", "found"]);
    // The search uses the linear model, but `allocate` uses the model of the cell.
    let judged = number(&found["cost"]);
    assert!(cost < 11.0 && (judged / cost - 1.0).abs() < 0.05, "{cost} and {judged}");
    let map = shop.json(&["map", "found/best.toml"]);
    assert_eq!(map["maps"][0]["unit"].as_str().or(map["unit"].as_str()), Some("cost"), "{map}");
    shop.write("strict.toml", &cell(&LIMITS.replace("12", "0.1")));
    let missed = shop.run(&["search", "strict.toml"]);
    assert_eq!(missed.code, Some(1), "{}", missed.err);
}
