//! Tests the search against known results: a proven bound, complete scans, and cells with few coordinates.

use crate::common::{buildable, from_text, from_text_to_build, shipped};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use sweetspot::cell::{Cell, Coordinate, Layout, Objective, Place, SearchSettings, Sense, Solver};
use sweetspot::error_map::Outcome;
use sweetspot::layout::{Evaluation, Workcell, evaluate};
use sweetspot::proof::{ProofOptions, prove};
use sweetspot::search::{SearchEnd, SearchJob, SearchRecord, SearchSpace, Watch, search, search_job};
use sweetspot::units::{m_from_mm, mm_from_m};

fn run(workcell: &Workcell, settings: SearchSettings) -> SearchRecord {
    let (stop, progress) = (AtomicBool::new(false), |_| {});
    let record = search(workcell, &settings, &Watch { progress: &progress, stop: &stop });
    check(workcell, &settings, &record);
    record
}

/// Checks properties that the record of every search must have.
fn check(workcell: &Workcell, settings: &SearchSettings, record: &SearchRecord) {
    assert!(record.evaluations <= settings.budget.max(1), "{} evaluations", record.evaluations);
    assert!(record.feasible <= record.evaluations);
    // Reported values equal those of `evaluate`, to the bit.
    for candidate in [&record.start, &record.best] {
        let again = evaluate(workcell, &candidate.layout);
        assert_eq!(bits(&again), bits(&candidate.evaluation));
        assert_eq!(again, candidate.evaluation);
    }
    assert_eq!(record.start.layout, workcell.cell.start());
    lies_in_its_ranges(&workcell.cell, &record.best.layout);
    let improving = record.trace.windows(2).all(|w| w[0].0 <= w[1].0 && w[0].1 > w[1].1);
    assert!(improving, "the trace goes back: {:?}", record.trace);
    if let Some((_, last)) = record.trace.last() {
        assert_eq!(Some(last.to_bits()), bits(&record.best.evaluation).0, "the trace ends elsewhere");
    }
    assert_eq!(record.found(), record.best.evaluation.objective.is_some());
}

fn bits(evaluation: &Evaluation) -> (Option<u64>, u64) {
    (evaluation.objective.map(f64::to_bits), evaluation.cost.to_bits())
}

/// Checks that free coordinates lie in their ranges and that fixed coordinates are unchanged.
fn lies_in_its_ranges(cell: &Cell, layout: &Layout) {
    for (equipment, p) in cell.equipment.iter().zip(&layout.placements) {
        for (coordinate, value) in equipment.placement.iter().zip([p.x, p.y, p.z, p.yaw]) {
            let inside = match coordinate {
                Coordinate::Fixed(fixed) => value.to_bits() == fixed.to_bits(),
                Coordinate::Range { min, max, .. } => (*min..=*max).contains(&value),
                Coordinate::List(values) => values.contains(&value),
            };
            assert!(inside, "{}: {value} in {coordinate:?}", equipment.name);
        }
    }
}

/// In drilling_cell, a better layout has another listed height of the table and another height of the base.
/// A converged run of a solver cannot change both heights together, so the restarts must do it. The lower
/// bound of the objective is 32.46 mm. Searches that stay at 600 mm end 3.8 to 4.4 % above it.
#[test]
fn restarts_leave_a_listed_value_that_a_run_chose_early() {
    let workcell = Workcell::new(buildable("drilling_cell.toml")).unwrap();
    let (stop, progress) = (AtomicBool::new(false), |_| {});
    let watch = Watch { progress: &progress, stop: &stop };
    for seed in [2, 3] {
        let found = search(&workcell, &SearchSettings { seed, ..workcell.cell.search }, &watch);
        let least = mm_from_m(found.least.expect("feasible"));
        assert!((32.46..32.46 * 1.02).contains(&least), "seed {seed}: {least} mm");
    }
}

/// Returns the error at the spot of every operation (m); None if an operation has no spot.
fn errors(evaluation: &Evaluation) -> Option<Vec<f64>> {
    let of = |o: &Outcome| match o {
        Outcome::Found(spot) => Some(spot.value),
        _ => None,
    };
    evaluation.outcomes.iter().map(of).collect()
}

fn settings(solver: Solver, budget: u64) -> SearchSettings {
    SearchSettings { solver, budget, ..SearchSettings::default() }
}

/// Returns a cell of one table; `placement` and `more` are TOML.
fn one_table(placement: &str, more: &str) -> Workcell {
    let text = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         robot = {{ from = \"robots/hitachi_pw10.toml\" }}\n\
         [equipment.worktable]\nfrom = \"equipment/worktable.toml\"\nplacement = {{ {placement} }}\n\
         [operation.assembly]\non = \"worktable\"\ngrid = [10, 8]\nstandoff_mm = 100\nbend_deg = -90\n\
         sense = \"xy\"\n{more}"
    );
    Workcell::new(from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell).unwrap()
}

/// Proven lower bound: the sum of the least errors of both operations anywhere on the floor.
const BOUND_MM: f64 = 20.429669;
/// Objective of the best layout of peer set D, which attains the bound.
const OPTIMUM_MM: f64 = 20.42967;

#[test]
fn ten_seeds_come_within_a_hundredth_of_the_proven_bound() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for seed in 1..=10 {
        let record = run(&workcell, SearchSettings { seed, ..workcell.cell.search });
        let objective = mm_from_m(record.best.evaluation.objective.unwrap());
        assert!(objective <= 20.44, "seed {seed}: {objective}");
        assert!(objective >= BOUND_MM, "seed {seed}: {objective} is below what is possible");
        assert_eq!(record.ended, SearchEnd::Done);
        assert!(record.evaluations > workcell.cell.search.budget / 2, "it gave up early");
    }
}

/// The reference program pycma succeeds with 10 of 10 seeds. The gap is the distance from the bound that this
/// program proves.
#[test]
fn thirty_seeds_come_within_a_thousandth_of_the_bound_in_2000_evaluations() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let bound = prove(&workcell, &ProofOptions::default(), &AtomicBool::new(false)).bound;
    let missed = (1..=30).filter(|&seed| {
        let settings = SearchSettings { seed, budget: 2000, ..workcell.cell.search };
        let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
        let job = SearchJob { bound, from: None, keep: &|_, _| () };
        let record = search_job(&workcell, &settings, &watch, &job);
        check(&workcell, &settings, &record);
        let objective = mm_from_m(record.best.evaluation.objective.unwrap());
        objective > OPTIMUM_MM * 1.001 || record.gap().is_none_or(|gap| gap > 0.001)
    });
    assert_eq!(missed.collect::<Vec<_>>(), [0; 0]);
}

#[test]
fn every_solver_gets_near_the_bound() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for solver in Solver::ALL {
        let record = run(&workcell, settings(solver, 20_000));
        let objective = mm_from_m(record.best.evaluation.objective.unwrap());
        assert!((BOUND_MM..20.6).contains(&objective), "{}: {objective}", solver.name());
    }
}

#[test]
fn one_seed_gives_the_same_record_for_any_number_of_threads() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for solver in Solver::ALL {
        let with = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let record = pool.install(|| run(&workcell, SearchSettings { seed, ..settings(solver, 1500) }));
            (record.best, record.evaluations, record.feasible, record.trace)
        };
        let one = with(1, 3);
        assert_eq!(one, with(1, 3), "{}", solver.name());
        assert_eq!(one, with(4, 3), "{}", solver.name());
        assert_ne!(one.3, with(1, 4).3, "{}: the seed changes nothing", solver.name());
    }
}

/// The stop flag ends a search, which then returns the best layout so far.
#[test]
fn the_stop_flag_interrupts_a_search() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for solver in Solver::ALL {
        for after in [0, 1, 500] {
            let stop = AtomicBool::new(after == 0);
            let progress = |p: sweetspot::search::Progress| {
                stop.fetch_or(p.evaluations >= after, Ordering::Relaxed);
            };
            let settings = settings(solver, 1_000_000);
            let record = search(&workcell, &settings, &Watch { progress: &progress, stop: &stop });
            check(&workcell, &settings, &record);
            assert_eq!(record.ended, SearchEnd::Interrupted, "{}", solver.name());
            assert!(record.evaluations <= after + 100, "{}: {}", solver.name(), record.evaluations);
        }
    }
}

#[test]
fn progress_counts_up_to_the_budget() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let seen = std::sync::Mutex::new(Vec::new());
    let progress = |p: sweetspot::search::Progress| seen.lock().unwrap().push(p);
    let watch = Watch { progress: &progress, stop: &AtomicBool::new(false) };
    let record = search(&workcell, &settings(Solver::CmaEs, 800), &watch);
    let seen = seen.into_inner().unwrap();
    assert!(seen.windows(2).all(|w| w[0].evaluations < w[1].evaluations));
    assert!(seen.iter().all(|p| p.budget == 800 && p.evaluations <= 800));
    let last = seen.last().unwrap();
    assert_eq!((last.evaluations, last.best), (record.evaluations, record.best.evaluation.objective));
}

/// The smallest budgets can end every solver, and the final local search, at any point.
#[test]
fn a_search_keeps_any_budget() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for solver in Solver::ALL {
        for budget in (1..=60).chain([79, 80, 81, 99, 120, 399, 400, 401]) {
            let record = run(&workcell, settings(solver, budget));
            assert!(record.evaluations >= 1, "{} {budget}", solver.name());
        }
    }
}

/// The start layout is a candidate, so no result may be worse.
#[test]
fn a_search_is_never_worse_than_the_start_layout() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    for solver in Solver::ALL {
        for budget in [100, 150, 300, 1000] {
            let record = run(&workcell, settings(solver, budget));
            let (best, start) = (record.best.evaluation.cost, record.start.evaluation.cost);
            assert!(best <= start, "{} {budget}: {best} after {start}", solver.name());
        }
    }
    // The start layout may differ in both directions from the coordinates to which the search rounds.
    for fine in [-4e-7, 4e-7] {
        let mut cell = shipped("hitachi_cell.toml");
        let Coordinate::Range { start, .. } = &mut cell.equipment[0].placement[1] else { panic!("fixed") };
        *start += fine;
        let drawn = Workcell::new(cell).unwrap();
        let record = run(&drawn, settings(Solver::CmaEs, 1));
        assert!(record.best.evaluation.cost <= record.start.evaluation.cost, "{fine}");
    }
}

#[test]
fn every_solver_searches_one_free_coordinate() {
    for (free, fixed) in [
        ("y_mm = { min = -1500, max = 1500 }", "x_mm = 0, z_mm = 650"),
        ("yaw_deg = { min = -180, max = 180 }", "x_mm = 0, y_mm = 900, z_mm = 650"),
        ("z_mm = { min = 300, max = 1200 }", "x_mm = 0, y_mm = 900"),
    ] {
        let workcell = one_table(&format!("{free}, {fixed}"), "");
        assert_eq!(SearchSpace::new(&workcell.cell).dimensions(), 1);
        for solver in Solver::ALL {
            let record = run(&workcell, settings(solver, 600));
            assert!(record.found(), "{free} {}", solver.name());
            assert!(record.best.evaluation.cost <= record.start.evaluation.cost, "{free} {}", solver.name());
        }
    }
}

#[test]
fn a_cell_without_free_coordinates_is_evaluated_once() {
    for (y, found) in [(900, true), (9000, false)] {
        let workcell = one_table(&format!("x_mm = 0, y_mm = {y}, z_mm = 650"), "");
        for solver in Solver::ALL {
            let record = run(&workcell, settings(solver, 600));
            assert_eq!((record.ended, record.found()), (SearchEnd::NothingToSearch, found));
            assert_eq!((record.evaluations, record.feasible), (1, u64::from(found)));
            assert_eq!(record.best, record.start);
        }
    }
}

#[test]
fn a_fixed_layout_that_misses_a_limit_is_not_counted_as_feasible() {
    for (limit, met) in [("1000", 1), ("0.001", 0)] {
        let workcell = one_table("x_mm = 0, y_mm = 900, z_mm = 650", &format!("limit_mm = {limit}\n"));
        let record = run(&workcell, settings(Solver::CmaEs, 600));
        assert_eq!((record.ended, record.found()), (SearchEnd::NothingToSearch, true));
        assert_eq!((record.feasible, record.least.is_some()), (met, met == 1), "{limit}");
    }
}

/// Only the coordinate y of the table is free, within a range of 100 mm. Steps of 1 um enumerate every
/// position.
#[test]
fn one_dimension_agrees_with_a_scan_of_every_position() {
    let post = "[obstacle.post]\nsolid = [{ name = \"post\", box = { centre_mm = [0, 0, 600], \
                size_mm = [100, 100, 1200] } }]\nplacement = { x_mm = 0, y_mm = 420, z_mm = 0 }\n";
    // A case states grid, sense, start of the range, obstacles, and the allowed excess over the scan (mm).
    let cases = [
        ((10, 8), "z", 700, "", 1e-6),
        // The optimum lies at the border of feasibility.
        ((1, 1), "xy", 650, "", 1e-6),
        // The objective has many equal minima, each at a joint limit. Rounding decides which minimum is the
        // least. At a distance of 1 um, the error is 1e-5 mm greater.
        ((10, 8), "xy", 850, "", 1.1e-5),
        ((10, 8), "xy", 900, post, 1.1e-5),
    ];
    for (grid, sense, low, more, tolerance) in cases {
        let y = format!("x_mm = 20, y_mm = {{ min = {low}, max = {} }}, z_mm = 650, yaw_deg = 3", low + 100);
        let mut cell = one_table(&y, more).cell;
        let area = cell.equipment[0].surface.unwrap();
        cell.operations[0].place = Place::Grid { area, divisions: grid };
        cell.operations[0].sense = Sense::plain(sense).unwrap();
        let workcell = Workcell::new(cell).unwrap();
        let at = |step: u32| {
            let mut layout = workcell.cell.start();
            layout.placements[0].y = m_from_mm(f64::from(low * 1000 + step) / 1000.0);
            evaluate(&workcell, &layout).cost
        };
        let scanned = (0..=100_000).into_par_iter().map(at).reduce(|| f64::INFINITY, f64::min);
        assert!(scanned < 1.0, "no layout of the scan is feasible");
        for solver in Solver::ALL {
            let record = run(&workcell, settings(solver, 4000));
            let found = record.best.evaluation.cost;
            assert!(found >= scanned, "{}: better than every position there is", solver.name());
            let missed = mm_from_m(found - scanned);
            assert!(missed <= tolerance, "{} from {low}: {missed} mm above the scan", solver.name());
        }
    }
}

/// Ranges need not end at a multiple of the rounding of placements.
#[test]
fn rounded_coordinates_stay_inside_narrow_ranges() {
    for placement in [
        "x_mm = { min = 20.0004, max = 20.0014 }, y_mm = 900, z_mm = 650",
        "x_mm = 0, y_mm = { min = 900.00049, max = 901.00051 }, z_mm = 650",
        "x_mm = 0, y_mm = 900, z_mm = 650, yaw_deg = { min = 3.00004, max = 3.00014 }",
        "x_mm = 0, y_mm = 900, z_mm = 650, yaw_deg = { min = 3.00004, max = 3.00005 }",
    ] {
        let workcell = one_table(placement, "");
        let space = SearchSpace::new(&workcell.cell);
        for k in 0..=1000 {
            lies_in_its_ranges(&workcell.cell, &space.layout(&[f64::from(k) / 1000.0]));
        }
        run(&workcell, settings(Solver::CmaEs, 200));
    }
}

/// Points outside the unit cube are folded back. The point of a layout gives the same layout again.
#[test]
fn every_point_of_the_search_space_has_a_layout() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let space = SearchSpace::new(&workcell.cell);
    assert_eq!(space.dimensions(), 7);
    assert_eq!(space.layout(&space.start()), workcell.cell.start());
    for k in 0..2000 {
        let point: Vec<f64> = (0..7).map(|i| f64::from(k * (i + 3) % 977) / 977.0 * 7.0 - 3.0).collect();
        let layout = space.layout(&point);
        lies_in_its_ranges(&workcell.cell, &layout);
        assert_eq!(space.layout(&space.point(&layout)), layout, "{point:?}");
        let folded: Vec<f64> = point.iter().map(|u| 2.0 - u).collect();
        let other = space.layout(&folded);
        for (a, b) in layout.placements.iter().zip(&other.placements) {
            assert!((a.x - b.x).abs() < 1.1e-6 && (a.yaw - b.yaw).abs() < 2e-6, "{point:?}");
        }
    }
}

#[test]
fn weights_and_the_maximum_make_the_objective() {
    let sums = [("sum", 1.0, 1.0), ("sum", 2.0, 0.5), ("max", 1.0, 1.0), ("max", 3.0, 0.25)];
    let best = sums.map(|(objective, a, b)| {
        let mut cell = shipped("hitachi_cell.toml");
        cell.search.objective = Objective::ALL.into_iter().find(|o| o.name() == objective).unwrap();
        (cell.operations[0].weight, cell.operations[1].weight) = (a, b);
        let workcell = Workcell::new(cell).unwrap();
        let record = run(&workcell, SearchSettings { budget: 6000, ..workcell.cell.search });
        let e = errors(&record.best.evaluation).unwrap();
        let want = if objective == "sum" { a * e[0] + b * e[1] } else { (a * e[0]).max(b * e[1]) };
        let got = record.best.evaluation.objective.unwrap();
        assert!((got - want).abs() <= 1e-15, "{objective} {a} {b}: {got} instead of {want}");
        e
    });
    // The maximum of the layout with the least maximum does not exceed the maximum of the layout with the
    // least sum.
    let greatest = |e: &[f64]| e[0].max(e[1]);
    assert!(greatest(&best[2]) <= greatest(&best[0]) + 1e-5, "{best:?}");
    // With the weights three and four, the first operation has at most the error that it has with equal
    // weights.
    assert!(best[3][0] <= best[0][0] + 1e-5 && best[1][0] <= best[0][0] + 1e-5, "{best:?}");
}

/// Every infeasible layout has a greater cost than every feasible layout.
#[test]
fn an_infeasible_layout_never_ranks_before_a_feasible_one() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let space = SearchSpace::new(&workcell.cell);
    let (mut feasible, mut infeasible) = (f64::MIN, f64::MAX);
    for k in 0..3000u32 {
        // The points form a lattice with irrational steps.
        let steps = [0.7548, 0.5698, 0.4301, 0.3247, 0.2451, 0.1851, 0.1397];
        let point: Vec<f64> = steps.iter().map(|s| (f64::from(k) * s).fract()).collect();
        let evaluation = evaluate(&workcell, &space.layout(&point));
        assert!(evaluation.cost.is_finite());
        match evaluation.objective {
            Some(objective) => {
                assert_eq!(objective.to_bits(), evaluation.cost.to_bits());
                assert!(evaluation.overlaps.is_empty() && errors(&evaluation).is_some());
                feasible = feasible.max(objective);
            }
            None => {
                assert!(!evaluation.overlaps.is_empty() || errors(&evaluation).is_none());
                infeasible = infeasible.min(evaluation.cost);
            }
        }
    }
    assert!(feasible > 0.0 && feasible < infeasible, "{feasible} {infeasible}");
}

/// A common weight scales the objective but does not change the layout that is found.
#[test]
fn scaled_weights_find_the_same_layout() {
    for weight in [1e6, 1e-6] {
        let mut cell = shipped("hitachi_cell.toml");
        cell.operations.iter_mut().for_each(|o| o.weight = weight);
        let workcell = Workcell::new(cell).unwrap();
        let record = run(&workcell, settings(Solver::CmaEs, 20_000));
        let objective = mm_from_m(record.best.evaluation.objective.expect("feasible")) / weight;
        assert!(objective <= 20.44, "weight {weight}: {objective} mm");
    }
}

/// The error of a relative operation has no bound over the misplacements, so its limit cannot be guaranteed.
/// The search still reduces the objective.
#[test]
fn a_limit_that_cannot_be_guaranteed_does_not_stop_the_search() {
    let text =
        "from = \"hitachi_cell.toml\"\n[operation.picking]\nrelative_to = \"assembly\"\nlimit_mm = 500\n";
    let cell = from_text_to_build(text).unwrap_or_else(|faults| panic!("{faults:#?}")).cell;
    let workcell = Workcell::new(cell).unwrap();
    let settings = SearchSettings { budget: 600, ..workcell.cell.search };
    let record = run(&workcell, settings);
    let [start, best] =
        [&record.start, &record.best].map(|c| c.evaluation.objective.expect("feasible layouts"));
    assert!(best < 0.95 * start, "{best} after {start}");
}
