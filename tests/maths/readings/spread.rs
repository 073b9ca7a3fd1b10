//! Tests parameters that are correlated or not normal, and the error budget.

use crate::readings::bench::*;
use crate::readings::worst::{columns, unit};
use nalgebra::{DMatrix, Matrix3, Vector3};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::*;
use sweetspot::reading::{Budget, Figures, MonteCarlo, monte_carlo};
use sweetspot::units::rad_from_deg;

/// Sets the covariance `B B^T` of a random matrix B over lengths and angles. Some correlations are nearly 1.
fn correlated(rng: &mut ChaCha8Rng, robot: &Robot, tolerance: &mut Tolerance) -> DMatrix<f64> {
    let n = robot.axes();
    let parameters = vec![0, PER_LINK + 1, PER_LINK + 2, 2 * PER_LINK + 3, PER_LINK * n + 4, PER_LINK * n];
    let sizes = [1e-4, 1e-4, 2e-4, 2e-4, 1e-9, 3e-4];
    let b = DMatrix::from_fn(6, 4, |row, _| sizes[row] * rng.random_range(-1.0..1.0));
    let matrix: DMatrix<f64> = &b * b.transpose();
    for (k, &p) in parameters.iter().enumerate() {
        tolerance.spreads[p] = Spread {
            plus_minus: 3.0 * matrix[(k, k)].sqrt(),
            distribution: Distribution::Normal,
            sigmas: 3.0,
        };
    }
    tolerance.covariance = Some(Covariance { parameters, matrix: matrix.clone() });
    matrix
}

/// The covariance of the position error is `G C G^T` with columns from dual numbers.
#[test]
fn a_covariance_is_propagated_to_the_tool() {
    let mut rng = ChaCha8Rng::seed_from_u64(61);
    for k in 0..100 {
        let axes = 3 + k % 5;
        let robot = random_robot(&mut rng, axes);
        let none = vec![Spread::of_magnitude(0.0); Parameter::count(axes)];
        let mut tolerance =
            Tolerance { name: "calibrated".into(), spreads: none, covariance: None, costs: Vec::new() };
        let matrix = correlated(&mut rng, &robot, &mut tolerance);
        let q = random_joints(&mut rng, &robot);
        let all: Vec<Parameter> = Parameter::of_robot(axes).collect();
        let column = |p: &usize| {
            let t = crate::kinematics::product::tcp(&robot, &q, &unit(axes, all[*p]), Dual64::new(0.0, 1.0));
            Vector3::from_fn(|row, _| t[(row, 3)].eps)
        };
        let g: Vec<Vector3<f64>> =
            tolerance.covariance.as_ref().unwrap().parameters.iter().map(column).collect();
        let mut want = Matrix3::zeros();
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            want += g[i] * g[j].transpose() * matrix[(i, j)];
        }
        let mut cell = cell_of(robot.clone(), tolerance, Sense::plain("xyz").unwrap());
        cell.reading = Reading::Statistical;
        let frames = frames_at(&robot, &q);
        for (sense, kept) in
            [("x", vec![0]), ("y", vec![1]), ("z", vec![2]), ("xy", vec![0, 1]), ("xyz", vec![0, 1, 2])]
        {
            cell.operations[0].sense = Sense::plain(sense).unwrap();
            let evaluator = gauge_of(&cell);
            let mut memory = evaluator.memory();
            evaluator.prepare(&alone(), &frames, &mut memory);
            let rms = evaluator.norm(&evaluator.sense, &alone(), &frames, &mut memory).rms();
            let variance: f64 = kept.iter().map(|&i| want[(i, i)]).sum();
            assert!(
                (rms * rms - variance).abs() <= 1e-12 * want.trace(),
                "{k} {sense}: {} {variance}",
                rms * rms
            );
            let budget = Budget::new(&evaluator, &alone(), &frames, &mut memory);
            assert!((budget.deviation - rms).abs() <= 1e-12 * rms.max(1e-9));
            let shares: f64 = budget.shares.iter().map(|s| s.of_variance).sum();
            assert!((shares - 1.0).abs() < 1e-9, "{shares}");
        }
        let evaluator = gauge_of(&cell);
        let judged = evaluator.judge(&alone(), &frames, &mut evaluator.memory());
        let first = judged.figures[evaluator.own()];
        if k < 5 {
            let sampled = monte_carlo(&evaluator, &alone(), &frames, 1 << 17, 7, first.p95);
            assert!(sampled.confirms(&first), "{first:?} {sampled:?}");
        }
    }
}

/// Percentiles depend on the shape of uniform and triangular distributions, which a normal law of equal
/// covariance misses. No parameter may contribute a quarter of the variance, because its shape alone would
/// then dominate.
#[test]
fn the_distributions_of_the_parameters_matter() {
    let mut rng = ChaCha8Rng::seed_from_u64(62);
    let shapes = [Distribution::Uniform, Distribution::Triangular, Distribution::Normal];
    let mut judged = 0;
    for k in 0..120 {
        let robot = random_robot(&mut rng, 6);
        let sizes = (3e-4, rad_from_deg(0.03));
        let tolerance =
            random_tolerance(&mut rng, 6, 20, sizes, if k % 4 < 2 { &shapes[..1] } else { &shapes });
        let mut cell = cell_of(robot.clone(), tolerance, Sense::plain(["xyz", "xy"][k % 2]).unwrap());
        (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
        let frames = frames_at(&robot, &random_joints(&mut rng, &robot));
        let evaluator = gauge_of(&cell);
        let budget = Budget::new(&evaluator, &alone(), &frames, &mut evaluator.memory());
        if budget.shares.iter().any(|s| s.of_variance > 0.25) {
            continue;
        }
        judged += 1;
        let first = evaluator.judge(&alone(), &frames, &mut evaluator.memory()).figures[evaluator.own()];
        let sampled = monte_carlo(&evaluator, &alone(), &frames, 1 << 17, 3, first.p95);
        assert!((sampled.above.value - 0.05).abs() < 0.004, "{k}: {first:?} {sampled:?}");
        assert!((first.p99 / sampled.p99.value - 1.0).abs() < 0.01, "{k}: {first:?} {sampled:?}");
        let half = (sampled.rms.high - sampled.rms.low) / 2.0;
        let off = (first.rms - sampled.rms.value).abs();
        assert!(off < 2.0 * half + 1e-3 * first.rms, "{k}: {first:?} {sampled:?}");
    }
    assert!(judged >= 10, "{judged}");
}

/// One uniform parameter is not normal: `|U(-1, 1) mm|` has the 95th percentile 0.95 mm and the mean 0.5 mm.
#[test]
fn one_uniform_parameter_keeps_its_distribution() {
    let cell =
        with_one_error(2, Spread { plus_minus: 1e-3, distribution: Distribution::Uniform, sigmas: 3.0 });
    let (first, sampled) = first_and_sampled(&cell);
    assert!((sampled.p95.value - 0.95e-3).abs() < 1e-6 && (sampled.mean.value - 0.5e-3).abs() < 1e-6);
    assert!((first.p95 - 0.95e-3).abs() < 1e-9 && (first.p99 - 0.99e-3).abs() < 1e-9, "{first:?}");
    assert!((first.mean - 0.5e-3).abs() < 1e-8 && sampled.confirms(&first), "{first:?}");
}

/// A large rotation moves the tool along an arc, not along its tangent. The samples therefore refute and
/// replace the first-order figures.
#[test]
fn monte_carlo_can_refute_the_first_order_figures() {
    let cell = with_one_error(0, Spread { plus_minus: 3.0, distribution: Distribution::Normal, sigmas: 3.0 });
    let (mut first, sampled) = first_and_sampled(&cell);
    assert!(!sampled.confirms(&first), "{first:?} {sampled:?}");
    let (mut success, mut value) = (None, first.p95);
    assert!(!sampled.check(Quantity::P95, &mut first, &mut success, &mut value));
    assert_eq!((first.p95, first.p99, value), (sampled.p95.value, sampled.p99.value, sampled.p95.value));
    assert!(sampled.check(Quantity::P95, &mut first, &mut success, &mut value));
}

/// Returns a cell with a random arm in which only one parameter has an error.
fn with_one_error(parameter: usize, spread: Spread) -> Cell {
    let mut rng = ChaCha8Rng::seed_from_u64(63);
    let mut robot = random_robot(&mut rng, 4);
    robot.joints[0].kind = JointKind::Revolute;
    let mut tolerance = random_tolerance(&mut rng, 4, 1, (1e-3, 1e-3), &[Distribution::Uniform]);
    tolerance.spreads.iter_mut().for_each(|s| s.plus_minus = 0.0);
    tolerance.spreads[parameter] = spread;
    let mut cell = cell_of(robot, tolerance, Sense::plain("xyz").unwrap());
    (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
    cell
}

/// Returns the computed and the sampled figures at a random posture.
fn first_and_sampled(cell: &Cell) -> (Figures, MonteCarlo) {
    let mut rng = ChaCha8Rng::seed_from_u64(65);
    let frames = frames_at(&cell.robot, &random_joints(&mut rng, &cell.robot));
    let evaluator = gauge_of(cell);
    let first = evaluator.judge(&alone(), &frames, &mut evaluator.memory()).figures[evaluator.own()];
    (first, monte_carlo(&evaluator, &alone(), &frames, 1 << 16, 3, first.p95))
}

/// Small errors of all links make the first-order figures exact. Chance must not refute them: no seed of 60
/// may contradict them, and the mean over all seeds agrees with them closely.
#[test]
fn chance_does_not_refute_exact_figures() {
    let mut rng = ChaCha8Rng::seed_from_u64(66);
    let robot = random_robot(&mut rng, 5);
    let normal = [Distribution::Normal];
    let tolerance = random_tolerance(&mut rng, robot.axes(), 3 * robot.axes(), (1e-6, 1e-6), &normal);
    let mut cell = cell_of(robot.clone(), tolerance, Sense::plain("xy").unwrap());
    (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
    let frames = frames_at(&robot, &random_joints(&mut rng, &robot));
    let evaluator = gauge_of(&cell);
    let first = evaluator.judge(&alone(), &frames, &mut evaluator.memory()).figures[evaluator.own()];
    let (mut p99, mut outside) = (0.0, 0);
    for seed in 0..60 {
        let sampled = monte_carlo(&evaluator, &alone(), &frames, 1 << 15, seed, first.p95);
        assert!(sampled.confirms(&first), "{seed}: {first:?} {sampled:?}");
        p99 += sampled.p99.value / 60.0;
        let far = (sampled.p99.value / first.p99 - 1.0).abs() > 0.01;
        outside += usize::from(far && !(sampled.p99.low..=sampled.p99.high).contains(&first.p99));
    }
    assert!((p99 / first.p99 - 1.0).abs() < 2e-3, "{p99} {first:?}");
    assert!(outside > 0, "some seeds must deviate by chance, or this test cannot fail");
}

/// The budget of the linear worst case consists of the terms at its corner, and these terms add up to the
/// error.
#[test]
fn the_error_budget_adds_up() {
    let mut rng = ChaCha8Rng::seed_from_u64(64);
    for k in 0..60 {
        let axes = 2 + k % 6;
        let robot = random_robot(&mut rng, axes);
        let tolerance = random_tolerance(&mut rng, axes, 2 * axes, (1e-3, 1e-2), &[Distribution::Normal]);
        let q = random_joints(&mut rng, &robot);
        let want = columns(&robot, &q, &tolerance);
        let cell = cell_of(robot.clone(), tolerance, Sense::plain("xyz").unwrap());
        let (evaluator, frames) = (gauge_of(&cell), frames_at(&robot, &q));
        let budget = Budget::new(&evaluator, &alone(), &frames, &mut evaluator.memory());
        let total: f64 = budget.shares.iter().map(|s| s.of_worst).sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert!(budget.shares.windows(2).all(|w| w[0].of_worst >= w[1].of_worst));
        for (place, source) in evaluator.sources.list.iter().enumerate() {
            let share = budget.shares.iter().find(|s| s.parameter == source.parameter).unwrap();
            assert!((share.term - want[place]).norm() < 1e-12, "{:?}", share.parameter);
            assert!((share.alone - want[place].norm()).abs() < 1e-12);
        }
        // Each share is the slope of the worst case with respect to its tolerance.
        let (first, h) = (&budget.shares[0], 1e-6);
        let mut tighter = cell.clone();
        if let ErrorSet::Tolerance(t) = &mut tighter.robot.errors[0] {
            let place = Parameter::of_robot(axes).position(|p| p == first.parameter).unwrap();
            t.spreads[place].plus_minus *= 1.0 - h;
        }
        let tighter = gauge_of(&tighter);
        let less = Budget::new(&tighter, &alone(), &frames, &mut tighter.memory()).worst;
        let slope = (budget.worst - less) / (h * budget.worst);
        assert!((slope - first.of_worst).abs() < 1e-4, "{slope} {}", first.of_worst);
    }
}
