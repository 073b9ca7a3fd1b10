//! Tests `errors`: with the printed table in a robot file, the robot has the requested accuracy.

use crate::cli::sandbox::{Sandbox, items, number, text};
use sweetspot::record::{DocumentKind, ErrorsDocument};

/// Pastes the table of `errors` into the robot file and returns the predicted accuracy of the new set, mm.
fn pasted(shop: &Sandbox, robot: &str, args: &[&str]) -> serde_json::Value {
    let table = shop.done(&[&["errors", robot, "--toml"], args].concat()).out;
    assert!(table.starts_with("[errors.guess]\n"), "{table}");
    assert!(table.contains("source = \"GUESS, not measured: "), "{table}");
    let own = shop.done(&["robot", robot, "--toml"]).out;
    shop.write("guessed.toml", &format!("{own}\n{table}"));
    shop.json(&["errors", "guessed.toml", "--errors", "guess"])
}

/// The robots have standard and modified rows, revolute and prismatic joints, error sets of the robot file
/// and presets.
#[test]
fn the_table_in_a_robot_file_gives_the_wanted_accuracy() {
    let shop = Sandbox::new();
    for (robot, args) in [
        ("ur5e", &["--ap", "0.5"][..]),
        ("kuka_kr6_r900", &["--ap", "0.7", "--preset", "small"]),
        ("adept_cobra_s600", &["--ap", "0.3", "--preset", "scara"]),
        ("hitachi_pw10", &["--ap", "2", "--errors", "table-3-tolerance"]),
        ("franka_panda", &["--ap", "3", "--preset", "research"]),
    ] {
        let document = pasted(&shop, robot, args);
        let wanted: f64 = args[1].parse().unwrap();
        let found = number(&document["ap"]["median_mm"]);
        assert!((found / wanted - 1.0).abs() < 1e-5, "{robot}: {found}");
        // An error set whose name begins with "guess" remains a guess.
        assert_eq!((&document["guess"], number(&document["scale"])), (&true.into(), 1.0));
    }
}

#[test]
fn a_repeatability_is_part_of_the_table() {
    let shop = Sandbox::new();
    let args = ["--ap", "0.5", "--rp", "0.1", "--preset", "collaborative"];
    let asked = shop.json(&[&["errors", "ur10"][..], &args].concat());
    assert_eq!(number(&asked["wanted_rp_mm"]), 0.1);
    let (constant, with_random) =
        (number(&asked["ap"]["median_mm"]), number(&asked["ap_of_set"]["median_mm"]));
    assert!((constant - 0.5).abs() < 1e-6 && with_random > constant, "{constant} {with_random}");
    let document = pasted(&shop, "ur10", &args);
    assert!((number(&document["ap"]["median_mm"]) - with_random).abs() < 1e-5);
}

#[test]
fn the_document_has_its_schema_and_reads_back() {
    let shop = Sandbox::new();
    let document = shop.json(&["errors", "puma560", "--ap", "1", "--rp", "0.1"]);
    let validator = jsonschema::draft7::new(&DocumentKind::Errors.schema()).unwrap();
    assert!(validator.is_valid(&document), "{document}");
    let read: ErrorsDocument = serde_json::from_value(document.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), document);
    assert_eq!(text(&document["schema"]), "sweetspot/errors/1");
    assert_eq!(items(&document["cube"]["poses"]).len(), 5);
    let plain = shop.json(&["errors", "puma560"]);
    assert_eq!((&plain["guess"], &plain["joint_scatter"]), (&false.into(), &serde_json::Value::Null));
    let nominal = shop.json(&["errors", "puma560", "--base", "nominal"]);
    assert!(number(&nominal["ap"]["median_mm"]) > number(&plain["ap"]["median_mm"]));
}

#[test]
fn guesses_are_labelled_wherever_they_are_used() {
    let shop = Sandbox::new();
    let words = shop.done(&["errors", "ur5e", "--ap", "0.5"]);
    assert!(words.out.contains("GUESS, not measured") && words.err.contains("next: sweetspot errors ur5e"));
    let table = shop.done(&["errors", "hitachi_pw10", "--ap", "1", "--toml"]).out;
    let robot = shop.text("cells/robots/hitachi_pw10.toml");
    shop.write("cells/robots/hitachi_pw10.toml", &format!("{robot}\n{table}"));
    let map = shop.done(&["map", "cells/hitachi_cell.toml", "--errors", "guess"]);
    assert!(map.err.contains("guess is a GUESS"), "{}", map.err);
    let json = shop.json(&["map", "cells/hitachi_cell.toml", "--errors", "guess"]);
    assert!(items(&json["notes"]).iter().any(|note| text(note).contains("GUESS")), "{}", json["notes"]);
    shop.run(&["report", "cells/hitachi_cell.toml", "--errors", "guess", "-o", "guess.html"]);
    assert!(shop.text("guess.html").contains("a GUESS; replace it"));
    // A second table gets another name.
    let again = shop.done(&["errors", "cells/robots/hitachi_pw10.toml", "--ap", "1", "--toml"]).out;
    assert!(again.starts_with("[errors.guess-2]"), "{again}");
}

#[test]
fn presets_are_listed_and_wrong_questions_refused() {
    let shop = Sandbox::new();
    let list = shop.done(&["errors", "--presets"]).out;
    for word in ["collaborative", "scara", "palletizer", "research", "our estimate", "GUESSES"] {
        assert!(list.contains(word), "{word}: {list}");
    }
    for (args, words) in [
        (&["errors", "ur5e", "--preset", "skara"][..], &["no preset `skara`", "did you mean scara?"][..]),
        (&["errors", "ur5e", "--errors", "factory"], &["no error set `factory`", "placeholder"]),
        (&["errors", "ur10e", "--errors", "factory"], &["is signed, so it describes one robot", "--preset"]),
        (&["errors", "ur5e", "--ap", "0"], &["more than 0"]),
        (&["errors", "ur5e", "--ap", "nan"], &["--ap"]),
        (&["errors", "ur5e", "--ap", "100000"], &["AP"]),
        (&["errors"], &["ROBOT"]),
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        ran.no_panic();
        words.iter().for_each(|word| assert!(ran.err.contains(word), "{args:?}: no {word:?} in {}", ran.err));
    }
    let taught = shop.done(&["errors", "ur5e", "--ap", "0.05", "--rp", "0.03"]);
    assert!(taught.err.contains("often state such an AP for taught poses"), "{}", taught.err);
}
