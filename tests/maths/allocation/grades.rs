//! Tests discrete grades against full enumeration, and the tolerance grades of ISO 286 against their
//! formulas.

use nalgebra::Vector6;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::allocation::{FigureScratch, LinearFigure, ToleranceProblem, ToleranceRequirement, allocate};
use sweetspot::cell::{ToleranceCost, ToleranceGrade, it_half_width};

fn random_grades(rng: &mut ChaCha8Rng) -> ToleranceCost {
    let mut scale = rng.random_range(0.1..0.4);
    let mut cost = rng.random_range(3.0..10.0);
    let grades = (0..rng.random_range(2..5)).map(|g| {
        let grade = ToleranceGrade { name: format!("process {g}"), scale, cost };
        scale *= rng.random_range(1.2..2.5);
        cost *= rng.random_range(0.4..0.9);
        grade
    });
    ToleranceCost::of_grades(grades.collect()).unwrap()
}

fn random_problem(rng: &mut ChaCha8Rng) -> ToleranceProblem {
    let n = rng.random_range(3..8);
    let costs: Vec<ToleranceCost> = (0..n).map(|_| random_grades(rng)).collect();
    let rows = rng.random_range(1..4);
    let statistical = rng.random_bool(0.4);
    let mut scratch = FigureScratch::default();
    let requirements = (0..rng.random_range(1..4)).map(|_| {
        let vector = |rng: &mut ChaCha8Rng| {
            Vector6::from_fn(|r, _| if r < rows { rng.random_range(-1.0..1.0) } else { 0.0 })
        };
        let generators: Vec<Vector6<f64>> = (0..n).map(|_| vector(rng)).collect();
        let figure = match statistical {
            true => LinearFigure::RootSumSquare {
                squares: generators.iter().map(|g| g.norm_squared()).collect(),
                constant: 0.0,
            },
            false => LinearFigure::WorstCase { rows, generators, fixed: Vec::new() },
        };
        let [least, most] = [0, 1].map(|end| {
            let ends: Vec<f64> = costs.iter().map(|c| if end == 0 { c.range.0 } else { c.range.1 }).collect();
            figure.value(&ends, &mut scratch)
        });
        ToleranceRequirement { limit: least + rng.random_range(0.05..0.95) * (most - least), figure }
    });
    let requirements = requirements.collect();
    ToleranceProblem { costs, requirements }
}

/// Returns the least cost of all choices of grades.
fn enumerated(problem: &ToleranceProblem) -> f64 {
    let mut scratch = FigureScratch::default();
    let counts: Vec<usize> = problem.costs.iter().map(|c| c.grades().len()).collect();
    let all: usize = counts.iter().product();
    let mut best = f64::INFINITY;
    for mut code in 0..all {
        let (mut scales, mut cost) = (Vec::new(), 0.0);
        for (model, count) in problem.costs.iter().zip(&counts) {
            let grade = &model.grades()[code % count];
            code /= count;
            scales.push(grade.scale);
            cost += grade.cost;
        }
        let kept = problem.requirements.iter().all(|r| r.figure.value(&scales, &mut scratch) <= r.limit);
        if kept && cost < best {
            best = cost;
        }
    }
    best
}

#[test]
fn grades_match_full_enumeration() {
    let mut rng = ChaCha8Rng::seed_from_u64(286);
    let mut programs = 0;
    for case in 0..50 {
        let problem = random_problem(&mut rng);
        let found = allocate(&problem).unwrap();
        let want = enumerated(&problem);
        programs += found.programs;
        assert!((found.cost - want).abs() < 1e-9 * want, "case {case}: {} instead of {want}", found.cost);
        assert!(found.gap() < 1e-6, "case {case}: gap {}", found.gap());
        let is_grade = |(cost, u): (&ToleranceCost, &f64)| cost.grades().iter().any(|g| g.scale == *u);
        assert!(problem.costs.iter().zip(&found.scales).all(is_grade), "case {case}: {:?}", found.scales);
    }
    assert!(programs > 200, "only {programs} programs: the cases are too easy");
}

/// A grade that costs as much as a tighter grade is never ordered.
#[test]
fn useless_grades_are_left_out() {
    let grade = |scale: f64, cost: f64| ToleranceGrade { name: String::new(), scale, cost };
    let cost =
        ToleranceCost::of_grades(vec![grade(2.0, 1.0), grade(0.5, 1.0), grade(0.1, 3.0), grade(0.3, 4.0)])
            .unwrap();
    let scales: Vec<f64> = cost.grades().iter().map(|g| g.scale).collect();
    assert_eq!(scales, [0.1, 0.5]);
    assert_eq!((cost.cost(0.4), cost.cost(2.0), cost.cost(0.01)), (3.0, 1.0, 3.0));
    assert!(ToleranceCost::of_grades(Vec::new()).is_none());
}

/// The values of ISO 286-1 above 3 mm follow from the factors of the standard, up to the rounding of the
/// standard.
#[test]
fn it_grades_follow_the_formulas_of_iso_286() {
    let ranges = [
        3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0,
        1000.0, 1250.0, 1600.0, 2000.0, 2500.0, 3150.0,
    ];
    // IT6 to IT14 as multiples of the factor.
    let multiples = [10.0, 16.0, 25.0, 40.0, 64.0, 100.0, 160.0, 250.0, 400.0];
    for pair in ranges.windows(2) {
        let d = f64::sqrt(pair[0] * pair[1]);
        let factor = if pair[1] <= 500.0 { 0.45 * d.cbrt() + 0.001 * d } else { 0.004 * d + 2.1 };
        for (k, multiple) in multiples.iter().enumerate() {
            let um = it_half_width(6 + k, pair[1]).unwrap() * 2e6;
            let want = multiple * factor;
            assert!((um - want).abs() < 0.06 * want + 0.5, "IT{} up to {} mm: {um}, {want}", 6 + k, pair[1]);
        }
    }
    let near = |grade, nominal, um: f64| (it_half_width(grade, nominal).unwrap() * 2e6 - um).abs() < 1e-9;
    assert!(near(7, 40.0, 25.0) && near(6, 50.0, 16.0) && near(6, 50.001, 19.0) && near(11, 400.0, 360.0));
    assert!(it_half_width(3, 40.0).is_none() && it_half_width(15, 40.0).is_none());
    assert!(it_half_width(7, 3151.0).is_none() && it_half_width(7, 0.0).is_none());
}
