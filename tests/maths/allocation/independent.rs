//! Tests random chains and cost models against an independent barrier method that uses all corners of the
//! tolerance box.

use crate::common::cases;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::allocation::{
    FigureScratch, LinearFigure, ToleranceProblem, ToleranceRequirement, allocate, uniform_scale,
};
use sweetspot::cell::{CostLaw, ToleranceCost};

/// Quadratic form `|constant + sum_k columns_k u_k|^2 <= 1` that the scales must satisfy.
struct Ball {
    columns: Vec<Vector6<f64>>,
    constant: Vector6<f64>,
}

/// Returns the constraints of a requirement, including all corners of a worst case.
fn balls(requirement: &ToleranceRequirement) -> Vec<Ball> {
    match requirement.figure.scaled(1.0 / requirement.limit) {
        LinearFigure::WorstCase { generators, fixed, .. } => {
            let all: Vec<Vector6<f64>> = generators.iter().chain(&fixed).copied().collect();
            let corner = |bits: u32| {
                let signed: Vec<Vector6<f64>> =
                    all.iter().enumerate().map(|(k, g)| if bits >> k & 1 == 1 { -g } else { *g }).collect();
                let (columns, fixed) = signed.split_at(generators.len());
                Ball { columns: columns.to_vec(), constant: fixed.iter().sum() }
            };
            (0..1u32 << (all.len() - 1)).map(corner).collect()
        }
        LinearFigure::RootSumSquare { .. } => Vec::new(),
    }
}

/// Returns value, slope and curvature of a cost.
fn derivatives(cost: &ToleranceCost, u: f64) -> [f64; 3] {
    match cost.law {
        CostLaw::Reciprocal { at, power } => {
            let c = at * u.powf(-power);
            [c, -power * c / u, power * (power + 1.0) * c / (u * u)]
        }
        CostLaw::Exponential { at, rate } => {
            let c = at * (-rate * (u - 1.0)).exp();
            [c, -rate * c, rate * rate * c]
        }
        CostLaw::Grades(_) => panic!("continuous costs"),
    }
}

/// Minimizes the cost by Newton's method on a logarithmic barrier of all constraints.
pub fn barrier(problem: &ToleranceProblem) -> f64 {
    let n = problem.costs.len();
    let balls: Vec<Ball> = problem.requirements.iter().flat_map(balls).collect();
    let ellipsoids: Vec<(Vec<f64>, f64)> = problem
        .requirements
        .iter()
        .filter_map(|r| match r.figure.scaled(1.0 / r.limit) {
            LinearFigure::RootSumSquare { squares, constant } => Some((squares, constant)),
            LinearFigure::WorstCase { .. } => None,
        })
        .collect();
    let count = (balls.len() + ellipsoids.len() + 2 * n) as f64;
    // Slacks of all constraints; each must be positive.
    let slacks = |u: &[f64]| -> Vec<f64> {
        let of_balls = balls.iter().map(|b| {
            let e: Vector6<f64> =
                b.constant + b.columns.iter().zip(u).map(|(c, u)| c * *u).sum::<Vector6<f64>>();
            1.0 - e.norm_squared()
        });
        let of_sums = ellipsoids.iter().map(|(squares, constant)| {
            1.0 - constant - squares.iter().zip(u).map(|(w, u)| w * u * u).sum::<f64>()
        });
        let of_bounds = problem.costs.iter().zip(u).flat_map(|(c, u)| [u - c.range.0, c.range.1 - u]);
        of_balls.chain(of_sums).chain(of_bounds).collect()
    };
    let objective = |u: &[f64], t: f64| -> f64 {
        let slacks = slacks(u);
        if slacks.iter().any(|s| *s <= 0.0) {
            return f64::INFINITY;
        }
        let cost: f64 = problem.costs.iter().zip(u).map(|(c, u)| c.cost(*u)).sum();
        t * cost - slacks.iter().map(|s| s.ln()).sum::<f64>()
    };
    let mut u: Vec<f64> = problem.costs.iter().map(|c| c.range.0 + 1e-4 * (c.range.1 - c.range.0)).collect();
    assert!(slacks(&u).iter().all(|s| *s > 0.0), "the start must be inside");
    let mut t = 1.0;
    while count / t > 1e-9 {
        t *= 4.0;
        for _ in 0..60 {
            let mut gradient = DVector::zeros(n);
            let mut hessian = DMatrix::zeros(n, n);
            for (k, cost) in problem.costs.iter().enumerate() {
                let [_, slope, bend] = derivatives(cost, u[k]);
                let (below, above) = (u[k] - cost.range.0, cost.range.1 - u[k]);
                gradient[k] += t * slope - 1.0 / below + 1.0 / above;
                hessian[(k, k)] += t * bend + 1.0 / (below * below) + 1.0 / (above * above);
            }
            for ball in &balls {
                let e: Vector6<f64> =
                    ball.constant + ball.columns.iter().zip(&u).map(|(c, u)| c * *u).sum::<Vector6<f64>>();
                let slack = 1.0 - e.norm_squared();
                let slope = DVector::from_fn(n, |k, _| 2.0 * e.dot(&ball.columns[k]));
                gradient += &slope / slack;
                hessian += &slope * slope.transpose() / (slack * slack);
                hessian += DMatrix::from_fn(n, n, |j, k| 2.0 * ball.columns[j].dot(&ball.columns[k]) / slack);
            }
            for (squares, constant) in &ellipsoids {
                let sum: f64 = squares.iter().zip(&u).map(|(w, u)| w * u * u).sum();
                let slack = 1.0 - constant - sum;
                let slope = DVector::from_fn(n, |k, _| 2.0 * squares[k] * u[k]);
                gradient += &slope / slack;
                hessian += &slope * slope.transpose() / (slack * slack);
                squares.iter().enumerate().for_each(|(k, w)| hessian[(k, k)] += 2.0 * w / slack);
            }
            let step = hessian.cholesky().expect("convex").solve(&-&gradient);
            let decrement = -gradient.dot(&step);
            let now = objective(&u, t);
            let mut length = 1.0;
            let moved = |length: f64| -> Vec<f64> {
                u.iter().zip(step.iter()).map(|(u, s)| u + length * s).collect()
            };
            while objective(&moved(length), t) > now - 0.1 * length * decrement && length > 1e-12 {
                length *= 0.5;
            }
            u = moved(length);
            if decrement < 1e-9 {
                break;
            }
        }
    }
    problem.costs.iter().zip(&u).map(|(c, u)| c.cost(*u)).sum()
}

/// Returns the errors of the TCP of a random arm that its joint angles, lengths and offsets cause, one list
/// per node.
///
/// Each call makes another arm. The variable `tip` moves the TCP, so one arm gives several nodes.
pub fn random_arm(rng: &mut ChaCha8Rng, n: usize, nodes: usize, rows: usize) -> Vec<Vec<Vector6<f64>>> {
    let vector = |rng: &mut ChaCha8Rng| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
    let joints: Vec<(bool, Vector3<f64>, Vector3<f64>, f64)> = (0..n)
        .map(|_| (rng.random_bool(0.5), vector(rng).normalize(), vector(rng), rng.random_range(0.2..2.0)))
        .collect();
    (0..nodes)
        .map(|_| {
            let tip = vector(rng);
            let effect = |(turns, axis, at, size): &(bool, Vector3<f64>, Vector3<f64>, f64)| {
                let moved = if *turns { axis.cross(&(tip - at)) * *size } else { axis * *size };
                let turned = if *turns { axis * *size } else { Vector3::zeros() };
                let mut all = Vector6::new(moved.x, moved.y, moved.z, turned.x, turned.y, turned.z);
                all.iter_mut().skip(rows).for_each(|v| *v = 0.0);
                all
            };
            joints.iter().map(effect).collect()
        })
        .collect()
}

pub fn random_cost(rng: &mut ChaCha8Rng) -> ToleranceCost {
    let at = rng.random_range(0.3..3.0);
    let law = match rng.random_range(0..3) {
        0 => CostLaw::Reciprocal { at, power: 1.0 },
        1 => CostLaw::Reciprocal { at, power: rng.random_range(0.5..3.0) },
        _ => CostLaw::Exponential { at, rate: rng.random_range(0.5..3.0) },
    };
    let low = rng.random_range(0.05..0.3);
    ToleranceCost { law, range: (low, rng.random_range(1.0..3.0)) }
}

pub fn random_problem(rng: &mut ChaCha8Rng) -> ToleranceProblem {
    let (n, nodes) = (rng.random_range(2..8), rng.random_range(1..4));
    let rows = [1, 2, 3, 6][rng.random_range(0..4)];
    let costs: Vec<ToleranceCost> = (0..n).map(|_| random_cost(rng)).collect();
    let statistical = rng.random_bool(0.4);
    let tightest: Vec<f64> = costs.iter().map(|c| c.range.0).collect();
    let loosest: Vec<f64> = costs.iter().map(|c| c.range.1).collect();
    let mut scratch = FigureScratch::default();
    let requirements = random_arm(rng, n, nodes, rows).into_iter().map(|generators| {
        let figure = match statistical {
            true => LinearFigure::RootSumSquare {
                squares: generators.iter().map(|g| g.norm_squared()).collect(),
                constant: if rng.random_bool(0.3) { 0.01 } else { 0.0 },
            },
            false => LinearFigure::WorstCase {
                rows,
                fixed: if rng.random_bool(0.3) { vec![generators[0] * 0.05] } else { Vec::new() },
                generators,
            },
        };
        let [least, most] = [&tightest, &loosest].map(|u| figure.value(u, &mut scratch));
        ToleranceRequirement { limit: least + rng.random_range(0.1..0.9) * (most - least), figure }
    });
    let requirements = requirements.collect();
    ToleranceProblem { costs, requirements }
}

#[test]
fn random_chains_cost_as_much_as_an_independent_method_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let mut largest = 0.0_f64;
    for case in 0..cases(100, 1000) {
        let problem = random_problem(&mut rng);
        let found = allocate(&problem).unwrap();
        let want = barrier(&problem);
        let off = found.cost / want - 1.0;
        largest = largest.max(off.abs());
        assert!(off.abs() < 1e-6, "case {case}: {} instead of {want}: {problem:?}", found.cost);
        assert!(found.gap() < 1e-6, "case {case}: gap {}", found.gap());
        check_corners(case, &problem, &found.scales);
        let (_, scales) = uniform_scale(&problem).unwrap();
        let uniform: f64 = problem.costs.iter().zip(&scales).map(|(c, u)| c.cost(*u)).sum();
        assert!(uniform >= found.lower_bound * (1.0 - 1e-9), "case {case}: uniform {uniform}");
    }
    println!("largest difference {largest:e}");
}

/// Checks that no corner of the tolerance box exceeds a limit, and that every scale is within its range.
fn check_corners(case: usize, problem: &ToleranceProblem, scales: &[f64]) {
    for (cost, u) in problem.costs.iter().zip(scales) {
        assert!((cost.range.0..=cost.range.1).contains(u), "case {case}: {u} outside {:?}", cost.range);
    }
    for ball in problem.requirements.iter().flat_map(balls) {
        let sum: Vector6<f64> = ball.columns.iter().zip(scales).map(|(c, u)| c * *u).sum();
        assert!((ball.constant + sum).norm() <= 1.0 + 1e-9, "case {case}: {}", (ball.constant + sum).norm());
    }
}

/// A shadow price is the slope of the cost with respect to the limit.
#[test]
fn a_shadow_price_is_the_slope_of_the_cost() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for case in 0..20 {
        let problem = random_problem(&mut rng);
        let prices = allocate(&problem).unwrap().shadow_prices;
        for k in 0..problem.requirements.len() {
            let cost = |factor: f64| {
                let mut moved = problem.clone();
                moved.requirements[k].limit *= factor;
                allocate(&moved).unwrap().cost
            };
            let slope = (cost(0.999) - cost(1.001)) / (0.002 * problem.requirements[k].limit);
            let scale = prices.iter().fold(1e-3, |a: f64, b| a.max(*b));
            assert!((slope - prices[k]).abs() < 0.01 * scale, "case {case}: {slope} and {}", prices[k]);
        }
    }
}

#[test]
fn two_parameters_match_a_refined_grid() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    let mut scratch = FigureScratch::default();
    for case in 0..20 {
        let problem = loop {
            let problem = random_problem(&mut rng);
            if problem.costs.len() == 2 {
                break problem;
            }
        };
        // The cost decreases with each scale, so the best second scale is the largest that the first scale
        // permits.
        let mut cost = |first: f64| {
            let mut keeps = |second: f64| {
                let at = [first, second];
                problem.requirements.iter().all(|r| r.figure.value(&at, &mut scratch) <= r.limit)
            };
            let (mut low, mut high) = problem.costs[1].range;
            if !keeps(low) {
                return f64::INFINITY;
            }
            if keeps(high) {
                low = high;
            }
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if keeps(middle) { low = middle } else { high = middle }
            }
            problem.costs[0].cost(first) + problem.costs[1].cost(low)
        };
        let (mut low, mut high) = problem.costs[0].range;
        let mut best = f64::INFINITY;
        for _ in 0..12 {
            let step = (high - low) / 40.0;
            let (at, least) = (0..=40)
                .map(|k| low + step * f64::from(k))
                .map(|u| (u, cost(u)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            best = best.min(least);
            (low, high) =
                ((at - step).max(problem.costs[0].range.0), (at + step).min(problem.costs[0].range.1));
        }
        let found = allocate(&problem).unwrap().cost;
        assert!((found / best - 1.0).abs() < 1e-6, "case {case}: {found} instead of {best}");
    }
}
