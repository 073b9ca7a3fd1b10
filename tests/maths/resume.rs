//! Tests that a search that is stopped anywhere and resumed gives the same bits as an uninterrupted search.

use crate::common::shipped;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use sweetspot::cell::{SearchSettings, Solver};
use sweetspot::layout::Workcell;
use sweetspot::search::{
    Checkpoint, Moment, SearchEnd, SearchJob, SearchRecord, Stopping, Unfit, Watch, search_job,
};

fn workcell() -> Workcell {
    Workcell::new(shipped("hitachi_cell.toml")).unwrap()
}

fn settings(solver: Solver, budget: u64) -> SearchSettings {
    SearchSettings { solver, budget, seed: 3, ..shipped("hitachi_cell.toml").search }
}

/// Runs a search to the end, starting from the checkpoint text `from` if there is one. Returns the record and
/// every checkpoint.
fn run(
    workcell: &Workcell,
    settings: &SearchSettings,
    bound: Option<f64>,
    from: Option<&str>,
) -> (SearchRecord, Vec<Checkpoint>) {
    let kept = Mutex::new(Vec::new());
    let keep = |c: &Checkpoint, _: Moment| kept.lock().unwrap().push(c.clone());
    let from = from.map(checkpoint);
    let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
    let record =
        search_job(workcell, settings, &watch, &SearchJob { bound, from: from.as_ref(), keep: &keep });
    (record, kept.into_inner().unwrap())
}

/// Returns the parts of a record that must be equal in two searches, with floats as bits.
fn bits(record: &SearchRecord) -> (u64, u64, Vec<(u64, u64)>, String, SearchEnd) {
    let trace = record.trace.iter().map(|(n, e)| (*n, e.to_bits())).collect();
    let best = format!("{:?} {}", record.best, record.best.evaluation.cost.to_bits());
    (record.evaluations, record.feasible, trace, best, record.ended)
}

fn checkpoint(text: &str) -> Checkpoint {
    serde_json::from_str(text).unwrap()
}

fn text(checkpoint: &Checkpoint) -> String {
    serde_json::to_string(checkpoint).unwrap()
}

#[test]
fn every_checkpoint_resumes_to_the_same_bits() {
    let workcell = workcell();
    for solver in Solver::ALL {
        let settings = settings(solver, 260);
        let (whole, kept) = run(&workcell, &settings, None, None);
        assert!(kept.len() > 6, "{}: {} checkpoints", solver.name(), kept.len());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        for (k, from) in kept.iter().enumerate() {
            let again = || run(&workcell, &settings, None, Some(&text(from)));
            let (record, after) = if k % 2 == 0 { again() } else { pool.install(again) };
            assert_eq!(bits(&record), bits(&whole), "{} from checkpoint {k}", solver.name());
            // The following checkpoints are also equal, so the search may be killed again.
            assert_eq!(
                after.last().map(text),
                kept.last().map(text),
                "{} from checkpoint {k}",
                solver.name()
            );
        }
    }
}

/// The checkpoints of a longer search cover restarts and the final local search.
#[test]
fn checkpoints_of_any_run_resume_to_the_same_bits() {
    let workcell = workcell();
    for solver in Solver::ALL {
        let settings = settings(solver, 9_000);
        let (whole, kept) = run(&workcell, &settings, None, None);
        let runs = |c: &Checkpoint| serde_json::to_value(c).unwrap()["run"].as_u64();
        assert!(runs(kept.last().unwrap()) > Some(0), "{}: no restart", solver.name());
        for from in kept.iter().step_by(kept.len() / 6).chain(kept.last()) {
            let (record, _) = run(&workcell, &settings, None, Some(&text(from)));
            assert_eq!(bits(&record), bits(&whole), "{}", solver.name());
        }
    }
}

/// The stop flag interrupts the search many times, each time after some hundred more evaluations.
#[test]
fn a_search_stopped_many_times_ends_in_the_same_bits() {
    let workcell = workcell();
    for solver in Solver::ALL {
        let settings = settings(solver, 3_000);
        let (whole, _) = run(&workcell, &settings, None, None);
        let mut from: Option<Checkpoint> = None;
        for round in 1.. {
            let stop = AtomicBool::new(false);
            let progress = |p: sweetspot::search::Progress| {
                stop.fetch_or(p.evaluations >= round * 377, Ordering::Relaxed);
            };
            let kept = Mutex::new(None);
            let keep = |c: &Checkpoint, _: Moment| *kept.lock().unwrap() = Some(c.clone());
            let job = SearchJob { bound: None, from: from.as_ref(), keep: &keep };
            let record = search_job(&workcell, &settings, &Watch { progress: &progress, stop: &stop }, &job);
            if record.ended != SearchEnd::Interrupted {
                assert_eq!(bits(&record), bits(&whole), "{}", solver.name());
                assert!(round > 5, "{}: it was hardly stopped", solver.name());
                break;
            }
            let now = kept.into_inner().unwrap().unwrap();
            // The reported record is the one in the checkpoint.
            assert_eq!(now.evaluations(), record.evaluations, "{}", solver.name());
            assert!(record.evaluations < round * 377 + 100, "{}", solver.name());
            from = Some(now);
        }
    }
}

/// If a checkpoint is resumed with a larger budget or other stopping rules, the result is the search under
/// the new rules.
#[test]
fn stopping_rules_may_change_on_resume() {
    let workcell = workcell();
    for solver in Solver::ALL {
        let first = settings(solver, 700);
        let (_, kept) = run(&workcell, &first, None, None);
        for next in [
            SearchSettings { budget: 1_500, ..first },
            SearchSettings { budget: 701, ..first },
            SearchSettings { stagnation: Some(150), ..first },
            SearchSettings { gap: Some(0.05), budget: 2_000, ..first },
        ] {
            let bound = next.gap.map(|_| 0.020429669);
            let (whole, _) = run(&workcell, &next, bound, None);
            let rules = Stopping::new(&next, bound);
            for from in kept.iter().step_by(1 + kept.len() / 8).chain(kept.last()) {
                match from.check(7, &rules) {
                    Ok(()) => {
                        let (record, after) = run(&workcell, &next, bound, Some(&text(from)));
                        assert_eq!(bits(&record), bits(&whole), "{} {next:?}", solver.name());
                        // The resumed search may be killed again.
                        let middle = after.get(after.len() / 2).map(text);
                        let (record, _) = run(&workcell, &next, bound, middle.as_deref());
                        assert_eq!(bits(&record), bits(&whole), "{} {next:?}", solver.name());
                    }
                    // The refusal is right only if the uninterrupted search ended earlier.
                    Err(why) => assert!(
                        matches!(why, Unfit::Ended(_)) && whole.evaluations < from.evaluations(),
                        "{why:?}"
                    ),
                }
            }
        }
    }
}

#[test]
fn a_checkpoint_of_another_search_is_refused() {
    let workcell = workcell();
    let settings = settings(Solver::CmaEs, 400);
    let (_, kept) = run(&workcell, &settings, None, None);
    let last = kept.last().unwrap();
    let rules = Stopping::new(&settings, None);
    assert_eq!(last.check(7, &rules), Ok(()));
    assert_eq!(last.check(6, &rules), Err(Unfit::Dimensions { has: 7, needs: 6 }));
    let used = last.evaluations();
    let small = Stopping { budget: used - 1, ..rules };
    assert_eq!(last.check(7, &small), Err(Unfit::Budget { used }));
    assert_eq!(last.check(7, &Stopping { budget: used, ..rules }), Ok(()));
    // With another seed, the search evaluates other points, so the journal does not match.
    let other = SearchSettings { seed: 4, ..settings };
    let (record, _) = run(&workcell, &other, None, Some(&text(last)));
    assert_eq!(record.ended, SearchEnd::Diverged);
    // One bit of one point is changed.
    let middle = text(&kept[kept.len() / 2]);
    let middle: Vec<&str> = middle.split("\"asked\":[").collect();
    let (hash, rest) = middle[1].split_once(',').unwrap();
    let changed = format!("{}\"asked\":[{},{rest}", middle[0], hash.parse::<u64>().unwrap() ^ 1);
    assert_eq!(run(&workcell, &settings, None, Some(&changed)).0.ended, SearchEnd::Diverged);
}

#[test]
fn a_reached_gap_ends_a_search() {
    let workcell = workcell();
    let settings = SearchSettings { gap: Some(0.01), ..settings(Solver::CmaEs, 20_000) };
    let bound = 0.020429669;
    let (record, _) = run(&workcell, &settings, Some(bound), None);
    assert_eq!(record.ended, SearchEnd::Gap);
    let best = record.best.evaluation.objective.unwrap();
    assert!(best <= bound * 1.01 && record.evaluations < 5_000, "{best} {}", record.evaluations);
    assert_eq!(record.gap(), Some(best / bound - 1.0));
    // Before the last generation the gap was wider.
    let before = record.trace.iter().rev().find(|(n, _)| *n + 20 < record.evaluations).unwrap();
    assert!(before.1 > bound * 1.01, "{before:?}");
    // Without a bound, the search continues.
    let (record, _) = run(&workcell, &SearchSettings { budget: 6_000, ..settings }, None, None);
    assert_eq!((record.ended, record.gap()), (SearchEnd::Done, None));
}

#[test]
fn stagnation_ends_a_search() {
    let workcell = workcell();
    for solver in Solver::ALL {
        let settings = SearchSettings { stagnation: Some(800), ..settings(solver, 100_000) };
        let (record, _) = run(&workcell, &settings, None, None);
        assert_eq!(record.ended, SearchEnd::Stagnation, "{}", solver.name());
        assert!(record.evaluations < 60_000, "{}: {}", solver.name(), record.evaluations);
        // The trace shows an interval of this length without improvement.
        let mut steps = vec![record.trace[0]];
        for &(n, e) in &record.trace {
            if e < steps[steps.len() - 1].1 * (1.0 - 1e-6) {
                steps.push((n, e));
            }
        }
        let ends = steps.iter().skip(1).map(|s| s.0).chain([record.evaluations]);
        let longest = steps.iter().zip(ends).map(|(s, end)| end - s.0).max().unwrap();
        assert!(longest >= 800, "{}: {longest}", solver.name());
    }
}
