//! Tests `map --measured`, `report --measured` and `compare --calibrated` with positions of a real arm.

use crate::cli::calibrate::flange_of_ur10;
use crate::cli::sandbox::{Sandbox, items, number, text};
use crate::common::{cell_of_robot, root};
use sweetspot::record::{DocumentKind, MapDocument, RemediesDocument};

fn series(name: &str) -> String {
    root().join(format!("tests/data/ipa_ur10/{name}.csv.gz")).to_string_lossy().into_owned()
}

/// Returns a sandbox with a cell of the UR10 whose errors come from a calibration with 100 positions of
/// series B.
fn shop() -> Sandbox {
    let shop = Sandbox::new();
    let robot = shop.done(&["robot", "ur10", "--toml"]).out;
    let table = shop.done(&["calibrate", "ur10", &series("B"), "--poses", "100", "--elastic", "--toml"]).out;
    shop.write("measured.toml", &format!("{robot}\n{table}"));
    shop.write("cell.toml", &cell_with("measured.toml"));
    shop
}

/// Returns a cell of a UR10 with measured errors, whose table the search may move along x.
fn cell_with(robot: &str) -> String {
    let cell = cell_of_robot("ur10")
        .replace("robots/ur10.toml", robot)
        .replace("bend_deg", "spin_deg = 0\nbend_deg");
    let chosen =
        cell.lines().map(|line| if line.starts_with("errors") { "errors = \"measured\"" } else { line });
    let cell = chosen.collect::<Vec<_>>().join("\n");
    let wide = "x_mm = { min = 400, max = 800, start = 600 }";
    cell.replace("x_mm = 600", wide) + "\n[search]\nideal = true\n"
}

/// Error set with measured errors of two uncertain parameters.
const SMALL: &str = r#"
[errors.measured]
kind = "measured"
source = "ours"
dq_deg = [0, 0.05, -0.04, 0, 0, 0]
dr_mm = [0, 0, 0, 0, 0, 0]
dl_mm = [0, 0.3, 0, 0, 0, 0]
dalpha_deg = [0, 0, 0, 0, 0, 0]
covariance = { parameters = ["dq2", "dq3"], matrix = [[1e-4, 0], [0, 1e-4]] }
"#;

fn valid(kind: DocumentKind, document: &serde_json::Value) {
    let validator = jsonschema::draft7::new(&kind.schema()).unwrap();
    let told: Vec<_> = validator.iter_errors(document).map(|e| e.to_string()).collect();
    assert!(told.is_empty(), "{told:#?}");
}

/// Series D was not measured in the same month as the positions of the calibration.
#[test]
fn a_map_tells_how_well_it_predicts_measured_positions() {
    let shop = shop();
    let d = series("D");
    let map = shop.json(&["map", "cell.toml", "--measured", &d, "--out", "mapped"]);
    valid(DocumentKind::Map, &map);
    let read: MapDocument<'_> = serde_json::from_value(map.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), map);
    let file = &items(&map["measured"])[0];
    assert_eq!((text(&file["file"]), items(&file["positions"]).len()), ("D.csv.gz", 632));
    // The mean error of the nominal arm equals the result of `calibrate --test`.
    assert!((number(&file["measured"]["mean_mm"]) - 0.721).abs() < 1e-3, "{}", file["measured"]);
    assert!(number(&file["residual"]["mean_mm"]) < 0.7 * number(&file["measured"]["mean_mm"]));
    let (constant, varying) = (number(&file["coverage_95"]), number(&file["coverage_95_varying"]));
    assert!(number(&file["rank_correlation"]) > 0.4 && varying > 0.9 && constant < varying, "{varying}");
    let best = number(&file["spots"]["predicted_best"]["measured_mm"]);
    assert!(best < number(&file["spots"]["mean_mm"]), "{best}");
    for p in items(&file["positions"]) {
        let v = |key: &str| items(&p[key]).iter().map(number).collect::<Vec<_>>();
        let off = v("measured_mm").iter().zip(v("predicted_mm")).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        assert!((off.sqrt() - number(&p["residual_mm"])).abs() < 1e-7, "{p}");
    }
    shop.has("mapped", &["measured.csv", "measured.svg", "residuals.svg"]);
    assert_eq!(shop.text("mapped/measured.csv").lines().count(), 633);
    let inputs = shop.document("mapped/manifest.json")["inputs"].clone();
    assert!(items(&inputs).iter().any(|input| text(&input["path"]) == d), "{inputs}");
    let words = shop.done(&["map", "cell.toml", "--measured", &d, "--measured", &d]);
    assert_eq!(words.out.matches("Rank correlation (Spearman)").count(), 2, "{}", words.out);
    assert!(words.err.contains("next: sweetspot report cell.toml --measured"), "{}", words.err);
    // Without measured positions, the map has no such field.
    assert!(shop.json(&["map", "cell.toml"]).get("measured").is_none());
}

/// A cell with the pasted table gives the same prediction as the calibration, including periodic errors.
#[test]
fn a_map_predicts_with_the_periodic_errors_of_a_calibration() {
    let shop = Sandbox::new();
    let (b, d) = (series("B"), series("D"));
    let robot = shop.done(&["robot", "ur10", "--toml"]).out;
    let fit = ["calibrate", "ur10", &b, "--poses", "150", "--elastic", "--harmonics", "12"];
    let table = shop.done(&[&fit[..], &["--toml"]].concat()).out;
    assert_eq!(table.matches("cos_deg").count(), 6, "{table}");
    shop.write("measured.toml", &format!("{robot}\n{table}"));
    shop.write("cell.toml", &cell_with("measured.toml"));
    let map = shop.json(&["map", "cell.toml", "--measured", &d]);
    let file = &items(&map["measured"])[0];
    let test = shop.json(&[&fit[..], &["--test", &d]].concat());
    let tested = &items(&test["tests"])[0];
    let (predicted, own) = (number(&file["residual"]["mean_mm"]), number(&tested["after"]["mean_mm"]));
    assert!((predicted - own).abs() < 0.01, "{predicted} mm, {own} mm");
    let without = fit.iter().filter(|w| !["--harmonics", "12"].contains(w)).copied().collect::<Vec<_>>();
    let without = shop.json(&[&without[..], &["--test", &d]].concat());
    let rigid = number(&items(&without["tests"])[0]["after"]["mean_mm"]);
    assert!(own < 0.9 * rigid, "{own} mm with harmonics, {rigid} mm without");
    let coverage = number(&file["coverage_95_varying"]);
    assert!((coverage - number(&tested["coverage_95"])).abs() < 0.08, "{coverage}, {tested}");
}

/// The measured range of joint 2 excludes every posture of the cell. The ranges of the other joints exclude
/// none.
#[test]
fn a_map_and_a_search_say_which_errors_are_extrapolated() {
    let shop = shop();
    let own = shop.text("measured.toml");
    let robot: Vec<_> = own.lines().filter(|line| !line.starts_with("measured_ranges")).collect();
    assert_eq!(robot.len() + 1, own.lines().count(), "`calibrate` states the ranges");
    let all = "[-180, 180]";
    let with = |second: &str| {
        let ranges =
            format!("[errors.measured]\nmeasured_ranges = [{all}, {second}, {all}, {all}, {all}, {all}]");
        shop.write("measured.toml", &robot.join("\n").replacen("[errors.measured]", &ranges, 1));
    };
    with("[10, 11]");
    let map = shop.done(&["map", "cell.toml"]);
    let said = "usable nodes, the spot among them, are extrapolated, because these joints are outside the ranges of the measured postures: q2";
    assert!(map.err.contains(said), "{}", map.err);
    let document = shop.json(&["map", "cell.toml"]);
    valid(DocumentKind::Map, &document);
    let operation = &items(&document["operations"])[0];
    assert_eq!(operation["extrapolated"]["nodes"], operation["counts"]["ok"], "{operation}");
    let search =
        shop.run(&["search", "cell.toml", "--budget", "200", "--out", "found", "--progress", "none"]);
    assert!(search.err.contains("extrapolated"), "{}", search.err);
    with(all);
    let map = shop.done(&["map", "cell.toml"]);
    assert!(!map.err.contains("extrapolated"), "{}", map.err);
    for (second, fault) in [("[11, 10]", "range 2 of `measured_ranges` is reversed"), ("[1]", "2 numbers")] {
        with(second);
        let refused = shop.run(&["check", "cell.toml"]);
        assert!(refused.code == Some(2) && refused.err.contains(fault), "{}", refused.err);
    }
}

#[test]
fn signed_errors_have_no_coverage_and_tolerances_have_no_direction() {
    let shop = Sandbox::new();
    shop.write("cells/own.toml", &cell_of_robot("ur10"));
    let with = |options: &[&str]| {
        let map = shop.json(&[&["map", "cells/own.toml", "--measured", &series("D")], options].concat());
        map["measured"][0].clone()
    };
    let signed = with(&["--errors", "factory"]);
    assert!(signed["coverage_95"].is_null() && signed["predicted_rms"] == false, "{}", signed["coverage_95"]);
    let tolerances = with(&["--errors", "placeholder", "--reading", "statistical"]);
    assert!(tolerances["coverage_95"].is_number() && tolerances["coverage_95_varying"].is_null());
    assert!(
        items(&tolerances["positions"])
            .iter()
            .all(|p| items(&p["predicted_mm"]).iter().all(|v| number(v).abs() < 1e-6))
    );
}

/// The table contains 40 postures with three visits each, whose positions are 10 um apart.
#[test]
fn repeats_give_accuracy_and_repeatability() {
    let shop = Sandbox::new();
    shop.write("cells/own.toml", &cell_of_robot("ur10"));
    let rows: String = (0..3)
        .flat_map(|visit| (0..40).map(move |k| (visit, k)))
        .map(|(visit, k)| {
            let q = [1.1, 0.7, 0.9, 1.3, 0.4, 0.8].map(|f| 1.5 * (f * f64::from(k * k)).sin());
            let p = flange_of_ur10(&q);
            let z = p.z + 1e-5 * f64::from(visit);
            format!("{},{},{},{z}\n", q.map(|q| q.to_string()).join(","), p.x, p.y)
        })
        .collect();
    shop.write("<b>.csv", &format!("q1,q2,q3,q4,q5,q6,x,y,z\n{rows}"));
    let ran = shop.done(&["map", "cells/own.toml", "--measured", "<b>.csv", "--spot", "1"]);
    assert!(
        ran.out.contains("ISO 9283 over 40 repeated postures") && ran.out.contains("demands 30 visits"),
        "{}",
        ran.out
    );
    assert!(ran.out.contains("over 40 spots"), "{}", ran.out);
    let map = shop.json(&["map", "cells/own.toml", "--measured", "<b>.csv"]);
    let repeats = &map["measured"][0]["repeats"];
    assert_eq!((number(&repeats["least_visits"]), items(&repeats["postures"]).len()), (3.0, 40));
    // The distances from the barycentre are 10, 0 and 10 um, so RP is (2/3 + 3 / sqrt(3)) times 10 um.
    let wanted = 0.01 * (2.0 / 3.0 + 3.0 / 3f64.sqrt());
    assert!((number(&repeats["largest_rp_mm"]) - wanted).abs() < 1e-8, "{repeats}");
    assert!(number(&repeats["largest_ap_mm"]) < 1e-3, "{repeats}");
    // The page has a section about the measurement, with the file name as text.
    let page = shop.run(&["report", "cells/own.toml", "--measured", "<b>.csv", "-o", "page.html"]);
    page.no_panic();
    let html = shop.text("page.html");
    assert!(html.contains("<h2>Measured against predicted</h2>") && html.contains("id=\"measured\""));
    assert!(html.contains("&lt;b&gt;.csv: repeated postures") && !html.contains("<b>.csv"));
    shop.run(&["report", "cells/own.toml", "-o", "plain.html"]).no_panic();
    assert!(!shop.text("plain.html").contains("Measured against predicted"));
}

#[test]
fn wrong_measured_tables_are_refused_with_their_place() {
    let shop = Sandbox::new();
    shop.write("cells/own.toml", &cell_of_robot("ur10"));
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    shop.write("numbers.csv", &format!("{header}0,0,0,0,0,0,1,2,far\n"));
    let noise: String = (0..60)
        .map(|i| format!("{i},{},{},0,0,{i},{},{},{i}\n", i % 7, i % 5, i * 31 % 97, i * 17 % 89))
        .collect();
    shop.write("noise.csv", &format!("{header}{noise}"));
    for command in ["map", "report"] {
        let refused = |table: &str, code: i32, said: &str| {
            let ran = shop.run(&[command, "cells/own.toml", "--measured", table]);
            assert_eq!((ran.code, ran.out.as_str()), (Some(code), ""), "{table}: {}", ran.err);
            ran.no_panic();
            assert!(ran.err.contains(said), "{table}: {}", ran.err);
        };
        refused("nowhere.csv", 3, "cannot read nowhere.csv");
        refused("numbers.csv", 2, "numbers.csv:2:1");
        refused("noise.csv", 2, "noise.csv: the positions do not fit the arm");
    }
    // An arm with other joints cannot read the table.
    let other = shop.run(&["map", "cells/panda_cell.toml", "--measured", &series("D")]);
    assert!(other.code == Some(2) && other.err.contains("D.csv.gz"), "{}", other.err);
    let without = shop.run(&["map", "cells/own.toml", "--spot", "5"]);
    assert!(without.code == Some(2) && without.err.contains("--measured"), "{}", without.err);
    assert_eq!(shop.run(&["map", "cells/own.toml", "--measured", "noise.csv", "--spot", "-1"]).code, Some(2));
}

#[test]
fn a_comparison_says_whether_to_calibrate_to_move_or_both() {
    let shop = Sandbox::new();
    let robot = shop.done(&["robot", "ur10", "--toml"]).out;
    shop.write("small.toml", &format!("{robot}\n{SMALL}"));
    shop.write("cell.toml", &cell_with("small.toml"));
    let args = ["compare", "cell.toml", "--calibrated", "--budget", "12", "--quantity", "rms"];
    let document = shop.json(&args);
    valid(DocumentKind::Remedies, &document);
    let read: RemediesDocument = serde_json::from_value(document.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), document);
    let columns = items(&document["remedies"]);
    let names: Vec<_> = columns.iter().map(|c| text(&c["remedy"])).collect();
    assert_eq!(names, ["as-drawn", "calibrated", "moved", "both"]);
    let values: Vec<_> = columns.iter().map(|c| number(&c["objective"])).collect();
    assert!(values[1] < values[0] && values[2] <= values[0] && values[3] <= values[1], "{values:?}");
    // The first remedy is the unchanged cell, whose objective equals the objective of the map.
    let map = shop.json(&["map", "cell.toml", "--quantity", "rms"]);
    assert_eq!(map["objective"], document["remedies"][0]["objective"]);
    assert_eq!(shop.json(&args), document);
    let words = shop.done(&args);
    assert!(
        words.out.contains(text(&document["advice"])) && words.out.contains("calibrated"),
        "{}",
        words.out
    );
    // No remedy meets a limit of 1 um. Every layout meets a limit of 1 m.
    let never = shop.run(&[&args[..], &["--limit", "0.001"]].concat());
    assert!(
        never.code == Some(1) && never.out.contains("No remedy meets every limit"),
        "{}{}",
        never.out,
        never.err
    );
    let always = shop.done(&[&args[..], &["--limit", "1000"]].concat());
    assert!(always.out.contains("meets every limit as it stands"), "{}", always.out);
}

#[test]
fn remedies_need_one_cell_with_measured_errors() {
    let shop = Sandbox::new();
    let refused = |args: &[&str], said: &str| {
        let ran = shop.run(args);
        assert!(ran.code == Some(2) && ran.err.contains(said), "{args:?}: {}", ran.err);
    };
    let cell = "cells/hitachi_cell.toml";
    refused(&["compare", cell, "--calibrated"], "sweetspot calibrate");
    refused(&["compare", cell, cell, "--calibrated"], "one cell");
    refused(&["compare", cell, "--budget", "3"], "--calibrated");
    refused(&["compare", cell, "--calibrated", "-o", "page.html"], "--out");
}
