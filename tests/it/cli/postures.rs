//! Tests `budget` and `explain`, the commands about one posture.

use crate::cli::sandbox::*;
use serde_json::Value;

/// Cell of these tests. It has no assumed margins, so nodes next to joint limits are usable.
const CELL: &str = IDEAL;

/// Cell with a robot that has no closed-form inverse kinematics here, and a table.
const UR10: &str = "schema = \"sweetspot/cell/1\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
                    errors = \"factory\"\ncollision = false\nmodel = \"linear\"\n\
                    [robot]\nfrom = \"robots/ur10.toml\"\nbase = { x_mm = 100, y_mm = 0, z_mm = 0, yaw_deg = 30 }\n\
                    [equipment.worktable]\nfrom = \"equipment/worktable.toml\"\n\
                    placement = { x_mm = 0, y_mm = 800, z_mm = 200 }\n\
                    [operation.work]\non = \"worktable\"\ngrid = [2, 2]\nbend_deg = -90\nsense = \"xyz\"\n";

/// Returns the sum of the vectors under a key.
fn sum(list: &[Value], key: &str) -> [f64; 3] {
    list.iter().map(|item| numbers(&item[key])).fold([0.0; 3], |s, v| [s[0] + v[0], s[1] + v[1], s[2] + v[2]])
}

fn size(v: &[f64]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

// --- budget -------------------------------------------------------------------------------------

#[test]
fn the_shares_of_a_budget_add_up_to_its_total() {
    let shop = Sandbox::new();
    for flags in [
        &[][..],
        &["--reading", "worst-case", "--model", "linear"],
        &["--quantity", "rms", "--registration", "best-fit"],
        &["--quantity", "yield", "--limit", "6"],
        &["--sense", "rotation", "--reading", "worst-case"],
        &["--errors", "table-3-tolerance", "--sense", "x"],
        &["--operation", "assembly", "--registration", "taught", "--at", "4,1"],
    ] {
        let document = shop.json(&[&["budget", CELL], flags].concat());
        assert_eq!(document["schema"], "sweetspot/budget/1");
        for operation in items(&document["operations"]) {
            let parameters = items(&operation["parameters"]);
            for key in ["share_of_worst", "share_of_variance"] {
                let shares: Vec<f64> = parameters.iter().map(|p| number(&p[key])).collect();
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{flags:?} {key}: {shares:?}");
            }
            let sorted = match text(&document["reading"]) {
                "statistical" => "share_of_variance",
                _ => "share_of_worst",
            };
            let shares: Vec<f64> = parameters.iter().map(|p| number(&p[sorted])).collect();
            assert!(shares.windows(2).all(|w| w[0] >= w[1]), "{flags:?}: {shares:?}");
            for tried in items(&operation["tighten"]) {
                assert!(number(&tried["to"]) <= number(&tried["of"]), "{flags:?}: {tried}");
                assert!((0.0..=100.0).contains(&number(&tried["cut_percent"])));
            }
            let total = &operation["total"];
            assert!(number(&total["p99"]) >= number(&total["p95"]));
            assert!(number(&total["worst_linear"]) >= number(&total["p95"]) * 0.5);
        }
    }
}

/// Halving a tolerance reduces the linear worst case by at most half the share of this tolerance. If the
/// share is small, the reduction is nearly half the share.
#[test]
fn the_gain_of_tightening_follows_the_shares() {
    let shop = Sandbox::new();
    let document = shop.json(&["budget", CELL, "--reading", "worst-case", "--model", "linear"]);
    for operation in items(&document["operations"]) {
        let parameters = items(&operation["parameters"]);
        for tried in items(&operation["tighten"]) {
            let halved = items(&tried["halved"]);
            let share: f64 = parameters
                .iter()
                .filter(|p| halved.contains(&p["parameter"]))
                .map(|p| number(&p["share_of_worst"]))
                .sum();
            let cut = number(&tried["cut_percent"]) / 100.0;
            assert!(cut <= share / 2.0 + 1e-9 && cut > 0.4 * share, "{cut} of {share}");
        }
    }
}

#[test]
fn the_budget_of_a_signed_set_adds_up_to_its_linear_error() {
    let shop = Sandbox::new();
    let document = shop.json(&["budget", CELL]);
    let map = shop.json(&["map", CELL]);
    for (budget, mapped) in items(&document["operations"]).iter().zip(items(&map["operations"])) {
        let terms = sum(items(&budget["parameters"]), "linear_term_mm");
        assert!(near(&terms, &numbers(&mapped["best"]["linear_error_mm"]), 1e-7), "{terms:?}");
        assert_eq!(budget["position_mm"], mapped["best"]["position_mm"]);
        assert_eq!(budget["total"]["worst"], mapped["best"]["worst_mm"]["xy"]);
        assert_eq!(budget["total"]["p95"], mapped["best"]["p95_mm"]["xy"]);
    }
}

#[test]
fn the_budget_names_the_source_to_tighten_first() {
    let shop = Sandbox::new();
    let ran = shop.done(&["budget", CELL, "--operation", "picking"]);
    assert!(ran.out.contains("picking on conveyor: node ("), "{}", ran.out);
    assert!(!ran.out.contains("assembly"), "{}", ran.out);
    assert!(ran.out.contains("halving dalpha2 cuts the worst case by "), "{}", ran.out);
    assert!(
        ran.err.contains("next: sweetspot explain cells/hitachi_ideal.toml --operation picking"),
        "{}",
        ran.err
    );
    let worst = shop.done(&["budget", CELL, "--reading", "worst-case"]);
    assert!(worst.err.contains("read as plus-or-minus"), "{}", worst.err);
    assert!(worst.err.contains("--reading worst-case"), "{}", worst.err);
}

#[test]
fn a_taught_point_has_no_error_left() {
    let shop = Sandbox::new();
    let taught = ["--registration", "taught", "--reading", "worst-case"];
    let at = ["--operation", "assembly", "--at", "0,2"];
    let ran = shop.done(&[&["budget", CELL][..], &at, &taught].concat());
    assert!(ran.out.contains("this point was touched to teach the frame: no error remains"), "{}", ran.out);
    assert!(!ran.out.contains("halving"), "{}", ran.out);
    // A taught point cannot be the spot, so the least error is at another node.
    let map = shop.done(&[&["map", CELL][..], &taught].concat());
    assert!(map.out.contains("at node (0, 3)") && !map.out.contains("0.000000 mm"), "{}", map.out);
}

#[test]
fn budget_and_explain_refuse_bad_nodes() {
    let shop = Sandbox::new();
    let one = ["--operation", "assembly"];
    for command in ["budget", "explain"] {
        for (args, code, why) in [
            (&["--at", "99,99"][..], 2, "i goes from 0 to 10, j from 0 to 8"),
            (&["--at", "11,0"], 2, "no node (11, 0)"),
            (&["--at", "foo"], 2, "expected `best`, or"),
            (&["--at", "3"], 2, "expected `best`, or"),
            (&["--at", "-1,2"], 2, "expected `best`, or"),
            (&["--at", "1,2,3"], 2, "expected `best`, or"),
            (&["--at", "99999999999999999999,1"], 2, "expected `best`, or"),
            (&["--at", "18446744073709551615,18446744073709551615"], 2, "i goes from 0"),
            (&["--at", "0,0"], 1, "needs -32.07 deg, but its limit is -25 deg"),
        ] {
            let ran = shop.run(&[&[command, CELL][..], &one, args].concat());
            assert_eq!((ran.code, ran.out.as_str()), (Some(code), ""), "{command} {args:?}: {}", ran.err);
            assert!(ran.err.contains(why), "{command} {args:?}: {}", ran.err);
        }
        let ran = shop.run(&[command, CELL, "--operation", "asembly"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""));
        assert!(ran.err.contains("no operation `asembly`; did you mean assembly?"), "{}", ran.err);
        // A node belongs to an operation, which the command must name.
        let ran = shop.run(&[command, CELL, "--at", "1,1"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""));
        assert!(ran.err.contains("add --operation and one of: assembly, picking"), "{}", ran.err);
        // In this cell, no node is in reach.
        shop.write("cells/far.toml", BEYOND_REACH);
        let ran = shop.run(&[command, "cells/far.toml"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(1), ""), "{}", ran.err);
        assert!(ran.err.contains("assembly has no usable node: 99 out of reach"), "{}", ran.err);
        // No axis of this arm rotates the tool about itself.
        shop.write("cells/spin.toml", "from = \"hitachi_cell.toml\"\noperation.assembly.spin_deg = 0\n");
        let ran = shop.run(&[command, "cells/spin.toml"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{}", ran.err);
        assert!(
            ran.err.contains("operation assembly: no joint of the arm rotates the tool about the tool axis"),
            "{}",
            ran.err
        );
    }
}

#[test]
fn a_colliding_node_exits_1_and_names_what_it_touches() {
    let shop = Sandbox::new();
    let map = shop.json(&["map", CELL]);
    let nodes = items(&map["operations"][0]["nodes"]);
    let hit = nodes.iter().find(|n| n["status"] == "collision").unwrap();
    let at = format!("{},{}", hit["i"], hit["j"]);
    let ran = shop.run(&["budget", CELL, "--operation", "assembly", "--at", &at]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(1), ""));
    assert!(ran.err.contains(text(&hit["reason"])), "{}", ran.err);
}

#[test]
fn commands_work_from_another_folder() {
    let shop = Sandbox::new();
    std::fs::create_dir(shop.path("elsewhere")).unwrap();
    let cell = format!("../{CELL}");
    for command in ["budget", "explain", "readings"] {
        let here = shop.done(&[command, CELL]);
        let there =
            ran(shop.command(&[command, &cell]).current_dir(shop.path("elsewhere")).output().unwrap());
        assert_eq!((there.code, &there.out), (Some(0), &here.out), "{}", there.err);
    }
}

// --- explain ------------------------------------------------------------------------------------

/// Checks that the numbers of an explanation are consistent.
fn check_explanation(e: &Value) {
    let parameters = items(&e["parameters"]);
    let linear = numbers(&e["linear"]["position_mm"]);
    assert!(near(&sum(parameters, "linear_term_mm"), &linear, 1e-6), "the terms are not the linear error");
    let second: Vec<f64> = linear
        .iter()
        .zip(numbers(&e["second_order_correction"]["position_mm"]))
        .map(|(a, b)| a + b)
        .collect();
    assert!(near(&second, &numbers(&e["second_order"]["position_mm"]), 1e-8));
    let nonlinear = numbers(&e["nonlinear"]["position_mm"]);
    let off: Vec<f64> = linear.iter().zip(&nonlinear).map(|(a, b)| a - b).collect();
    let percent = number(&e["guard"]["linear_off_percent"]);
    assert!((percent - 100.0 * size(&off) / size(&nonlinear)).abs() < 1e-4 * percent.max(1.0));
    for p in parameters {
        let mut effect = [0.0; 3];
        for motion in items(&p["motions"]) {
            let (w, o) = (numbers(&motion["axis_base"]), numbers(&motion["lever_base_mm"]));
            let cross = [w[1] * o[2] - w[2] * o[1], w[2] * o[0] - w[0] * o[2], w[0] * o[1] - w[1] * o[0]];
            let unit = match text(&motion["kind"]) {
                "turn" => cross.map(|c| c.to_radians()),
                _ => [w[0], w[1], w[2]],
            };
            (0..3).for_each(|k| effect[k] += number(&motion["factor"]) * unit[k]);
        }
        assert!(near(&effect, &numbers(&p["effect_base_mm_per_unit"]), 1e-7), "{p}");
    }
    let rows: f64 = items(&e["sense_rows"]).iter().map(|r| number(&r["value"]).powi(2)).sum();
    assert!((rows.sqrt() - number(&e["total"]["error"])).abs() < 1e-7);
}

#[test]
fn the_numbers_of_an_explanation_are_consistent() {
    let shop = Sandbox::new();
    for (cell, flags) in [
        (CELL, &[][..]),
        (PAPER, &["--at", "5,4"]),
        ("cells/hitachi_paper_parallelogram.toml", &[]),
        (CELL, &["--operation", "picking", "--reading", "worst-case", "--model", "second-order"]),
        (CELL, &["--registration", "best-fit", "--sense", "xy@tool", "--quantity", "p99"]),
        (
            CELL,
            &[
                "--operation",
                "assembly",
                "--at",
                "4,1",
                "--registration",
                "taught",
                "--sense",
                "rotation@surface",
            ],
        ),
        (CELL, &["--joints", "-12.5,3,40,-7", "--model", "linear"]),
        (CELL, &["--joints=1,2,3,4", "--registration", "taught"]),
    ] {
        let e = shop.json(&[&["explain", cell], flags].concat());
        assert_eq!(e["schema"], "sweetspot/explain/1");
        check_explanation(&e);
    }
}

#[test]
fn an_explanation_agrees_with_map() {
    let shop = Sandbox::new();
    for flags in [&[][..], &["--reading", "worst-case", "--registration", "best-fit"], &["--quantity", "p95"]]
    {
        let map = shop.json(&[&["map", CELL], flags].concat());
        let e = shop.json(&[&["explain", CELL, "--operation", "assembly"], flags].concat());
        let best = &map["operations"][0]["best"];
        for key in ["position_mm", "joints_deg", "value"] {
            assert_eq!(e[key], best[key], "{flags:?} {key}");
        }
        assert_eq!(e["linear"]["position_mm"], best["linear_error_mm"]);
        assert_eq!(e["nonlinear"]["position_mm"], best["nonlinear_error_mm"]);
        assert_eq!(
            (&e["total"]["worst"], &e["total"]["rms"]),
            (&best["worst_mm"]["xy"], &best["rms_mm"]["xy"])
        );
        let joints: Vec<String> = numbers(&e["joints_deg"]).iter().map(f64::to_string).collect();
        let again = shop.json(&[&["explain", CELL, "--joints", &joints.join(",")], flags].concat());
        assert!(near(&numbers(&again["position_mm"]), &numbers(&e["position_mm"]), 1e-6));
        assert!((number(&again["value"]) - number(&e["value"])).abs() < 1e-6);
        assert_eq!(again["node"], Value::Null);
    }
}

#[test]
fn explain_accepts_joints_of_any_robot() {
    let shop = Sandbox::new();
    shop.write("cells/ur.toml", UR10);
    let joints = ["--joints", "10,-80,70,-60,-90,20"];
    let e = shop.json(&[&["explain", "cells/ur.toml"][..], &joints].concat());
    check_explanation(&e);
    assert_eq!(items(&e["dh"]).len(), 6);
    // The error of offsets of a metre that nearly cancel cannot be linearized.
    assert_eq!(e["guard"]["trusted"], false);
    let ran = shop.done(&[&["explain", "cells/ur.toml"][..], &joints].concat());
    assert!(ran.out.contains("do NOT trust the linear model here"), "{}", ran.out);
    assert!(ran.err.contains("warning: the linear model cannot be trusted"), "{}", ran.err);
    shop.done(&[&["explain", "cells/ur.toml", "--registration", "best-fit"][..], &joints].concat());
    let taught =
        shop.done(&[&["explain", "cells/ur.toml", "--registration", "taught"][..], &joints].concat());
    assert!(taught.out.contains("subtracted: the taught surface frame"), "{}", taught.out);
}

#[test]
fn bad_joints_exit_2_and_joints_beyond_limits_are_reported() {
    let shop = Sandbox::new();
    for (joints, why) in [
        ("1,2,3", "--joints has 3 values, but the robot has 4 joints"),
        ("1,2,3,4,5", "--joints has 5 values"),
        ("1,2,3,nan", "it must be a finite number"),
        ("1,2,3,inf", "it must be a finite number"),
        ("1,2,3,x", "it is not a number"),
        ("1,2,,4", "it is not a number"),
        ("", "it is not a number"),
    ] {
        let ran = shop.run(&["explain", CELL, "--joints", joints]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{joints}: {}", ran.err);
        assert!(ran.err.contains(why), "{joints}: {}", ran.err);
    }
    let both = shop.run(&["explain", PAPER, "--joints", "0,0,0,0", "--at", "5,4"]);
    assert_eq!((both.code, both.out.as_str()), (Some(2), ""));
    let beyond = shop.done(&["explain", PAPER, "--joints", "-200,0,0,1e6"]);
    assert!(beyond.err.contains("note: joint q1 (waist) is outside its limits"), "{}", beyond.err);
    assert!(beyond.out.contains("outside its limits"), "{}", beyond.out);
    // The paper's initial posture.
    let e = shop.json(&["explain", PAPER, "--joints", "0,0,0,0"]);
    assert!(near(&numbers(&e["position_mm"]), &[0.0, 1250.0, 1350.0], 1e-9));
    assert!(near(&numbers(&e["linear"]["position_mm"]), &[1.691003, 3.0, 2.0], 1e-6));
}

#[test]
fn a_printed_explanation_has_every_step() {
    let shop = Sandbox::new();
    let ran = shop.done(&["explain", CELL]);
    for step in [
        "1. Links",
        "2. Frames",
        "3. Each error",
        "4. Effect",
        "5. Models",
        "6. Sense xy",
        "7. As plus-or-minus",
    ] {
        assert!(ran.out.contains(step), "{step}: {}", ran.out);
    }
    assert!(ran.out.contains("turn about x of frame 1") && ran.out.contains("slide along z of frame 0"));
    assert!(
        ran.err.contains("note: showing assembly; choose another with --operation: picking"),
        "{}",
        ran.err
    );
    assert!(ran.err.contains("next: sweetspot budget"), "{}", ran.err);
    let taken = shop.done(&["explain", CELL, "--registration", "best-fit"]);
    assert!(taken.out.contains("subtracted: the best-fitted base frame"), "{}", taken.out);
    assert!(!ran.out.contains("subtracted: "), "{}", ran.out);
}
