//! Tests the closed forms that Newton's method refines: against an independent D-H product, against the
//! numeric solver, and on rows with offsets of kilometres.

use crate::common::shipped;
use crate::kinematics::six_axes::{InverseBench, irb140, offsets, puma560, ur5};
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use sweetspot::cell::{Attitude, Robot, Spin};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::pose::Pose;
use sweetspot::reach::{Inverse, RefinedSolver};
use sweetspot::robot::Chain;

/// Adds a random error of up to `size` (rad and m) to every entry of every row.
fn disturb(robot: &mut Robot, size: f64, rng: &mut ChaCha8Rng) {
    for joint in &mut robot.joints {
        for entry in [&mut joint.theta, &mut joint.r, &mut joint.l, &mut joint.alpha] {
            *entry += rng.random_range(-size..size);
        }
    }
}

/// Returns the number of random poses without any solution, and the number of poses whose original posture is
/// not found. Checks that every posture found attains the pose, and that no branch index occurs twice.
fn missed(bench: &InverseBench, count: usize, seed: u64) -> [usize; 2] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut missed = [0; 2];
    for _ in 0..count {
        let q = bench.random(&mut rng);
        let answer = bench.verified(&q);
        let numbers: std::collections::BTreeSet<u8> = answer.found.iter().map(|f| f.0).collect();
        assert_eq!(numbers.len(), answer.found.len(), "{q:?}: a number occurs twice");
        assert!(numbers.iter().all(|n| *n < 16), "{q:?}: {numbers:?}");
        missed[0] += usize::from(answer.found.is_empty());
        missed[1] += usize::from(bench.nearest(&q, &answer) > 1e-4);
    }
    missed
}

/// Postures whose distance from a singular posture is about the size of the errors may be missed.
#[test]
fn the_original_postures_of_disturbed_arms_are_found() {
    let poses = crate::common::cases(500, 20_000);
    let sizes = [1e-5, 1e-4, 1e-3];
    let cases: Vec<(usize, f64)> = (0..4).flat_map(|arm| sizes.map(|size| (arm, size))).collect();
    let lost: Vec<_> = cases
        .into_par_iter()
        .map(|(arm, size)| {
            let mut robot = [puma560, irb140, ur5, offsets][arm]().robot;
            disturb(&mut robot, size, &mut ChaCha8Rng::seed_from_u64(arm as u64));
            let family = Inverse::new(&Chain::new(&robot)).family();
            assert!(family.ends_with("(closed form and Newton's method)"), "{arm} {size}: {family}");
            (arm, size, missed(&InverseBench::refined(robot), poses, 7))
        })
        .collect();
    println!("of {poses} poses each: {lost:?}");
    for (arm, size, [nothing, original]) in lost {
        assert!(nothing * 500 <= poses, "arm {arm}, errors of {size}: no posture for {nothing} of {poses}");
        assert!(original * 100 <= poses, "arm {arm}, errors of {size}: {original} of {poses} are missed");
        assert!(size > 1e-5 || original * 500 <= poses, "arm {arm}: {original} of {poses} are missed");
    }
}

#[test]
fn the_solutions_of_the_numeric_solver_are_found() {
    let counts: Vec<[usize; 3]> = (0..60u64)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(900 + seed);
            let mut robot = if seed.is_multiple_of(2) { puma560() } else { ur5() }.robot;
            disturb(&mut robot, 5e-4, &mut rng);
            let bench = InverseBench::refined(robot);
            bench.beside_numeric(&mut rng)
        })
        .collect();
    let [expected, found] = [0, 1].map(|k| counts.iter().map(|c| c[k]).sum::<usize>());
    assert!(expected > 300 && found == expected, "{found} of {expected}: {counts:?}");
}

/// Rotates every joint axis after the first by up to `size` (rad) in both directions, and returns exact D-H
/// rows of the new axes. The common normal of two nearly parallel axes can be kilometres away.
fn tilted(robot: &Robot, size: f64, rng: &mut ChaCha8Rng) -> Robot {
    let mut tilted = robot.clone();
    // Motion that the rows so far do not contain: a rotation about z (rad) and a translation along z (m).
    let (mut turn, mut slide) = (0.0, 0.0);
    for joint in &mut tilted.joints {
        let about = |axis: Vector3<f64>| Rotation3::new(axis).into_inner();
        let tilt = Vector3::new(rng.random_range(-size..size), rng.random_range(-size..size), 0.0);
        let rotation = about(Vector3::z() * (joint.theta + turn)) * about(Vector3::x() * joint.alpha);
        let translation = about(Vector3::z() * (joint.theta + turn)) * Vector3::new(joint.l, 0.0, 0.0)
            + Vector3::z() * (joint.r + slide);
        let next = Pose { rotation: rotation * about(tilt), translation };
        let (d, p) = (next.rotation.column(2).into_owned(), next.translation);
        let across = d.x.hypot(d.y);
        let normal = Vector3::new(-d.y, d.x, 0.0) / across;
        (joint.theta, joint.alpha) = (normal.y.atan2(normal.x), across.atan2(d.z));
        (joint.r, joint.l) = (p.cross(&d).dot(&normal) / across, p.dot(&normal));
        let row = Pose {
            rotation: about(Vector3::z() * joint.theta) * about(Vector3::x() * joint.alpha),
            translation: normal * joint.l + Vector3::z() * joint.r,
        };
        let left = row.inverse() * next;
        let off = left.rotation * Vector3::z() - Vector3::z();
        assert!(off.norm() < 1e-9 && left.translation.xy().norm() < 1e-6, "{left:?}");
        (turn, slide) = (left.rotation.m21.atan2(left.rotation.m11), left.translation.z);
    }
    tilted
}

#[test]
fn rows_with_offsets_of_kilometres_are_solved() {
    for seed in 0..6 {
        let robot = tilted(&ur5().robot, 1e-4, &mut ChaCha8Rng::seed_from_u64(40 + seed));
        let longest = robot.joints.iter().map(|joint| joint.r.abs()).fold(0.0, f64::max);
        assert!(longest > 500.0, "{longest} m");
        let bench = InverseBench::refined(robot);
        let [nothing, original] = missed(&bench, 300, seed);
        assert!(nothing == 0 && original <= 1, "{nothing} and {original} of 300 are missed");
    }
}

#[test]
fn arms_far_from_every_family_are_not_refined() {
    let mut robot = puma560().robot;
    robot.joints[3].l = 0.1;
    robot.joints[2].alpha = 1.0;
    robot.joints[1].alpha = 0.3;
    assert!(RefinedSolver::new(&Chain::new(&robot)).is_none());
    let mut short = puma560().robot;
    short.joints.pop();
    assert!(RefinedSolver::new(&Chain::new(&short)).is_none());
}

/// A pose far out of reach gives its distance, and a pose with invalid numbers gives no posture.
#[test]
fn poses_out_of_reach_have_a_distance() {
    let mut robot = ur5().robot;
    let exact = ur5();
    disturb(&mut robot, 1e-4, &mut ChaCha8Rng::seed_from_u64(3));
    let bench = InverseBench::refined(robot);
    let mut flange = Pose { rotation: Matrix3::identity(), translation: Vector3::new(3.0, 0.0, 0.4) };
    let (refined, closed) = (bench.solve(&flange), exact.solve(&flange));
    assert!(refined.found.is_empty() && (refined.missing - closed.missing).abs() < 2e-3);
    for hostile in [f64::NAN, f64::INFINITY, 1e300] {
        flange.translation.x = hostile;
        assert!(bench.solve(&flange).found.is_empty());
    }
}

/// Changes of nanometres in the lengths do not change the class of any node, and hardly any value. The twists
/// stay exact, because the error model of parallel axes has another parameter.
#[test]
fn a_cell_with_nearly_exact_rows_has_the_values_of_the_closed_form() {
    let mut cell = shipped("wrist_cell.toml");
    // A free spin would be refined only in the cell with nearly exact rows, where no single joint turns the
    // tool.
    for operation in &mut cell.operations {
        operation.attitude.spin = Spin::At(Attitude::free_spins().collect());
    }
    let mut nearly = cell.clone();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for joint in &mut nearly.robot.joints {
        joint.r += rng.random_range(-1e-9..1e-9);
        joint.l += rng.random_range(-1e-9..1e-9);
    }
    let [exact, refined] = [cell, nearly].map(|cell| Workcell::new(cell).unwrap());
    assert!(refined.inverse().family().contains("Newton"), "{}", refined.inverse().family());
    let start = exact.cell.start();
    let objective = |workcell: &Workcell| evaluate(workcell, &start).objective.unwrap();
    let (a, b) = (objective(&exact), objective(&refined));
    assert!((a - b).abs() < 1e-6 * a, "{a} {b}");
    for (a, b) in exact.maps(&start).iter().zip(refined.maps(&start)) {
        for (a, b) in a.nodes.iter().zip(&b.nodes) {
            assert_eq!(a.status.sign(), b.status.sign());
            let values = a.usable_posture().zip(b.usable_posture()).map(|(a, b)| (a.value, b.value));
            assert!(values.is_none_or(|(a, b)| (a - b).abs() < 1e-6 * a), "{values:?}");
        }
    }
}
