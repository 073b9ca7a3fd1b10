//! Tests first-order statistics with a second-order mean against Monte Carlo with the nonlinear model.

use crate::common::{cases, shipped};
use crate::readings::bench::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::*;
use sweetspot::reading::{Figures, MonteCarlo, monte_carlo};
use sweetspot::units::rad_from_deg;

/// Number of samples of each posture.
const SAMPLES: usize = 1 << 20;

/// Returns five robots: the paper's robot, two robots with six axes, and two random robots with seven axes
/// and with five axes and slides.
fn robots(rng: &mut ChaCha8Rng) -> Vec<Robot> {
    let paper = shipped("hitachi_paper.toml").robot;
    let mut seven = random_robot(rng, 7);
    seven.joints.iter_mut().for_each(|j| j.kind = JointKind::Revolute);
    vec![paper, robot_from("puma560"), robot_from("ur5"), seven, random_robot(rng, 5)]
}

/// Returns the computed and the sampled figures of one posture.
fn both(cell: &Cell, q: &JointVector, seed: u64) -> (Figures, f64, MonteCarlo) {
    let evaluator = gauge_of(cell);
    let frames = frames_at(&cell.robot, q);
    let mut memory = evaluator.memory();
    let judged = evaluator.judge(&alone(), &frames, &mut memory);
    let figures = judged.figures[evaluator.own()];
    let sampled = monte_carlo(&evaluator, &alone(), &frames, SAMPLES, seed, figures.p95);
    (figures, judged.success.unwrap(), sampled)
}

#[test]
fn percentiles_and_yields_of_five_robots_agree_with_monte_carlo() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let (mut inside, mut all) = (0, 0);
    for (first, robot) in robots(&mut rng).into_iter().enumerate() {
        for k in first..first + cases(1, 20) {
            // Good arms have tolerances of 0.2 mm and 0.03 degrees (three standard deviations).
            let sizes = (2e-4, rad_from_deg(0.03));
            let wrong = 3 * robot.axes() + k % 4;
            let tolerance = random_tolerance(&mut rng, robot.axes(), wrong, sizes, &[Distribution::Normal]);
            let sense = Sense::plain(["xyz", "xy", "z", "xyz@tool"][k % 4]).unwrap();
            let mut cell = cell_of(robot.clone(), tolerance, sense);
            (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
            let q = random_joints(&mut rng, &cell.robot);
            cell.operations[0].limit = Some(1.0);
            let typical = gauge_of(&cell);
            let frames = frames_at(&cell.robot, &q);
            let judged = typical.judge(&alone(), &frames, &mut typical.memory());
            cell.operations[0].limit = Some(judged.figures[typical.own()].rms * 1.3);
            let (first, success, sampled) = both(&cell, &q, k as u64);
            let what = format!("{} posture {k}: {first:?} {success} {sampled:?}", cell.robot.name);
            // Under the nonlinear model, about 5 % of the samples exceed the computed 95th percentile.
            assert!((0.045..=0.055).contains(&sampled.above.value), "{what}");
            let pairs = [
                (sampled.rms, first.rms),
                (sampled.mean, first.mean),
                (sampled.p95, first.p95),
                (sampled.p99, first.p99),
                (sampled.success.unwrap(), success),
            ];
            for (interval, figure) in pairs {
                // Plain sampling would give a figure to about 0.1 %. With quasi-random points, the sampling
                // error is smaller than the neglected terms of third order.
                let slack = 5e-4 * interval.value;
                let within = (interval.low..=interval.high).contains(&figure);
                let half = (interval.high - interval.low) / 2.0;
                assert!((figure - interval.value).abs() <= 2.0 * half + slack, "{what}");
                (inside, all) = (inside + usize::from(within), all + 1);
            }
            assert!(sampled.confirms(&first), "{what}");
        }
    }
    assert!(inside * 100 >= all * 85, "{inside} of {all} inside");
}

/// Returns a tolerance of random parameters with random distributions. One parameter dominates: its tolerance
/// is `factor` times as wide, and it has the distribution `first`.
fn dominated(rng: &mut ChaCha8Rng, axes: usize, count: usize, first: Distribution, factor: f64) -> Tolerance {
    let sizes = (3e-4, rad_from_deg(0.03));
    let mut tolerance = random_tolerance(rng, axes, count, sizes, &Distribution::ALL);
    let wrong: Vec<usize> =
        (0..tolerance.spreads.len()).filter(|&k| tolerance.spreads[k].plus_minus > 0.0).collect();
    let spread = &mut tolerance.spreads[wrong[rng.random_range(0..wrong.len())]];
    spread.plus_minus *= factor;
    spread.distribution = first;
    tolerance
}

/// On random chains with any mix of distributions, of which each kind dominates in turn, the statistical
/// reading agrees with a million samples of the nonlinear model. Percentiles agree within 1 %, and yields
/// within 0.5 percentage points. No percentile is above the worst case of bounded parameters.
#[test]
fn a_dominating_parameter_of_any_distribution_keeps_the_figures_right() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    for k in 0..cases(6, 150) {
        let axes = 3 + k % 5;
        let robot = random_robot(&mut rng, axes);
        let factor = [3.0, 10.0, 30.0][k / 3 % 3];
        let count = 1 + rng.random_range(0..3 * axes);
        let tolerance = dominated(&mut rng, axes, count, Distribution::ALL[k % 3], factor);
        let bounded =
            tolerance.spreads.iter().all(|s| s.plus_minus == 0.0 || s.distribution != Distribution::Normal);
        let sense = Sense::plain(["xyz", "xy", "z", "xyz@tool"][k % 4]).unwrap();
        let mut cell = cell_of(robot.clone(), tolerance, sense);
        (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
        let q = random_joints(&mut rng, &cell.robot);
        let typical = gauge_of(&cell);
        let judged = typical.judge(&alone(), &frames_at(&robot, &q), &mut typical.memory());
        let rms = judged.figures[typical.own()].rms;
        if rms < 1e-7 {
            continue; // The few parameters have no effect in this sense.
        }
        cell.operations[0].limit = Some(rms * rng.random_range(0.5..1.8));
        let (first, success, sampled) = both(&cell, &q, k as u64);
        let what = format!("{k}: {first:?} {success} {sampled:?}");
        for (figure, sample) in [(first.p95, sampled.p95), (first.p99, sampled.p99)] {
            assert!((figure / sample.value - 1.0).abs() < 0.01, "{what}");
            assert!(!bounded || figure <= first.worst, "{what}");
        }
        assert!((success - sampled.success.unwrap().value).abs() < 0.005, "{what}");
        assert!(sampled.confirms(&first) && sampled.confirms_yield(Some(success)), "{what}");
    }
}
