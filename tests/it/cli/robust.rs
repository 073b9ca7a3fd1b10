//! Tests the commands `robust` and `search --robust`.

use crate::cli::sandbox::*;

/// Shipped cell with placement tolerances of a table and a conveyor.
const LOOSE: &str = "from = \"hitachi_cell.toml\"\n[equipment.worktable]\n\
                     placement_tolerance = { x_mm = 2, y_mm = 2, z_mm = 1, yaw_deg = 0.2 }\n\
                     [equipment.conveyor]\nplacement_tolerance = { x_mm = 3 }\n";

#[test]
fn robust_reports_worst_corner_slopes_and_allowed_misplacement() {
    let shop = Sandbox::new();
    shop.write("cells/loose.toml", LOOSE);
    let told = shop.done(&["robust", "cells/loose.toml", "--limit", "14"]);
    for words in [
        "placement tolerance: worst ",
        "gradient: x ",
        " times the placement tolerances",
        "may be misplaced by at most ",
    ] {
        assert_eq!(told.out.matches(words).count() % 2, 0, "{}", told.out);
        assert!(told.out.contains(words), "{}", told.out);
    }
    assert!(told.err.contains("next: sweetspot search cells/loose.toml --robust"), "{}", told.err);
    let document = shop.json(&["robust", "cells/loose.toml", "--limit", "14"]);
    assert_eq!((text(&document["schema"]), &document["holds"]), ("sweetspot/robust/1", &true.into()));
    for operation in items(&document["operations"]) {
        let r = field(operation, "robustness");
        let worst = number(&r["worst"]["value"]);
        assert!(worst > number(&r["value"]) && worst < 14.0, "{r}");
        assert!(
            number(&r["largest_times_tolerance"]["most"]) > 1.0
                && number(&r["largest_in_plan_mm"]["most"]) > 3.0
        );
        for key in ["lost", "gradient", "largest_yaw_deg", "corners", "tolerance", "holds"] {
            field(r, key);
        }
    }
    // The limit is exceeded within the tolerance, or even at the nominal layout, so the answer is no.
    for limit in ["13.01", "5"] {
        let no = shop.run(&["robust", "cells/loose.toml", "--limit", limit]);
        assert_eq!(no.code, Some(1), "{limit}: {}", no.out);
    }
}

#[test]
fn a_robust_search_holds_where_the_nominal_search_fails() {
    let shop = Sandbox::new();
    shop.write("cells/loose.toml", LOOSE);
    let search =
        |flags: &[&str]| shop.json(&[&["search", "cells/loose.toml", "--budget", "1500"], flags].concat());
    let nominal = search(&["--out", "nominal", "--ideal"]);
    let robust = search(&["--out", "robust", "--robust"]);
    let holds = |document: &serde_json::Value| {
        items(&document["operations"]).iter().all(|o| o["robustness"]["holds"] == true)
    };
    assert!(holds(&robust) && !holds(&nominal));
    assert!(number(&robust["objective_mm"]) > number(&nominal["objective_mm"]));
    let worst = items(&robust["operations"]).iter().map(|o| number(&o["worst"]));
    assert!((worst.sum::<f64>() - number(&robust["objective_mm"])).abs() < 1e-6);
    // best.toml of a robust search has the same value.
    let [map, compare, search] = objectives(&shop, "robust");
    assert_eq!([map, compare], [search, search]);
    assert_eq!(shop.run(&["robust", "robust/best.toml"]).code, Some(0));
    assert_eq!(shop.run(&["robust", "nominal/best.toml"]).code, Some(1));
    assert_eq!(shop.run(&["compare", "nominal", "robust"]).code, Some(2));
}

#[test]
fn a_robust_search_without_placement_tolerances_is_refused() {
    let shop = Sandbox::new();
    let ran = shop.run(&["search", "cells/hitachi_paper.toml", "--robust"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.err.contains("no placement has a tolerance") && ran.err.contains("help: "), "{}", ran.err);
    // The allowed misplacement is still reported.
    let told = shop.done(&["robust", IDEAL]);
    assert!(
        told.out.contains("may be misplaced by at most") && !told.out.contains("tolerance: worst"),
        "{}",
        told.out
    );
}

#[test]
fn the_refined_spot_is_in_every_report() {
    let shop = Sandbox::new();
    let document = shop.json(&["map", PAPER, "--out", "mapped"]);
    let operation = &document["operations"][0];
    let refined = field(operation, "refined");
    assert!(number(&refined["value"]) < number(&operation["best"]["value"]));
    assert_eq!(number(&refined["node_value"]), number(&operation["best"]["value"]));
    assert!(shop.done(&["map", PAPER]).out.contains("refined between the nodes"));
    let csv = shop.text("mapped/map.csv");
    let given: Vec<f64> = csv.lines().skip(1).filter_map(|l| l.rsplit(',').next()?.parse().ok()).collect();
    assert_eq!(given.len(), 1, "only the best node has one");
    assert!((given[0] - number(&refined["value"])).abs() < 1e-9);
    assert!(shop.text("mapped/map.svg").contains(" refined: "));
}

/// If a search finds no layout that works within the tolerances, it names the limiting tolerance and the
/// largest value that would work.
#[test]
fn a_search_names_the_tolerance_that_leaves_no_layout() {
    let shop = Sandbox::new();
    let wide = "from = \"hitachi_cell.toml\"\n[equipment.worktable]\nplacement_tolerance = { x_mm = 300 }\n";
    shop.write("cells/wide.toml", wide);
    let ran = shop.run(&["search", "cells/wide.toml", "--budget", "600", "--out", "found"]);
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    let line =
        ran.out.lines().find(|l| l.contains("with smaller placement tolerances: x_mm of worktable at most "));
    let line = line.unwrap_or_else(|| panic!("{}", ran.out));
    assert!(line.ends_with("instead of 300"), "{line}");
    let reasons = shop.document("found/search.json")["reasons"].to_string();
    assert!(reasons.contains("x_mm of worktable at most "), "{reasons}");
}

/// A limit between the error of the layout as drawn and its proven bound may or may not be exceeded.
#[test]
fn a_limit_below_the_proven_bound_is_not_guaranteed() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "300", "--out", "found"]);
    let map = shop.json(&["map", "found/best.toml"]);
    let operation = &items(&map["operations"])[0];
    let name = operation["name"].as_str().unwrap();
    let (value, most) = (number(&operation["value"]), number(&operation["worst"]));
    assert!(value < most, "{value} {most}");
    for (share, said) in [
        (0.5, "not guaranteed: the proven bound over the misplacements is"),
        (-0.1, "MISSED by"),
        (1.1, "to spare"),
    ] {
        let limit = value + share * (most - value);
        shop.write(
            "limited.toml",
            &format!("from = \"found/best.toml\"\noperation.{name}.limit_mm = {limit}\n"),
        );
        let ran = shop.run(&["compare", "limited.toml"]);
        let told = ["not guaranteed", "MISSED by", "to spare"].map(|word| ran.out.contains(word));
        assert_eq!(told.iter().filter(|is_told| **is_told).count(), 1, "{share}: {}", ran.out);
        assert!(ran.out.contains(said), "{share}: {}\n{}", ran.out, ran.err);
    }
}

/// `map`, `sweep` and `report` give the same verdict on a limit that only the proven bound exceeds.
#[test]
fn a_limit_that_is_not_guaranteed_is_told_alike_by_sweep_and_report() {
    let shop = Sandbox::new();
    let set = "operation.assembly.limit_mm=12";
    let report = shop.run(&["report", CELL, "--set", set, "--json"]);
    assert_eq!(report.code, Some(1), "{}", report.err);
    let document = report.document();
    assert_eq!(document["requirement"], "not-guaranteed");
    assert_eq!(items(&document["operations"])[0]["requirement"], "not-guaranteed");
    let sweep = shop.run(&["sweep", CELL, "--map", "--set", &format!("{set},13"), "--out", "swept"]);
    assert!(sweep.out.contains("not guaranteed") && sweep.out.contains("met"), "{}", sweep.out);
    assert_eq!(sweep.code, Some(0), "{}", sweep.err);
    let best = shop.document("swept/table.json")["best"].clone();
    assert_eq!(best, 1, "the row that meets its limit is the best one");
    let missed = shop.run(&["sweep", CELL, "--map", "--set", &format!("{set},3"), "--out", "missed"]);
    assert_eq!(missed.code, Some(1), "{}", missed.out);
}
