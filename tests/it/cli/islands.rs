//! Tests `search --islands`: one island is a plain search, and several islands are merged by a fixed rule.
//! The bytes depend neither on the workers nor on the order in which they finish.

use crate::cli::sandbox::*;
use crate::cli::worker::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Duration;

const BUDGET: [&str; 2] = ["--budget", "300"];

fn search<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["search", CELL], &BUDGET[..], more].concat()
}

/// Returns every file of a folder with its bytes, without the claims and the files of jobs.
pub fn result(shop: &Sandbox, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let own = |f: &String| !f.starts_with("islands/claims/") && !f.starts_with("islands/slurm/");
    let files = shop.files(folder).into_iter().filter(own);
    files.map(|f| (f.clone(), shop.read(&format!("{folder}/{f}")))).collect()
}

/// Asserts that two folders contain the same files with the same bytes.
pub fn assert_same(shop: &Sandbox, a: &str, b: &str) {
    let (a, b) = (result(shop, a), result(shop, b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    a.iter().for_each(|(name, bytes)| assert!(b[name] == *bytes, "{name} differs"));
}

fn assert_one_island_is_plain(more: &[&str], files: &[&str]) {
    let shop = Sandbox::new();
    shop.done(&[&search(&["--seed", "3", "--out", "plain"])[..], more].concat());
    shop.done(&[&search(&["--seed", "3", "--islands", "1", "--out", "one"])[..], more].concat());
    let [plain, mut one] = ["plain", "one"].map(|folder| shop.document(&format!("{folder}/search.json")));
    let islands = one.as_object_mut().unwrap().remove("islands").unwrap();
    assert_eq!(plain, one);
    assert_eq!(items(&islands).len(), 1);
    assert_eq!((&islands[0]["seed"], &islands[0]["is_best"]), (&3.into(), &true.into()));
    assert_eq!(islands[0]["evaluations"], plain["evaluations"]);
    for file in files {
        assert!(shop.read(&format!("plain/{file}")) == shop.read(&format!("one/{file}")), "{file}");
    }
}

#[test]
fn one_island_is_a_plain_search() {
    assert_one_island_is_plain(&[], &["best.toml", "map.csv", "map.svg"]);
}

#[test]
fn one_island_has_the_shortlist_and_the_front_of_a_plain_search() {
    assert_one_island_is_plain(
        &["--keep", "3"],
        &["best.toml", "front.csv", "layout-01.toml", "layout-03.toml"],
    );
    assert_one_island_is_plain(&["--pareto", "error,clearance"], &["best.toml", "front.csv", "front.svg"]);
}

/// `search --islands` returns the result of the best seed, with the evaluations of all seeds. Other commands
/// can read it.
#[test]
fn the_best_of_several_seeds_is_the_result() {
    let shop = Sandbox::new();
    let found = shop.json(&search(&["--seed", "5", "--islands", "3", "--out", "found"]));
    let plain: Vec<Value> = ["5", "6", "7"]
        .iter()
        .map(|seed| shop.json(&search(&["--seed", seed, "--out", &format!("plain-{seed}")])))
        .collect();
    let least: Vec<f64> = plain.iter().map(|p| number(&p["least_value"])).collect();
    let best = (0..3).min_by(|a, b| least[*a].total_cmp(&least[*b])).unwrap();
    for key in ["layout", "objective_value", "least_value", "operations", "bound", "gap_percent", "regions"] {
        assert_eq!(found[key], plain[best][key], "{key}");
    }
    let sum = |key: &str| plain.iter().map(|p| p[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!([&found["evaluations"], &found["feasible"]], [sum("evaluations"), sum("feasible")]);
    for (k, island) in items(&found["islands"]).iter().enumerate() {
        assert_eq!((&island["seed"], &island["is_best"]), (&(5 + k).into(), &(k == best).into()));
        for key in ["least_value", "evaluations", "feasible", "ended"] {
            assert_eq!(island[key], plain[k][key], "{key} of island {k}");
        }
    }
    // The trace joins the traces of the searches, one after the other.
    let trace = items(&found["trace"]);
    assert!(trace.windows(2).all(|w| number(&w[0][1]) > number(&w[1][1])), "{trace:?}");
    assert!(trace.windows(2).all(|w| number(&w[0][0]) < number(&w[1][0])), "{trace:?}");
    let first = items(&plain[0]["trace"]);
    assert_eq!(&trace[..first.len()], first);
    assert_eq!(number(&trace[trace.len() - 1][1]), least[best]);
    shop.done(&["report", "found", "-o", "found.html"]);
    shop.done(&["export", "found", "--to", "csv", "-o", "found.csv"]);
    let compared = shop.json(&["compare", "found", &format!("plain-{}", 5 + best)]);
    assert_eq!(compared["layouts"][0]["objective"], compared["layouts"][1]["objective"]);
    shop.done(&["map", "found/best.toml"]);
    let table = shop.document("found/islands/table.json");
    assert_eq!(table["best_of"][0]["path"], "search.seed");
    // The command of the manifest makes the folder again.
    let manifest = shop.document("found/manifest.json");
    let command: Vec<&str> = items(&manifest["command"]).iter().map(text).collect();
    shop.done(&[&command[..], &["--out", "again"]].concat());
    assert_same(&shop, "found", "again");
    // A finished folder is merged again without a search.
    let before = result(&shop, "found");
    shop.done(&["search", "--resume", "found"]);
    assert_eq!(before, result(&shop, "found"));
}

/// Every member of the merged front belongs to the front of an island, and no member of an island's front
/// dominates it.
#[test]
fn the_merged_front_is_that_of_all_fronts() {
    let shop = Sandbox::new();
    let front = |more: &[&str]| {
        let goals = ["search", CELL, "--pareto", "error,clearance,footprint", "--budget", "500"];
        let document = shop.json(&[&goals[..], more].concat());
        let losses = |l: &Value| {
            let goal = |key: &str| number(&l["goals"][key]);
            [goal("error"), -goal("clearance_mm"), goal("footprint_m2")]
        };
        items(&document["front"]).iter().map(losses).collect::<Vec<[f64; 3]>>()
    };
    let merged = front(&["--islands", "3", "--out", "merged"]);
    let own: Vec<_> =
        ["1", "2", "3"].iter().flat_map(|seed| front(&["--seed", seed, "--out", seed])).collect();
    let dominates = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| a <= b) && a != b;
    for member in &merged {
        assert!(own.contains(member), "{member:?} is of no island");
        assert!(!own.iter().any(|other| dominates(other, member)), "{member:?} is dominated");
    }
    let dominated = own.iter().filter(|member| own.iter().any(|other| dominates(other, member))).count();
    assert!(dominated > 0, "merging had nothing to do");
    assert!(merged.len() > 3 && merged.len() <= own.len() - dominated, "{} of {}", merged.len(), own.len());
    let kept = shop.json(&[
        "search",
        CELL,
        "--pareto",
        "error,clearance,footprint",
        "--budget",
        "500",
        "--islands",
        "3",
        "--keep",
        "4",
        "--out",
        "kept",
    ]);
    assert_eq!(items(&kept["front"]).len(), 4);
}

/// Waits until the given number of islands is finished.
fn wait_for(shop: &Sandbox, folder: &str, islands: usize) {
    let done = || (0..99).filter(|k| shop.path(&format!("{folder}/islands/{k:04}.json")).exists()).count();
    wait_until("islands", || done() >= islands);
}

#[test]
fn islands_in_any_order_give_the_same_bytes() {
    let shop = Sandbox::new();
    shop.done(&search(&["--islands", "5", "--threads", "1", "--out", "straight"]));
    shop.done(&search(&["--islands", "5", "--threads", "4", "--out", "parallel"]));
    assert_same(&shop, "straight", "parallel");
    // The islands are processed in reverse order, each by a worker that has only the folder.
    for file in shop.files("straight/islands") {
        if file == "plan.json" || file.starts_with("inputs/") {
            let to = shop.path(&format!("backwards/islands/{file}"));
            std::fs::create_dir_all(to.parent().unwrap()).unwrap();
            std::fs::copy(shop.path(&format!("straight/islands/{file}")), to).unwrap();
        }
    }
    std::fs::rename(shop.path("cells"), shop.path("elsewhere")).unwrap();
    for index in ["4", "2", "3", "0"] {
        shop.done(&["sweep", "--claim", "backwards/islands", "--only", index]);
    }
    assert!(!shop.path("backwards/search.json").exists());
    shop.done(&["search", "--claim", "backwards"]);
    assert_same(&shop, "straight", "backwards");
}

/// The test kills one of three workers with SIGKILL six times, and starts a new worker each time.
#[test]
fn killed_workers_end_in_the_bytes_of_a_straight_run() {
    const KILLS: usize = 6;
    let shop = Sandbox::new();
    let islands = ["search", CELL, "--budget", "60", "--islands", "16"];
    shop.done(&[&islands[..], &["--out", "straight"]].concat());
    let claim = [&islands[..], &["--claim", "shared", "--threads", "1", "--lease", "2"]].concat();
    let mut workers: Vec<Worker> = (0..3).map(|_| Worker::start(&shop, &claim)).collect();
    for kill in 0..KILLS {
        wait_for(&shop, "shared", 2 * kill);
        std::thread::sleep(Duration::from_millis(17 * kill as u64));
        // Dropping a worker kills it.
        drop(workers.swap_remove(kill % 3));
        workers
            .push(Worker::start(&shop, &["search", "--claim", "shared", "--threads", "1", "--lease", "2"]));
    }
    for (k, worker) in workers.into_iter().enumerate() {
        let ran = worker.ended();
        ran.no_panic();
        assert_eq!(ran.code, Some(0), "worker {k}: {}", ran.err);
    }
    assert_same(&shop, "straight", "shared");
    let again = shop.files("shared/islands/claims").len() - 16;
    assert!(again <= KILLS, "{again} islands were begun again after {KILLS} kills");
    println!("{KILLS} kills: {again} of 16 islands were begun again");
}

#[cfg(unix)]
#[test]
fn islands_on_a_full_disk_or_a_read_only_share_exit_3() {
    let shop = Sandbox::new();
    let islands = ["search", CELL, "--budget", "60", "--islands", "3"];
    // This command writes the plan but no island.
    shop.done(&[&islands[..], &["--on", "slurm", "--chunk", "1", "--dry-run", "--out", "spread"]].concat());
    assert_no_room_exits_3(&shop, "spread", "islands/claims", &["search", "--claim", "spread"]);
    shop.done(&["search", "--claim", "spread"]);
    shop.done(&[&islands[..], &["--out", "straight"]].concat());
    assert_same(&shop, "straight", "spread");
}

#[cfg(unix)]
#[test]
fn interrupted_islands_go_on() {
    let shop = Sandbox::new();
    let islands = ["search", CELL, "--budget", "500", "--islands", "6", "--threads", "1"];
    let worker = Worker::start(&shop, &[&islands[..], &["--out", "found"]].concat());
    wait_for(&shop, "found", 2);
    let ended = worker.stopped();
    assert_eq!(ended.out, "", "{}", ended.err);
    assert!(ended.err.contains("next: sweetspot search --resume found\n"), "{}", ended.err);
    assert!(!shop.path("found/search.json").exists());
    let kept = shop.read("found/islands/0000.json");
    let ran = shop.done(&["search", "--resume", "found"]);
    assert!(ran.out.contains("islands\n") && ran.out.contains("6 seeds"), "{}", ran.out);
    assert_eq!(kept, shop.read("found/islands/0000.json"));
    shop.done(&[&islands[..], &["--out", "straight"]].concat());
    assert_same(&shop, "found", "straight");
}

#[test]
fn what_does_not_fit_islands_is_refused_with_words() {
    let shop = Sandbox::new();
    shop.done(&search(&["--islands", "2", "--out", "found"]));
    let before = result(&shop, "found");
    shop.write("cells/changed.toml", "from = \"hitachi_cell.toml\"\n");
    let cases: [(&[&str], &str); 14] = [
        (&["search", CELL, "--islands", "0"], "0 is not in 1..=10000"),
        (&["search", CELL, "--islands", "2", "--resume", "found"], "cannot be used with"),
        (&["search", CELL, "--islands", "2", "--time", "9"], "cannot be used with"),
        (&["search", CELL, "--islands", "2", "--checkpoint", "9"], "cannot be used with"),
        (&["search", CELL, "--claim", "new"], "the number of islands is missing"),
        (&["search", CELL, "--on", "slurm"], "the number of islands is missing"),
        (&["search", "--claim", "new"], "new holds no islands"),
        (&["search", CELL, "--islands", "2", "--task-time", "1:00"], "--on"),
        (
            &["search", "--resume", "found", "--budget", "400"],
            "--budget 400 cannot be used with the islands in found",
        ),
        (&["search", CELL, "--resume", "found", "--time", "9"], "hitachi_cell.toml, --time cannot be used"),
        (&["search", PAPER, "--islands", "2", "--out", "new"], "so all islands would be equal"),
        (
            &["search", CELL, "--islands", "2", "--seed", "18446744073709551615", "--out", "new"],
            "exceed the largest seed",
        ),
        (
            &["search", CELL, "--budget", "300", "--islands", "3", "--out", "found"],
            "the seeds of the islands",
        ),
        (
            &["search", CELL, "--budget", "200", "--islands", "2", "--claim", "found"],
            "the flags of the search",
        ),
    ];
    for (args, said) in cases {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{args:?}: no {said:?} in {}", ran.err);
    }
    assert!(!shop.path("new").exists());
    assert_eq!(before, result(&shop, "found"));
    // The inputs of the plan are used, even if the cell file changes.
    let inputs = shop.text("found/islands/inputs/hitachi_cell.toml");
    shop.write(
        "found/islands/inputs/hitachi_cell.toml",
        &inputs.replace("[search]", "[search]\nrobust = true"),
    );
    let ran = shop.run(&["search", "--claim", "found"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("it has changed: its hash is not the one in plan.json"), "{}", ran.err);
    assert!(ran.err.contains("CELL and --islands"), "{}", ran.err);
    shop.done(&search(&["--islands", "2", "--claim", "found"]));
    assert_eq!(before.keys().collect::<Vec<_>>(), result(&shop, "found").keys().collect::<Vec<_>>());
    // A folder with other files is not touched.
    std::fs::create_dir(shop.path("full")).unwrap();
    shop.write("full/notes.txt", "mine");
    let ran = shop.run(&search(&["--islands", "2", "--claim", "full"]));
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("full is not empty"), "{}", ran.err);
    assert_eq!(shop.files("full"), ["notes.txt"]);
}

/// A damaged island is searched again.
#[test]
fn damaged_islands_are_mended() {
    let shop = Sandbox::new();
    shop.done(&search(&["--islands", "3", "--out", "found"]));
    let before = result(&shop, "found");
    let whole = shop.text("found/islands/0001.island.json");
    shop.write("found/islands/0001.island.json", &whole[..whole.len() / 2]);
    let ran = shop.done(&["search", "--resume", "found"]);
    assert!(ran.err.contains("0001.island.json: its hash is not the one in 0001.json"), "{}", ran.err);
    assert_eq!(before, result(&shop, "found"));
}
