//! Tests sweeps: the rows, the refusals, and that a killed and resumed sweep gives the result of an
//! undisturbed sweep.

use crate::cli::sandbox::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Duration;

const SETS: [&str; 4] = [
    "--set",
    "errors=table-2,table-3",
    "--set",
    "equipment.worktable.placement.z_mm=600,{ min = 500, max = 900 }",
];

fn sweep<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["sweep", CELL][..], &SETS, &["--budget", "400", "--out", out], more].concat()
}

/// Returns every file of a folder with its bytes.
fn bytes(shop: &Sandbox, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let files = shop.files(folder).into_iter().filter(|f| !f.starts_with(".tmp"));
    files.map(|f| (f.clone(), shop.read(&format!("{folder}/{f}")))).collect()
}

/// A row equals the result of `search` with a cell file with the same settings. A map of the cell of the row
/// gives the same objective.
#[test]
fn a_sweep_row_equals_the_search_of_that_cell() {
    let shop = Sandbox::new();
    let table = shop.done(&sweep("swept", &["--json"])).document();
    assert_eq!((&table["schema"], &table["combinations"]), (&"sweetspot/sweep/1".into(), &4.into()));
    for (index, row) in items(&table["rows"]).iter().enumerate() {
        let z = if index % 2 == 0 { "600" } else { "{ min = 500, max = 900 }" };
        let errors = ["table-2", "table-3"][index / 2];
        shop.write(
            "cells/one.toml",
            &format!(
                "from = \"hitachi_cell.toml\"\nerrors = \"{errors}\"\n[equipment.worktable.placement]\nz_mm = {z}\n"
            ),
        );
        let out = format!("one-{index}");
        let found = shop.json(&["search", "cells/one.toml", "--budget", "400", "--out", &out]);
        assert_eq!(row["objective"], found["objective_mm"], "row {index}");
        assert_eq!(row["layout"], found["layout"], "row {index}");
        assert_eq!(row["evaluations"], found["evaluations"]);
        // The row has the bound of the search, and no objective is below the bound.
        assert_eq!([&row["bound"], &row["gap_percent"]], [&found["bound"], &found["gap_percent"]]);
        let (bound, objective) = (number(&row["bound"]), number(&row["objective"]));
        assert!(0.0 < bound && bound <= objective, "row {index}: {bound} {objective}");
        assert!((number(&row["gap_percent"]) - 100.0 * (objective / bound - 1.0)).abs() < 1e-4, "{row}");
        for (spot, other) in items(&row["operations"]).iter().zip(items(&found["operations"])) {
            assert_eq!(spot["position_mm"], other["position_mm"]);
            assert_eq!(spot["value"], other["value"]);
        }
        let mapped = shop.json(&["map", &format!("swept/{index:04}.toml")]);
        assert_eq!(mapped["objective_mm"], row["objective"], "the cell of row {index}");
    }
    // The best row has the least objective, and every value of a setting also has a best row.
    let objectives: Vec<f64> = items(&table["rows"]).iter().map(|r| number(&r["objective"])).collect();
    let least = |of: &[usize]| *of.iter().min_by(|a, b| objectives[**a].total_cmp(&objectives[**b])).unwrap();
    assert_eq!(table["best"], least(&[0, 1, 2, 3]));
    let of: Vec<_> = items(&table["best_of"]).iter().map(|g| g["best"].as_u64().unwrap() as usize).collect();
    assert_eq!(of, [least(&[0, 1]), least(&[2, 3]), least(&[0, 2]), least(&[1, 3])]);
    let csv = shop.text("swept/table.csv");
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column =
        |name: &str| header.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{name}: {header:?}"));
    let second: Vec<&str> = csv.lines().nth(3).unwrap().split(',').collect();
    assert_eq!(second[column("errors")], "table-3");
    assert_eq!(second[column("objective")].parse::<f64>().unwrap(), objectives[2]);
    assert_eq!(second[column("bound")].parse::<f64>().unwrap(), number(&items(&table["rows"])[2]["bound"]));
    assert_eq!(csv.lines().count(), 5);
}

#[test]
fn any_number_of_jobs_and_any_kill_end_in_the_same_bytes() {
    let shop = Sandbox::new();
    shop.done(&sweep("whole", &["--jobs", "1"]));
    let whole = bytes(&shop, "whole");
    shop.has("whole", &["plan.json", "0000.json", "0003.json", "table.csv", "table.json", "manifest.json"]);
    shop.done(&sweep("four", &["--jobs", "4"]));
    assert!(bytes(&shop, "four") == whole, "four jobs");
    // Each sweep is killed at an arbitrary moment, twice, and resumed in both ways.
    for (k, wait) in [30, 60, 90, 120, 160, 200, 250, 300].into_iter().enumerate() {
        let out = format!("killed-{k}");
        for wait in [wait, wait / 2] {
            let mut child = shop.command(&sweep(&out, &["--jobs", "2"])).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(wait));
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let resumes = k % 2 == 0 && shop.path(&format!("{out}/plan.json")).exists();
        let again = if resumes { vec!["sweep", "--resume", &out] } else { sweep(&out, &[]) };
        shop.done(&again);
        assert!(bytes(&shop, &out) == whole, "killed after {wait} ms: {:?}", shop.files(&out));
    }
}

#[test]
fn a_finished_combination_is_not_searched_again() {
    let shop = Sandbox::new();
    shop.done(&sweep("swept", &[]));
    // The marked file has a value that no run computes.
    let marked =
        resealed(&shop.text("swept/0001.json").replace("\"evaluations\": 400", "\"evaluations\": 7"));
    shop.write("swept/0001.json", &marked);
    std::fs::remove_file(shop.path("swept/0002.json")).unwrap();
    let table = shop.json(&["sweep", "--resume", "swept"]);
    let evaluations: Vec<_> = items(&table["rows"]).iter().map(|r| r["evaluations"].clone()).collect();
    assert_eq!(evaluations, [400, 7, 400, 400]);
    // A truncated file is not accepted.
    shop.write("swept/0001.json", &marked[..marked.len() / 2]);
    assert_eq!(shop.json(&["sweep", "--resume", "swept"])["rows"][1]["evaluations"], 400);
}

#[test]
fn single_combinations_merge_into_the_same_sweep() {
    let shop = Sandbox::new();
    shop.done(&sweep("whole", &[]));
    for index in ["2", "0-1,1", "3"] {
        shop.done(&sweep("parts", &["--only", index]));
        assert!(!shop.path("parts/table.csv").exists());
    }
    shop.done(&["sweep", "--resume", "parts"]);
    assert!(bytes(&shop, "parts") == bytes(&shop, "whole"));
    let beyond = shop.run(&sweep("parts", &["--only", "4"]));
    assert_eq!(beyond.code, Some(2));
    assert!(beyond.err.contains("0 to 3"), "{}", beyond.err);
    for (wrong, said) in
        [("0-4", "no combination 4"), ("3-1", "write 1-3"), ("1,", "0-9,17"), ("-", "0-9,17")]
    {
        let ran = shop.run(&sweep("parts", &[&format!("--only={wrong}")]));
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{wrong}: {}", ran.err);
        assert!(ran.err.contains(said), "{wrong}: {}", ran.err);
    }
}

#[test]
fn a_changed_sweep_is_not_resumed_and_names_the_change() {
    let shop = Sandbox::new();
    shop.done(&sweep("swept", &[]));
    let before = bytes(&shop, "swept");
    for (more, named) in [
        (&["--seed", "5"][..], "seed or budget"),
        (&["--map"], "search or map"),
        (&["--set", "clearance_mm=1"], "the sets"),
        (&["--solver", "particle-swarm"], "the solver"),
    ] {
        let ran = shop.run(&sweep("swept", more));
        assert_eq!(ran.code, Some(2), "{more:?}: {}", ran.err);
        assert!(ran.err.contains(&format!("these differ: {named}\n")), "{}", ran.err);
    }
    let robot = shop.text("cells/robots/hitachi_pw10.toml");
    shop.write("cells/robots/hitachi_pw10.toml", &(robot + "# a remark\n"));
    for args in [sweep("swept", &[]), vec!["sweep", "--resume", "swept"]] {
        let ran = shop.run(&args);
        assert_eq!(ran.code, Some(2), "{}", ran.err);
        assert!(ran.err.contains("these differ: robots/hitachi_pw10.toml\n"), "{}", ran.err);
    }
    assert!(bytes(&shop, "swept") == before, "a refused sweep wrote something");
    // A folder with other files is refused.
    shop.write("cells/plan.json", "{}");
    for (args, said) in [
        (sweep("cells/robots", &[]), "is not empty"),
        (vec!["sweep", "--resume", "cells/robots"], "not the folder of a sweep"),
        (vec!["sweep", "--resume", "cells"], "is not the plan"),
    ] {
        let ran = shop.run(&args);
        assert_eq!(ran.code, Some(2), "{}", ran.err);
        assert!(ran.err.contains(said), "{}", ran.err);
    }
}

/// All faults of all combinations are reported before the first combination runs. Each fault is reported once
/// and names the argument.
#[test]
fn faults_of_a_sweep_name_the_setting() {
    let shop = Sandbox::new();
    let cases: [(&[&str], &[&str]); 14] = [
        (&["errors=tabel-3,table-2"], &["--set errors=tabel-3: error: ", "did you mean \"table-3\"?\n"]),
        (
            &["equipment.worktabel.placement.z_mm=600"],
            &["--set equipment.worktabel.placement.z_mm=600: error: ", "did you mean equipment.worktable?"],
        ),
        (&["equipment.worktable.placement.z=600"], &["unknown key `z`", "did you mean `z_mm`?"]),
        (&["clearence_mm=1"], &["unknown key `clearence_mm`", "did you mean `clearance_mm`?"]),
        (&["clearance_mm=1,ten"], &["--set clearance_mm=ten: error: ", "1 error;"]),
        (&["robot.from=robots/nobody.toml"], &["--set robot.from=robots/nobody.toml: error: cannot read"]),
        (&["robot.from=../robots/ur5e.toml"], &["leaves the folder"]),
        (
            &["clearance_mm=-1,2", "operation.assembly.sense=xy,xyzz,w"],
            &["clearance_mm=-1: ", "sense=xyzz: ", "sense=w: ", "3 errors; nothing was done"],
        ),
        (&["clearance_mm"], &["--set clearance_mm: error: there is no ="]),
        (&["a..b=3"], &["not the path of a key"]),
        (&["clearance_mm=1,,2"], &["a value is missing"]),
        (&["search.seed=1", "search.seed=2"], &["search.seed is set already"]),
        (
            &["robot.base={ x_mm = 0, y_mm = 0, z_mm = 0 }", "robot.base.x_mm=2"],
            &["robot.base is set already"],
        ),
        (&["from=hitachi_paper.toml"], &["cannot set the key `from`"]),
    ];
    for (sets, said) in cases {
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let args: Vec<&str> = ["sweep", CELL, "--out", "swept"].into_iter().chain(sets).collect();
        let ran = shop.run(&args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        for word in said {
            assert!(ran.err.contains(word), "{args:?}: no `{word}` in {}", ran.err);
        }
        ran.no_panic();
    }
    let hundred: Vec<String> = (0..101).map(|k| k.to_string()).collect();
    let set = |path: &str| format!("{path}={}", hundred.join(","));
    let ran = shop.run(&["sweep", CELL, "--set", &set("clearance_mm"), "--set", &set("search.seed")]);
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.err.contains("the values of --set make 101 times 101 combinations, more than the allowed 10000"),
        "{}",
        ran.err
    );
    // A fault of only some combinations names these combinations.
    let sets = ["--set", "errors=table-2", "--set", "robot.from=robots/hitachi_pw10.toml,robots/ur5e.toml"];
    let ran = shop.run(&[&["sweep", CELL, "--out", "swept"][..], &sets].concat());
    assert!(
        ran.err.contains("in 1 of 2 combinations, first with errors=table-2 robot.from=robots/ur5e.toml"),
        "{}",
        ran.err
    );
    for args in [&["sweep", CELL][..], &["sweep", "--set", "clearance_mm=1"], &["sweep"]] {
        assert_eq!(shop.run(args).code, Some(2), "{args:?}");
    }
    assert!(!shop.path("swept").exists() && !shop.path("results").exists(), "something was written");
}

/// Lists, tables, quoted names, keys that the file does not have, and another robot can be set.
#[test]
fn every_kind_of_value_can_be_set() {
    let shop = Sandbox::new();
    shop.write(
        "cells/quoted.toml",
        "from = \"hitachi_paper.toml\"\n[equipment.\"side, table\"]\nfrom = \"equipment/bench.toml\"\n\
         placement = { x_mm = 4000, y_mm = 0, z_mm = 0 }\n",
    );
    let rows = |sets: &[&str]| {
        let out = format!("out-{}", shop.files("").len());
        let args: Vec<&str> = ["sweep", "cells/quoted.toml", "--map", "--json", "--out", &out]
            .into_iter()
            .chain(sets.iter().flat_map(|set| ["--set", set]))
            .collect();
        items(&shop.done(&args).document()["rows"]).to_vec()
    };
    let coordinate = |row: &Value, name: &str, axis: &str| number(&row["layout"][name][axis]);
    let placed = rows(&["equipment.\"side, table\".placement.x_mm=4000,-4100.5"]);
    assert_eq!(
        placed.iter().map(|r| coordinate(r, "side, table", "x_mm")).collect::<Vec<_>>(),
        [4000.0, -4100.5]
    );
    let whole =
        rows(&["equipment.worktable.placement={ x_mm = 100, y_mm = 1200, z_mm = 1350, yaw_deg = 5 }"]);
    assert_eq!(
        ["x_mm", "y_mm", "yaw_deg"].map(|axis| coordinate(&whole[0], "worktable", axis)),
        [100.0, 1200.0, 5.0]
    );
    let new = rows(&[
        "equipment.rack={ from = \"equipment/bench.toml\", placement = { x_mm = 0, y_mm = -4000, z_mm = 0 } }",
    ]);
    assert_eq!(coordinate(&new[0], "rack", "y_mm"), -4000.0);
    // The spot of a finer grid is at least as good, because the grid [20, 16] contains every node of [10, 8].
    let grids = rows(&["operation.mapping.grid=[10,8],[20, 16]"]);
    assert_eq!(grids[0]["set"]["operation.mapping.grid"], serde_json::json!([10, 8]));
    assert!(number(&grids[1]["objective"]) <= number(&grids[0]["objective"]));
    assert!((number(&grids[0]["objective"]) - 3.768569).abs() < 1e-6, "{}", grids[0]);
    // One limit is below the error of 3.77 mm, and the other is above it.
    let limits = rows(&["operation.mapping.limit_mm=3.7,3.8"]);
    let met: Vec<_> = limits.iter().map(|r| r["operations"][0]["limit_met"].clone()).collect();
    assert_eq!(met, [false, true]);
    // One command combines robots with error sets, whose names differ from robot to robot.
    let robots = rows(&[
        "robot.from=robots/ur5e.toml,robots/ur10e.toml",
        "errors=placeholder",
        "robot.base={ x_mm = 0, y_mm = 0, z_mm = 900 }",
    ]);
    let direct = |robot: &str| {
        shop.write(
            "cells/direct.toml",
            &format!(
                "from = \"quoted.toml\"\nerrors = \"placeholder\"\n[robot]\nfrom = \"robots/{robot}.toml\"\n\
                 base = {{ z_mm = 900, x_mm = 0, y_mm = 0 }}\n"
            ),
        );
        shop.json(&["map", "cells/direct.toml"])["objective"].clone()
    };
    for (row, robot) in robots.iter().zip(["ur5e", "ur10e"]) {
        assert_eq!(row["objective"], direct(robot), "{robot}");
    }
}

#[test]
fn a_sweep_exits_1_only_if_no_combination_is_feasible_and_within_its_limits() {
    let shop = Sandbox::new();
    let limited = |z: &'static str, out: &'static str, limit: &'static str| {
        vec!["sweep", CELL, "--map", "--set", z, "--set", limit, "--out", out]
    };
    let args = |z: &'static str, out: &'static str| limited(z, out, "operation.picking.limit_mm=1");
    let met = limited("equipment.worktable.placement.z_mm=9000,600", "met", "operation.picking.limit_mm=100");
    assert_eq!(shop.run(&met).code, Some(0));
    let none = shop.run(&args("equipment.worktable.placement.z_mm=9000,9100", "none"));
    assert_eq!(none.code, Some(1), "{}", none.err);
    assert!(none.out.contains("not feasible") && !none.err.contains("next: "), "{}{}", none.out, none.err);
    let row = shop.document("none/0001.json");
    assert!(row["reasons"].to_string().contains("assembly has no usable node"), "{row}");
    assert!(!shop.path("none/0001.toml").exists());
    let some = shop.run(&args("equipment.worktable.placement.z_mm=9000,600", "some"));
    assert_eq!(some.code, Some(1), "{}", some.err);
    let marked: Vec<_> = some.out.lines().filter(|l| l.starts_with('*')).collect();
    assert!(marked.len() == 1 && marked[0].contains("0001"), "{}", some.out);
    assert!(some.out.contains("missed") && some.out.contains("0 of 1"), "{}", some.out);
    assert!(some.err.contains("next: sweetspot map some/0001.toml"), "{}", some.err);
    let manifest = shop.document("some/manifest.json");
    for output in items(&manifest["outputs"]) {
        let path = format!("some/{}", text(&output["path"]));
        assert_eq!(text(&output["sha256"]), sha256(&shop.read(&path)), "{path}");
    }
    let inputs = items(&manifest["inputs"]).iter().map(|i| text(&i["path"]));
    for path in inputs {
        assert_eq!(
            shop.read(&format!("some/inputs/{path}")),
            std::fs::read(crate::common::root().join("cells").join(path)).unwrap()
        );
    }
}
