//! Tests `calibrate` with measured positions of a real arm (tests/data/ipa_ur10) and with wrong tables.

use crate::cli::sandbox::{Sandbox, items, number, text};
use crate::common::{cell_of_robot, root};
use sweetspot::record::{CalibrationDocument, DocumentKind};

fn series(name: &str) -> String {
    root().join(format!("tests/data/ipa_ur10/{name}.csv.gz")).to_string_lossy().into_owned()
}

/// The other series were measured in other months than the positions of the fit.
#[test]
fn a_calibration_of_a_real_arm_predicts_other_series() {
    let shop = Sandbox::new();
    let (c, a, d) = (series("C"), series("A"), series("D"));
    let document =
        shop.json(&["calibrate", "ur10", &c, "--elastic", "--poses", "300", "--test", &a, "--test", &d]);
    let mean = |of: &serde_json::Value, when: &str| number(&of[when]["mean_mm"]);
    let session = &items(&document["sessions"])[0];
    assert!(mean(session, "after") < 0.55 * mean(session, "before"), "{session}");
    for test in items(&document["tests"]) {
        assert!(mean(test, "after") < 0.9 * mean(test, "before"), "{test}");
        assert!(number(&test["coverage_95"]) > 0.9, "{test}");
    }
    assert_eq!(number(&items(&document["tests"])[0]["poses"]), 11_911.0);
    let validator = jsonschema::draft7::new(&DocumentKind::Calibration.schema()).unwrap();
    assert!(validator.is_valid(&document));
    let read: CalibrationDocument = serde_json::from_value(document.clone()).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), document);
    // The random choice of rows depends only on the seed.
    let again = shop.json(&["calibrate", "ur10", &c, "--elastic", "--poses", "300"]);
    assert_eq!(again["parameters"], document["parameters"]);
    let other = shop.json(&["calibrate", "ur10", &c, "--elastic", "--poses", "300", "--seed", "2"]);
    assert_ne!(other["parameters"], document["parameters"]);
}

/// A cell can use the table with its elastic terms and its covariance in every reading.
#[test]
fn the_table_of_measured_errors_is_ready_for_the_robot_file() {
    let shop = Sandbox::new();
    let run = shop.done(&["calibrate", "ur10", &series("D"), "--elastic", "--toml"]);
    let table = run.out;
    assert!(table.starts_with("[errors.measured]\nkind = \"measured\"\n"), "{table}");
    assert!(!run.err.contains("no elastic terms"), "{}", run.err);
    assert!(
        table.contains("{ joint = 2, link = 3, deg_per_m = ") && table.contains("\"elastic 2 3\""),
        "{table}"
    );
    let robot = shop.done(&["robot", "ur10", "--toml"]).out;
    shop.write("measured.toml", &format!("{robot}\n{table}"));
    let sheet = shop.done(&["robot", "measured.toml"]);
    assert!(sheet.out.contains("measured errors"), "{}", sheet.out);
    let cell = cell_of_robot("ur10").replace("robots/ur10.toml", "measured.toml");
    let chosen =
        cell.lines().map(|line| if line.starts_with("errors") { "errors = \"measured\"" } else { line });
    shop.write("cell.toml", &chosen.collect::<Vec<_>>().join("\n"));
    let signed = shop.done(&["explain", "cell.toml"]);
    assert!(signed.out.contains("elastic 2 3") && signed.out.contains("deg/m"), "{}", signed.out);
    for reading in ["worst-case", "statistical"] {
        shop.done(&["map", "cell.toml", "--reading", reading, "--json"]);
        let budget = shop.done(&["budget", "cell.toml", "--reading", reading]);
        assert!(budget.out.contains("elastic 2 3"), "{}", budget.out);
    }
    let words = shop.done(&["calibrate", "ur10", &series("D")]);
    assert!(
        words.out.contains("Rank ") && words.err.contains("next: sweetspot calibrate ur10"),
        "{}",
        words.err
    );
    assert!(words.err.contains("joints shoulder_pan_joint") && words.err.contains("in rad"), "{}", words.err);
}

/// Table with decimal commas and with column names that a user chose.
const ROWS: &str = "A1;A2;A3;A4;A5;A6;along;across;up\n0,1;0,2;0,3;0,4;0,5;0,6;1,5;2;3\n";

#[test]
fn wrong_tables_are_refused_with_their_place() {
    let shop = Sandbox::new();
    let refused = |name: &str, content: &str, options: &[&str], said: &[&str]| {
        shop.write(name, content);
        let ran = shop.run(&[&["calibrate", "ur10", name][..], options].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{name}: {}", ran.err);
        ran.no_panic();
        for words in said {
            assert!(ran.err.contains(words), "{name}: no {words:?} in {}", ran.err);
        }
    };
    refused("columns.csv", ROWS, &[], &["no column is recognized as `x`", "--column x=NAME", "across"]);
    let named = ["--column", "x=along", "--column", "y=across", "--column", "z=up"];
    refused("few.csv", ROWS, &named, &["few.csv"]);
    refused(
        "unknown.csv",
        ROWS,
        &["--column", "q7=up"],
        &["`q7` is neither a joint of this arm nor x, y or z"],
    );
    refused("missing.csv", ROWS, &["--column", "x=pq"], &["no column `pq`"]);
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    let bad = format!("{header}0,0,0,0,0,0,1,2,3\n0,0,nan,0,0,0,1,2,3\n0,0,0,0,0,0,1,2,far\n");
    refused("numbers.csv", &bad, &[], &["numbers.csv:3:1", "`nan`", "numbers.csv:4:1", "`far`"]);
    refused("short.csv", &format!("{header}0,0,0\n"), &[], &["short.csv:2"]);
    refused("empty.csv", header, &[], &["no row of numbers"]);
    refused("nothing.csv", "", &[], &["no column is recognized as `q1`"]);
    // These positions belong to no arm.
    let random: String = (0..60)
        .map(|i| format!("{i},{},{},0,0,{i},{},{},{}\n", i % 7, i % 5, i * 31 % 97, i * 17 % 89, i))
        .collect();
    refused("noise.csv", &format!("{header}{random}"), &[], &["do not fit the arm"]);
    assert_eq!(shop.run(&["calibrate", "ur10", "nowhere.csv"]).code, Some(3));
    let unknown = shop.run(&["calibrate", "ur10", &series("D"), "--prior", "placehoder"]);
    assert!(unknown.code == Some(2) && unknown.err.contains("did you mean placeholder?"), "{}", unknown.err);
    assert_eq!(shop.run(&["calibrate", "ur1O", "few.csv"]).code, Some(2));
}

#[test]
fn every_parameter_has_a_name_and_a_unit() {
    let shop = Sandbox::new();
    let document = shop.json(&["calibrate", "ur10", &series("B"), "--poses", "100", "--elastic"]);
    let parameters = items(&document["parameters"]);
    let narrow = shop.json(&["calibrate", "ur10", &series("B"), "--prior", "placeholder"]);
    let dl1 = &items(&narrow["parameters"])[0];
    assert!(text(&dl1["name"]) == "dl1" && (number(&dl1["prior"]) - 0.1 / 3.0).abs() < 1e-9, "{dl1}");
    let units: Vec<_> = parameters.iter().map(|p| (text(&p["name"]), text(&p["unit"]))).collect();
    assert!(units.contains(&("dl2", "mm")) && units.contains(&("dbeta2", "deg")), "{units:?}");
    assert!(units.contains(&("q2 carries link 3", "deg/m")), "{units:?}");
    assert_eq!(number(&document["rank"]) as usize + items(&document["unidentified"]).len(), parameters.len());
}

/// The second table has every row twice, once for each of two reflectors.
#[test]
fn a_column_names_the_reflector_of_each_row() {
    let shop = Sandbox::new();
    let header = "q1,q2,q3,q4,q5,q6,x,y,z";
    let rows: Vec<String> = (0..60)
        .map(|i| {
            let q = [1.1, 0.7, 0.9, 1.3, 0.4, 0.8].map(|f| 1.5 * (f * f64::from(i * i)).sin());
            // The reflector is at the flange, and the base frame equals the frame of the tracker.
            let p = flange_of_ur10(&q);
            format!("{},{},{},{}", q.map(|q| q.to_string()).join(","), p.x, p.y, p.z)
        })
        .collect();
    shop.write("one.csv", &format!("{header}\n{}\n", rows.join("\n")));
    let twice: Vec<_> = rows.iter().map(|row| format!("{row},left\n{row},right\n")).collect();
    shop.write("two.csv", &format!("{header},reflector\n{}", twice.concat()));
    let (one, two) =
        (shop.json(&["calibrate", "ur10", "one.csv"]), shop.json(&["calibrate", "ur10", "two.csv"]));
    let before = |of: &serde_json::Value| number(&items(&of["sessions"])[0]["before"]["max_mm"]);
    assert!(before(&one) < 1e-6 && before(&two) < 1e-6, "{one}");
    assert_eq!(number(&items(&two["sessions"])[0]["poses"]), 120.0);
    let words = shop.done(&["calibrate", "ur10", "two.csv"]);
    assert!(words.err.contains("reflectors left, right") && words.err.contains("in m"), "{}", words.err);
}

/// Returns the position of the flange (m) of an arm with the rows of the UR10.
pub fn flange_of_ur10(q: &[f64; 6]) -> nalgebra::Vector3<f64> {
    let frames = q.iter().zip(ROWS_OF_UR10).fold(nalgebra::Isometry3::identity(), |t, (q, (r, l, alpha))| {
        let along = nalgebra::Isometry3::translation(0.0, 0.0, r)
            * nalgebra::Isometry3::rotation(nalgebra::Vector3::z() * *q);
        t * along
            * nalgebra::Isometry3::translation(l, 0.0, 0.0)
            * nalgebra::Isometry3::rotation(nalgebra::Vector3::x() * alpha)
    });
    frames.translation.vector
}

/// Offset r (m), common normal l (m) and twist alpha (rad) of the rows of the UR10.
const ROWS_OF_UR10: [(f64, f64, f64); 6] = [
    (0.1273, 0.0, std::f64::consts::FRAC_PI_2),
    (0.0, -0.612, 0.0),
    (0.0, -0.5723, 0.0),
    (0.163941, 0.0, std::f64::consts::FRAC_PI_2),
    (0.1157, 0.0, -std::f64::consts::FRAC_PI_2),
    (0.0922, 0.0, 0.0),
];

/// The charts have a dot for every position over every joint, and the suggested next command keeps the
/// options of the fit.
#[test]
fn the_residuals_are_drawn_over_every_joint() {
    let shop = Sandbox::new();
    let b = series("B");
    let run = shop.done(&["calibrate", "ur10", &b, "--elastic", "--poses", "60", "--svg", "left.svg"]);
    let svg = shop.text("left.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let dots = document.descendants().filter(|node| node.has_tag_name("circle"));
    // One more circle belongs to the legend.
    assert_eq!(dots.count(), 6 * 60 + 1);
    let next = format!("next: sweetspot calibrate ur10 {b} --elastic --poses 60 --seed 1 --toml");
    assert!(run.err.contains("wrote left.svg") && run.err.contains(&next), "{}", run.err);
}
