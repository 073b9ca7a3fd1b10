//! Tests the stable interface of the library against the commands: the numbers are the same, and faults are
//! returned as values.

use crate::cli::sandbox::*;
use crate::common::root;
use std::sync::atomic::AtomicBool;
use sweetspot::study::{Study, StudyError, StudyValue};

fn paper() -> Study {
    Study::load(root().join("cells/hitachi_paper.toml")).unwrap()
}

#[test]
fn a_study_evaluates_as_map_does() {
    let shop = Sandbox::new();
    let set = "equipment.worktable.placement.x_mm";
    let study = Study::load(shop.path(CELL)).unwrap().set(set, 350.0).unwrap();
    let evaluated = study.evaluate().unwrap();
    let map = shop.json(&["map", CELL, "--set", &format!("{set}=350.0")]);
    assert_eq!(evaluated.objective.unwrap(), number(&map["objective_mm"]));
    assert_eq!(evaluated.layout["worktable"].x_mm, 350.0);
    assert_eq!(evaluated.operations.len(), items(&map["operations"]).len());
    // The original study does not change.
    let drawn = Study::load(shop.path(CELL)).unwrap().evaluate().unwrap();
    assert_ne!(drawn.objective, evaluated.objective);
}

#[test]
fn a_search_of_a_study_equals_that_of_the_command() {
    let shop = Sandbox::new();
    let study = Study::load(shop.path(CELL)).unwrap();
    let study = study.set("search.budget", 300).unwrap().set("search.ideal", true).unwrap();
    let found = study.search().unwrap();
    let said =
        shop.json(&["search", CELL, "--budget", "300", "--ideal", "--out", "found", "--progress", "none"]);
    assert_eq!(found.result.objective_value.unwrap(), number(&said["objective_value"]));
    assert_eq!(found.result.evaluations as f64, number(&said["evaluations"]));
    // The study at the best layout has the value of the search and keeps the settings.
    let best = found.best.unwrap();
    assert_eq!(best.evaluate().unwrap().objective, found.result.objective_value);
    assert!(
        best.cell().free().is_empty()
            && best.layout_file("a.toml").starts_with("# Layout of a study\nfrom = \"a.toml\"")
    );
    // A search that is stopped at once returns the start layout or no layout.
    let stopped = study.search_until(&AtomicBool::new(true), &|_| ()).unwrap();
    assert!(stopped.result.evaluations <= found.result.evaluations);
}

#[test]
fn values_of_keys_are_numbers_words_lists_and_toml() {
    let study = paper().set("reading", "signed").unwrap().set("clearance_mm", 1).unwrap();
    let study = study.set("operation.mapping.grid", [4, 2]).unwrap();
    let study =
        study.set("equipment.worktable.placement.z_mm", StudyValue::toml("{ min = 0, max = 500 }")).unwrap();
    assert_eq!((study.cell().operations[0].nodes(), study.cell().free().len()), (15, 1));
    assert_eq!(study.cell().clearance, 0.001);
    // If a key is set twice, the last value counts.
    let again = study.set("operation.mapping.grid", [1, 1]).unwrap();
    assert_eq!(again.cell().operations[0].nodes(), 4);
    let both = [("operation.mapping.grid", StudyValue::from([1, 2])), ("search.seed", StudyValue::from(7))];
    assert_eq!(study.set_all(both).unwrap().cell().search.seed, 7);
}

#[test]
fn faults_are_values_with_place_and_remedy() {
    let refused = |study: Result<Study, StudyError>| match study {
        Err(StudyError::Faults(faults)) => faults,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("accepted"),
    };
    let faults = refused(Study::load("nowhere/no.toml"));
    assert!(faults[0].message.contains("no such file"), "{faults:?}");
    let error = paper().set("equipment.worktabel.placement.x_mm", 1.0).err().unwrap();
    assert!(error.to_string().contains("worktable"), "{error}");
    assert!(refused(paper().set("clearance_mm", f64::NAN))[0].message.contains("clearance_mm"));
    // A text with a line break cannot add a second key.
    refused(paper().set("name", StudyValue::toml("\"a\"\nfloor_mm = 1")));
    let text = "from = \"hitachi_paper.toml\"\nname = \"from text\"\n";
    let study = Study::from_text(text, root().join("cells/of_text.toml")).unwrap();
    assert_eq!((study.cell().name.as_str(), study.warnings().len()), ("from text", 0));
    assert_eq!(study.evaluate().unwrap().objective, paper().evaluate().unwrap().objective);
}
