//! Measures the savings of the cheapest tolerances over uniform tightening on the shipped cells, and the
//! computing times.

use super::independent::{random_arm, random_cost};
use super::search::{priced, searched};
use crate::common::{buildable, root};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::time::Instant;
use sweetspot::allocation::{FigureScratch, LinearFigure, ToleranceProblem, ToleranceRequirement, allocate};
use sweetspot::assess::{AllocatedNodes, CellAllocation, NoAllocation};
use sweetspot::cell::{Cell, Interpretation, Objective, Quantity, Reading, Unit};
use sweetspot::layout::{Workcell, evaluate};

const HEAD: &str = "# What the cheapest tolerances save\n\n\
    This table states the results of `sweetspot allocate` for every cell in cells/, as drawn. The errors of each cell\n\
    are read as tolerances. The limit of each operation is a share of the present worst case or 95th percentile, at the\n\
    spot or at the worst of all usable nodes. A tolerance costs 1 at its present value and 1 / scale at another value,\n\
    with scales from 0.1 to 3. \"Uniform\" is the cost of uniform tightening, which gives all tolerances the same scale.\n\
    \"Cheapest\" is the cost of the cheapest tolerances. Both solutions meet the limits according to the error model of\n\
    the cell. Limits of percentiles are also checked by samples. \"Gap\" is the duality gap. The times were measured in\n\
    one run, on 2 cores that other jobs also used, and include maps and samples. This command makes the table:\n\n\
    \u{20}   SWEETSPOT_FIGURES=1 cargo test --test maths allocation::figures -- --nocapture\n\n\
    | cell | reading | limits at | of present | tolerances | uniform | cheapest | saved | rounds | gap | seconds |\n\
    |---|---|---|---|---|---|---|---|---|---|---|\n";

/// Allocation problem for one cell.
#[derive(Clone, Copy)]
struct Asked {
    reading: Reading,
    nodes: AllocatedNodes,
    /// Limit divided by the largest present figure of the operation.
    share: f64,
}

/// Returns a cell whose limits are a share of the present figures of its operations.
fn limited(name: &str, asked: Asked) -> Result<Cell, String> {
    let cell = buildable(&format!("{name}.toml"));
    let quantity = Quantity::P95;
    let interpretation = Interpretation { reading: asked.reading, quantity, ..cell.interpretation() };
    let mut cell = cell.with_interpretation(&interpretation).map_err(|faults| faults[0].message.clone())?;
    for operation in &mut cell.operations {
        operation.limit = Some(if operation.sense.unit == Unit::Angle { 1.0 } else { 10.0 });
    }
    let workcell = Workcell::new(cell.clone())?;
    let layout = workcell.cell.start();
    let maps = workcell.maps(&layout);
    let problem = CellAllocation::new(&workcell, &layout, &maps, (None, asked.nodes), 0.99);
    let problem = problem.map_err(|why| match why {
        NoAllocation::Question { why, .. } | NoAllocation::Unusable(why) => why,
        other => format!("{other:?}"),
    })?;
    for (k, operation) in cell.operations.iter_mut().enumerate() {
        let own = problem.requirements.iter().filter(|r| r.operation == k).map(|r| r.before);
        let largest = own.fold(0.0, f64::max);
        operation.limit = Some(asked.share * largest);
    }
    Ok(cell)
}

/// Returns a row of the table; checks that the cheapest tolerances meet the limits and cost least.
fn row(name: &str, asked: Asked) -> String {
    let place = if asked.nodes == AllocatedNodes::Spots { "spots" } else { "all nodes" };
    let head =
        format!("| {name} | {} | {place} | {} % |", asked.reading.name(), (100.0 * asked.share).round());
    let cell = match limited(name, asked) {
        Ok(cell) => cell,
        Err(why) => return format!("{head} {why} | | | | | | |\n"),
    };
    let clock = Instant::now();
    let workcell = Workcell::new(cell).unwrap();
    let layout = workcell.cell.start();
    let maps = workcell.maps(&layout);
    let problem = CellAllocation::new(&workcell, &layout, &maps, (None, asked.nodes), 0.99).unwrap();
    let solved = problem.solve();
    let seconds = clock.elapsed().as_secs_f64();
    let cheapest = match solved {
        Ok(cheapest) => cheapest,
        Err(NoAllocation::Infeasible(_)) => {
            return format!("{head} even the tightest exceed a limit | | | | | | |\n");
        }
        Err(why) => panic!("{name}: {why:?}"),
    };
    let (found, count) = (&cheapest.found, problem.parameters.len());
    let cost = found.allocation.cost;
    assert!(found.excess <= 1e-6, "{name}: a limit is exceeded by {}", found.excess);
    assert!(found.allocation.gap() < 1e-3, "{name}: gap {}", found.allocation.gap());
    let (uniform, saved) = found.uniform.map_or(("-".into(), "-".into()), |(_, uniform)| {
        assert!(cost <= uniform * (1.0 + 1e-6), "{name}: {cost} above uniform {uniform}");
        (format!("{uniform:.3}"), format!("{:.1} %", 100.0 * (1.0 - cost / uniform)))
    });
    let (rounds, gap) = (found.rounds + cheapest.sampled_rounds, found.allocation.gap());
    format!("{head} {count} | {uniform} | {cost:.3} | {saved} | {rounds} | {gap:.0e} | {seconds:.2} |\n")
}

/// Returns the time (s) of an allocation of random arms with `parameters` tolerances at `nodes` nodes.
fn time(parameters: usize, nodes: usize, rows: usize, statistical: bool) -> (f64, usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(50);
    let mut scratch = FigureScratch::default();
    let costs: Vec<_> = (0..parameters).map(|_| random_cost(&mut rng)).collect();
    let requirements = random_arm(&mut rng, parameters, nodes, rows).into_iter().map(|generators| {
        let figure = match statistical {
            true => LinearFigure::RootSumSquare {
                squares: generators.iter().map(|g| g.norm_squared()).collect(),
                constant: 0.0,
            },
            false => LinearFigure::WorstCase { rows, generators, fixed: Vec::new() },
        };
        ToleranceRequirement { limit: 0.6 * figure.value(&vec![1.0; parameters], &mut scratch), figure }
    });
    let problem = ToleranceProblem { costs, requirements: requirements.collect() };
    let mut times: Vec<(f64, usize)> = (0..5)
        .map(|_| {
            let clock = Instant::now();
            let found = allocate(&problem).unwrap();
            assert!(found.gap() < 1e-6, "{parameters} at {nodes}: gap {}", found.gap());
            (clock.elapsed().as_secs_f64(), found.programs)
        })
        .collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    times[2]
}

/// Returns a row of the table of searches; checks that the search by cost finds the cheaper layout.
fn search_row((reading, quantity): (Reading, Quantity), limit_mm: f64, ideal: bool) -> String {
    let mut priced = priced("hitachi_cell.toml", (reading, quantity), limit_mm);
    priced.search.ideal = ideal;
    let mut by_error = priced.clone();
    by_error.search.objective = Objective::WeightedSum;
    // The limits constrain the tolerances to be found, not the error at the present tolerances.
    by_error.operations.iter_mut().for_each(|o| o.limit = None);
    let found = |cell: &Cell| {
        let (workcell, clock) = (Workcell::new(cell.clone()).unwrap(), Instant::now());
        let layout = searched(&workcell).best.layout;
        (layout, clock.elapsed().as_secs_f64())
    };
    let ((by_error, seconds_by_error), (cheapest, seconds)) = (found(&by_error), found(&priced));
    let workcell = Workcell::new(priced.clone()).unwrap();
    let [start, error, cost] =
        [&priced.start(), &by_error, &cheapest].map(|layout| evaluate(&workcell, layout).objective.unwrap());
    // The search may choose a layout with more room whose cost is higher by up to the indifference.
    let most = error.min(start) * if ideal { 1.0 } else { 1.0 + priced.search.indifference };
    assert!(cost <= most, "{cost} at the cheapest, {error} and {start} elsewhere");
    let (name, layout) = (quantity.name(), if ideal { "ideal" } else { "to build" });
    let name = if reading == Reading::WorstCase { "worst case" } else { name };
    format!(
        "| {name} | {limit_mm} | {layout} | {start:.3} | {error:.3} | {cost:.3} | {seconds_by_error:.1} | {seconds:.1} |\n"
    )
}

/// Writes results/allocation/README.md if SWEETSPOT_FIGURES is set. Otherwise checks two cells quickly.
#[test]
fn figures() {
    let (worst, random) = (Reading::WorstCase, Reading::Statistical);
    let (spots, all) = (AllocatedNodes::Spots, AllocatedNodes::Usable);
    if std::env::var("SWEETSPOT_FIGURES").is_err() {
        for reading in [worst, random] {
            let told = row("hitachi_cell", Asked { reading, nodes: spots, share: 0.7 });
            assert!(told.contains(" | 11 | "), "{told}");
        }
        let (seconds, _) = time(50, 1, 2, false);
        assert!(seconds < 0.1, "50 tolerances at a node take {seconds} s");
        return;
    }
    let mut text = HEAD.to_string();
    let mut put = |line: String| {
        print!("{line}");
        text.push_str(&line);
    };
    let files = std::fs::read_dir(root().join("cells")).unwrap().map(|f| f.unwrap().path());
    let cells = files.filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let mut names: Vec<String> = cells.map(|p| p.file_stem().unwrap().to_str().unwrap().into()).collect();
    names.sort();
    for name in &names {
        for (reading, nodes) in [(worst, spots), (worst, all), (random, spots), (random, all)] {
            put(row(name, Asked { reading, nodes, share: 0.7 }));
        }
    }
    put("\nThe next table states the time of `allocation::allocate` alone on one core (median of five runs), for random arms.\n\
         One third of the costs are reciprocal, one third are reciprocal powers, and one third are exponential.\n\n\
         | tolerances | nodes | requirement | milliseconds | cone programs |\n|---|---|---|---|---|\n".into());
    for (nodes, rows, statistical, what) in [
        (1, 1, false, "worst case in an axis"),
        (1, 2, false, "worst case in a plane"),
        (1, 3, false, "worst case in space"),
        (1, 3, true, "root sum square"),
        (80, 2, false, "worst case in a plane"),
        (80, 3, false, "worst case in space"),
        (80, 3, true, "root sum square"),
    ] {
        for parameters in [12, 50] {
            let (seconds, programs) = time(parameters, nodes, rows, statistical);
            put(format!("| {parameters} | {nodes} | {what} | {:.2} | {programs} |\n", seconds * 1e3));
        }
    }
    put("\nThe last table compares searches for the least cost with searches for the least error. The cell is hitachi_cell, the\n\
         seed is 1, and both operations have the limit of the row. `allocate` computes the cost of each layout by the linear\n\
         model, at the spots of the search. An ideal layout need only work as drawn. Layouts to build must work everywhere\n\
         within the placement tolerances, and leave room to place the pieces. The last two columns are the times in seconds\n\
         of the search for the least error and of the search for the least cost, on two cores.\n\n\
         | reading | limit mm | layout | cost at the start | least error | cheapest | s by error | s by cost |\n\
         |---|---|---|---|---|---|---|---|\n".into());
    for (reading, quantity, limit_mm) in
        [(worst, Quantity::Rms, 12.0), (random, Quantity::Rms, 3.0), (random, Quantity::P95, 6.0)]
    {
        for ideal in [true, false] {
            put(search_row((reading, quantity), limit_mm, ideal));
        }
    }
    let folder = root().join("results/allocation");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("README.md"), text).unwrap();
}
