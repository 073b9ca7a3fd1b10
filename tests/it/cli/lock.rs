//! Tests that two programs never write to one result folder at the same time, and that the folder is free
//! again when its owner dies.

use crate::cli::sandbox::*;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

const LOCK: &str = ".sweetspot-lock";

/// Process of a search that would take minutes. The process is killed when the value is dropped.
struct RunningSearch(Child);

impl RunningSearch {
    /// Starts a search and waits for its first checkpoint.
    fn start(shop: &Sandbox) -> Self {
        let args = ["search", CELL, "--budget", "1000000", "--checkpoint", "0.05", "--out", "found"];
        let mut command = shop.command(&args);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let running = Self(child);
        let clock = Instant::now();
        while !shop.path("found/checkpoint.jsonl").is_file() {
            assert!(clock.elapsed() < Duration::from_secs(120), "no checkpoint");
            std::thread::sleep(Duration::from_millis(5));
        }
        running
    }

    /// Kills the process, which has the effect of a crash.
    fn kill(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

impl Drop for RunningSearch {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn assert_in_use(ran: &RunOutput, owner: &str) {
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    let said = format!("the folder found is in use by {owner}");
    assert!(ran.err.contains(&said), "no {said:?} in {}", ran.err);
    ran.no_panic();
}

#[test]
fn a_running_search_keeps_its_folder_until_it_dies() {
    let shop = Sandbox::new();
    let mut running = RunningSearch::start(&shop);
    let owner = format!("process {}: sweetspot search {CELL}", running.0.id());
    assert_in_use(&shop.run(&["search", "--resume", "found"]), &owner);
    assert_in_use(&shop.run(&["search", CELL, "--budget", "50", "--out", "found"]), &owner);
    assert_in_use(&shop.run(&["map", CELL, "--out", "found"]), &owner);
    assert!(running.0.try_wait().unwrap().is_none(), "the owner still runs");
    running.kill();
    assert!(shop.path("found").join(LOCK).is_file(), "a killed owner cannot tidy up");
    let ran = shop.run(&["search", "--resume", "found", "--time", "0.2"]);
    assert_eq!(ran.code, Some(4), "{}", ran.err);
    assert!(!shop.path("found").join(LOCK).exists(), "the lock outlives its owner");
}

#[test]
fn of_searches_started_together_one_gets_the_folder() {
    let shop = Sandbox::new();
    let rounds = crate::common::cases(4, 80);
    for round in 0..rounds {
        let folder = format!("found-{round}");
        let args = |seed| ["search", CELL, "--budget", "40", "--seed", seed, "--out", &folder];
        let start = |seed| {
            let mut command = shop.command(&args(seed));
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
        };
        let children = ["1", "2", "3"].map(start);
        let ended = children.map(|child| ran(child.wait_with_output().unwrap()));
        let done = ended.iter().filter(|ran| ran.code == Some(0)).count();
        assert_eq!(done, 1, "{}", ended.map(|ran| ran.err).concat());
        // A late process finds a finished search. The other processes find the folder in use.
        let refused = ended.iter().filter(|ran| ran.code != Some(0));
        refused.for_each(|ran| assert!(ran.code == Some(3) || ran.code == Some(2), "{}", ran.err));
        shop.done(&["report", &folder, "--json"]);
        assert!(!shop.path(&folder).join(LOCK).exists());
    }
    println!("{rounds} rounds of three searches, one result each");
}

#[test]
fn array_jobs_share_a_folder_and_a_whole_sweep_does_not_join_them() {
    let shop = Sandbox::new();
    let heights = "equipment.worktable.placement.z_mm=600,700,800";
    let sweep = ["sweep", CELL, "--map", "--set", heights, "--out", "found"];
    let job = |index: &str| {
        let mut command = shop.command(&[&sweep[..], &["--only", index]].concat());
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let ended = ["0", "1", "2"].map(job).map(|child| ran(child.wait_with_output().unwrap()));
    ended.iter().for_each(|ran| assert_eq!(ran.code, Some(0), "{}", ran.err));
    assert!(!shop.path("found").join(LOCK).exists(), "the last job removes the lock");

    let lock = std::fs::File::create(shop.path("found").join(LOCK)).unwrap();
    std::fs::write(shop.path("found").join(LOCK), "process 1: sweetspot sweep --only 2").unwrap();
    lock.lock_shared().unwrap();
    shop.done(&[&sweep[..], &["--only", "1"]].concat());
    assert_eq!(shop.run(&sweep).code, Some(3));
    lock.unlock().unwrap();
    shop.done(&sweep);
    shop.has("found", &["table.json", "0000.json", "0001.json", "0002.json"]);
}

#[test]
fn a_lock_file_of_a_killed_owner_does_not_change_a_finished_result() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "40", "--out", "found"]);
    let page = shop.done(&["report", "found", "--json"]).out;
    shop.write(&format!("found/{LOCK}"), "process 1: sweetspot search");
    assert_eq!(shop.done(&["report", "found", "--json"]).out, page);
    shop.done(&["map", "found/best.toml"]);
}

#[cfg(unix)]
#[test]
fn a_lock_that_is_no_file_is_refused() {
    let shop = Sandbox::new();
    std::fs::create_dir(shop.path("found")).unwrap();
    let fifo = shop.path("found").join(LOCK);
    assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    let ran = shop.run(&["map", CELL, "--out", "found"]);
    assert_eq!(ran.code, Some(3), "{}", ran.err);
    assert!(ran.err.contains("found/.sweetspot-lock is not a file: remove it"), "{}", ran.err);
}
