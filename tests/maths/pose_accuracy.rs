//! Tests the predicted pose accuracy and repeatability with simulated robots. The simulation uses
//! pseudo-random numbers, a product of textbook D-H matrices, and a fit of the base frame by singular value
//! decomposition.

use crate::common::{cases, robots};
use crate::kinematics::product::{position, product, random_joints};
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use sweetspot::cell::{Distribution, ErrorSet, MAX_JOINTS, Parameter, Robot, Spread};
use sweetspot::pose_accuracy::{PRESETS, PoseAccuracyTest, TestCube, guessed, joint_scatter, repeatability};
use sweetspot::reach::Inverse;
use sweetspot::robot::Chain;

/// Arms of several families, all without a mount.
const ARMS: [&str; 4] = ["puma560", "ur5e", "adept_cobra_s600", "abb_irb460"];

fn arm(name: &str) -> (Robot, Chain, TestCube) {
    let (_, robot) = robots().into_iter().find(|(stem, _)| stem == name).unwrap();
    let chain = Chain::new(&robot);
    let cube = TestCube::largest(&robot, &chain, &Inverse::new(&chain)).unwrap();
    (robot, chain, cube)
}

fn tolerances(robot: &Robot) -> Vec<Spread> {
    let set = robot.errors.iter().find_map(|set| match set {
        ErrorSet::Tolerance(t) => Some(t.spreads.clone()),
        ErrorSet::Signed(_) | ErrorSet::Measured(_) => None,
    });
    set.unwrap()
}

/// Returns a normally distributed number (Box and Muller).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random());
    (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
}

fn drawn(spread: &Spread, rng: &mut ChaCha8Rng) -> f64 {
    let h = spread.plus_minus;
    match spread.distribution {
        Distribution::Normal => h / spread.sigmas * normal(rng),
        Distribution::Uniform => h * rng.random_range(-1.0..=1.0),
        Distribution::Triangular => h * (rng.random::<f64>() - rng.random::<f64>()),
    }
}

/// Returns the motion (rotation, translation) that brings `from` nearest to `to` (Kabsch).
fn rigid(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> (Matrix3<f64>, Vector3<f64>) {
    let mean = |all: &[Vector3<f64>]| all.iter().sum::<Vector3<f64>>() / all.len() as f64;
    let (a, b) = (mean(from), mean(to));
    let cross: Matrix3<f64> = from.iter().zip(to).map(|(p, q)| (q - b) * (p - a).transpose()).sum();
    let svd = cross.svd(true, true);
    let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap());
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
    let rotation = u * sign * v;
    (rotation, b - rotation * a)
}

/// Returns the median over simulated robots of the mean distance at the five poses.
fn simulated(robot: &Robot, cube: &TestCube, spreads: &[Spread], fitted: bool, count: usize) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let none = vec![0.0; spreads.len()];
    let everywhere: Vec<_> =
        (0..if fitted { 150 } else { 0 }).map(|_| random_joints(robot, &mut rng)).collect();
    let at = |q: &[f64], values: &[f64]| position(&product(robot, q, values));
    let nominal: Vec<_> = everywhere.iter().map(|q| at(q, &none)).collect();
    let mut means: Vec<f64> = (0..count)
        .map(|_| {
            let values: Vec<_> = spreads.iter().map(|s| drawn(s, &mut rng)).collect();
            let real: Vec<_> = everywhere.iter().map(|q| at(q, &values)).collect();
            let (turn, shift) =
                if fitted { rigid(&nominal, &real) } else { (Matrix3::identity(), Vector3::zeros()) };
            let miss = |q: &[f64; MAX_JOINTS]| (at(q, &values) - (turn * at(q, &none) + shift)).norm();
            cube.poses.iter().map(|pose| miss(&pose.joints)).sum::<f64>() / 5.0
        })
        .collect();
    means.sort_by(f64::total_cmp);
    means[count / 2]
}

#[test]
fn the_predicted_accuracy_is_that_of_simulated_robots() {
    for name in ARMS {
        let (robot, chain, cube) = arm(name);
        let mut spreads = tolerances(&robot);
        // Every kind of distribution occurs.
        let kinds = [Distribution::Normal, Distribution::Uniform, Distribution::Triangular];
        spreads.iter_mut().enumerate().for_each(|(k, s)| s.distribution = kinds[k % 3]);
        for (fitted, within) in [(false, 0.05), (true, 0.08)] {
            let predicted = PoseAccuracyTest::new(&chain, &cube, fitted).accuracy(&spreads);
            let simulated = simulated(&robot, &cube, &spreads, fitted, if fitted { 800 } else { 4000 });
            let off = predicted.median / simulated - 1.0;
            assert!(off.abs() < within, "{name}, fitted {fitted}: {} {simulated}", predicted.median);
            assert!(predicted.best < predicted.median && predicted.median < predicted.worst, "{name}");
            assert!(predicted.largest_pose > predicted.median, "{name}");
        }
    }
}

#[test]
fn a_guess_has_the_accuracy_of_the_data_sheet() {
    for name in ARMS {
        let (robot, chain, cube) = arm(name);
        let test = PoseAccuracyTest::new(&chain, &cube, false);
        let spreads = tolerances(&robot);
        let guess = guessed(&robot, &chain, &test, &spreads, (Some(2e-3), None)).unwrap();
        assert!(guess.steps <= 6, "{name}: {} steps", guess.steps);
        assert!((guess.accuracy.median - 2e-3).abs() < 1e-11, "{name}");
        let ratios = guess.spreads.iter().zip(&spreads).filter(|(_, s)| s.plus_minus > 0.0);
        ratios.for_each(|(g, s)| assert!((g.plus_minus / s.plus_minus - guess.scale).abs() < 1e-9, "{name}"));
        let simulated = simulated(&robot, &cube, &guess.spreads, false, 4000);
        assert!((simulated / 2e-3 - 1.0).abs() < 0.05, "{name}: {simulated}");
    }
}

#[test]
fn the_repeatability_is_that_of_simulated_repetitions() {
    for name in ARMS {
        let (robot, chain, cube) = arm(name);
        let test = PoseAccuracyTest::new(&chain, &cube, true);
        let rp = 5e-5;
        let scatter = joint_scatter(&robot, &chain, &test, rp).unwrap();
        assert!((repeatability(&chain, &test, &scatter) / rp - 1.0).abs() < 1e-9, "{name}");
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let none = vec![0.0; Parameter::count(robot.axes())];
        let of_pose = |q: &[f64; MAX_JOINTS], rng: &mut ChaCha8Rng| {
            let attained: Vec<_> = (0..2000)
                .map(|_| {
                    let moved: Vec<_> = q.iter().zip(scatter).map(|(q, s)| q + s * normal(rng)).collect();
                    position(&product(&robot, &moved, &none))
                })
                .collect();
            let count = attained.len() as f64;
            let barycentre = attained.iter().sum::<Vector3<f64>>() / count;
            let l: Vec<f64> = attained.iter().map(|p| (p - barycentre).norm()).collect();
            let mean = l.iter().sum::<f64>() / count;
            mean + 3.0 * (l.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
        };
        let simulated = cube.poses.iter().map(|pose| of_pose(&pose.joints, &mut rng)).sum::<f64>() / 5.0;
        assert!((simulated / rp - 1.0).abs() < 0.04, "{name}: {simulated}");
    }
}

/// The random errors of the joints add to their tolerances by root sum square.
#[test]
fn a_repeatability_widens_the_tolerances_of_the_joints_alone() {
    let (robot, chain, cube) = arm("puma560");
    let test = PoseAccuracyTest::new(&chain, &cube, true);
    let spreads = tolerances(&robot);
    let plain = guessed(&robot, &chain, &test, &spreads, (Some(1e-3), None)).unwrap();
    let random = guessed(&robot, &chain, &test, &spreads, (Some(1e-3), Some(1e-4))).unwrap();
    let scatter = random.scatter.unwrap();
    for ((parameter, a), b) in Parameter::of_robot(6).zip(&plain.spreads).zip(&random.spreads) {
        match parameter {
            Parameter::Dq(i) => {
                let both = (a.deviation().powi(2) + scatter[i].powi(2)).sqrt();
                assert!((b.deviation() - both).abs() < 1e-15 && b.deviation() > a.deviation());
            }
            _ => assert_eq!(a, b),
        }
    }
}

/// The standard defines the poses: the centre, and points in a diagonal plane at 10 % of the diagonal from
/// the corners.
#[test]
fn the_test_cube_of_every_robot_has_the_poses_of_the_standard() {
    for (name, robot) in robots() {
        let chain = Chain::new(&robot);
        let cube =
            TestCube::largest(&robot, &chain, &Inverse::new(&chain)).unwrap_or_else(|| panic!("{name}"));
        let diagonal = cube.edge * 3f64.sqrt();
        assert_eq!(cube.poses[0].position, cube.centre, "{name}");
        for pose in &cube.poses[1..] {
            let from_corner = diagonal / 2.0 - (pose.position - cube.centre).norm();
            assert!((from_corner / diagonal - 0.1).abs() < 1e-9, "{name}");
        }
        let [_, p2, p3, p4, p5] = cube.poses.each_ref().map(|pose| pose.position);
        assert!((p2 - cube.centre + p4 - cube.centre).norm() < 1e-12, "{name}");
        assert!((p2 - p3).dot(&(p3 - p4)).abs() < 1e-12 && (p3 - p4).dot(&(p4 - p5)).abs() < 1e-12, "{name}");
        for pose in &cube.poses {
            let there = chain.forward(&chain.posture(&pose.joints)).translation;
            assert!((there - pose.position).norm() < 1e-5, "{name}: {there} {}", pose.position);
            for (q, joint) in pose.joints.iter().zip(&robot.joints).filter(|(_, j)| !j.is_passive()) {
                assert!(*q >= joint.limits.0 - 1e-9 && *q <= joint.limits.1 + 1e-9, "{name}");
            }
        }
    }
}

#[test]
fn every_preset_gives_every_robot_an_accuracy() {
    // By default, every robot is tested with a third of the presets, so each preset is tested with a third of
    // the robots.
    let step = cases(3, 1);
    for (k, (name, robot)) in robots().into_iter().filter(|(name, _)| name != "fanuc_crx10ia").enumerate() {
        let chain = Chain::new(&robot);
        let cube = TestCube::largest(&robot, &chain, &Inverse::new(&chain)).unwrap();
        let test = PoseAccuracyTest::new(&chain, &cube, true);
        for preset in PRESETS.iter().skip(k % step).step_by(step) {
            let spreads = preset.spreads(&robot, &chain);
            assert_eq!(spreads.len(), Parameter::count(robot.axes()), "{name}");
            let median = test.accuracy(&spreads).median;
            assert!(median > 1e-5 && median < 2e-2, "{name}, {}: {median}", preset.name);
        }
    }
}

/// The sources of the presets state these accuracies, in mm.
#[test]
fn the_sources_of_the_presets_state_the_right_accuracies() {
    let stated = [
        ("ur10", "collaborative", 0.9, 0.05),
        ("puma560", "medium", 0.6, 0.05),
        ("abb_irb460", "palletizer", 1.0, 0.1),
        ("adept_cobra_s600", "scara", 0.15, 0.015),
        ("franka_panda", "research", 3.0, 0.3),
    ];
    for (name, preset, mm, within) in stated {
        let (robot, chain, cube) = arm(name);
        let preset = PRESETS.iter().find(|p| p.name == preset).unwrap();
        assert!(preset.source.contains(&format!("is {mm} mm")), "{}", preset.source);
        let accuracy = PoseAccuracyTest::new(&chain, &cube, true).accuracy(&preset.spreads(&robot, &chain));
        assert!((accuracy.median * 1e3 - mm).abs() < within, "{name}: {} mm", accuracy.median * 1e3);
    }
}
