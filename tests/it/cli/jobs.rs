//! Tests a search as a job: it is killed or interrupted, or it runs out of time or disk space, and is then
//! resumed.

use crate::cli::sandbox::*;
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Budget of a search that takes some seconds, so that the kills happen in every part of the search.
const BUDGET: &str = "12000";

/// Returns every file of a folder with its bytes.
fn content(shop: &Sandbox, folder: &str) -> Vec<(String, Vec<u8>)> {
    shop.files(folder).into_iter().map(|f| (f.clone(), shop.read(&format!("{folder}/{f}")))).collect()
}

fn assert_same(shop: &Sandbox, whole: &Sandbox) {
    let (a, b) = (content(shop, "found"), content(whole, "found"));
    let names = |c: &[(String, Vec<u8>)]| c.iter().map(|f| f.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&a), names(&b));
    for ((name, one), (_, other)) in a.iter().zip(&b) {
        assert!(one == other, "{name} differs");
    }
}

/// The test kills a process with SIGKILL at random moments and resumes the search until it ends. The result
/// has the same bytes. SWEETSPOT_KILLS sets the number of kills.
#[test]
fn a_killed_and_resumed_search_ends_in_the_same_bytes() {
    let kills: u32 = std::env::var("SWEETSPOT_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(6);
    let args =
        ["search", CELL, "--budget", BUDGET, "--out", "found", "--checkpoint", "0.02", "--threads", "2"];
    let whole = Sandbox::new();
    let clock = std::time::Instant::now();
    whole.done(&args);
    let length = clock.elapsed();
    // With a separate generator (Knuth's MMIX), the kills happen at the same shares of the search on every
    // machine.
    let mut seed = 20_261_121u64;
    let mut killed = 0;
    while killed < kills {
        let shop = Sandbox::new();
        loop {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let share = (seed >> 33) as f64 / f64::from(1u32 << 31);
            let resumable = shop.path("found/checkpoint.jsonl").is_file();
            let now = ["search", "--resume", "found", "--checkpoint", "0.02"];
            let mut command = shop.command(if resumable { &now } else { &args });
            let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
            std::thread::sleep(length.mul_f64(share));
            let _ = child.kill();
            let ran = ran(child.wait_with_output().unwrap());
            if ran.code.is_some() {
                assert_eq!(ran.code, Some(0), "{}", ran.err);
                break;
            }
            killed += 1;
            // A run killed at the very end has written its result, but may not have removed its lock file.
            if shop.path("found/manifest.json").is_file() && !shop.path("found/checkpoint.jsonl").is_file() {
                let _ = std::fs::remove_file(shop.path("found/.sweetspot-lock"));
                break;
            }
        }
        assert_same(&shop, &whole);
    }
    println!("{killed} kills, nothing lost");
}

/// Returns a folder with a search that ran out of time.
fn stopped() -> Sandbox {
    let shop = Sandbox::new();
    let args =
        ["search", CELL, "--budget", "1000000", "--time", "0.3", "--out", "found", "--seed", "2", "--json"];
    let ran = shop.run(&args);
    assert_eq!(ran.code, Some(4), "{}", ran.err);
    assert_eq!((&ran.document()["ended"], &ran.document()["seed"]), (&"time-limit".into(), &2.into()));
    assert!(ran.err.contains("next: sweetspot search --resume found"), "{}", ran.err);
    shop.has("found", &["checkpoint.jsonl", "best.toml", "search.json"]);
    // The best layout so far is usable, but the folder is incomplete.
    assert!(!shop.files("found").contains(&"manifest.json".to_string()));
    shop.done(&["map", "found/best.toml"]);
    shop
}

#[test]
fn a_time_limit_exits_4_and_a_larger_budget_resumes() {
    let shop = stopped();
    let ran = shop.run(&["search", "--resume", "found", "--time", "0.3"]);
    assert_eq!(ran.code, Some(4), "{}", ran.err);
    // A larger budget gives the result of a search with that budget from the start.
    let used = shop.document("found/search.json")["evaluations"].as_u64().unwrap();
    let budget = &*(used + used / 4).to_string();
    shop.done(&["search", "--resume", "found", "--budget", budget]);
    let manifest = shop.document("found/manifest.json");
    let command: Vec<_> = items(&manifest["command"]).iter().map(text).collect();
    assert!(command.ends_with(&["--budget", budget]) && !command.contains(&"1000000"), "{command:?}");
    let whole = Sandbox::new();
    whole.done(&["search", CELL, "--budget", budget, "--out", "found", "--seed", "2"]);
    for name in ["best.toml", "search.json", "map.csv", "map.svg"] {
        assert_eq!(shop.read(&format!("found/{name}")), whole.read(&format!("found/{name}")), "{name}");
    }
    let again = shop.run(&["search", "--resume", "found"]);
    assert_eq!(again.code, Some(2));
    assert!(again.err.contains("nothing to resume"), "{}", again.err);
}

#[test]
fn a_changed_input_is_refused_and_named() {
    let shop = stopped();
    let checkpoint = shop.read("found/checkpoint.jsonl");
    let refused = |args: &[&str], said: &str| {
        let ran = shop.run(&[&["search", "--resume", "found", "--time", "0.1"], args].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said) && ran.err.contains("help: "), "{args:?}: {}", ran.err);
        assert_eq!(shop.read("found/checkpoint.jsonl"), checkpoint, "{args:?}");
    };
    refused(&["--seed", "3"], "--seed was 2");
    refused(&["--solver", "particle-swarm"], "--solver was not given");
    refused(&["--sense", "xyz"], "--sense was not given");
    refused(&["--limit", "30"], "--limit was not given");
    refused(&["--budget", "1"], "more than --budget");
    refused(&["cells/scara_cell.toml"], "scara_cell.toml is read now");
    for input in [
        CELL,
        "cells/equipment/conveyor.toml",
        "cells/robots/hitachi_pw10.toml",
        "cells/equipment/machine.obj",
    ] {
        let was = shop.text(input);
        shop.write(input, &format!("{was}\n# changed\n"));
        refused(&[], &format!("{} has changed", input.trim_start_matches("cells/")));
        shop.write(input, &was);
    }
    // A new search refuses the folder and states how to continue.
    let ran = shop.run(&["search", CELL, "--out", "found"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.err.contains("search --resume found"), "{}", ran.err);
    // The same command with --resume continues.
    let same = ["search", CELL, "--seed", "2", "--resume", "found", "--time", "0.1"];
    assert_eq!(shop.run(&same).code, Some(4));
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let shop = stopped();
    let whole = shop.read("found/checkpoint.jsonl");
    let second = whole.iter().position(|&b| b == b'\n').unwrap() + 1;
    let refused = |bytes: &[u8], said: &str| {
        std::fs::write(shop.path("found/checkpoint.jsonl"), bytes).unwrap();
        let ran = shop.run(&["search", "--resume", "found"]);
        ran.no_panic();
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{}", ran.err);
        assert!(ran.err.contains("found/checkpoint.jsonl:") && ran.err.contains(said), "{}", ran.err);
    };
    for at in [second, second + 10, whole.len() / 2, whole.len() - 2] {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        refused(&bytes, ":2: the checkpoint is damaged");
    }
    refused(&whole[..whole.len() - 5], ":2: the checkpoint is damaged");
    refused(&whole[..second], ":2: the checkpoint is damaged");
    refused(&whole[..20], ":1: ");
    refused(b"", ":1: ");
    let other = String::from_utf8(whole.clone()).unwrap();
    let version = format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION"));
    refused(other.replacen(&version, "\"version\":\"0.0.9\"", 1).as_bytes(), "0.0.9");
    refused(other.replacen("checkpoint/1", "checkpoint/9", 1).as_bytes(), "checkpoint/9");
    // The hash is right, but the content is wrong.
    let sealed = |content: &str| {
        let hash = sha256(content.as_bytes());
        format!("{{\"schema\":\"sweetspot/checkpoint/1\",{version},\"sha256\":\"{hash}\"}}\n{content}")
    };
    refused(sealed("{}\n").as_bytes(), ":2: the checkpoint cannot be read");
    let content = &other[second..];
    let unknown = content.replacen("\"settings\"", "\"setting\"", 1);
    refused(sealed(&unknown).as_bytes(), ":2: the checkpoint cannot be read: unknown field `setting`");
    std::fs::write(shop.path("found/checkpoint.jsonl"), &whole).unwrap();
    assert_eq!(shop.run(&["search", "--resume", "found", "--time", "0.1"]).code, Some(4));
}

/// The first SIGINT or SIGTERM stops the search with a checkpoint.
#[cfg(unix)]
#[test]
fn a_signal_exits_130_and_leaves_a_checkpoint() {
    for signal in ["-INT", "-TERM"] {
        let shop = Sandbox::new();
        let args = ["search", CELL, "--budget", "1000000000", "--out", "found", "--checkpoint", "0"];
        let child = shop.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        for _ in 0..600 {
            if shop.path("found/checkpoint.jsonl").exists() {
                break;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(100));
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let ran = ran(child.wait_with_output().unwrap());
        assert_eq!(ran.code, Some(130), "{signal}: {}", ran.err);
        assert_eq!(shop.document("found/search.json")["ended"], "interrupted");
        let used = shop.document("found/search.json")["evaluations"].as_u64().unwrap();
        // The search reserves a part of the budget for the final local search.
        let budget = (used + used / 4).to_string();
        shop.done(&["search", "--resume", "found", "--budget", &budget]);
        let whole = Sandbox::new();
        whole.done(&["search", CELL, "--budget", &budget, "--out", "found"]);
        assert_eq!(shop.text("found/search.json"), whole.text("found/search.json"), "{signal}");
    }
}

/// If the disk has no space for a larger checkpoint, the search exits with 3 and keeps the previous
/// checkpoint. With more space, the search continues.
#[cfg(unix)]
#[test]
fn a_full_disk_exits_3_and_keeps_the_last_checkpoint() {
    let shop = Sandbox::new();
    let line = format!(
        "trap '' XFSZ; ulimit -f 12; exec {} search {CELL} --budget {BUDGET} --out found --checkpoint 0.001",
        env!("CARGO_BIN_EXE_sweetspot")
    );
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(shop.dir.path()).env("SWEETSPOT_CACHE", "off");
    let full = ran(command.output().unwrap());
    full.no_panic();
    assert_eq!((full.code, full.out.as_str()), (Some(3), ""), "{}", full.err);
    assert!(full.err.contains("cannot write") && full.err.contains("--resume found"), "{}", full.err);
    assert_eq!(shop.files("found"), ["checkpoint.jsonl"]);
    shop.done(&["search", "--resume", "found"]);
    let whole = Sandbox::new();
    whole.done(&["search", CELL, "--budget", BUDGET, "--out", "found"]);
    for name in ["best.toml", "search.json", "map.csv", "map.svg"] {
        assert_eq!(shop.read(&format!("found/{name}")), whole.read(&format!("found/{name}")), "{name}");
    }
}

#[test]
fn progress_is_written_as_json_lines_without_a_terminal() {
    let shop = Sandbox::new();
    let lines = |more: &[&str]| -> Vec<Value> {
        let args = [&["search", CELL, "--budget", "800"], more].concat();
        let ran = shop.done(&args);
        let json = ran.err.lines().filter(|l| l.starts_with('{'));
        json.map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{e}: {l}"))).collect()
    };
    let told = lines(&["--out", "a"]);
    let last = told.last().unwrap();
    assert_eq!((text(&last["schema"]), &last["evaluations"]), ("sweetspot/progress/1", &800.into()));
    let found = shop.document("a/search.json");
    let share = found["feasible"].as_f64().unwrap() / 800.0;
    assert!((number(&last["feasible_share"]) - share).abs() < 1e-12, "{last}");
    assert!((number(&last["best"]) - number(&found["least_value"])).abs() < 1e-6, "{last}");
    assert_eq!(text(&last["unit"]), "mm");
    // The file contains the bound rounded down.
    let rounded = number(&last["bound"]) - number(&found["bound"]);
    assert!((0.0..1e-8).contains(&rounded), "{last}");
    let gap = number(&last["best"]) / number(&last["bound"]) - 1.0;
    assert!((number(&last["gap"]) - gap).abs() < 1e-12 && gap > 0.0, "{last}");
    assert!(lines(&["--out", "b", "--progress", "none"]).is_empty());
    assert!(!lines(&["--out", "c", "--progress", "json", "--json"]).is_empty());
}

#[test]
fn the_stopping_rule_that_ended_a_search_is_reported() {
    let shop = Sandbox::new();
    let found = shop.json(&["search", CELL, "--budget", "50000", "--stagnation", "600", "--out", "a"]);
    assert_eq!(found["ended"], "stagnation");
    assert!(found["evaluations"].as_u64().unwrap() < 20_000, "{}", found["evaluations"]);
    // The cell file may also set the stopping rule.
    let cell = shop.text(CELL).replace("seed = 1", "seed = 1\nstagnation = 600");
    shop.write("cells/still.toml", &cell);
    let same = shop.json(&["search", "cells/still.toml", "--budget", "50000", "--out", "b"]);
    assert_eq!((&same["ended"], &same["evaluations"]), (&found["ended"], &found["evaluations"]));
    for wrong in [&["--gap", "-1"][..], &["--stagnation", "0"], &["--time", "-3"], &["--checkpoint", "nan"]] {
        let ran = shop.run(&[&["search", CELL], wrong].concat());
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{wrong:?}");
    }
    assert_eq!(shop.run(&["search"]).code, Some(2));
}
