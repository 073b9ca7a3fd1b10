//! Tests `robots`, `robot` and `envelope`.

use crate::cli::sandbox::{CELL, Sandbox, field, items, near, number, numbers, text};
use serde_json::Value;

/// Returns the names that `robots` lists.
fn listed(shop: &Sandbox) -> Vec<String> {
    items(&shop.json(&["robots"])["robots"]).iter().map(|r| text(&r["robot"]).to_string()).collect()
}

#[test]
fn the_built_in_library_equals_the_robots_folder() {
    let shop = Sandbox::new();
    let folder = crate::common::root().join("cells/robots");
    let mut files: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .filter_map(|e| Some(e.unwrap().file_name().to_string_lossy().strip_suffix(".toml")?.to_string()))
        .collect();
    files.sort();
    assert_eq!(listed(&shop), files);
    for name in files {
        let file = std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
        assert_eq!(shop.done(&["robot", &name, "--toml"]).out, file, "{name}");
    }
    let words = shop.done(&["robots"]);
    assert!(words.out.contains("Hitachi PW 10-II") && words.err.starts_with("next: sweetspot robot "));
}

/// The built-in library is available in any folder, because it needs no files.
#[test]
fn the_built_in_library_needs_no_files() {
    let shop = Sandbox::new();
    let elsewhere = crate::cli::sandbox::temporary_folder();
    let mut command = shop.command(&["robot", "hitachi_pw10_parallelogram", "--json"]);
    let ran = crate::cli::sandbox::ran(command.current_dir(elsewhere.path()).output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let sheet = ran.document();
    assert_eq!(text(field(&sheet, "name")), "Hitachi PW 10-II (parallelogram)");
    assert_eq!(numbers(&sheet["coupling"][2]), [0.0, -1.0, 1.0, 0.0]);
}

#[test]
fn an_unknown_robot_exits_2_with_a_suggestion() {
    let shop = Sandbox::new();
    for args in [["robot", "hitachi_pw1O"], ["envelope", "hitachi_pw1O"]] {
        let ran = shop.run(&args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}");
        assert!(ran.err.contains("did you mean hitachi_pw10?"), "{}", ran.err);
    }
    for args in [["robot", "nowhere.toml"], ["envelope", "nowhere.toml"]] {
        assert_eq!(shop.run(&args).code, Some(3), "{args:?}");
    }
    for bad in [&["--bend", "136"][..], &["--step", "0"], &["--operation", "picking"], &["--height", "nan"]] {
        let ran = shop.run(&[&["envelope", "hitachi_pw10"][..], bad].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{bad:?}");
    }
    assert_eq!(shop.run(&["robot", CELL]).code, Some(2));
}

#[test]
fn a_library_robot_is_printed_with_its_numbers() {
    let shop = Sandbox::new();
    let by_name = shop.json(&["robot", "hitachi_pw10"]);
    assert_eq!(by_name, shop.json(&["robot", "cells/robots/hitachi_pw10.toml"]));
    assert_eq!(text(field(&by_name, "schema")), "sweetspot/robot-sheet/1");
    let first = &items(field(&by_name, "joints"))[0];
    assert_eq!(number(field(first, "r_mm")), 750.0);
    assert_eq!(numbers(field(first, "limits")), [-150.0, 150.0]);
    // At home, the upper arm is vertical, and forearm and tool are horizontal along +y.
    assert!(near(&numbers(field(&by_name, "home_position_mm")), &[0.0, 1250.0, 1350.0], 1e-6));
    let words = shop.done(&["robot", "hitachi_pw10"]).out;
    for said in ["D-H rows, standard", "q1 (waist)", "envelope", "a signed sample", "source"] {
        assert!(words.contains(said), "no {said} in {words}");
    }
}

#[test]
fn the_sheet_of_an_arm_without_closed_form_names_the_envelope_command() {
    let shop = Sandbox::new();
    for robot in ["franka_panda", "fanuc_crx10ia"] {
        assert!(field(&shop.json(&["robot", robot]), "envelope").is_null());
        assert!(shop.done(&["robot", robot]).out.contains("`sweetspot envelope`"));
    }
    let size = &shop.json(&["robot", "ur10e"])["envelope"]["size"];
    // The wrist centre moves on a torus about the base axis, which is far inside the reach of 1595 mm.
    let radius = numbers(field(size, "radius_mm"));
    assert!(number(field(size, "extent_within_mm")) == 0.1 && radius[1] < 1595.0, "{size}");
}

/// The file declares modified rows, which begin with the common normal.
#[test]
fn modified_dh_rows_are_printed_as_they_are_written() {
    let shop = Sandbox::new();
    let rows = [(11.0, 0.0), (500.0, -90.0), (400.0, 0.0)];
    let mut file =
        "schema = \"sweetspot/robot/1\"\nunits = { length = \"mm\", angle = \"deg\" }\nname = \"arm\"\n\
        source = \"a test\"\nconvention = \"modified\"\nfootprint = { size_mm = [100, 100] }\n\
        tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }\n"
            .to_string();
    for (k, (l, alpha)) in rows.iter().enumerate() {
        file += &format!(
            "[[joint]]\nname = \"q{k}\"\nq_offset_deg = 0\nr_mm = {k}\nl_mm = {l}\nalpha_deg = {alpha}\n\
             limits_deg = [-90, 90]\n"
        );
    }
    file += "[errors.none]\nkind = \"signed\"\nsource = \"none\"\ndr_mm = [0, 0, 0]\ndl_mm = [0, 0, 0]\n\
             dalpha_deg = [0, 0, 0]\n";
    shop.write("arm.toml", &file);
    let sheet = shop.json(&["robot", "arm.toml"]);
    let told = items(&sheet["joints"]).iter().map(|j| (number(&j["l_mm"]), number(&j["alpha_deg"])));
    assert_eq!(told.collect::<Vec<_>>(), rows);
}

fn area(outline: &Value, [u, v]: [&str; 2]) -> f64 {
    let (u, v) = (numbers(field(outline, u)), numbers(field(outline, v)));
    let n = u.len();
    (0..n).map(|k| u[k] * v[(k + 1) % n] - u[(k + 1) % n] * v[k]).sum::<f64>() / 2e6
}

#[test]
fn envelope_json_has_every_documented_field() {
    let shop = Sandbox::new();
    let args = ["envelope", "hitachi_pw10", "--height", "700", "--height", "1000", "--step", "20"];
    let document = shop.json(&args);
    assert_eq!(text(field(&document, "schema")), "sweetspot/envelope/1");
    assert_eq!(text(field(&document, "frame")), "base");
    assert!(field(&document, "operation").is_null());
    assert_eq!(number(field(&document, "bend_deg")), -90.0);
    let size = field(&document, "size");
    let (volume, error) = (number(field(size, "volume_m3")), number(field(size, "volume_error_m3")));
    assert!(volume > 1.0 && error < 0.02 * volume, "{size}");
    let section = field(&document, "section");
    assert_eq!(number(field(section, "azimuth_deg")), 90.0);
    let plans = items(field(&document, "plans"));
    assert_eq!(plans.len(), 2);
    let drawn = [(section, ["r_mm", "z_mm"]), (&plans[0], ["x_mm", "y_mm"]), (&plans[1], ["x_mm", "y_mm"])];
    for (part, axes) in drawn {
        let outlines = items(field(part, "outlines"));
        let sum: f64 = outlines.iter().map(|o| area(o, axes)).sum();
        assert!((sum - number(field(part, "area_m2"))).abs() < 1e-5, "{sum}");
        outlines.iter().for_each(|o| assert_eq!(area(o, axes) < 0.0, field(o, "hole").as_bool().unwrap()));
    }
    // The section lies within the extent.
    let (radius, height) = (numbers(field(size, "radius_mm")), numbers(field(size, "height_mm")));
    for outline in items(field(section, "outlines")) {
        assert!(numbers(&outline["r_mm"]).iter().all(|r| r.abs() <= radius[1] + 20.0));
        assert!(numbers(&outline["z_mm"]).iter().all(|z| (height[0] - 20.0..=height[1] + 20.0).contains(z)));
    }
    assert_eq!(document, shop.json(&args));
}

#[test]
fn the_envelope_of_a_cell_holds_the_tool_of_its_operation() {
    let shop = Sandbox::new();
    let args = ["envelope", CELL, "--operation", "assembly", "--svg", "e.svg"];
    let document = shop.json(&args);
    assert_eq!(text(field(&document, "operation")), "assembly");
    // The height is 600 mm for the table plus 100 mm of standoff.
    assert_eq!(number(&document["plans"][0]["height_mm"]), 700.0);
    let picture = shop.text("e.svg");
    assert!(picture.contains("section at azimuth 90 deg") && picture.contains("plan at z = 700 mm"));
    let ran = shop.done(&["envelope", CELL]);
    assert!(ran.err.contains("next: sweetspot map ") && ran.out.contains("m^3"), "{}{}", ran.out, ran.err);
    let map = shop.done(&["map", CELL, "--svg", "map.svg"]);
    assert!(map.out.contains("assembly") && shop.text("map.svg").contains("reach at the height of"));
}

#[test]
fn every_text_of_the_envelope_picture_has_a_place_of_its_own() {
    let shop = Sandbox::new();
    shop.done(&["envelope", "hitachi_pw10", "--step", "40", "--svg", "e.svg"]);
    let svg = shop.text("e.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let mut places = std::collections::BTreeMap::new();
    for node in document.descendants().filter(|n| n.tag_name().name() == "text") {
        let place = (node.attribute("x"), node.attribute("y"), node.attribute("text-anchor"));
        let other = places.insert(place, node.text());
        assert!(other.is_none(), "{:?} covers {other:?} at {place:?}", node.text());
    }
    assert!(places.len() > 10);
}
