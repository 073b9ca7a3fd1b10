//! Tests workers that share the combinations of a sweep through a folder. Although workers die, fail and
//! start late, the result has the bytes of an undisturbed run.

use crate::cli::sandbox::*;
use crate::cli::worker::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Duration;

const HEIGHTS: &str = "equipment.worktable.placement.z_mm=";

/// Returns the arguments of a sweep over heights of the table. One combination takes about 0.1 s.
fn sweep(count: usize, more: &[&str]) -> Vec<String> {
    let heights: Vec<String> = (0..count).map(|k| (500 + 5 * k).to_string()).collect();
    let set = format!("{HEIGHTS}{}", heights.join(","));
    let args = ["sweep", CELL, "--budget", "60", "--set", &set];
    args.iter().chain(more).map(|word| word.to_string()).collect()
}

fn words(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

/// Returns a sandbox with the plan of a sweep in the folder `shared`.
fn planned(count: usize) -> Sandbox {
    let shop = Sandbox::new();
    shop.done(&words(&sweep(count, &["--out", "shared", "--plan-only"])));
    shop
}

/// Returns every file of a folder with its bytes, without the claims.
fn result(shop: &Sandbox, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let files = shop.files(folder).into_iter().filter(|f| !f.starts_with("claims/"));
    files.map(|f| (f.clone(), shop.read(&format!("{folder}/{f}")))).collect()
}

/// Asserts that the folder `shared` contains the files of an undisturbed run, byte for byte.
fn assert_whole(shop: &Sandbox, count: usize) {
    shop.done(&words(&sweep(count, &["--out", "straight"])));
    let (shared, straight) = (result(shop, "shared"), result(shop, "straight"));
    assert_eq!(shared.keys().collect::<Vec<_>>(), straight.keys().collect::<Vec<_>>());
    straight.iter().for_each(|(name, bytes)| assert!(shared[name] == *bytes, "{name} differs"));
}

fn rows(shop: &Sandbox) -> usize {
    let is_row = |f: &&String| f.len() == 9 && f.ends_with(".json") && f.as_bytes()[0].is_ascii_digit();
    shop.files("shared").iter().filter(is_row).count()
}

/// Returns the text of a claim of another host.
fn claim(state: &str, beat: u32, losses: u32) -> String {
    format!(
        "{{\"host\":\"elsewhere\",\"process\":7,\"state\":\"{state}\",\"beat\":{beat},\"lease\":1,\
         \"losses\":{losses},\"seconds\":2.5,\"why\":null}}\n"
    )
}

/// Returns the number of combinations that a worker reports as processed.
fn processed(worker: &RunOutput) -> usize {
    let (_, count) = worker.err.split_once("this worker has processed ").unwrap();
    count.split(' ').next().unwrap().parse().unwrap()
}

fn put_claim(shop: &Sandbox, name: &str, text: &str) {
    std::fs::create_dir_all(shop.path("shared/claims")).unwrap();
    shop.write(&format!("shared/claims/{name}"), text);
}

/// The test kills one of four workers with SIGKILL at 20 random moments, and starts a new worker each time.
/// Each kill costs at most one combination.
#[test]
fn killed_workers_end_in_the_bytes_of_a_straight_run() {
    const COMBINATIONS: usize = 64;
    const KILLS: usize = 20;
    let shop = planned(COMBINATIONS);
    let worker = || Worker::start(&shop, &["sweep", "--claim", "shared", "--jobs", "1", "--lease", "2"]);
    let mut workers: Vec<Worker> = (0..4).map(|_| worker()).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    for kill in 0..KILLS {
        wait_until("progress", || rows(&shop) >= kill * 3);
        std::thread::sleep(Duration::from_millis(rng.random_range(0..100)));
        let k = rng.random_range(0..workers.len());
        // Dropping a worker kills it.
        drop(workers.swap_remove(k));
        workers.push(worker());
    }
    for ran in workers.into_iter().map(Worker::ended) {
        ran.no_panic();
        assert_eq!(ran.code, Some(0), "{}", ran.err);
    }
    assert_whole(&shop, COMBINATIONS);
    let begun = shop.files("shared/claims").len();
    let again = begun - COMBINATIONS;
    assert!((1..=KILLS).contains(&again), "{again} combinations were begun again after {KILLS} kills");
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert_eq!((&status["done"], &status["complete"]), (&COMBINATIONS.into(), &true.into()), "{status}");
    println!("{KILLS} kills: {again} of {COMBINATIONS} combinations were begun again");
}

/// All workers run the same command, which starts the sweep or joins it.
#[test]
fn workers_that_start_at_the_same_time_share_the_work() {
    let shop = Sandbox::new();
    let command = sweep(12, &["--claim", "shared", "--jobs", "1"]);
    let workers: Vec<Worker> = (0..4).map(|_| Worker::start(&shop, &words(&command))).collect();
    let ended: Vec<RunOutput> = workers.into_iter().map(Worker::ended).collect();
    ended.iter().for_each(|ran| assert_eq!(ran.code, Some(0), "{}", ran.err));
    ended.iter().for_each(|ran| assert_eq!(ran.out, ended[0].out));
    // No combination was processed twice.
    assert_eq!(ended.iter().map(processed).sum::<usize>(), 12);
    let claims: Vec<String> = (0..12).map(|k| format!("{k:04}-1")).collect();
    assert_eq!(shop.files("shared/claims"), claims);
    assert_whole(&shop, 12);
    // A late worker finds all combinations finished.
    assert_eq!(shop.done(&["sweep", "--claim", "shared"]).out, ended[0].out);
}

/// A worker needs only the shared folder.
#[test]
fn a_worker_needs_only_the_folder() {
    let shop = planned(3);
    std::fs::rename(shop.path("cells"), shop.path("elsewhere")).unwrap();
    shop.done(&["sweep", "--claim", "shared", "--only", "0,2"]);
    assert_eq!(rows(&shop), 2);
    assert!(!shop.path("shared/table.csv").exists());
    shop.done(&["sweep", "--claim", "shared"]);
    std::fs::rename(shop.path("elsewhere"), shop.path("cells")).unwrap();
    assert_whole(&shop, 3);
}

/// The clock of the dead owner does not matter, so the date of its claim may be in the future.
#[test]
fn a_claim_is_taken_over_only_after_its_heartbeat_stops() {
    let shop = planned(2);
    put_claim(&shop, "0001-1", &claim("running", 0, 0));
    let worker = Worker::start(&shop, &["sweep", "--claim", "shared"]);
    wait_until("the free combination", || rows(&shop) == 1);
    let future = std::time::SystemTime::now() + Duration::from_secs(86_400);
    // The other host renews its claim for three leases.
    for beat in 1..=30 {
        put_claim(&shop, "0001-1", &claim("running", beat, 0));
        let file = std::fs::File::options().write(true).open(shop.path("shared/claims/0001-1")).unwrap();
        file.set_modified(future).unwrap();
        std::thread::sleep(Duration::from_millis(100));
        assert!(!shop.path("shared/claims/0001-2").exists(), "taken over at heartbeat {beat}");
    }
    let ended = worker.ended();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let said = "combination 1 is taken over: process 7 on elsewhere has shown no heartbeat for 1 s";
    assert!(ended.err.contains(said), "{}", ended.err);
    assert_whole(&shop, 2);
    assert_eq!(shop.files("shared/claims"), ["0000-1", "0001-1", "0001-2"]);
}

/// Neither a worker that died before it wrote its name nor damaged files stop the other workers.
#[test]
fn empty_claims_and_damaged_files_are_mended() {
    let shop = planned(3);
    put_claim(&shop, "0000-1", "");
    shop.done(&["sweep", "--claim", "shared", "--lease", "1"]);
    let whole = shop.text("shared/0002.toml");
    shop.write("shared/0002.toml", &whole[..whole.len() / 2]);
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert!(text(&status["failed"][0]["why"]).starts_with("0002.toml: its hash"), "{status}");
    let ran = shop.done(&["sweep", "--claim", "shared"]);
    assert!(ran.err.contains("combination 2 is computed again"), "{}", ran.err);
    assert_eq!(shop.text("shared/0002.toml"), whole);
    assert_whole(&shop, 3);
}

#[test]
fn a_combination_that_kills_its_workers_is_given_up() {
    let shop = planned(2);
    put_claim(&shop, "0001-1", &claim("running", 3, 5));
    let ran = shop.run(&["sweep", "--claim", "shared"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(4), ""), "{}", ran.err);
    assert!(
        ran.err.contains("1 combination given up (1), because 6 workers per combination have died"),
        "{}",
        ran.err
    );
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert_eq!((&status["done"], &status["failed"][0]["given_up"]), (&1.into(), &true.into()), "{status}");
    shop.done(&["sweep", "--resume", "shared"]);
    assert_whole(&shop, 2);
}

/// The first worker keeps its claim with heartbeats. After a signal stops the first worker, the second worker
/// does not wait until the lease ends.
#[cfg(unix)]
#[test]
fn a_worker_keeps_its_combination_until_it_is_stopped() {
    let shop = Sandbox::new();
    let height = format!("{HEIGHTS}600");
    let args =
        ["sweep", CELL, "--budget", "1000000000", "--set", &height, "--claim", "shared", "--lease", "1"];
    let first = Worker::start(&shop, &args);
    wait_until("a claim", || shop.path("shared/claims/0000-1").exists());
    let second = Worker::start(&shop, &["sweep", "--claim", "shared"]);
    let beat = |name: &str| {
        let text = std::fs::read(shop.path(&format!("shared/claims/{name}"))).unwrap_or_default();
        serde_json::from_slice(&text).map_or(0, |claim: Value| claim["beat"].as_u64().unwrap())
    };
    // This time is three leases.
    wait_until("18 heartbeats", || beat("0000-1") >= 18);
    assert_eq!(shop.files("shared/claims"), ["0000-1"]);
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert_eq!(status["running"][0]["process"], first.id(), "{status}");
    let stop = |worker: Worker| {
        let ended = worker.stopped();
        assert!(ended.err.contains("next: sweetspot sweep --claim shared"), "{}", ended.err);
        ended.err
    };
    let process = first.id();
    stop(first);
    wait_until("the successor", || shop.path("shared/claims/0000-2").exists());
    let said = stop(second);
    assert!(said.contains("note: waiting for 1 combination of other workers"), "{said}");
    assert!(said.contains(&format!("combination 0 is taken over: process {process} on ")), "{said}");
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert!(text(&status["failed"][0]["why"]).ends_with("was stopped"), "{status}");
}

#[test]
fn a_status_counts_what_is_done_running_and_free() {
    let shop = planned(5);
    shop.done(&["sweep", "--claim", "shared", "--only", "0-1"]);
    put_claim(&shop, "0002-1", &claim("running", 4, 0).replace("\"lease\":1", "\"lease\":3600"));
    put_claim(&shop, "0003-1", &claim("failed", 1, 0).replace("null", "\"error: the disk is full\""));
    let status = shop.json(&["sweep", "--status", "shared"]);
    assert_eq!(status["schema"], "sweetspot/sweep-status/1");
    assert_eq!(
        (&status["combinations"], &status["done"], &status["free"]),
        (&5.into(), &2.into(), &1.into())
    );
    let running = &status["running"][0];
    assert_eq!((text(&running["host"]), &running["process"]), ("elsewhere", &7.into()));
    assert_eq!((&running["index"], &running["seconds"]), (&2.into(), &2.5.into()));
    assert_eq!(text(&status["failed"][0]["why"]), "process 7 on elsewhere failed: error: the disk is full");
    // The times of two finished combinations give the estimated time of the three remaining combinations.
    let spent = number(&status["hosts"][0]["seconds"]);
    assert_eq!(status["hosts"][0]["combinations"], serde_json::json!([0, 1]));
    assert!((number(&status["seconds_left"]) - (1.5 * spent - 2.5).max(0.0)).abs() < 1e-9, "{status}");
    let ran = shop.done(&["sweep", "--status", "shared"]);
    let first = "2 of 5 combinations done, 1 running, 1 failed, 1 free; about ";
    assert!(ran.out.starts_with(first) && ran.out.contains("elsewhere"), "{}", ran.out);
    assert_eq!(shop.run(&["sweep", "--status", "cells"]).code, Some(2));
}

#[test]
fn a_worker_refuses_another_plan_other_inputs_and_another_version() {
    let shop = planned(2);
    let refused = |args: &[&str], said: &str| {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said) && ran.err.contains("help: "), "{args:?}: {}", ran.err);
        assert_eq!(rows(&shop), 0);
    };
    refused(&words(&sweep(3, &["--claim", "shared"])), "these differ: the sets\n");
    refused(&words(&sweep(2, &["--claim", "shared", "--seed", "4"])), "these differ: seed or budget\n");
    let robot = "robots/hitachi_pw10.toml";
    let was = shop.text(&format!("cells/{robot}"));
    shop.write(&format!("cells/{robot}"), &(was.clone() + "# a remark\n"));
    refused(&words(&sweep(2, &["--claim", "shared"])), &format!("these differ: {robot}\n"));
    shop.write(&format!("cells/{robot}"), &was);
    let join = ["sweep", "--claim", "shared"];
    shop.write(&format!("shared/inputs/{robot}"), &(was.clone() + "# a remark\n"));
    refused(&join, &format!("shared/inputs/{robot}: it has changed"));
    std::fs::remove_file(shop.path(&format!("shared/inputs/{robot}"))).unwrap();
    refused(&join, &format!("shared/inputs/{robot}: no such file"));
    // The full command writes the inputs again.
    shop.done(&words(&sweep(2, &["--claim", "shared", "--only", "0"])));
    assert_eq!(shop.text(&format!("shared/inputs/{robot}")), was);
    std::fs::remove_file(shop.path("shared/0000.json")).unwrap();
    let plan = shop.text("shared/plan.json");
    let old = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    shop.write("shared/plan.json", &resealed(&plan.replace(&old, "\"version\": \"0.0.9\"")));
    let said = format!("the version of the program ({}, not 0.0.9)\n", env!("CARGO_PKG_VERSION"));
    refused(&join, &said);
    refused(&["sweep", "--claim", "cells"], "cells has no plan.json");
}

#[cfg(unix)]
#[test]
fn a_full_disk_and_a_read_only_share_exit_3() {
    let shop = planned(3);
    assert_no_room_exits_3(&shop, "shared", "claims", &["sweep", "--claim", "shared"]);
    shop.done(&["sweep", "--claim", "shared"]);
    assert_whole(&shop, 3);
}

/// Starts a worker that evaluates `budget` layouts of its only combination.
fn start_long(shop: &Sandbox, budget: u64, more: &[&str]) -> Worker {
    let (height, budget) = (format!("{HEIGHTS}600"), budget.to_string());
    let args = ["sweep", CELL, "--budget", &budget, "--set", &height];
    Worker::start(shop, &[&args[..], more].concat())
}

/// Name of the checkpoint of the first combination.
const FIRST_CHECKPOINT: &str = "shared/.sweetspot-0000.checkpoint";

/// Returns the number of layouts after which a worker has continued a combination.
fn continued(worker: &RunOutput) -> u64 {
    let (_, count) = worker.err.split_once("note: combination 0 continues after ").unwrap_or_else(|| {
        panic!("it did not continue: {}", worker.err);
    });
    count.split(' ').next().unwrap().parse().unwrap()
}

/// Kills a worker after the first checkpoint of its combination, which the worker writes after 2 s. Returns
/// the folder, and a number of layouts of which at most a third are done.
fn killed_after_checkpoint() -> (Sandbox, u64) {
    let mut budget = 150_000;
    loop {
        let shop = Sandbox::new();
        let worker = start_long(&shop, budget, &["--claim", "shared", "--lease", "1"]);
        let (checkpoint, row) = (shop.path(FIRST_CHECKPOINT), shop.path("shared/0000.json"));
        wait_until("a checkpoint", || checkpoint.exists() || row.exists());
        // Dropping a worker kills it.
        drop(worker);
        match std::fs::read(checkpoint).ok().filter(|_| !row.exists()) {
            Some(text) => {
                let stored: Value = serde_json::from_slice(&text).unwrap();
                let done = stored["state"]["record"]["evaluations"].as_u64().unwrap();
                if 3 * done <= budget {
                    return (shop, budget);
                }
                budget = 4 * done;
            }
            None => budget *= 4,
        }
    }
}

/// One worker is killed with SIGKILL, and another worker is stopped. The next workers continue from the
/// checkpoints, and no checkpoint remains at the end.
#[cfg(unix)]
#[test]
fn a_killed_combination_continues_from_its_checkpoint() {
    let (shop, budget) = killed_after_checkpoint();
    let written = || shop.path(FIRST_CHECKPOINT).metadata().unwrap().modified().unwrap();
    let first = written();
    let second = Worker::start(&shop, &["sweep", "--claim", "shared", "--lease", "1"]);
    wait_until("the successor's checkpoint", || written() > first);
    let stopped = second.stopped();
    let third = shop.done(&["sweep", "--claim", "shared"]);
    assert!(continued(&third) > continued(&stopped), "{} {}", stopped.err, third.err);
    let straight = start_long(&shop, budget, &["--out", "straight"]).ended();
    assert_eq!(straight.code, Some(0), "{}", straight.err);
    assert_eq!(result(&shop, "shared"), result(&shop, "straight"));
}

/// A checkpoint that is damaged or belongs to another search costs time but changes no byte of the result.
#[cfg(unix)]
#[test]
fn a_useless_checkpoint_is_ignored_with_a_note() {
    let shop = Sandbox::new();
    let height = format!("{HEIGHTS}600,610");
    // The other search keeps two layouts, so its checkpoints never match, even if they contain few layouts.
    let keep = ["--set", "search.keep=2"];
    let args = [&["sweep", CELL, "--budget", "500", "--jobs", "1", "--set", &height], &keep[..]].concat();
    shop.done(&[&args[..], &["--out", "straight"]].concat());
    let put = |said: &str, text: &[u8]| {
        let folder = format!("shared{}", text.len());
        shop.done(&[&args[..], &["--out", &folder, "--plan-only"]].concat());
        shop.write_bytes(&format!("{folder}/.sweetspot-0000.checkpoint"), text);
        let ran = shop.done(&["sweep", "--claim", &folder]);
        assert!(
            ran.err.contains("note: combination 0 begins again, because ") && ran.err.contains(said),
            "{}",
            ran.err
        );
        assert_eq!(result(&shop, &folder), result(&shop, "straight"), "{said}");
    };
    put("its text does not match the hash", b"{}");
    let budget = 100_000;
    let worker = start_long(&shop, budget, &["--claim", "shared", "--lease", "1"]);
    wait_until("a claim", || shop.path("shared/claims/0000-1").exists());
    std::thread::sleep(Duration::from_millis(500));
    worker.stopped();
    let text = shop.text(FIRST_CHECKPOINT);
    put("its text does not match the hash", &text.as_bytes()[..text.len() - 9]);
    put("it is from another search", text.as_bytes());
    // This is the record of a step that the search does not repeat.
    let hash = text.split_once("\"asked\": [\n").unwrap().1.split_once(',').unwrap().0.trim();
    shop.write(FIRST_CHECKPOINT, &resealed(&text.replacen(hash, "7", 1)));
    let ran = shop.done(&["sweep", "--claim", "shared"]);
    assert!(
        ran.err.contains("begins again") && ran.err.contains("cannot reproduce the search"),
        "{}",
        ran.err
    );
    assert_eq!(start_long(&shop, budget, &["--out", "long"]).ended().code, Some(0));
    assert_eq!(result(&shop, "shared"), result(&shop, "long"));
}
