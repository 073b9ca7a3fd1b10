//! Compares the global solvers over cells and seeds: the number of evaluations until the objective is within
//! 1 % of the best known value.
//!
//! By default, a small study checks that the default solver is no worse than the other solvers. This command
//! runs the full study, which writes results/solvers/README.md:
//!
//! ```text
//! SWEETSPOT_STUDY=full cargo test --test maths solvers:: -- --nocapture
//! ```

use crate::common::{from_text, root, shipped};
use rayon::prelude::*;
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, SearchSettings, Solver};
use sweetspot::layout::Workcell;
use sweetspot::search::{SearchRecord, SearchSpace, Watch, search};

/// Shipped cells that a solver searches in little time. The study adds random cells.
const SHIPPED: [&str; 1] = ["hitachi_cell"];

/// Number of evaluations that check whether a random cell has a feasible layout. Other cells are skipped.
const LOOK: u64 = 500;

/// Largest relative excess over the best known objective that counts as found.
const WITHIN: f64 = 0.01;
const NOTHING: f64 = 1e-6;

struct Study {
    shipped: usize,
    random: usize,
    seeds: u64,
    budget: u64,
}

/// Results of the solvers on one cell: for each seed, the number of evaluations until the objective is within
/// 1 % of the best known value, or None.
struct SolverRow {
    cell: String,
    dimensions: usize,
    /// Best known objective, in mm, degrees or a share.
    best: f64,
    needed: Vec<(Solver, Vec<Option<u64>>)>,
}

fn run(workcell: &Workcell, solver: Solver, seed: u64, budget: u64) -> SearchRecord {
    let settings = SearchSettings { solver, seed, budget, ..workcell.cell.search };
    let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
    search(workcell, &settings, &watch)
}

/// Returns the number of evaluations after which the trace is within 1 % of the best known value; None if it
/// never is.
fn needed(record: &SearchRecord, best: f64) -> Option<u64> {
    let enough = best + (WITHIN * best).max(NOTHING);
    record.trace.iter().find(|(_, value)| *value <= enough).map(|(n, _)| *n)
}

/// Searches a cell with every solver and seed. The best known value is the best of all results.
fn row(name: String, cell: Cell, study: &Study) -> Option<SolverRow> {
    let workcell = Workcell::new(cell).unwrap();
    let seeds = 1..=study.seeds;
    let runs: Vec<(Solver, Vec<SearchRecord>)> = Solver::ALL
        .map(|solver| {
            let all = seeds.clone().into_par_iter();
            (solver, all.map(|seed| run(&workcell, solver, seed, study.budget)).collect())
        })
        .into();
    let objectives = runs.iter().flat_map(|(_, r)| r).filter_map(|r| r.best.evaluation.objective);
    let best = objectives.fold(f64::INFINITY, f64::min);
    let needed = runs.iter().map(|(s, all)| (*s, all.iter().map(|r| needed(r, best)).collect())).collect();
    println!("{name} done");
    let dimensions = SearchSpace::new(&workcell.cell).dimensions();
    let best_told = workcell.cell.unit().from_si(best);
    best.is_finite().then_some(SolverRow { cell: name, dimensions, best: best_told, needed })
}

fn rows(study: &Study) -> Vec<SolverRow> {
    let named = SHIPPED[..study.shipped].iter().map(|n| (n.to_string(), shipped(&format!("{n}.toml"))));
    let random = (1000..).map(|seed| {
        let text = crate::common::random_cells::random_cell(seed).1;
        (format!("random {seed}"), from_text(&text).unwrap_or_else(|f| panic!("{seed}: {f:#?}")).cell)
    });
    // Cells of one or two free coordinates do not distinguish the solvers.
    let random = random.filter(|(_, cell)| SearchSpace::new(cell).dimensions() > 2);
    let random = random.filter(|(_, cell)| {
        let workcell = Workcell::new(cell.clone()).unwrap();
        run(&workcell, Solver::CmaEs, 0, LOOK).found()
    });
    let all = named.filter_map(|(name, cell)| row(name, cell, study));
    all.chain(random.filter_map(|(name, cell)| row(name, cell, study)).take(study.random)).collect()
}

/// Returns the median number of evaluations. Seeds without success count as infinitely many evaluations.
fn median(needed: &[Option<u64>]) -> Option<u64> {
    let mut all: Vec<u64> = needed.iter().map(|n| n.unwrap_or(u64::MAX)).collect();
    all.sort_unstable();
    all.get((all.len() - 1) / 2).copied().filter(|n| *n < u64::MAX)
}

fn successes(needed: &[Option<u64>]) -> usize {
    needed.iter().flatten().count()
}

/// Returns the number of successful runs of a solver over all rows, and the number of rows in which its
/// median was the least.
fn totals(rows: &[SolverRow], solver: usize) -> (usize, usize) {
    let at = |row: &SolverRow, k: usize| median(&row.needed[k].1).unwrap_or(u64::MAX);
    let least = |row: &&SolverRow| (0..row.needed.len()).all(|k| at(row, solver) <= at(row, k));
    let came = rows.iter().map(|r| successes(&r.needed[solver].1)).sum();
    (came, rows.iter().filter(least).count())
}

fn table(rows: &[SolverRow], study: &Study) -> String {
    let mut out = String::from("| cell | variables | best known |");
    Solver::ALL.iter().for_each(|s| write!(out, " {} |", s.name()).unwrap());
    out += "\n|---|---|---|---|---|---|\n";
    for row in rows {
        write!(out, "| {} | {} | {:.5} |", row.cell, row.dimensions, row.best).unwrap();
        for (_, needed) in &row.needed {
            let median = median(needed).map_or("-".into(), |n| n.to_string());
            write!(out, " {median} ({} of {}) |", successes(needed), study.seeds).unwrap();
        }
        out.push('\n');
    }
    out += "| runs that reached this accuracy, cells with the least median | | |";
    for k in 0..Solver::ALL.len() {
        let (came, least) = totals(rows, k);
        write!(out, " {came} of {}, {least} |", rows.len() as u64 * study.seeds).unwrap();
    }
    out + "\n"
}

const README: &str = "# Which solver\n\n\
    The table states how many layout evaluations a solver needs until its best objective is within 1 % or 1 um of the\n\
    best known objective. The best known objective is the least objective of all runs of all solvers on the cell. Each\n\
    entry is the median over the seeds, with the number of seeds that reached this accuracy within the budget. The\n\
    random cells are those of tests/common/random_cells.rs with three or more free coordinates. Every cell has\n\
    `ideal = true`: its layouts need only work exactly as drawn. The other cells in cells/ are left out, because thousands of\n\
    searches in them take hours. Two of these cells would add no information: in hitachi_paper nothing may change, and\n\
    hitachi_urdf has the same arm as hitachi_cell.\n\n";

#[test]
fn the_study_recommends_the_default_solver() {
    let is_full = std::env::var("SWEETSPOT_STUDY").is_ok_and(|s| s == "full");
    let study = match is_full {
        true => Study { shipped: SHIPPED.len(), random: 20, seeds: 30, budget: 20_000 },
        false => Study { shipped: 1, random: 3, seeds: 4, budget: 4_000 },
    };
    let rows = rows(&study);
    let table = table(&rows, &study);
    println!("{table}");
    if is_full {
        let budget = format!(
            "The budget is {} evaluations, with {} seeds. This command makes the table:\n\n",
            study.budget, study.seeds
        );
        let command = "    SWEETSPOT_STUDY=full cargo test --test maths solvers:: -- --nocapture\n\n";
        let folder = root().join("results/solvers");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("README.md"), format!("{README}{budget}{command}{table}")).unwrap();
    }
    // CMA-ES is the default because no other solver succeeds more often.
    let came = Solver::ALL.map(|s| totals(&rows, Solver::ALL.iter().position(|t| *t == s).unwrap()).0);
    assert_eq!(Solver::ALL[0], Solver::CmaEs);
    assert!(came[0] >= *came.iter().max().unwrap(), "{came:?} runs came there by solver\n{table}");
}
