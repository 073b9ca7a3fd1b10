//! Speed of `evaluate` for 100 000 layouts of a cell on all cores, for comparison with the evaluator of the
//! Python package:
//!
//!     cargo bench --bench evaluator -- cells/hitachi_cell.toml
//!
//! The program prints the layouts per second of the fastest round, and the sum of the costs in the unit
//! of the objective. results/optimisers/run.py evaluates the same layouts.

#![allow(clippy::print_stdout)] // the script that compares both evaluators reads the output

use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use sweetspot::cell::Layout;
use sweetspot::files;
use sweetspot::layout::{Workcell, Workspace, evaluate_in};
use sweetspot::proof::rank_nodes;
use sweetspot::record::nine_digits;
use sweetspot::search::SearchSpace;

/// Number of layouts that are evaluated.
const LAYOUTS: usize = 100_000;

/// Number of times that all layouts are evaluated; the least time is printed.
const ROUNDS: usize = 5;

/// Primes for the Richtmyer sequence in the unit cube, one for each free coordinate. From point to
/// point, a coordinate increases by the square root of its prime, modulo 1.
const PRIMES: [f64; 12] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];

fn main() {
    // Cargo also passes its own flags, which begin with `--`.
    let given = std::env::args().skip(1).find(|word| !word.starts_with("--"));
    let file = PathBuf::from(given.unwrap_or_else(|| "cells/hitachi_cell.toml".into()));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = if file.is_file() { file } else { root.join(file) };
    let (folder, name) = (file.parent().unwrap_or(Path::new(".")), file.file_name().unwrap_or_default());
    let mut read = |path: &str| std::fs::read(folder.join(path)).map_err(|e| e.to_string());
    let loaded = match files::load(&name.to_string_lossy(), &mut read) {
        Ok(loaded) => loaded,
        Err(faults) => return faults.iter().for_each(|fault| println!("{fault}")),
    };
    let workcell = match Workcell::new(loaded.cell) {
        Ok(workcell) => workcell,
        Err(why) => return println!("{why}"),
    };
    let space = SearchSpace::new(&workcell.cell);
    let point = |k: usize| -> Vec<f64> {
        PRIMES[..space.dimensions()].iter().map(|p| ((k + 1) as f64 * p.sqrt()).fract()).collect()
    };
    let layouts: Vec<Layout> = (0..LAYOUTS).map(|k| space.layout(&point(k))).collect();
    let unit = workcell.cell.unit();
    rank_nodes(&workcell, &AtomicBool::new(false));
    let mut best = f64::INFINITY;
    let mut costs = Vec::new();
    for _ in 0..ROUNDS {
        let begun = Instant::now();
        let one = |workspace: &mut Workspace, layout: &Layout| evaluate_in(&workcell, layout, workspace).cost;
        costs = layouts.par_iter().with_min_len(50).map_init(Workspace::default, one).collect();
        best = best.min(begun.elapsed().as_secs_f64());
    }
    let sum: f64 = costs.iter().map(|cost| nine_digits(unit.from_si(*cost))).sum();
    println!("{{\"layouts_per_s\": {}, \"sum\": {sum:?}}}", (LAYOUTS as f64 / best).round());
}
