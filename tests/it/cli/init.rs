//! Tests `init`: every generated cell runs without changes.

use crate::cli::sandbox::*;
use crate::common::document;
use serde_json::Value;

/// Returns the names and robots that `init` lists.
fn listed(shop: &Sandbox) -> Vec<(String, String)> {
    let out = shop.done(&["init"]).out;
    let words = |line: &str| {
        let mut words = line.split_whitespace().map(str::to_string);
        (words.next().unwrap(), words.next().unwrap())
    };
    out.lines().map(words).collect()
}

/// Returns the command of a `next:` line.
fn next(ran: &RunOutput) -> Vec<String> {
    let line = ran.err.lines().find_map(|line| line.strip_prefix("next: sweetspot ")).expect("no next");
    line.split(' ').map(str::to_string).collect()
}

#[test]
fn an_unknown_name_lists_the_names_that_contain_it() {
    let shop = Sandbox::new();
    let ran = shop.run(&["init", "abb"]);
    let line = ran.err.lines().next().unwrap();
    assert_eq!(ran.code, Some(2));
    assert!(line.contains("names that contain it: ") && line.contains("abb_irb140"), "{line}");
    assert!(!line.contains("ur10e"), "{line}");
    let ran = shop.run(&["init", "nonesuch"]);
    let line = ran.err.lines().next().unwrap();
    let (_, known) = line.split_once("known: ").unwrap();
    let known: Vec<_> = known.split(", ").collect();
    let unique: std::collections::BTreeSet<_> = known.iter().collect();
    assert!(known.len() > 30 && unique.len() == known.len(), "{line}");
}

#[test]
fn init_leads_to_the_first_error_map_in_two_commands() {
    let shop = Sandbox::new();
    let mut args = vec!["init".to_string()];
    for expected in ["init hitachi", "map hitachi/cell.toml --svg map.svg", "search hitachi/cell.toml"] {
        let ran = shop.done(&args.iter().map(String::as_str).collect::<Vec<_>>());
        args = next(&ran);
        assert_eq!(args.join(" "), expected);
    }
    assert!(shop.text("map.svg").starts_with("<svg"));
}

#[test]
fn every_library_robot_has_a_generated_cell() {
    let shop = Sandbox::new();
    let mut robots: Vec<_> = listed(&shop).into_iter().map(|(_, robot)| robot).collect();
    robots.sort();
    let library = shop.json(&["robots"]);
    let mut known: Vec<_> = items(&library["robots"]).iter().map(|r| text(&r["name"]).to_string()).collect();
    known.sort();
    assert_eq!(robots.len(), known.len());
    let files =
        shop.files("cells/robots").into_iter().filter_map(|f| f.strip_suffix(".toml").map(str::to_string));
    assert_eq!(robots, files.collect::<Vec<_>>());
}

/// Checks that at least a third of the nodes of both surfaces are usable, and that both operations have a
/// spot.
fn maps_well(map: &Value, name: &str) {
    for operation in items(&map["operations"]) {
        let nodes = items(&operation["nodes"]);
        let ok = nodes.iter().filter(|node| node["status"] == "ok").count();
        assert!(3 * ok >= nodes.len(), "{name}, {}: {ok} of {} nodes ok", operation["name"], nodes.len());
    }
    assert!(number(&map["objective_mm"]) > 0.0, "{name}");
}

#[test]
fn every_generated_cell_passes_check_and_map() {
    let shop = Sandbox::new();
    for (name, robot) in listed(&shop) {
        let ran = shop.done(&["init", &name]);
        assert!(ran.out.is_empty(), "{}", ran.out);
        let cell = format!("{name}/cell.toml");
        let check = shop.json(&["check", &cell]);
        // A URDF reports its unused elements.
        assert!(items(&check["faults"]).is_empty() || robot.ends_with("urdf"), "{check}");
        let drawn = shop.text(&cell);
        // In an unoptimized build, each node of these robots takes long.
        if ["crx10ia", "kinova_gen3", "kuka_iiwa14", "panda", "track", "ufactory_xarm6"]
            .contains(&name.as_str())
        {
            shop.write(
                &cell,
                &drawn.replace("grid = [6, 4]", "grid = [2, 1]").replace("grid = [6, 2]", "grid = [2, 2]"),
            );
        }
        maps_well(&shop.json(&["map", &cell]), &name);
        let schema = shop.document(&format!("{name}/schemas/cell.schema.json"));
        let cell = document(&drawn).unwrap();
        let told: Vec<_> =
            jsonschema::draft7::new(&schema).unwrap().iter_errors(&cell).map(|e| e.to_string()).collect();
        assert!(told.is_empty(), "{name}: {told:?}");
        // The named files equal the files of the shipped cells.
        for file in shop.files(&name).iter().filter(|file| *file != "cell.toml") {
            assert_eq!(shop.read(&format!("{name}/{file}")), shop.read(&format!("cells/{file}")), "{file}");
        }
    }
}

#[test]
fn generated_cells_search_to_a_feasible_layout() {
    let shop = Sandbox::new();
    for name in ["hitachi", "ur10e", "scara", "palletizer"] {
        shop.done(&["init", name]);
        let found = shop.json(&[
            "search",
            &format!("{name}/cell.toml"),
            "--budget",
            "40",
            "--out",
            &format!("{name}/found"),
        ]);
        assert_eq!(found["status"], "found", "{name}: {found}");
        assert!(number(&found["objective_mm"]) > 0.0, "{name}");
    }
}

#[test]
fn init_accepts_a_library_robot_and_another_folder() {
    let shop = Sandbox::new();
    let ran = shop.done(&["init", "adept_cobra_s600", "--out", "my shop/cell 1"]);
    assert_eq!(next(&ran).join(" "), "map 'my shop/cell 1/cell.toml' --svg map.svg");
    shop.done(&["init", "scara"]);
    assert_eq!(shop.read("my shop/cell 1/cell.toml"), shop.read("scara/cell.toml"));
    // The files to which the robot file refers are also written.
    shop.done(&["init", "hitachi-parallelogram", "--out", "p"]);
    shop.has("p/robots", &["hitachi_pw10.toml", "hitachi_pw10_parallelogram.toml"]);
    shop.done(&["init", "hitachi-urdf", "--out", "u"]);
    shop.has("u/robots", &["hitachi_pw10.urdf", "hitachi_pw10_urdf.toml"]);
}

#[test]
fn init_overwrites_nothing_and_reports_misspellings() {
    let shop = Sandbox::new();
    shop.done(&["init", "scara"]);
    shop.write("scara/cell.toml", "mine");
    let again = shop.run(&["init", "scara"]);
    assert!(again.code == Some(2) && again.err.contains("nothing is overwritten"), "{}", again.err);
    assert_eq!(shop.text("scara/cell.toml"), "mine");
    let slip = shop.run(&["init", "hitatchi"]);
    assert!(
        slip.code == Some(2) && slip.err.contains("did you mean") && slip.err.contains("hitachi"),
        "{}",
        slip.err
    );
    let odd = shop.run(&["init", "\u{1b}[31m"]);
    assert!(odd.code == Some(2) && !odd.err.contains('\u{1b}'), "{}", odd.err);
    assert_eq!(shop.run(&["init", "--out", "x"]).code, Some(2));
    shop.write("file", "");
    assert_eq!(shop.run(&["init", "scara", "--out", "file/x"]).code, Some(3));
    assert!(shop.done(&["init", "--help"]).out.starts_with("Example: sweetspot init "));
}
