//! Tests the cost of tolerances as the objective of a search against the allocation for single layouts.

use crate::common::shipped;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;
use sweetspot::assess::{AllocatedNodes, CellAllocation};
use sweetspot::cell::{Cell, Goal, Goals, Layout, Model, Objective, Quantity, Reading, Sense};
use sweetspot::error_map::Outcome;
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::search::{SearchRecord, SearchSpace, Watch, search};
use sweetspot::units::m_from_mm;

/// Returns a shipped cell that minimizes the cost of its tolerances, with the linear model and a limit in xy.
pub fn priced(name: &str, (reading, quantity): (Reading, Quantity), limit_mm: f64) -> Cell {
    let mut cell = shipped(name);
    (cell.model, cell.reading, cell.quantity) = (Model::Linear, reading, quantity);
    cell.search.objective = Objective::ToleranceCost;
    for operation in &mut cell.operations {
        operation.sense = Sense::plain("xy").unwrap();
        operation.limit = Some(m_from_mm(limit_mm));
    }
    cell
}

/// Returns the cost that the allocation of one layout finds.
fn allocated(workcell: &Workcell, layout: &Layout, nodes: AllocatedNodes) -> f64 {
    let maps = workcell.maps(layout);
    let problem = CellAllocation::new(workcell, layout, &maps, (None, nodes), 0.99).unwrap();
    problem.solve().unwrap().found.allocation.cost
}

pub fn searched(workcell: &Workcell) -> SearchRecord {
    let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
    search(workcell, &workcell.cell.search, &watch)
}

const READINGS: [(Reading, Quantity, f64); 4] = [
    (Reading::WorstCase, Quantity::Rms, 12.0),
    (Reading::Statistical, Quantity::Rms, 3.0),
    (Reading::Statistical, Quantity::P95, 6.0),
    (Reading::Statistical, Quantity::Mean, 3.0),
];

/// According to another program, the cheapest node is (5, 4), which is not the node of least error.
#[test]
fn a_layout_is_evaluated_at_the_cheapest_node_of_the_reference() {
    let mut cell = priced("hitachi_paper.toml", (Reading::WorstCase, Quantity::Rms), 10.0);
    cell.errors = cell.robot.errors.iter().position(|e| e.name() == "table-3-tolerance").unwrap();
    let workcell = Workcell::new(cell).unwrap();
    let layout = workcell.cell.start();
    let found = evaluate(&workcell, &layout);
    let (objective, node) =
        (found.objective.unwrap(), workcell.maps(&layout)[0].best_node().map(|n| (n.i, n.j)));
    assert!((objective - 10.223).abs() < 5e-4 && node == Some((5, 4)), "{objective} at {node:?}");
    assert!(found.is_accepted());
}

/// The evaluation compares bounds first and prices only nodes that can still be the cheapest. The map prices
/// every node.
#[test]
fn the_evaluation_finds_the_cheapest_node_of_the_map() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    for (reading, quantity, limit_mm) in READINGS {
        let workcell = Workcell::new(priced("hitachi_cell.toml", (reading, quantity), limit_mm)).unwrap();
        let space = SearchSpace::new(&workcell.cell);
        let mut judged = 0;
        while judged < 4 {
            let point: Vec<f64> = (0..space.dimensions()).map(|_| rng.random()).collect();
            let layout = space.layout(&point);
            let found = evaluate(&workcell, &layout);
            if found.objective.is_none() {
                continue;
            }
            judged += 1;
            for (k, map) in workcell.maps(&layout).iter().enumerate() {
                let Outcome::Found(spot) = found.outcomes[k] else { panic!("no spot") };
                let usable = map.usable().map(|(_, _, p)| p.value);
                let least = usable.fold(f64::INFINITY, f64::min);
                // The misplacements of the cell may exclude the cheapest node.
                let is_least = spot.value == least || workcell.certifies() && spot.value > least;
                assert!(is_least, "{reading:?} {quantity:?}: {} instead of {least}", spot.value);
            }
        }
    }
}

/// The objective is the cost of one set of tolerances that serves both operations, as the allocation finds
/// it.
#[test]
fn the_objective_is_the_cost_that_the_allocation_finds() {
    for (reading, quantity, limit_mm) in READINGS {
        let workcell = Workcell::new(priced("hitachi_cell.toml", (reading, quantity), limit_mm)).unwrap();
        let layout = workcell.cell.start();
        let objective = evaluate(&workcell, &layout).objective.unwrap();
        let want = allocated(&workcell, &layout, AllocatedNodes::Spots);
        // The figures of percentiles and means are linearized at the present tolerances.
        let most = if quantity == Quantity::Rms { 1e-6 } else { 0.05 };
        assert!((objective / want - 1.0).abs() < most, "{reading:?} {quantity:?}: {objective} for {want}");
        assert!(quantity == Quantity::Rms || objective <= want * 1.01, "{objective} for {want}");
    }
}

/// A layout at which even the tightest tolerances exceed a limit ranks behind all layouts within the limits.
#[test]
fn a_limit_beyond_the_tightest_tolerances_is_missed() {
    let workcell =
        Workcell::new(priced("hitachi_cell.toml", (Reading::WorstCase, Quantity::Rms), 0.5)).unwrap();
    let found = evaluate(&workcell, &workcell.cell.start());
    assert!(!found.is_accepted() && found.cost > 100.0 * workcell.tightest_cost(), "{found:?}");
}

/// A search for the least cost finds cheaper tolerances than the layout of least error needs. A Pareto front
/// contains both layouts.
#[test]
fn a_search_finds_the_cheapest_layout() {
    let mut cell = priced("hitachi_cell.toml", (Reading::WorstCase, Quantity::Rms), 12.0);
    cell.search.budget = 1500;
    let by_cost = Workcell::new(cell.clone()).unwrap();
    let cheapest = searched(&by_cost).least.unwrap();
    assert!(cheapest < evaluate(&by_cost, &cell.start()).objective.unwrap());
    let mut by_error = cell.clone();
    by_error.search.objective = Objective::WeightedSum;
    by_error.search.pareto = Goals::of(&[Goal::Error, Goal::Cost]).unwrap();
    let workcell = Workcell::new(by_error.clone()).unwrap();
    let front = searched(&workcell).alternatives;
    let place = |goal: Goal| Goal::ALL.iter().position(|g| *g == goal).unwrap();
    let ends = |goal: Goal| {
        let by = |a: &&sweetspot::search::Alternative, b: &&sweetspot::search::Alternative| {
            a.goals[place(goal)].total_cmp(&b.goals[place(goal)])
        };
        let best = front.iter().min_by(by).unwrap();
        (best.goals[place(Goal::Error)], best.goals[place(Goal::Cost)])
    };
    let (of_error, of_cost) = (ends(Goal::Error), ends(Goal::Cost));
    assert!(of_error.0 <= of_cost.0 && of_cost.1 <= of_error.1, "{of_error:?} {of_cost:?}");
    for a in &front {
        let want = allocated(&workcell, &a.candidate.layout, AllocatedNodes::Spots);
        let cost = a.goals[place(Goal::Cost)];
        assert!((cost / want - 1.0).abs() < 1e-6, "{cost} for {want}");
    }
}
