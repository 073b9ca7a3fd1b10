//! Dual ascent, which prices a node in a search, against the barrier method and the cone programs.

use super::independent::{barrier, random_problem};
use crate::common::cases;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sweetspot::allocation::{
    FigureScratch, LimitRow, LinearFigure, PricedScales, ToleranceProblem, allocate, priced_scales,
};

fn ascended(problem: &ToleranceProblem) -> Option<PricedScales> {
    let figures: Vec<LinearFigure> =
        problem.requirements.iter().map(|r| r.figure.scaled(1.0 / r.limit)).collect();
    priced_scales(&problem.costs, &figures, 1e-6, &mut FigureScratch::default())
}

/// Both the cost and the lower bound match an independent method; the scales keep every limit.
#[test]
fn dual_ascent_costs_as_much_as_an_independent_method_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(120);
    let mut scratch = FigureScratch::default();
    let mut failed = 0;
    let count = cases(100, 1000);
    for case in 0..count {
        let problem = random_problem(&mut rng);
        let want = barrier(&problem);
        let found = ascended(&problem).unwrap();
        failed += usize::from(found.gap() > 1e-6);
        assert!((found.cost / want - 1.0).abs() < 2e-6, "case {case}: {} for {want}", found.cost);
        assert!(found.lower_bound <= want * (1.0 + 1e-8), "case {case}: {}", found.lower_bound);
        for r in &problem.requirements {
            let value = r.figure.value(&found.scales, &mut scratch);
            assert!(value <= r.limit * (1.0 + 1e-9), "case {case}: {value} above {}", r.limit);
        }
    }
    // A search solves a cone program where the ascent leaves a gap.
    assert!(failed * 50 <= count, "{failed} of {count} left a gap");
}

/// One constraint along one direction never costs more than the whole problem.
#[test]
fn the_bound_of_one_direction_is_below_the_cost() {
    let mut rng = ChaCha8Rng::seed_from_u64(121);
    for case in 0..100 {
        let problem = random_problem(&mut rng);
        let cost = allocate(&problem).unwrap().cost;
        for r in &problem.requirements {
            let figure = r.figure.scaled(1.0 / r.limit);
            let row = match &figure {
                LinearFigure::RootSumSquare { squares, constant } => {
                    LimitRow { squares: squares.clone(), constant: *constant, ..LimitRow::default() }
                }
                LinearFigure::WorstCase { generators, fixed, .. } => LimitRow {
                    linear: generators.iter().map(|g| g[0].abs()).collect(),
                    constant: fixed.iter().map(|f| f[0].abs()).sum(),
                    ..LimitRow::default()
                },
            };
            let bound = row.least_cost(&problem.costs);
            assert!(bound <= cost * (1.0 + 1e-8), "case {case}: {bound} above {cost}");
            let is_whole =
                problem.requirements.len() == 1 && matches!(figure, LinearFigure::RootSumSquare { .. });
            assert!(!is_whole || bound >= cost * (1.0 - 1e-6), "case {case}: {bound} below {cost}");
        }
    }
}
