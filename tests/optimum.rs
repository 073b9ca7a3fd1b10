//! Fifty small random cells with their optimum by enumeration: the search finds it, and what it calls
//! feasible is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "common/brute.rs"]
mod brute;
mod common;
#[path = "common/random_cells.rs"]
mod random_cells;

use common::from_text;
use random_cells::{Arm, random_cell};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use sweetspot::compare::Assessment;
use sweetspot::layout::{Workcell, Workspace, evaluate, evaluate_in};
use sweetspot::search::{Space, Watch, search};

const CELLS: usize = 50;

/// Steps of the enumeration along each of one, two, three free coordinates.
const STEPS: [usize; 3] = [16_000, 100, 20];

/// Points of the enumeration from which the optimum is refined, and the last step in the unit cube.
const STARTS: usize = 60;
const FINEST: f64 = 1e-5;

/// What an enumeration found.
struct Enumerated {
    points: usize,
    feasible: usize,
    least: f64,
}

/// Every point of a lattice over the search space, then from the best ones downhill by ever shorter steps
/// along the axes and diagonals.
fn enumerate(workcell: &Workcell) -> Enumerated {
    let space = Space::new(&workcell.cell);
    let (n, steps) = (space.dimensions(), STEPS[space.dimensions() - 1]);
    let digits = |k: usize| (0..n as u32).map(move |d| k / (steps + 1).pow(d) % (steps + 1));
    let at = |k: usize| digits(k).map(|d| d as f64 / steps as f64).collect::<Vec<f64>>();
    let objective = |workspace: &mut Workspace, point: &[f64]| {
        evaluate_in(workcell, &space.layout(point), workspace).objective
    };
    let points = (steps + 1).pow(n as u32);
    let mut found: Vec<(f64, usize)> = (0..points)
        .into_par_iter()
        .map_init(Workspace::default, |workspace, k| Some((objective(workspace, &at(k))?, k)))
        .flatten()
        .collect();
    let feasible = found.len();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refined = found.into_par_iter().take(STARTS).map(|(value, k)| {
        let (mut best, mut point, mut step) = (value, at(k), 0.5 / steps as f64);
        let mut workspace = Workspace::default();
        while step > FINEST {
            let around = (0..3usize.pow(n as u32)).map(|k| {
                let moved = point.iter().enumerate();
                moved
                    .map(|(d, u)| (u + step * ((k / 3usize.pow(d as u32) % 3) as f64 - 1.0)).clamp(0.0, 1.0))
                    .collect()
            });
            let next = around.map(|p: Vec<f64>| (objective(&mut workspace, &p).unwrap_or(f64::INFINITY), p));
            let (value, p) = next.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            if value < best { (best, point) = (value, p) } else { step /= 2.0 }
        }
        best
    });
    Enumerated { points, feasible, least: refined.reduce(|| f64::INFINITY, f64::min) }
}

/// Random cells in which some layouts are feasible, and many are not.
fn cells() -> Vec<(u64, Arm, Workcell, Enumerated)> {
    let mut cells = Vec::new();
    for seed in 1.. {
        let (arm, text) = random_cell(seed);
        let loaded = from_text(&text).unwrap_or_else(|f| panic!("seed {seed}: {f:#?}\n{text}"));
        let workcell = Workcell::new(loaded.cell).unwrap();
        // A short look first: most cells have nothing feasible in them.
        let space = Space::new(&workcell.cell);
        let lattice = |k: u32| [0.7548, 0.5698, 0.4301].map(|s| (f64::from(k) * s).fract());
        let look = |k: &u32| {
            evaluate(&workcell, &space.layout(&lattice(*k)[..space.dimensions()])).objective.is_some()
        };
        let share = (1..=200).filter(look).count();
        if (2..=180).contains(&share) {
            let enumerated = enumerate(&workcell);
            cells.push((seed, arm, workcell, enumerated));
        }
        if cells.len() == CELLS {
            break;
        }
    }
    cells
}

#[test]
fn the_search_finds_the_optimum_of_fifty_random_cells() {
    let cells = cells();
    for arm in [Arm::Planar, Arm::Hitachi, Arm::Scara, Arm::SixAxes] {
        assert!(cells.iter().filter(|c| c.1 == arm).count() >= 3, "too few of {arm:?}");
    }
    let two = cells.iter().filter(|c| c.2.cell.operations.len() > 1).count();
    assert!(two >= 10, "{two} cells with two operations");
    let told: Vec<(String, bool)> = cells.par_iter().map(judged).collect();
    told.iter().for_each(|(line, _)| println!("{line}"));
    let missed: Vec<&str> = told.iter().filter(|t| !t.1).map(|t| t.0.as_str()).collect();
    assert!(missed.is_empty(), "missed {} of {CELLS}: {missed:#?}", missed.len());
}

/// What the search with the default budget comes to, and whether that is within 1 % of the enumeration.
fn judged((seed, arm, workcell, e): &(u64, Arm, Workcell, Enumerated)) -> (String, bool) {
    let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
    let record = search(workcell, &workcell.cell.search, &watch);
    let best = record.best.evaluation.objective.unwrap_or(f64::INFINITY);
    let assessment = Assessment::new("best", workcell, record.best.layout);
    let wrong = brute::faults(&assessment);
    assert!(wrong.is_empty(), "seed {seed}, {arm:?}: called feasible, but {wrong:#?}");
    let line = format!(
        "seed {seed:4} {arm:?}: {} free, {:.1} % of {} feasible, least {:.6} mm, search {:+.4} %",
        Space::new(&workcell.cell).dimensions(),
        100.0 * e.feasible as f64 / e.points as f64,
        e.points,
        1e3 * e.least,
        100.0 * (best - e.least) / e.least
    );
    // Below a micrometre a share says nothing.
    (line, best <= e.least + (0.01 * e.least).max(1e-6))
}
