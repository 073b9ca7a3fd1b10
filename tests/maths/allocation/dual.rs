//! Tests dual ascent, which prices a node in a search, against the barrier method and the cone programs.

use super::independent::{barrier, random_problem};
use crate::common::cases;
use nalgebra::Vector6;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::allocation::{
    FigureScratch, LimitRow, LinearFigure, NearbyPrice, PricedScales, ToleranceProblem, allocate,
    priced_scales,
};

fn ascended(problem: &ToleranceProblem) -> Option<PricedScales> {
    let figures: Vec<LinearFigure> =
        problem.requirements.iter().map(|r| r.figure.scaled(1.0 / r.limit)).collect();
    priced_scales(&problem.costs, &figures, 1e-6, &mut FigureScratch::default())
}

/// Both the cost and the lower bound match an independent method; the scales meet every limit.
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
    // If the ascent leaves a gap, a search solves a cone program.
    assert!(failed * 50 <= count, "{failed} of {count} left a gap");
}

/// A problem with one constraint along one direction never costs more than the whole problem.
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

/// Returns the figures of a problem, divided by their limits.
fn scaled(problem: &ToleranceProblem) -> Vec<LinearFigure> {
    problem.requirements.iter().map(|r| r.figure.scaled(1.0 / r.limit)).collect()
}

/// Returns a problem with each coefficient changed by a relative amount of up to `share`.
fn moved(problem: &ToleranceProblem, share: f64, rng: &mut ChaCha8Rng) -> ToleranceProblem {
    let mut moved = problem.clone();
    let mut factor = || 1.0 + share * rng.random_range(-1.0..1.0);
    let mut turned = |v: &mut Vector6<f64>| v.iter_mut().for_each(|c| *c *= factor());
    for r in &mut moved.requirements {
        match &mut r.figure {
            LinearFigure::WorstCase { generators, fixed, .. } => {
                generators.iter_mut().chain(fixed).for_each(&mut turned);
            }
            LinearFigure::RootSumSquare { squares, .. } => {
                let mut one = Vector6::zeros();
                for w in squares {
                    one[0] = *w;
                    turned(&mut one);
                    *w = one[0];
                }
            }
        }
    }
    moved
}

/// The solution of one problem bounds the cost of similar problems from both sides. The bounds are tight if
/// the problems differ little.
#[test]
fn a_nearby_price_bounds_the_cost_that_an_independent_method_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(122);
    let mut scratch = FigureScratch::default();
    let (mut widest, mut compared) = (0.0_f64, 0);
    for case in 0..cases(60, 600) {
        let problem = random_problem(&mut rng);
        let Some(near) = NearbyPrice::new(&problem.costs, &scaled(&problem), &mut scratch) else { continue };
        for share in [0.3, 0.01] {
            let other = moved(&problem, share, &mut rng);
            let figures = scaled(&other);
            let want = barrier(&other);
            let bound = near.bound(&problem.costs, &figures, &mut scratch);
            assert!(bound <= want * (1.0 + 1e-6), "case {case}: bound {bound} above {want}");
            let reduced = near.reduced_cost(&problem.costs, &figures, &mut scratch);
            let reduced = reduced.unwrap_or(f64::INFINITY);
            assert!(reduced >= want * (1.0 - 2e-6), "case {case}: {reduced} below {want}");
            if share == 0.01 && reduced.is_finite() {
                widest = widest.max(reduced / bound - 1.0);
                compared += 1;
            }
        }
    }
    assert!(compared > 40, "{compared} problems were compared");
    assert!(widest < 0.02, "the bounds of a change by 1 % are {widest} apart");
}
