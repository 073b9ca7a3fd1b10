//! Tests the numbers of the command line: every numeric option rejects the values that a file rejects.

use super::sandbox::{CELL, PAPER, Sandbox};

/// Placeholders of options whose values are numbers, each with the hostile values that are in range.
const NUMERIC: [(&str, &[&str]); 18] = [
    ("MM", &[]),
    ("DEG", &["1e-320", "-0"]),
    ("SECONDS", &["1e-320", "-0"]),
    ("SHARE", &["1e-320", "-0"]),
    ("Q1,Q2,...", &["1e-320", "-0"]),
    ("N", &[]),
    ("ORDER", &[]),
    ("SEED", &[]),
    ("INDICES", &[]),
    ("LEASE", &[]),
    ("CHUNK", &[]),
    ("TIME", &[]),
    ("JOBS", &[]),
    ("THREADS", &[]),
    ("PX", &[]),
    ("PORT", &[]),
    ("best|I,J", &[]),
    ("X,Y,Z", &[]),
];

/// Placeholders of options whose values are not numbers.
const OTHERS: [&str; 24] = [
    "CELL",
    "DIR",
    "ENGINE",
    "ERRORS",
    "FILE",
    "FORMAT",
    "FRAME",
    "GOAL,GOAL,...",
    "LINK",
    "MODEL",
    "NAME",
    "NAME=DIR",
    "OPERATION|home",
    "PATH=A,B,...",
    "PATH=VALUE",
    "PROGRESS",
    "QUANTITY",
    "QUANTITY=NAME",
    "READING",
    "REGISTRATION",
    "SENSE",
    "SOLVER",
    "OPERATION",
    "URI",
];

const HOSTILE: [&str; 8] = ["nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "-0", "ten"];

/// Returns the names of all commands, from the help.
fn commands(shop: &Sandbox) -> Vec<String> {
    let help = shop.done(&["--help"]).out;
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    names.map(|line| line.split_whitespace().next().unwrap().to_string()).collect()
}

/// Returns the options of a command that take a value, each with its placeholder.
fn options(shop: &Sandbox, command: &str) -> Vec<(String, String)> {
    let help = shop.done(&[command, "--help"]).out;
    let option = |line: &str| {
        let (names, rest) = line.trim_start().split_once(" <")?;
        let name = names.rsplit(' ').next().filter(|name| name.starts_with("--"))?;
        Some((name.to_string(), rest.split('>').next()?.to_string()))
    };
    help.lines().filter(|line| line.trim_start().starts_with('-')).filter_map(option).collect()
}

/// Returns arguments with which a command runs quickly on the cell of the paper.
fn arguments(command: &str) -> Vec<&str> {
    let own: &[&str] = match command {
        "search" => &[PAPER, "--out", "out", "--progress", "none"],
        "sweep" => &[PAPER, "--map", "--set", "clearance_mm=0", "--out", "out"],
        "export" => &[PAPER, "--to", "csv", "-o", "out.csv"],
        "figures" => &[PAPER, "--out", "out"],
        "report" => &[PAPER, "-o", "out.html"],
        "allocate" => &["cells/drilling_cell.toml"],
        "robot" | "envelope" => &["hitachi_pw10"],
        "robots" | "schema" | "init" => &[],
        _ => &[PAPER],
    };
    [&[command], own].concat()
}

#[test]
fn every_numeric_option_refuses_hostile_numbers() {
    let shop = Sandbox::new();
    let mut tried = 0;
    for command in commands(&shop) {
        for (name, placeholder) in options(&shop, &command) {
            let numeric = NUMERIC.iter().find(|(known, _)| *known == placeholder);
            let Some((_, in_range)) = numeric else {
                assert!(OTHERS.contains(&placeholder.as_str()), "{command} {name} <{placeholder}> is new");
                continue;
            };
            for value in HOSTILE {
                let typed = match placeholder.as_str() {
                    "Q1,Q2,..." => format!("{value},0,0,0"),
                    "X,Y,Z" => format!("{value},0,0"),
                    _ => value.into(),
                };
                let ran = shop.run(&[&arguments(&command)[..], &[&name, &typed]].concat());
                let what = format!("{command} {name} {typed}: {:?}, {}", ran.code, ran.err);
                ran.no_panic();
                // A height may have any value, but a limit and a step may not. Here `calibrate` has no table,
                // and `compare --time` needs `--calibrated`, which needs a measured arm.
                let lacks_data = command == "calibrate" || command == "compare" && name == "--time";
                let is_in_range = in_range.contains(&value) && !lacks_data;
                if is_in_range || name == "--height" && ["1e-320", "-0"].contains(&value) {
                    assert!(matches!(ran.code, Some(0 | 1 | 4)), "{what}");
                    let _ = std::fs::remove_dir_all(shop.path("out"));
                } else {
                    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{what}");
                    assert!(ran.err.contains("error: ") && !ran.err.contains("00000000"), "{what}");
                    assert!(!shop.path("out").exists() && !shop.path("out.csv").exists(), "{what}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried >= 240, "{tried} values");
}

/// The command line and the file reject a number with the same message.
#[test]
fn an_option_has_the_range_of_its_key() {
    let shop = Sandbox::new();
    let said = |text: &str, mark: &str| {
        text.split_once(mark).map(|(_, rest)| rest.lines().next().unwrap().to_string())
    };
    for value in ["nan", "-1", "1e8", "1e308"] {
        shop.write("cells/gap.toml", &format!("from = \"hitachi_cell.toml\"\n[search]\ngap = {value}\n"));
        let file = said(&shop.run(&["check", "cells/gap.toml"]).err, "error: `gap` ");
        let option = shop.run(&["search", CELL, "--gap", value]);
        assert_eq!(said(&option.err, "error: `gap` "), file, "{}", option.err);
        assert!(file.is_some() && option.err.contains("--gap "), "{}", option.err);
        if value == "-1" {
            continue;
        }
        shop.write("cells/floor.toml", &format!("from = \"hitachi_cell.toml\"\nfloor_mm = {value}\n"));
        let file = said(&shop.run(&["check", "cells/floor.toml"]).err, "error: `floor_mm` ").unwrap();
        let range = file.split(", not").next().unwrap();
        for option in [["envelope", "hitachi_pw10", "--height"], ["explain", PAPER, "--joints"]] {
            let ran = shop.run(&[&option[..], &[value]].concat());
            assert!(ran.err.contains(range), "{option:?} {value}: {}", ran.err);
        }
    }
    // The range of the bend is the same as in a cell.
    let leaning = shop.json(&["envelope", "hitachi_pw10", "--bend", "135"]);
    assert_eq!(leaning["bend_deg"], 135.0);
    let beyond = shop.run(&["envelope", "hitachi_pw10", "--bend", "136"]);
    assert!(beyond.code == Some(2) && beyond.err.contains("it must be from -135 to 135"), "{}", beyond.err);
}

#[test]
fn a_cell_that_is_not_utf8_exits_2_at_its_first_wrong_byte() {
    let shop = Sandbox::new();
    let text = b"from = \"hitachi_paper.toml\"\nname = \"caf\xe9\"\n";
    std::fs::write(shop.path("cells/latin.toml"), text).unwrap();
    for args in
        [&["check"][..], &["check", "--json"], &["map"], &["search"], &["compare"], &["report"], &["view"]]
    {
        let ran = shop.run(&[args, &["cells/latin.toml"]].concat());
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.err);
        if args.len() == 1 {
            assert!(ran.err.contains("cells/latin.toml:2:12: error: it is not UTF-8 text"), "{}", ran.err);
            assert!(ran.err.contains("help: save it as UTF-8"), "{}", ran.err);
        }
    }
    let json = shop.run(&["check", "cells/latin.toml", "--json"]).document();
    assert_eq!((&json["faults"][0]["line"], &json["faults"][0]["column"]), (&2.into(), &12.into()));
    std::fs::write(shop.path("cells/robots/latin.toml"), b"\xff\xfe").unwrap();
    assert_eq!(shop.run(&["robot", "cells/robots/latin.toml"]).code, Some(2));
    // A fault of a file that a cell names is reported at the place where the cell names the file.
    shop.write("cells/names.toml", "from = \"latin.toml\"\n");
    let named = shop.run(&["check", "cells/names.toml"]);
    assert_eq!(named.code, Some(2));
    assert!(named.err.contains("cells/names.toml:1:8: error: cannot read `latin.toml`"), "{}", named.err);
}
