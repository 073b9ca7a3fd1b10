//! Computing time of one evaluation of a layout, on one thread: `cargo bench --bench cells [-- NAME ...]`.
//! Without a `NAME`, the program measures all cells of `CELLS`. Otherwise, it measures the cells whose names
//! contain at least one `NAME`.
//!
//! Half of the layouts are random in the search ranges. The others are plausible: they lie within 300 mm and
//! 20 deg of the best layout of a short search. The program prints medians in microseconds as a table. In the
//! "ideal" columns, a layout needs to work only at its nominal placements. In the "to build" columns, it must
//! stay feasible at all misplacements within the placement tolerances.
//!
//! A second table states the work per plausible ideal layout: the share of the nodes whose inverse kinematics
//! is solved, and the numbers of judged postures and contact checks. It also states the time that the value
//! fields of the cell take before the first layout. Its last column is the ratio of the computing times with
//! and without ten times the nodes.

#![allow(clippy::expect_used, clippy::print_stdout)] // without the cells, a benchmark has nothing to measure

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use sweetspot::cell::{Cell, Layout, Place};
use sweetspot::files::{self, Setting};
use sweetspot::layout::{Workcell, Workspace, evaluate_in};
use sweetspot::proof::rank_nodes;
use sweetspot::search::{SearchSpace, Watch, search};

/// Number of random layouts per cell, and number of plausible layouts per cell.
const LAYOUTS: usize = 60;
/// Least number of times that all layouts are evaluated; the median time is printed.
const ROUNDS: usize = 5;
/// Least time, s, for which the layouts are evaluated.
const SECONDS: f64 = 0.3;
/// Number of evaluations of the search for the plausible layouts.
const BUDGET: u64 = 200;
/// Paths of cell files without their extension. A path without a folder refers to a file in `cells`. The last
/// two files describe one cell under two readings. The paths of these files are relative to `benches`.
const CELLS: [&str; 14] = [
    "hitachi_cell",
    "ur_cell",
    "scara_cell",
    "palletizer_cell",
    "five_axis_cell",
    "drilling_cell",
    "wrist_cell",
    "track_cell",
    "panda_cell",
    "offset_wrist_cell",
    "hitachi_paper",
    "hitachi_urdf",
    "frame_tolerances/statistical",
    "frame_tolerances/worst_case",
];

fn workcell(name: &str, is_ideal: bool) -> Workcell {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = if name.contains('/') { here.to_path_buf() } else { here.join("../cells") };
    let ideal = Setting::new("search.ideal", "true");
    let settings = if is_ideal { vec![ideal] } else { Vec::new() };
    let read = &mut |path: &str| std::fs::read(folder.join(path)).map_err(|e| e.to_string());
    let loaded = files::load_with(&format!("{name}.toml"), &settings, read).expect("a shipped cell");
    Workcell::new(loaded.cell).expect("a workcell")
}

/// Returns random and plausible layouts of a cell.
fn layouts(workcell: &Workcell) -> [Vec<Layout>; 2] {
    let space = SearchSpace::new(&workcell.cell);
    let mut rng = ChaCha8Rng::seed_from_u64(20_261_122);
    let random = (0..LAYOUTS)
        .map(|_| space.layout(&(0..space.dimensions()).map(|_| rng.random()).collect::<Vec<f64>>()))
        .collect();
    let mut settings = workcell.cell.search;
    settings.budget = BUDGET;
    let best = search(workcell, &settings, &Watch { progress: &|_| (), stop: &AtomicBool::new(false) }).best;
    let plausible = (0..LAYOUTS).map(|_| {
        let mut near = best.layout.clone();
        for at in &mut near.placements {
            let mut by = |most: f64| rng.random_range(-most..most);
            (at.x, at.y, at.yaw) = (at.x + by(0.3), at.y + by(0.3), at.yaw + by(0.35));
        }
        space.layout(&space.point(&near))
    });
    [random, plausible.collect()]
}

/// Returns the median computing time per layout, us.
fn cost(workcell: &Workcell, layouts: &[Layout]) -> f64 {
    let mut workspace = Workspace::default();
    let mut round = || {
        let began = Instant::now();
        for layout in layouts {
            black_box(evaluate_in(workcell, layout, &mut workspace));
        }
        began.elapsed().as_secs_f64() * 1e6 / layouts.len() as f64
    };
    round();
    let (began, mut rounds) = (Instant::now(), Vec::new());
    while rounds.len() < ROUNDS || began.elapsed().as_secs_f64() < SECONDS {
        rounds.push(round());
    }
    rounds.sort_by(f64::total_cmp);
    rounds[rounds.len() / 2]
}

/// Multiplies the number of nodes of every grid by about ten.
fn with_ten_times_the_nodes(mut cell: Cell) -> Cell {
    for operation in &mut cell.operations {
        if let Place::Grid { divisions: (m, n), .. } = &mut operation.place {
            let finer = |n: usize| ((n + 1) as f64 * 10f64.sqrt()).round() as usize - 1;
            (*m, *n) = (finer(*m), finer(*n));
        }
    }
    cell
}

/// Work per layout: solved nodes as a share of all nodes in percent, judged postures, and contact checks.
fn work(workcell: &Workcell, layouts: &[Layout]) -> [f64; 3] {
    let mut workspace = Workspace::default();
    for layout in layouts {
        black_box(evaluate_in(workcell, layout, &mut workspace));
    }
    let (counts, each) = (workspace.counts(), layouts.len() as f64);
    let nodes: usize = workcell.cell.operations.iter().map(|operation| operation.nodes()).sum();
    let [solved, postures, contacts] =
        [counts.nodes, counts.postures, counts.contacts].map(|count| count as f64 / each);
    [100.0 * solved / nodes as f64, postures, contacts]
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!("| cell | ideal, random us | plausible us | to build, random us | plausible us |");
    println!("|---|---|---|---|---|");
    let mut lines = Vec::new();
    for name in
        CELLS.iter().filter(|name| asked.is_empty() || asked.iter().any(|a| name.contains(a.as_str())))
    {
        let costs = [true, false].map(|is_ideal| {
            let workcell = workcell(name, is_ideal);
            let began = Instant::now();
            rank_nodes(&workcell, &AtomicBool::new(false));
            let preparation = began.elapsed().as_secs_f64() * 1e3;
            let layouts = layouts(&workcell);
            let costs = layouts.each_ref().map(|layouts| cost(&workcell, layouts));
            if is_ideal {
                let [solved, postures, contacts] = work(&workcell, &layouts[1]);
                let finer = Workcell::new(with_ten_times_the_nodes(workcell.cell)).expect("a workcell");
                rank_nodes(&finer, &AtomicBool::new(false));
                let ratio = cost(&finer, &layouts[1]) / costs[1];
                lines.push(format!(
                    "| {name} | {preparation:.0} | {solved:.1} | {postures:.1} | {contacts:.1} | {ratio:.1} |"
                ));
            }
            costs
        });
        let [[a, b], [c, d]] = costs.map(|all| all.map(|us| format!("{us:.1}")));
        println!("| {name} | {a} | {b} | {c} | {d} |");
    }
    println!("\n| cell | value fields ms | solved nodes % | judged postures | contact checks | 10 x nodes |");
    println!("|---|---|---|---|---|---|");
    lines.iter().for_each(|line| println!("{line}"));
}
