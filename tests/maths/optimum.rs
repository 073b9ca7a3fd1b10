//! Tests the search on small random cells whose optimum is known by enumeration. The search finds the
//! optimum, its layouts are feasible, and the proven bound is never above the optimum.

use crate::common::from_text;
use crate::common::random_cells::{RandomArm, random_cell};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use sweetspot::assess::Assessment;
use sweetspot::cell::Coordinate;
use sweetspot::layout::{Workcell, Workspace, evaluate, evaluate_in};
use sweetspot::proof::{Covers, ProofOptions, prove};
use sweetspot::search::{SearchSpace, Watch, search};

/// Number of random cells whose optimum is enumerated.
const CELLS: usize = 50;
/// Number of random cells whose coordinates are lists of allowed values.
const LISTED: usize = 12;

/// Number of boxes of the proof of every operation. The bound must hold even if the proof ends early.
const BOXES: u64 = 1000;

/// Number of steps of the enumeration along each coordinate for one, two and three free coordinates.
const STEPS: [usize; 3] = [16_000, 100, 20];

/// Number of points of the enumeration from which the optimum is refined.
const STARTS: usize = 60;
const FINEST: f64 = 1e-5;

/// Result of an enumeration.
struct Enumerated {
    points: usize,
    feasible: usize,
    least: f64,
}

/// Evaluates every point of a lattice over the search space, then descends from the best points by ever
/// shorter steps along axes and diagonals.
fn enumerate(workcell: &Workcell) -> Enumerated {
    let space = SearchSpace::new(&workcell.cell);
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

/// Replaces the ranges in the text of a cell by lists of values, as for a rack with rows of holes.
fn listed(text: &str, counts: &mut impl Iterator<Item = i32>) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("{ min = ") {
        let (range, tail) = after.split_once(" }").unwrap();
        let (min, max) = range.split_once(", max = ").unwrap();
        let (min, max): (i32, i32) = (min.parse().unwrap(), max.parse().unwrap());
        let last = counts.next().unwrap() - 1;
        let mut values: Vec<i32> = (0..=last).map(|k| min + (max - min) * k / last).collect();
        values.dedup();
        out += &format!("{before}{values:?}");
        rest = tail;
    }
    out + rest
}

/// Evaluates every layout of listed values.
fn enumerate_lists(workcell: &Workcell) -> Enumerated {
    let space = SearchSpace::new(&workcell.cell);
    let lengths: Vec<usize> = workcell.cell.free().iter().map(|(_, c)| values(c).len()).collect();
    let points = lengths.iter().product();
    let at = |mut k: usize| {
        let digits = lengths.iter().map(|n| {
            let digit = k % n;
            k /= n;
            (digit as f64 + 0.5) / *n as f64
        });
        space.layout(&digits.collect::<Vec<f64>>())
    };
    let mut distinct: Vec<_> = (0..points).map(at).map(|l| format!("{l:?}")).collect();
    distinct.sort();
    distinct.dedup();
    assert_eq!(distinct.len(), points, "layouts met twice");
    let found: Vec<f64> =
        (0..points).into_par_iter().filter_map(|k| evaluate(workcell, &at(k)).objective).collect();
    let least = found.iter().copied().fold(f64::INFINITY, f64::min);
    Enumerated { points, feasible: found.len(), least }
}

fn values(coordinate: &Coordinate) -> &[f64] {
    match coordinate {
        Coordinate::List(values) => values,
        other => panic!("{other:?} is no list"),
    }
}

/// Returns random cells in which some layouts are feasible and many are not.
fn cells() -> Vec<(u64, RandomArm, Workcell, Enumerated)> {
    let mut cells = Vec::new();
    for seed in 1.. {
        let (arm, text) = random_cell(seed);
        let loaded = from_text(&text).unwrap_or_else(|f| panic!("seed {seed}: {f:#?}\n{text}"));
        let workcell = Workcell::new(loaded.cell).unwrap();
        // A few samples are tried first, because most cells have no feasible layout.
        let space = SearchSpace::new(&workcell.cell);
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
fn the_search_finds_the_optimum_of_random_cells() {
    let cells = cells();
    for arm in [RandomArm::Planar, RandomArm::Hitachi, RandomArm::Scara, RandomArm::SixAxes] {
        assert!(cells.iter().filter(|c| c.1 == arm).count() >= 3, "too few of {arm:?}");
    }
    let two = cells.iter().filter(|c| c.2.cell.operations.len() > 1).count();
    assert!(two >= 10, "{two} cells with two operations");
    let told: Vec<(String, f64)> = cells.par_iter().map(judged).collect();
    told.iter().for_each(|(line, _)| println!("{line}"));
    // Below a micrometre, a relative difference has no meaning.
    let missed = cells.iter().zip(&told).filter(|(c, t)| t.1 > c.3.least + (0.01 * c.3.least).max(1e-6));
    let missed: Vec<&str> = missed.map(|(_, t)| t.0.as_str()).collect();
    assert!(missed.is_empty(), "missed {} of {CELLS}: {missed:#?}", missed.len());
}

/// If the number of layouts is finite, the search finds the best layout, equal to the bit.
#[test]
fn the_search_finds_the_optimum_of_listed_values() {
    let mut counts = [13, 7, 31, 4, 19].into_iter().cycle();
    let cells = (2000..).map(|seed| {
        let (arm, text) = random_cell(seed);
        let text = listed(&text, &mut counts);
        let loaded = from_text(&text).unwrap_or_else(|f| panic!("seed {seed}: {f:#?}\n{text}"));
        (seed, arm, Workcell::new(loaded.cell).unwrap())
    });
    let many = cells.filter(|c| SearchSpace::new(&c.2.cell).dimensions() > 1);
    let all = many.map(|(seed, arm, workcell)| {
        let enumerated = enumerate_lists(&workcell);
        (seed, arm, workcell, enumerated)
    });
    let cells: Vec<_> = all.filter(|c| (2..c.3.points / 2).contains(&c.3.feasible)).take(LISTED).collect();
    let told: Vec<(String, f64)> = cells.par_iter().map(judged).collect();
    for ((line, best), cell) in told.iter().zip(&cells) {
        println!("{line}");
        assert_eq!(best.to_bits(), cell.3.least.to_bits(), "{line}");
    }
}

/// Searches with the default budget. Returns a line of text about the result, and the objective (m).
fn judged((seed, arm, workcell, e): &(u64, RandomArm, Workcell, Enumerated)) -> (String, f64) {
    let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
    let record = search(workcell, &workcell.cell.search, &watch);
    let best = record.best.evaluation.objective.unwrap_or(f64::INFINITY);
    let assessment = Assessment::new("best", workcell, record.best.layout);
    let wrong = crate::common::brute::faults(&assessment);
    assert!(wrong.is_empty(), "seed {seed}, {arm:?}: called feasible, but {wrong:#?}");
    let options = ProofOptions { boxes: BOXES, ..ProofOptions::default() };
    let proof = prove(workcell, &options, &AtomicBool::new(false));
    let bound = proof.bound.unwrap_or(0.0);
    assert_ne!(proof.covers, Covers::Infeasible, "seed {seed}, {arm:?}: there are feasible layouts");
    assert!(bound <= best.min(e.least), "seed {seed}, {arm:?}: {bound} m is above {} m", best.min(e.least));
    let line = format!(
        "seed {seed:4} {arm:?}: {} free, {:.1} % of {} feasible, least {:.6} mm, search {:+.4} %, bound {:+.2} %",
        SearchSpace::new(&workcell.cell).dimensions(),
        100.0 * e.feasible as f64 / e.points as f64,
        e.points,
        1e3 * e.least,
        100.0 * (best - e.least) / e.least,
        100.0 * (bound - e.least) / e.least
    );
    (line, best)
}
