//! Tests that a damaged file of a result folder is refused or computed again, and never read as a result.

use crate::cli::sandbox::*;
use crate::common::cases;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::collections::BTreeMap;

const SWEEP: [&str; 7] =
    ["sweep", CELL, "--map", "--set", "equipment.worktable.placement.z_mm=600,800", "--out", "swept"];

fn files(shop: &Sandbox, folder: &str) -> BTreeMap<String, Vec<u8>> {
    shop.files(folder).into_iter().map(|f| (f.clone(), shop.read(&format!("{folder}/{f}")))).collect()
}

fn restore(shop: &Sandbox, folder: &str, whole: &BTreeMap<String, Vec<u8>>) {
    std::fs::remove_dir_all(shop.path(folder)).unwrap();
    for (name, bytes) in whole {
        let path = shop.path(&format!("{folder}/{name}"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
}

/// Returns a file with one bit flipped or with its end cut off.
fn damaged(bytes: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut damaged = bytes.to_vec();
    if rng.random_bool(0.2) {
        damaged.truncate(rng.random_range(0..bytes.len()));
    } else {
        damaged[rng.random_range(0..bytes.len())] ^= 1 << rng.random_range(0..8);
    }
    damaged
}

#[test]
fn every_damage_of_a_search_folder_is_refused() {
    let shop = Sandbox::new();
    let tolerance =
        "from = \"hitachi_cell.toml\"\n[equipment.worktable]\nplacement_tolerance = { x_mm = 2 }\n";
    shop.write("cells/loose.toml", tolerance);
    let search = |folder: &'static str, cell: &'static str, more: &[&'static str]| {
        let args = ["search", cell, "--seed", "3", "--budget", "60", "--out", folder];
        let ran = shop.run(&[&args[..], more].concat());
        assert!(ran.code == Some(0) || ran.code == Some(1), "{}", ran.err);
    };
    search("plain", CELL, &["--limit", "11"]);
    search("front", CELL, &["--pareto", "error,travel"]);
    search("robust", "cells/loose.toml", &["--robust"]);
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut refused = 0;
    for folder in ["plain", "front", "robust"] {
        let whole = files(&shop, folder);
        for (name, bytes) in whole.iter().cycle().take(cases(whole.len(), 500)) {
            std::fs::write(shop.path(&format!("{folder}/{name}")), damaged(bytes, &mut rng)).unwrap();
            for args in [["report", folder, "--json"], ["export", folder, "--to=csv"]] {
                let ran = shop.run(&args);
                ran.no_panic();
                assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?} {name}: {}", ran.err);
            }
            std::fs::write(shop.path(&format!("{folder}/{name}")), bytes).unwrap();
            refused += 1;
        }
        assert_ne!(shop.run(&["report", folder]).code, Some(2), "{folder} is whole again");
    }
    println!("search, Pareto and robust folders: {refused} damages, all refused");
}

/// The folder of a stopped search has no manifest. The checkpoint names the inputs, and the layout is
/// assessed again.
#[test]
fn every_damage_of_a_stopped_search_is_refused_or_changes_no_report() {
    let shop = Sandbox::new();
    let ran =
        shop.run(&["search", CELL, "--limit", "11", "--time", "0.3", "--budget", "900000", "--out", "found"]);
    assert_eq!(ran.code, Some(4), "{}", ran.err);
    let report = || {
        let ran = shop.run(&["report", "found", "--json", "-o", "found.html"]);
        ran.no_panic();
        (ran.code, ran.out, std::fs::read(shop.path("found.html")).unwrap_or_default())
    };
    let (code, out, page) = report();
    assert_eq!(code, Some(1), "the limit is missed");
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let whole = files(&shop, "found");
    let (mut refused, mut harmless) = (0, 0);
    for (name, bytes) in whole.iter().cycle().take(cases(2 * whole.len(), 500)) {
        std::fs::write(shop.path(&format!("found/{name}")), damaged(bytes, &mut rng)).unwrap();
        std::fs::remove_file(shop.path("found.html")).unwrap();
        let now = report();
        if now.0 == Some(2) {
            refused += 1;
            assert!(now.1.is_empty() && now.2.is_empty(), "{name}");
            std::fs::write(shop.path("found.html"), &page).unwrap();
        } else {
            harmless += 1;
            assert!(now == (code, out.clone(), page.clone()), "{name} changes the report");
        }
        std::fs::write(shop.path(&format!("found/{name}")), bytes).unwrap();
    }
    println!("stopped search: {refused} damages refused, {harmless} without effect on the report");
    assert!(refused > 0 && harmless > 0, "the checkpoint is checked, a picture is not read");
}

#[test]
fn every_damage_of_a_sweep_folder_is_refused_or_computed_again() {
    let shop = Sandbox::new();
    shop.done(&SWEEP);
    let whole = files(&shop, "swept");
    let mut rng = ChaCha8Rng::seed_from_u64(15);
    let (mut refused, mut again) = (0, 0);
    for (name, bytes) in whole.iter().cycle().take(cases(2 * whole.len(), 500)) {
        std::fs::write(shop.path(&format!("swept/{name}")), damaged(bytes, &mut rng)).unwrap();
        let ran = shop.run(&["sweep", "--resume", "swept"]);
        ran.no_panic();
        if ran.code == Some(0) {
            again += 1;
            assert_eq!(files(&shop, "swept"), whole, "{name}: {}", ran.err);
            if name.ends_with("000.json") || name.ends_with("001.json") {
                assert!(ran.err.contains("is computed again"), "{name}: {}", ran.err);
            }
        } else {
            refused += 1;
            assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{name}: {}", ran.err);
            restore(&shop, "swept", &whole);
        }
    }
    println!("sweep folder: {refused} damages refused, {again} repaired");
    assert!(refused > 0 && again > 0, "{refused} refused, {again} computed again");
}

#[test]
fn an_edited_row_or_cell_of_a_sweep_is_computed_again() {
    let shop = Sandbox::new();
    shop.done(&SWEEP);
    let whole = files(&shop, "swept");
    let row = shop.document("swept/0000.json");
    let better = number(&row["objective"]) - 10.0;
    let named: Vec<&str> = items(&row["files"]).iter().map(|file| text(&file["path"])).collect();
    assert_eq!(named, ["inputs/set-0000.toml", "0000.toml"]);
    let old = format!("\"objective\": {}", row["objective"]);
    let edited = shop.text("swept/0000.json").replacen(&old, &format!("\"objective\": {better}"), 1);
    for (name, text) in [
        ("0000.json", edited),
        ("0000.toml", shop.text("swept/0000.toml") + "# edited\n"),
        ("inputs/set-0000.toml", shop.text("swept/inputs/set-0000.toml").replace("600", "700")),
    ] {
        shop.write(&format!("swept/{name}"), &text);
        let ran = shop.done(&["sweep", "--resume", "swept"]);
        let said = format!("warning: {name}: ");
        assert!(
            ran.err.contains(&said) && ran.err.contains("combination 0 is computed again"),
            "{}",
            ran.err
        );
        assert_eq!(files(&shop, "swept"), whole, "{name}");
    }
}

#[test]
fn an_edited_manifest_is_refused() {
    let shop = Sandbox::new();
    shop.run(&["search", CELL, "--limit", "11", "--budget", "60", "--out", "found"]);
    let manifest = shop.text("found/manifest.json");
    let document: Value = serde_json::from_str(&manifest).unwrap();
    let list = |key: &str| {
        let start = manifest.find(&format!("\"{key}\": [")).unwrap();
        let end = start + manifest[start..].find(']').unwrap() + 1;
        manifest.replacen(&manifest[start..end], &format!("\"{key}\": []"), 1)
    };
    assert!(document["inputs"].is_array() && document["outputs"].is_array());
    for edited in [manifest.replace("11", "19"), list("inputs"), list("outputs")] {
        assert_ne!(edited, manifest);
        shop.write("found/manifest.json", &edited);
        let ran = shop.run(&["report", "found"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{}", ran.err);
        assert!(ran.err.contains("manifest.json: it is damaged"), "{}", ran.err);
    }
    // A forged manifest without inputs is refused with a reason.
    shop.write("found/manifest.json", &resealed(&list("inputs")));
    let ran = shop.run(&["report", "found"]);
    assert!(ran.code == Some(2) && ran.err.contains("manifest.json: it names no inputs"), "{}", ran.err);
}

#[test]
fn the_kept_cell_file_replaces_no_other_input() {
    let shop = Sandbox::new();
    let cell = shop.text(CELL);
    shop.write("cells/my_cell.toml", &cell);
    let lamp = "[obstacle.lamp]\nsolid = [{ name = \"lamp\", box = { centre_mm = [0, 0, 0], size_mm = [200, 200, 200] } }]\n";
    let post =
        format!("from = \"my_cell.toml\"\n{lamp}placement = {{ x_mm = 3000, y_mm = 3000, z_mm = 500 }}\n");
    shop.write("cells/my cell.toml", &post);
    let ran = shop.run(&["search", "cells/my cell.toml", "--budget", "60", "--out", "found"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_eq!(shop.text("found/inputs/my_cell.toml"), cell);
    assert_eq!(shop.text("found/inputs/_my_cell.toml"), post);
    assert!(shop.text("found/best.toml").contains("from = \"inputs/_my_cell.toml\""));
    let report = shop.run(&["report", "found", "--json"]);
    assert_ne!(report.code, Some(2), "{}", report.err);
}

/// A named pipe without a writer would block a program that opens it.
#[cfg(unix)]
#[test]
fn a_plan_or_checkpoint_that_is_no_file_is_refused_at_once() {
    let shop = Sandbox::new();
    std::fs::create_dir(shop.path("piped")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(shop.path("piped/plan.json")).status().unwrap();
    assert!(made.success());
    let ran = shop.run(&["sweep", "--resume", "piped"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    assert!(ran.err.contains("plan.json: it is not a file"), "{}", ran.err);
    std::fs::rename(shop.path("piped/plan.json"), shop.path("piped/checkpoint.jsonl")).unwrap();
    let ran = shop.run(&["search", "--resume", "piped"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{}", ran.err);
    // A symbolic link must not lead out of the folder.
    shop.done(&SWEEP);
    std::fs::create_dir(shop.path("linked")).unwrap();
    std::os::unix::fs::symlink(shop.path("swept/plan.json"), shop.path("linked/plan.json")).unwrap();
    let ran = shop.run(&["sweep", "--resume", "linked"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    assert!(ran.err.contains("outside the folder of the sweep"), "{}", ran.err);
    // A sparse file of 3 GB is refused without using memory.
    let huge = std::fs::File::create(shop.path("piped/plan.json")).unwrap();
    huge.set_len(3 << 30).unwrap();
    let ran = shop.run(&["sweep", "--resume", "piped"]);
    assert!(ran.code == Some(3) && ran.err.contains("more than 128 MB"), "{}", ran.err);
}
