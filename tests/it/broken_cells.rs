//! Tests broken cell files: every fault has a place and a help text, and no file makes the reader panic.
//!
//! Each file in tests/broken begins with every message that must be reported for it: `#! FILE:LINE:COLUMN:
//! error: MESSAGE` and `#!   help: HELP`.

use crate::common::{cases, load_from, root};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use sweetspot::files;
use sweetspot::files::{Fault, Loaded};

/// Returns the first line and the help of a printed fault.
fn told(fault: &Fault) -> Vec<String> {
    let shown = fault.to_string();
    let lines = shown.lines().map(str::to_string);
    let is_help = |(i, line): &(usize, String)| *i == 0 || line.starts_with("  help: ");
    lines.enumerate().filter(is_help).map(|(_, line)| line).collect()
}

/// Returns names and texts of tests/broken/*.toml.
fn broken_files() -> Vec<(String, String)> {
    let entries = std::fs::read_dir(root().join("tests/broken")).unwrap();
    let paths = entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let name = |p: &std::path::Path| p.file_name().unwrap().to_str().unwrap().to_string();
    let mut files: Vec<_> = paths.map(|p| (name(&p), std::fs::read_to_string(&p).unwrap())).collect();
    files.sort();
    files
}

#[test]
fn every_broken_file_gets_its_expected_messages() {
    let files = broken_files();
    assert!(files.len() >= 40, "{} files", files.len());
    let mut known: BTreeMap<Vec<String>, String> = BTreeMap::new();
    for (name, text) in files {
        let expected: Vec<_> = text.lines().map_while(|line| line.strip_prefix("#! ")).collect();
        let faults = match load_from(&root().join("tests/broken"), &name) {
            Ok(loaded) => loaded.warnings,
            Err(faults) => faults,
        };
        let got: Vec<_> = faults.iter().flat_map(told).collect();
        assert_eq!(
            got,
            expected,
            "{name} says:\n{}\n",
            got.iter().map(|l| format!("#! {l}\n")).collect::<String>()
        );
        assert!(!expected.is_empty(), "{name} is not broken");
        assert!(faults.iter().all(|f| !f.help.is_empty()), "{name}: no help");
        let messages = faults.into_iter().flat_map(|f| [f.message, f.help]).collect();
        if let Some(other) = known.insert(messages, name.clone()) {
            panic!("{name} shows nothing that {other} does not show");
        }
    }
}

/// Loads a cell from files in memory and the shipped files.
fn load_parts(files: &BTreeMap<String, String>, path: &str) -> Result<Loaded, Vec<Fault>> {
    let cells = root().join("cells");
    files::load(path, &mut |path: &str| match files.get(path) {
        Some(text) => Ok(text.clone().into_bytes()),
        None => std::fs::read(cells.join(path)).map_err(|_| "no such file".to_string()),
    })
}

fn load_text(text: &str) -> Result<Loaded, Vec<Fault>> {
    load_parts(&BTreeMap::from([("cell.toml".to_string(), text.to_string())]), "cell.toml")
}

/// Checks that a rejection has an error, and that every fault can be displayed and lies in its file.
fn check(result: Result<Loaded, Vec<Fault>>, files: &BTreeMap<String, String>, what: &str) {
    let (faults, refused) = match result {
        Ok(loaded) => (loaded.warnings, false),
        Err(faults) => (faults, true),
    };
    assert_eq!(faults.iter().any(Fault::is_error), refused, "{what}: {faults:#?}");
    let lines: BTreeMap<_, _> = files.iter().map(|(path, text)| (path, text.lines().count())).collect();
    for fault in &faults {
        assert!(fault.line >= 1 && fault.column >= 1, "{what}: {fault:?}");
        assert!(lines.get(&fault.file).is_none_or(|n| fault.line <= n + 1), "{what}: {fault:?}");
        let shown = fault.to_string();
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{what}: {shown:?}");
        assert!(shown.lines().count() <= 4 && shown.len() < 3000, "{what}: {shown}");
        assert!(!fault.help.is_empty(), "{what}: {shown}");
    }
}

/// Returns the message of the only error of a text.
fn only_error(text: &str) -> String {
    let faults = load_text(text).unwrap_err();
    assert_eq!(faults.len(), 1, "{faults:#?}");
    faults[0].to_string()
}

const BASE: &str = "from = \"hitachi_cell.toml\"\n";

#[test]
fn the_nearest_from_key_wins() {
    let other = "from = \"hitachi_paper_parallelogram.toml\"\n[robot]\nfrom = \"robots/hitachi_pw10.toml\"\n";
    let robot = load_text(other).unwrap().cell.robot;
    assert_eq!(robot.coupling[2], [0.0, 0.0, 1.0, 0.0]);
    assert_eq!(robot.name, "Hitachi PW 10-II, parallelogram".replace(", parallelogram", ""));
}

#[test]
fn long_chains_of_from_are_refused() {
    for (length, fits) in [(13, true), (15, false), (5000, false)] {
        let link = |i| format!("from = \"{}.toml\"\n", i + 1);
        let mut files: BTreeMap<_, _> = (0..length).map(|i| (format!("{i}.toml"), link(i))).collect();
        files.insert(format!("{length}.toml"), BASE.to_string());
        let result = load_parts(&files, "0.toml");
        assert_eq!(result.is_ok(), fits, "{length}");
        if !fits {
            let told = told(&result.unwrap_err()[0]);
            assert_eq!(told[0], "15.toml:1:8: error: the chain of `from` keys has more than 16 files");
        }
    }
}

#[test]
fn files_that_add_up_to_more_than_100_mb_are_refused() {
    let part = "schema = \"sweetspot/equipment/1\"\n".to_string() + &"# much\n".repeat(500_000);
    let named = |i| format!("[obstacle.o{i}]\nfrom = \"part.toml\"\n");
    let cell = BASE.to_string() + &(0..1000).map(named).collect::<String>();
    let files = BTreeMap::from([("cell.toml".to_string(), cell), ("part.toml".to_string(), part)]);
    let faults = load_parts(&files, "cell.toml").unwrap_err();
    assert!(faults.iter().any(|f| f.message.contains("add up to more than 100 MB")));
}

#[test]
fn deep_nesting_is_refused() {
    let n = 20_000;
    let arrays = only_error(&format!("a = {}{}", "[".repeat(n), "]".repeat(n)));
    assert!(arrays.starts_with("cell.toml:1:37: error: the values are nested too deeply\n"), "{arrays}");
    let tables = only_error(&format!("a = {}1{}", "{a = ".repeat(n), "}".repeat(n)));
    assert!(tables.contains("error: the values are nested too deeply"), "{tables}");
    let keys = only_error(&format!("{}a = 1", "a.".repeat(n)));
    assert!(keys.starts_with("cell.toml:1:1: error: the values are nested too deeply\n"), "{keys}");
    // Both the key and the value have the deepest nesting that the parser accepts.
    let key = format!("{}a", "a.".repeat(78));
    let nested = format!("[{key}]\n{key} = {}1{}", format!("{{{key} = ").repeat(78), "}".repeat(78));
    assert!(only_error(&nested).contains("error: the values are nested too deeply"));
}

/// Faults inside inline tables once made the TOML parser overflow the stack, which ends the process.
#[test]
fn deep_nesting_is_refused_in_faulty_text_too() {
    let n = 20_000;
    let pieces = [
        ("{ a = { b = 9", "i = { c = 1 }, d = { e = 9"),
        ("{ a = { b = 9", "int = { c = [-nan, 1] }, d = { e = 9, f = 9"),
        ("", "{ a = 9 b = "),
        ("", "{a={b=1]"),
        ("", "{ a = \"}\" b = "),
        ("", "a = [{x={"),
    ];
    for (start, piece) in pieces {
        let text = format!("{BASE}v = {start}{}", piece.repeat(n));
        let faults = load_text(&text).unwrap_err();
        let first =
            faults.iter().map(|f| &f.message).find(|m| m.contains("the values are nested too deeply"));
        assert!(first.is_some(), "{piece}: {} faults", faults.len());
    }
    // Brackets in strings and comments do not nest.
    let quiet = "[".repeat(100);
    for text in [
        format!("name = '{quiet}'"),
        format!("source = \"\"\"\n{quiet} \\\" {quiet}\"\"\""),
        format!("# {quiet}"),
    ] {
        let faults = load_text(&format!("{BASE}{text}\n")).err().unwrap_or_default();
        assert!(!faults.iter().any(|f| f.message.contains("nested")), "{text}: {faults:#?}");
    }
}

/// Returns the processor time that this thread has used, s; None if the system does not count it.
///
/// This time hardly depends on the programs and tests that run beside this test.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    (nanoseconds > 0.0).then_some(nanoseconds / 1e9)
}

#[test]
fn hostile_texts_are_refused_quickly() {
    let megabyte = |t: &str| t.repeat(1_000_000 / t.len());
    let many = |line: fn(usize) -> String| BASE.to_string() + &(0..20_000).map(line).collect::<String>();
    let texts = [
        String::new(),
        "\u{feff}".into(),
        megabyte("x"),
        format!("{BASE}name = \"{}\"", megabyte("x")),
        format!("{BASE}{} = 1", megabyte("clearance_")),
        format!("{BASE}floor_mm = {}", megabyte("9")),
        format!("{BASE}floor_mm = 0x{}", megabyte("f")),
        format!("{BASE}floor_mm = [{}]", megabyte("1, ")),
        format!("{BASE}errors = \"{}\"", megabyte("table")),
        megabyte("\\u0"),
        megabyte("=\n"),
        megabyte("a\n"),
        megabyte("a=1\n"),
        megabyte("[a]\na=1\na=1\n"),
        megabyte("[[a]]\n"),
        megabyte("a=["),
        megabyte("\""),
        "#\n".repeat(2_500_000),
        many(|i| format!("key{i} = 1\n")),
        many(|i| format!("[obstacle.o{i}]\nfootprint = {{ size_mm = [1, 1] }}\n")),
        many(|i| format!("[operation.o{i}]\non = \"worktabel\"\n")),
        many(|i| format!("[[robot.solid]]\nname = \"{i}\"\n")),
        many(|i| format!("[sense.s{i}]\nof = \"rotate\"\n")),
        many(|i| format!("[sense.s{i}]\nof = \"xy\"\n[operation.o{i}]\nsense = \"t{i}\"\n")),
        many(|i| format!("[operation.o{i}]\nrelative_to = \"o{}\"\n", i + 1)),
        many(|i| format!("[robot.errors.e{i}]\nkind = \"tolerance\"\ndistribution = {{ dl = \"norml\" }}\n")),
        format!("{BASE}[sense.s]\nterm = [{}]", megabyte("{ of = \"xyz\" },")),
        format!("{BASE}[robot.errors.table-3-tolerance.covariance]\nparameters = [{}]", megabyte("\"dl2\",")),
    ];
    for text in texts {
        let what: String = text.chars().take(40).collect();
        // Other tests may slow one reading down, so only three slow readings in a row are a fault.
        // The check of the faults takes longer than a reading, so it is not timed.
        let read = || {
            let (start, before) = (std::time::Instant::now(), processor_seconds());
            let result = load_text(&text);
            let used = before.zip(processor_seconds()).map(|(before, after)| after - before);
            (used.unwrap_or(start.elapsed().as_secs_f64()) < 5.0).then_some(result)
        };
        let result = (0..3).find_map(|_| read()).unwrap_or_else(|| panic!("{what}: over 5 s three times"));
        assert!(result.is_err(), "{what}");
        check(result, &BTreeMap::from([("cell.toml".to_string(), text)]), &what);
    }
}

const CUBE: &str = "# a cube
mtllib cube.mtl
o cube
v 0 0 0\nv 100 0 0\nv 0 100 0\nv 100 100 0\nv 0 0 100\nv 100 0 100\nv 0 100 100\nv 100 100 100
vt 0.5 0.5
vn 0 0 1
g sides
usemtl red
s off
f 1/1/1 3/1/1 4/1/1 2/1/1\nf 5//1 6//1 8//1 7//1
f 1 2 6 5\nf 3 7 8 4
f -8 -4 -2 -6\nf 2 4 8\nf 2 8 6
";

/// Returns a text with one random change.
fn mutated(text: &str, rng: &mut ChaCha8Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let mut lines: Vec<_> = text.split_inclusive('\n').collect();
    let at = rng.random_range(0..=bytes.len());
    let to = (at + rng.random_range(1..=8)).min(bytes.len());
    let line = rng.random_range(0..=lines.len());
    let other = rng.random_range(0..=lines.len());
    match rng.random_range(0..7) {
        0 => drop(bytes.drain(at..to)),
        1 => drop(bytes.splice(at..at, bytes[at..to].to_vec()).count()),
        2 => bytes.insert(at, b"\"'[]{}=.,#\n\\\0\x1b\xff-e/9"[rng.random_range(0..19)]),
        3 | 4 => return with_other_number(text, rng),
        5 if line < lines.len() => drop(lines.remove(line)),
        6 if line.max(other) < lines.len() => lines.swap(line, other),
        _ => {}
    }
    if bytes != text.as_bytes() { String::from_utf8_lossy(&bytes).into() } else { lines.concat() }
}

/// Returns a text with one number replaced.
fn with_other_number(text: &str, rng: &mut ChaCha8Rng) -> String {
    let part_of = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let starts: Vec<_> = text.match_indices(|c: char| c.is_ascii_digit()).map(|(i, _)| i).collect();
    if starts.is_empty() {
        return text.to_string();
    }
    let start = starts[rng.random_range(0..starts.len())];
    let end = text[start..].find(|c| !part_of(c)).map_or(text.len(), |i| start + i);
    let other = ["nan", "inf", "-1e309", "\"x\"", "[]", "{}", "0", "-7", "1e-320", "9223372036854775808"];
    format!("{}{}{}", &text[..start], other[rng.random_range(0..other.len())], &text[end..])
}

#[test]
fn mutated_files_never_panic() {
    let files = [
        ("hitachi_cell.toml", "hitachi_cell.toml"),
        ("hitachi_paper.toml", "hitachi_paper.toml"),
        ("hitachi_paper_parallelogram.toml", "hitachi_paper_parallelogram.toml"),
        ("robots/hitachi_pw10.toml", "hitachi_cell.toml"),
        ("robots/hitachi_pw10_parallelogram.toml", "hitachi_paper_parallelogram.toml"),
        ("equipment/worktable.toml", "hitachi_cell.toml"),
        ("equipment/conveyor.toml", "hitachi_cell.toml"),
        ("equipment/machine.toml", "hitachi_cell.toml"),
        ("equipment/machine.obj", "hitachi_cell.toml"),
        ("every_key.toml", "every_key.toml"),
    ];
    let mut shipped: BTreeMap<String, String> = BTreeMap::new();
    for (path, _) in files {
        let folder = root().join(if path == "every_key.toml" { "tests/data" } else { "cells" });
        shipped.insert(path.to_string(), std::fs::read_to_string(folder.join(path)).unwrap());
    }
    shipped.insert("equipment/machine.obj".into(), CUBE.into());
    check(load_parts(&shipped, "hitachi_cell.toml"), &shipped, "the shipped cell");
    let mut rng = ChaCha8Rng::seed_from_u64(1998);
    for (path, cell) in files {
        for i in 0..cases(300, 2000) {
            let mut text = shipped[path].clone();
            for _ in 0..rng.random_range(1..=3) {
                text = mutated(&text, &mut rng);
            }
            let mut files = shipped.clone();
            files.insert(path.to_string(), text);
            check(load_parts(&files, cell), &files, &format!("{path}, mutation {i}"));
        }
    }
}
