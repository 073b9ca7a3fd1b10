//! Tests the merging of islands: the rule, ties, and fronts with more members than one search keeps.

use crate::common::{buildable, shipped};
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Goal, Goals, Layout, SearchSettings};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::search::{Island, IslandLayout, SearchEnd, SearchSpace, Watch, best_island, merged, search};

fn workcell(settings: SearchSettings) -> Workcell {
    Workcell::new(Cell { search: settings, ..shipped("hitachi_cell.toml") }).unwrap()
}

fn settings() -> SearchSettings {
    SearchSettings { budget: 400, ..shipped("hitachi_cell.toml").search }
}

/// Returns an island whose layouts are given with invented costs and goals.
fn island(seed: u64, best: &Layout, least: Option<f64>, alternatives: Vec<IslandLayout>) -> Island {
    Island {
        seed,
        best: best.clone(),
        cost: least.unwrap_or(7.0 + seed as f64),
        least,
        evaluations: 10 * seed,
        feasible: seed,
        trace: least.map(|least| (seed, least)).into_iter().collect(),
        ended: SearchEnd::Done,
        alternatives,
    }
}

#[test]
fn the_least_objective_wins_and_the_first_of_equals() {
    let start = workcell(settings()).cell.start();
    let all = |least: &[Option<f64>]| -> Vec<Island> {
        least.iter().enumerate().map(|(k, l)| island(k as u64 + 1, &start, *l, Vec::new())).collect()
    };
    assert_eq!(best_island(&all(&[Some(3.0), Some(2.0), None, Some(2.0)])), Some(1));
    // If no island has an accepted layout, the island of least cost is best; here it is the first island.
    assert_eq!(best_island(&all(&[None, None])), Some(0));
    assert_eq!(best_island(&[]), None);
    let record = merged(&workcell(settings()), &all(&[Some(3.0), None, Some(3.0), Some(1.0)]), None).unwrap();
    assert_eq!((record.evaluations, record.feasible), (100, 10));
    assert_eq!(record.trace, [(1, 3.0), (64, 1.0)]);
    assert!(merged(&workcell(settings()), &[], None).is_none());
}

/// A stored island keeps every bit of its search. Merging this island alone gives the record of the search
/// again.
#[test]
fn an_island_survives_its_file() {
    let cell = buildable("hitachi_cell.toml");
    let plain = SearchSettings { budget: 400, ..cell.search };
    let front = SearchSettings { pareto: Goals::of(&[Goal::Error, Goal::Clearance]).unwrap(), ..plain };
    for settings in [plain, SearchSettings { keep: 3, ..plain }, front] {
        let workcell = Workcell::new(Cell { search: settings, ..cell.clone() }).unwrap();
        let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
        let record = search(&workcell, &settings, &watch);
        let island = Island::new(&settings, &record);
        let text = serde_json::to_string(&island).unwrap();
        let read: Island = serde_json::from_str(&text).unwrap();
        assert_eq!(read, island);
        let again = merged(&workcell, &[read], record.bound).unwrap();
        assert_eq!(again.best, record.best);
        // A goal that the cell does not measure is NaN, which equals nothing. The comparison therefore uses
        // texts.
        assert_eq!(format!("{:?}", again.alternatives), format!("{:?}", record.alternatives));
        assert_eq!((again.trace, again.least, again.ended), (record.trace, record.least, record.ended));
    }
}

/// The members of two fronts of 150 members each lie on one line, so they do not dominate each other. The
/// merged front keeps members of both fronts and no dominated layout.
#[test]
fn large_fronts_are_thinned_without_dominated_members() {
    let pareto = Goals::of(&[Goal::Error, Goal::Travel]).unwrap();
    let workcell = workcell(SearchSettings { pareto, ..settings() });
    let space = SearchSpace::new(&workcell.cell);
    // The merged front evaluates its members, so they lie around a feasible layout.
    let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
    let found = search(&workcell, &SearchSettings { pareto: Goals::NONE, ..settings() }, &watch).best.layout;
    assert!(evaluate(&workcell, &found).objective.is_some());
    let layout = |k: usize, dimension: usize| {
        let mut point = space.point(&found);
        point[dimension] = (k as f64 + 0.5) / 300.0;
        space.layout(&point)
    };
    // The coordinate along which the most layouts are feasible.
    let is_feasible = |layout: &Layout| evaluate(&workcell, layout).objective.is_some();
    let feasible = |d: &usize| (0..300).step_by(15).filter(|k| is_feasible(&layout(*k, *d))).count();
    let dimension = (0..space.dimensions()).max_by_key(feasible).unwrap();
    let losses = |k: usize, worse: f64| vec![k as f64 + worse, 300.0 - k as f64 + worse];
    let member = |k: usize| IslandLayout { layout: layout(k, dimension), cost: 1.0, losses: losses(k, 0.0) };
    let dominated = |k: usize| IslandLayout { layout: found.clone(), cost: 1.0, losses: losses(k, 0.25) };
    let even = (0..300).step_by(2).map(member).chain((1..300).step_by(50).map(dominated)).collect();
    let odd = (1..300).step_by(2).map(member).chain((0..300).step_by(50).map(dominated)).collect();
    let islands = [island(1, &found, Some(1.0), even), island(2, &found, Some(2.0), odd)];
    let record = merged(&workcell, &islands, None).unwrap();
    let kept: Vec<&Layout> = record.alternatives.iter().map(|a| &a.candidate.layout).collect();
    assert!(kept.len() > 5, "{} layouts", kept.len());
    assert!(!kept.contains(&&found), "a dominated layout is kept");
    let place = |layout: &Layout| space.point(layout)[dimension];
    // Kept layouts differ by more than 1 % of the range, and each island contributes some.
    assert!(kept.windows(2).all(|w| place(w[1]) - place(w[0]) > 0.01), "layouts are similar");
    let number = |layout: &Layout| (place(layout) * 300.0 - 0.5).round() as usize;
    assert!(kept.iter().any(|l| number(l) % 2 == 0) && kept.iter().any(|l| number(l) % 2 == 1));
}
