//! Tests the verdicts on statistical figures: the joint yield, and equal verdicts of all commands.

use crate::cli::sandbox::*;

/// Options for the statistical reading, with a limit for both operations of the shipped cell.
const QUESTION: [&str; 4] = ["--quantity", "p99", "--limit", "9"];

#[test]
fn a_map_gives_the_yield_of_all_operations_together() {
    let shop = Sandbox::new();
    let document = shop.json(&[&["map", CELL], &QUESTION[..]].concat());
    let whole = &document["cell_yield"];
    let together = number(&whole["together"]["value"]);
    let mut alone = Vec::new();
    for operation in items(&document["operations"]) {
        let of = &whole["operations"][text(&operation["name"])];
        assert_eq!(of, &operation["monte_carlo"]["yield"]);
        alone.push(number(&of["value"]));
    }
    assert!(alone.len() == 2 && together <= alone[0].min(alone[1]) && together >= alone[0] + alone[1] - 1.0);
    assert!(number(&whole["together"]["low"]) < together && together < number(&whole["together"]["high"]));
    let said = shop.done(&[&["map", CELL], &QUESTION[..]].concat()).out;
    assert!(
        said.contains("sampled arms that stay within the limits of all operations (")
            && said.contains("; each alone: assembly "),
        "{said}"
    );
    let without = shop.json(&["map", CELL, "--quantity", "p99"]);
    assert!(without.get("cell_yield").is_none());
}

#[test]
fn a_sum_of_percentiles_is_not_called_a_percentile() {
    let shop = Sandbox::new();
    let ran = shop.run(&[&["report", CELL], &QUESTION[..], &["--json"]].concat());
    let verdict = ran.document();
    let headline = text(&verdict["headline"]);
    assert!(headline.contains("; p99 of assembly "), "each operation alone: {headline}");
    let facts = items(&verdict["facts"]);
    let note = |label: &str| text(&facts.iter().find(|f| f["label"] == label).unwrap()["note"]).to_string();
    assert!(note("Objective").contains("in each operation alone, 99 of 100 arms"), "{}", note("Objective"));
    assert!(note("Yield").contains("stay within the limits of all operations"), "{}", note("Yield"));
    assert_eq!(verdict["cell_yield"], shop.json(&[&["map", CELL], &QUESTION[..]].concat())["cell_yield"]);
    // For a cell with only one operation, the page states its percentile.
    let verdict = shop.json(&["report", PAPER, "--quantity", "p99"]);
    assert!(text(&verdict["headline"]).contains("; p99 of "), "{}", verdict["headline"]);
    let objective = items(&verdict["facts"]).iter().find(|f| f["label"] == "Objective").unwrap();
    assert!(text(&objective["note"]).contains("; 99 of 100 arms"), "{objective}");
}

/// `budget` and `explain` give the limit, the samples and the verdict of the map.
#[test]
fn budget_and_explain_carry_the_verdict_of_the_map() {
    let shop = Sandbox::new();
    for flags in [&QUESTION[..], &["--quantity", "yield", "--limit", "6", "--registration", "best-fit"]] {
        let map = shop.json(&[&["map", CELL], flags].concat());
        let budget = shop.json(&[&["budget", CELL], flags].concat());
        for (mapped, budgeted) in items(&map["operations"]).iter().zip(items(&budget["operations"])) {
            let name = text(&mapped["name"]);
            let explained = shop.json(&[&["explain", CELL, "--operation", name], flags].concat());
            for other in [budgeted, &explained] {
                assert_eq!(other["monte_carlo"], mapped["monte_carlo"], "{name} {flags:?}");
                assert_eq!(other["margin"], mapped["margin"], "{name} {flags:?}");
                assert_eq!(other["total"]["p95"], mapped["best"]["p95_mm"][text(&mapped["sense"])]);
            }
            assert_eq!(explained["value"], mapped["value"], "{name} {flags:?}");
        }
    }
    for command in ["budget", "explain"] {
        let said = shop.done(&[&[command, CELL], &QUESTION[..]].concat()).out;
        assert!(
            said.contains("limit 9.0000 mm: MISSED by") || said.contains("limit 9.0000 mm: met,"),
            "{said}"
        );
        assert!(said.contains("Monte Carlo samples of the nonlinear model"), "{said}");
    }
}
