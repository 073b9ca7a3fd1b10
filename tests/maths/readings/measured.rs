//! Tests measured errors: values with a covariance, in every reading, against plain Monte Carlo and all
//! corners.

use crate::common::shipped;
use crate::readings::bench::{alone, cell_of, gauge_of};
use nalgebra::{DMatrix, DVector, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, Normal};
use sweetspot::cell::*;
use sweetspot::kinematic_error::{Perturbation, pose_error};
use sweetspot::reading::{Budget, monte_carlo};
use sweetspot::robot::{Chain, Frames};

/// Returns parameters of a UR10 that a calibration identifies, each with its value and the size of its
/// deviation.
fn identified() -> [(Parameter, f64, f64); 7] {
    [
        (Parameter::Dl(1), 8e-4, 2e-4),
        (Parameter::Dr(3), -5e-4, 1e-4),
        (Parameter::Dq(2), 6e-4, 2e-4),
        (Parameter::Dalpha(0), -4e-4, 2e-4),
        (Parameter::Elastic(1, 2), -1.5e-3, 4e-4),
        (Parameter::Elastic(2, 2), 1e-3, 3e-4),
        (Parameter::Tool(2), 3e-4, 2e-4),
    ]
}

/// Returns a cell whose UR arm has measured errors with a random covariance.
fn measured_cell(rng: &mut ChaCha8Rng) -> (Cell, DMatrix<f64>) {
    let robot = shipped("ur_cell.toml").robot;
    let axes = robot.axes();
    let all: Vec<Parameter> = Parameter::of_robot(axes).collect();
    let mut values = vec![0.0; all.len()];
    let mut spreads = vec![Spread::of_magnitude(0.0); all.len()];
    let places = identified().map(|(p, ..)| all.iter().position(|a| *a == p).unwrap());
    let sizes = identified().map(|(.., size)| size);
    let b = DMatrix::from_fn(7, 7, |row, _| sizes[row] * rng.random_range(-0.5..0.5));
    let matrix = &b * b.transpose();
    for (k, (place, (_, value, _))) in places.iter().zip(identified()).enumerate() {
        values[*place] = value;
        spreads[*place] = Spread::of_magnitude(3.0 * matrix[(k, k)].sqrt());
    }
    let covariance = Some(Covariance { parameters: places.to_vec(), matrix: matrix.clone() });
    let mean = SignedErrors::of_values("measured".into(), axes, &values);
    let spread = Tolerance { name: "measured".into(), spreads, covariance, costs: Vec::new() };
    let none = Tolerance {
        name: "none".into(),
        spreads: vec![Spread::of_magnitude(0.0); all.len()],
        covariance: None,
        costs: Vec::new(),
    };
    let mut cell = cell_of(robot, none, Sense::plain("xyz").unwrap());
    cell.robot.errors = vec![ErrorSet::Measured(Box::new(MeasuredErrors { mean, spread, ranges: None }))];
    cell.model = Model::Nonlinear;
    (cell, matrix)
}

fn postures(chain: &Chain) -> Vec<Frames> {
    (0..5).map(|k| chain.frames(&chain.posture(&chain.halton_sample(4 + 6 * k)))).collect()
}

/// Returns the nonlinear position error of a sample of the identified parameters.
fn error(chain: &Chain, frames: &Frames, sample: &[f64]) -> Vector3<f64> {
    let mut values = vec![0.0; Parameter::count(chain.axes())];
    for (place, parameter) in Parameter::of_robot(chain.axes()).enumerate() {
        if let Some(k) = identified().iter().position(|(p, ..)| *p == parameter) {
            values[place] = sample[k];
        }
    }
    pose_error(frames, &Perturbation::of_values(chain, &values), Model::Nonlinear).position
}

#[test]
fn the_signed_reading_of_measured_errors_is_the_error_of_their_values() {
    let (mut cell, _) = measured_cell(&mut ChaCha8Rng::seed_from_u64(1));
    cell.reading = Reading::Signed;
    let (evaluator, chain) = (gauge_of(&cell), Chain::new(&cell.robot));
    for frames in postures(&chain) {
        let want = error(&chain, &frames, &identified().map(|(_, value, _)| value)).norm();
        let got = evaluator.value(&alone(), &frames, &mut evaluator.memory());
        assert!((got - want).abs() < 1e-15, "{got} {want}");
    }
}

/// The reference draws samples with the Cholesky factor of the covariance, without code of the program.
#[test]
fn statistics_of_measured_errors_agree_with_plain_monte_carlo() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for model in [Model::Nonlinear, Model::Linear] {
        let (mut cell, matrix) = measured_cell(&mut rng);
        (cell.reading, cell.model) = (Reading::Statistical, model);
        let factor = matrix.cholesky().unwrap().l();
        let (evaluator, chain) = (gauge_of(&cell), Chain::new(&cell.robot));
        let normal = Normal::standard();
        for frames in postures(&chain) {
            let mut sizes: Vec<f64> = (0..60_000)
                .map(|_| {
                    let z = DVector::from_fn(7, |_, _| normal.inverse_cdf(rng.random_range(1e-12..1.0)));
                    let by = &factor * z;
                    let sample: Vec<f64> =
                        identified().iter().zip(by.iter()).map(|((_, v, _), by)| v + by).collect();
                    error(&chain, &frames, &sample).norm()
                })
                .collect();
            sizes.sort_by(f64::total_cmp);
            let n = sizes.len() as f64;
            let rms = (sizes.iter().map(|s| s * s).sum::<f64>() / n).sqrt();
            let mean = sizes.iter().sum::<f64>() / n;
            let at = |p: f64| sizes[(p * n) as usize];
            let judged = evaluator.judge(&alone(), &frames, &mut evaluator.memory());
            let got = judged.figures[evaluator.own()];
            for (got, want) in [(got.rms, rms), (got.mean, mean), (got.p95, at(0.95)), (got.p99, at(0.99))] {
                assert!((got / want - 1.0).abs() < 0.012, "{model:?}: {got} instead of {want}");
            }
            let own = monte_carlo(&evaluator, &alone(), &frames, 1 << 15, 3, got.p95);
            assert!(own.confirms(&got), "{got:?} {own:?}");
        }
    }
}

/// The worst case is at a corner of the box around the measured values.
#[test]
fn the_worst_case_of_measured_errors_agrees_with_all_corners() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for model in [Model::Nonlinear, Model::Linear] {
        let (mut cell, matrix) = measured_cell(&mut rng);
        (cell.reading, cell.model) = (Reading::WorstCase, model);
        let (evaluator, chain) = (gauge_of(&cell), Chain::new(&cell.robot));
        for frames in postures(&chain) {
            let unit = |k: usize| {
                let sample: [f64; 7] = std::array::from_fn(|i| if i == k { 1e-7 } else { 0.0 });
                error(&chain, &frames, &sample) / 1e-7
            };
            let columns: Vec<_> = (0..7).map(unit).collect();
            let corner = |signs: usize| {
                let value = |k: usize| {
                    let sign = if signs >> k & 1 == 1 { 1.0 } else { -1.0 };
                    identified()[k].1 + sign * 3.0 * matrix[(k, k)].sqrt()
                };
                let sample: [f64; 7] = std::array::from_fn(value);
                match model {
                    Model::Linear => {
                        columns.iter().zip(sample).map(|(c, v)| c * v).sum::<Vector3<f64>>().norm()
                    }
                    _ => error(&chain, &frames, &sample).norm(),
                }
            };
            let want = (0..1 << 7).map(corner).fold(0.0, f64::max);
            let mut memory = evaluator.memory();
            let got = evaluator.value(&alone(), &frames, &mut memory);
            assert!((got / want - 1.0).abs() < 1e-5, "{model:?}: {got} instead of {want}");
            let budget = Budget::new(&evaluator, &alone(), &frames, &mut memory);
            let shares: f64 = budget.shares.iter().map(|s| s.of_worst).sum();
            assert!((shares - 1.0).abs() < 1e-9, "{shares}");
            // The reported corner has the reported error.
            evaluator.prepare(&alone(), &frames, &mut memory);
            let worst = evaluator.worst(&evaluator.sense, &alone(), &frames, &mut memory);
            let mut values = vec![0.0; evaluator.sources.list.len()];
            evaluator.corner(worst.corner, &mut values);
            let there = evaluator.error_of(&values, &alone(), &frames, model, &mut memory).position.norm();
            assert!((there - worst.by_model).abs() < 1e-12, "{there} {}", worst.by_model);
        }
    }
}
