//! Tests two real calibrations: the actual arms against their nominal rows, with precomputed reference
//! values.
//!
//! The errors are not small: offsets of metres nearly cancel, which only the nonlinear model can handle.

use crate::common::ur::CalibratedArm;
use crate::kinematics::product::{no_errors, position, rotation, tcp};
use nalgebra::Rotation3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use sweetspot::cell::{ErrorSet, JointVector, Model, Robot};
use sweetspot::kinematic_error::{Perturbation, deviation, pose_error};
use sweetspot::pose::Displacement;
use sweetspot::robot::Chain;

const POSES: usize = 100_000;

fn posture(rng: &mut ChaCha8Rng) -> JointVector {
    std::array::from_fn(|i| if i < 6 { rng.random_range(-PI..=PI) } else { 0.0 })
}

/// Returns the nonlinear and the linear error of the flange at joint vectors that are the same in every test.
fn errors(arm: &CalibratedArm) -> Vec<(JointVector, Displacement, Displacement)> {
    let chain = Chain::new(&arm.robot);
    let factory = Perturbation::new(&chain, &arm.factory);
    let mut rng = ChaCha8Rng::seed_from_u64(2024);
    let at = |_| {
        let q = posture(&mut rng);
        let frames = chain.frames(&chain.posture(&q));
        let error = |model| pose_error(&frames, &factory, model);
        (q, error(Model::Nonlinear), error(Model::Linear))
    };
    (0..POSES).map(at).collect()
}

#[test]
fn the_nominal_flange_is_where_the_controller_reports_it() {
    let arm = CalibratedArm::new("ur10");
    let chain = Chain::new(&arm.robot);
    for (q, p) in &arm.golden {
        let q = std::array::from_fn(|i| q.get(i).copied().unwrap_or(0.0));
        let off = (chain.forward(&chain.posture(&q)).translation - p).norm();
        assert!(off < 1e-14, "{off:e} m");
    }
    assert_eq!(arm.golden.len(), 2);
}

/// An error of 2 mm is the sum of offsets of 303 m and -310 m, so the rounding error of the product is about
/// 1e-12 m.
#[test]
fn the_pose_error_is_the_difference_of_two_products() {
    for name in ["ur10", "ur10e"] {
        let arm = CalibratedArm::new(name);
        for (q, error, _) in errors(&arm).iter().take(2_000) {
            let nominal = tcp(&arm.robot, q, &no_errors(6), 0.0);
            let built = tcp(&arm.robot, q, &arm.factory, 1.0);
            let off = (position(&built) - position(&nominal) - error.position).norm();
            let turned = Rotation3::new(error.rotation) * rotation(&nominal);
            let askew = (turned - rotation(&built)).norm();
            assert!(off < 1e-12 && askew < 1e-14, "{name}: {off:e} m, {askew:e}");
        }
    }
}

fn assert_within(got: f64, want: f64, share: f64, what: &str) {
    assert!((got / want - 1.0).abs() < share, "{what}: {got} instead of {want}");
}

#[test]
fn errors_of_both_calibrated_arms_match_the_recorded_values() {
    for name in ["ur10", "ur10e"] {
        let arm = CalibratedArm::new(name);
        let errors = errors(&arm);
        let mean = |of: &dyn Fn(&(JointVector, Displacement, Displacement)) -> f64| {
            errors.iter().map(of).sum::<f64>() / POSES as f64
        };
        let mut sizes: Vec<f64> = errors.iter().map(|(_, e, _)| 1e3 * e.position.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        let got = [
            ("mean_mm", mean(&|e| 1e3 * e.1.position.norm()), 0.01),
            ("p95_mm", sizes[POSES * 95 / 100], 0.01),
            ("max_mm", sizes[POSES - 1], 0.01),
            ("rotation_mean_deg", mean(&|e| e.1.rotation.norm().to_degrees()), 0.01),
            ("linear_mean_mm", mean(&|e| 1e3 * e.2.position.norm()), 0.02),
        ];
        for (key, value, share) in got {
            println!("{name} {key} {value:.4} ({})", arm.figure(key));
            assert_within(value, arm.figure(key), share, &format!("{name} {key}"));
        }
    }
}

/// The guard tells a user not to trust the linear model.
#[test]
fn the_guard_rejects_the_linear_model_at_nearly_every_pose() {
    for (name, least) in [("ur10", 0.999), ("ur10e", 0.9999)] {
        let errors = errors(&CalibratedArm::new(name));
        let fires = |(_, nonlinear, linear): &&(JointVector, Displacement, Displacement)| {
            deviation(&nonlinear.position, &linear.position) > 0.01
        };
        let share = errors.iter().filter(fires).count() as f64 / POSES as f64;
        println!("{name}: linear model more than 1 % off at {} % of the poses", 100.0 * share);
        assert!(share >= least, "{name}: {share}");
    }
}

/// Loads the robot file of an arm.
fn shipped(name: &str) -> Robot {
    let text = format!(
        r#"
        schema = "sweetspot/cell/1"
        units = {{ length = "mm", angle = "deg" }}
        errors = "factory"
        [robot]
        from = "robots/{name}.toml"
        [equipment.table]
        surface = {{ size_mm = [1000, 1000] }}
        placement = {{ x_mm = 600, y_mm = 0, z_mm = 0 }}
        [operation.map]
        on = "table"
        grid = [2, 2]
        bend_deg = -90
        sense = "xyz""#
    );
    crate::common::from_text(&text).unwrap_or_else(|faults| panic!("{name}: {faults:#?}")).cell.robot
}

#[test]
fn shipped_arms_have_the_rows_and_errors_of_the_calibration_file() {
    for name in ["ur10", "ur10e"] {
        let (robot, arm) = (shipped(name), CalibratedArm::new(name));
        let near = |a: f64, b: f64, what: &str| {
            assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{name}, {what}: {a} instead of {b}");
        };
        assert_eq!(robot.axes(), 6);
        for (a, b) in robot.joints.iter().zip(&arm.robot.joints) {
            near(a.r, b.r, "r");
            near(a.l, b.l, "l");
            near(a.theta, b.theta, "theta");
            // The file states 90 degrees, and the controller states 1.570796327.
            assert!((a.alpha - b.alpha).abs() < 3e-10, "{name}, alpha: {} instead of {}", a.alpha, b.alpha);
        }
        let factory = robot.errors.iter().find(|e| e.name() == "factory");
        let Some(ErrorSet::Signed(errors)) = factory else { panic!("{name}: no signed set factory") };
        for (k, (a, b)) in errors.values().into_iter().zip(arm.factory.values()).enumerate() {
            near(a, b, &format!("parameter {k}"));
        }
    }
}
