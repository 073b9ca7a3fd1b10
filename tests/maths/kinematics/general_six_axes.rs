//! Tests the inverse kinematics of any six revolute axes against an independent D-H product, against closed
//! forms and against the numeric solver.

use crate::kinematics::six_axes::{InverseAnswer, InverseBench, P, R, Row, puma560, robot, turning, ur5};
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::time::{Duration, Instant};
use sweetspot::pose::Pose;
use sweetspot::reach::GeneralSixAxes;
use sweetspot::robot::{Chain, Posture};

/// Returns the rows of an arm of random lengths and twists: theta (degrees), r, l (mm), alpha (degrees).
fn random_rows(rng: &mut ChaCha8Rng) -> [[f64; 4]; 6] {
    std::array::from_fn(|_| {
        let [theta, alpha] = [0, 1].map(|_| rng.random_range(-180.0..180.0));
        let [r, l] = [0, 1].map(|_| rng.random_range(-500.0..500.0));
        [theta, r, l, alpha]
    })
}

/// Returns the rows of the FANUC CRX-10iA.
fn crx() -> [[f64; 4]; 6] {
    [
        [0.0, 245.0, 0.0, -90.0],
        [-90.0, 0.0, 540.0, 180.0],
        [0.0, 0.0, 0.0, -90.0],
        [0.0, -540.0, 0.0, 90.0],
        [0.0, 150.0, 0.0, -90.0],
        [0.0, -160.0, 0.0, 0.0],
    ]
}

/// Returns the rows of a painting robot with a hollow wrist, whose axes do not meet in a point.
fn hollow_wrist() -> [[f64; 4]; 6] {
    [
        [0.0, 800.0, 300.0, -90.0],
        [-90.0, 0.0, 1200.0, 0.0],
        [0.0, 0.0, 150.0, -90.0],
        [0.0, 1400.0, 0.0, 60.0],
        [0.0, 120.0, 0.0, -60.0],
        [0.0, 100.0, 0.0, 0.0],
    ]
}

/// Returns the number of random poses whose original posture is not found. Checks that every posture found
/// attains the pose.
fn missed(bench: &InverseBench, count: usize, seed: u64) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let missed = |_| {
        let q = bench.random(&mut rng);
        let answer = bench.verified(&q);
        let numbers: Vec<u8> = answer.found.iter().map(|found| found.0).collect();
        assert_eq!(numbers, (0..answer.found.len() as u8).collect::<Vec<_>>(), "{q:?}");
        assert!(answer.found.len() <= 16 && (answer.missing == 0.0) != answer.found.is_empty(), "{q:?}");
        usize::from(bench.nearest(&q, &answer) > 1e-5)
    };
    (0..count).map(missed).sum()
}

/// Two postures that nearly coincide may be missed together, which concerned 3 of 400 000 poses.
#[test]
fn the_original_posture_of_random_arms_is_found() {
    let arms: Vec<u64> = (0..crate::common::cases(200, 4000) as u64).collect();
    let (poses, all) = (100, arms.len());
    let lost: usize = arms
        .into_par_iter()
        .map(|seed| {
            let rows = random_rows(&mut ChaCha8Rng::seed_from_u64(100 + seed));
            missed(&InverseBench::general(turning(rows)), poses, seed)
        })
        .sum();
    println!("{lost} of {} postures are missed", all * poses);
    assert!(lost * 10_000 <= all * poses, "{lost} of {}", all * poses);
}

#[test]
fn the_original_posture_of_arms_with_parallel_or_intersecting_axes_is_found() {
    let poses = crate::common::cases(5000, 50_000);
    for (name, robot) in [
        ("CRX-10iA", turning(crx())),
        ("hollow wrist", turning(hollow_wrist())),
        ("PUMA 560", puma560().robot),
        ("UR5", ur5().robot),
    ] {
        let lost = missed(&InverseBench::general(robot), poses, 7);
        println!("{name}: {lost} of {poses} postures are missed");
        assert!(lost * 1000 <= poses, "{name}: {lost} of {poses}");
    }
}

/// Returns three numbers: the solutions of a closed form that the general method misses, the poses with
/// different numbers of solutions, and all solutions of the closed form.
fn compared(closed: &InverseBench, general: &InverseBench, poses: usize) -> [usize; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut sums = [0; 3];
    for _ in 0..poses {
        let flange = closed.pose(&closed.random(&mut rng));
        let (expected, answer) = (closed.solve(&flange), general.solve(&flange));
        let lost = expected.found.iter().filter(|(_, posture)| !holds(&answer, posture)).count();
        sums[0] += lost;
        sums[1] += usize::from(expected.found.len() != answer.found.len());
        sums[2] += expected.found.len();
    }
    sums
}

/// Returns whether a posture is among the solutions, up to 1e-4 of a cosine or sine.
fn holds(answer: &InverseAnswer, posture: &Posture) -> bool {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
    answer.found.iter().any(|(_, found)| near(&found.cos, &posture.cos) && near(&found.sin, &posture.sin))
}

/// Only nearly singular poses may differ, because solutions that nearly coincide count as one or as two.
#[test]
fn the_solutions_are_those_of_the_closed_forms() {
    let poses = crate::common::cases(3000, 30_000);
    for (name, closed) in
        [("PUMA 560", puma560()), ("UR5", ur5()), ("CRX-10iA", InverseBench::offset(turning(crx())))]
    {
        let general = InverseBench::general(closed.robot.clone());
        let [lost, differing, expected] = compared(&closed, &general, poses);
        println!(
            "{name}: {lost} of {expected} solutions are missed, and {differing} of {poses} counts differ"
        );
        assert!(expected > 4 * poses && lost * 2000 <= expected, "{name}: {lost} of {expected}");
        assert!(differing * 400 <= poses, "{name}: {differing} of {poses}");
    }
}

/// The numeric solver starts from 384 postures, so it rarely misses a solution.
#[test]
fn the_solutions_of_the_numeric_solver_are_found() {
    let counts: Vec<[usize; 3]> = (0..32u64)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(700 + seed);
            let bench = InverseBench::general(turning(random_rows(&mut rng)));
            bench.beside_numeric(&mut rng)
        })
        .collect();
    let [expected, both, found] = [0, 1, 2].map(|k| counts.iter().map(|c| c[k]).sum::<usize>());
    assert!(
        expected > 64 && both == expected && found >= expected,
        "{expected}, {both}, {found}: {counts:?}"
    );
}

#[test]
fn a_target_out_of_reach_has_the_distance_beyond_the_sphere_of_reach() {
    let bench = InverseBench::general(turning(hollow_wrist()));
    let flange = Pose { rotation: Matrix3::identity(), translation: Vector3::new(6.0, 0.0, 0.1) };
    let answer = bench.solve(&flange);
    // Frame 5 is 100 mm below the flange, and the distances of the frames sum to the radius of the sphere.
    let radius = 0.3f64.hypot(0.8) + 1.2 + 0.15 + 1.4 + 0.12;
    let missing = answer.missing - (6.0 - radius);
    assert!(answer.found.is_empty() && missing.abs() < 1e-6, "{} {missing:e}", answer.missing);
}

#[test]
fn a_target_in_the_sphere_of_reach_without_solution_has_a_measure() {
    let bench = InverseBench::general(turning(hollow_wrist()));
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut missing = Vec::new();
    for _ in 0..200 {
        let q = bench.random(&mut rng);
        let translation = Vector3::from_fn(|_, _| rng.random_range(-2.0..2.0));
        let answer = bench.solve(&Pose { translation, ..bench.pose(&q) });
        assert_eq!(answer.missing > 0.0, answer.found.is_empty(), "{q:?}");
        assert!(answer.missing.is_finite(), "{q:?}");
        missing.extend(answer.found.is_empty().then_some(answer.missing));
    }
    assert!(missing.len() > 20, "{missing:?}");
}

#[test]
fn a_pose_that_is_not_finite_has_no_solution() {
    let bench = InverseBench::general(turning(hollow_wrist()));
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let shifted = Pose { translation: Vector3::new(1.0, value, 1.0), ..Pose::identity() };
        let turned = Pose { rotation: Matrix3::from_element(value), ..Pose::identity() };
        for flange in [shifted, turned] {
            let answer = bench.solve(&flange);
            assert!(answer.found.is_empty() && answer.missing > 0.0, "{flange:?}: {}", answer.missing);
        }
    }
}

/// Returns degenerate arms, whose axes are all parallel, all on one line or all through one point, or whose
/// lengths are all 0.
fn degenerate_arms() -> Vec<[[f64; 4]; 6]> {
    let uniform = |row: [f64; 4]| [row; 6];
    let mut arms: Vec<_> = [
        [0.0, 0.0, 0.0, 0.0],
        [10.0, 0.0, 300.0, 0.0],
        [10.0, 200.0, 0.0, 0.0],
        [10.0, 0.0, 0.0, 90.0],
        [10.0, 100.0, 200.0, 180.0],
        [10.0, 1e-300, 1e-300, 30.0],
        [10.0, 1e300, 1e300, 30.0],
    ]
    .map(uniform)
    .into();
    // Four axes meet in one point.
    let mut meeting = hollow_wrist();
    meeting[2][2] = 0.0;
    meeting[3][1] = 0.0;
    meeting[4][1] = 0.0;
    arms.push(meeting);
    // Axes 1 to 4 are parallel.
    let mut parallel = hollow_wrist();
    for row in &mut parallel[..3] {
        row[3] = 0.0;
    }
    arms.push(parallel);
    arms
}

#[test]
fn degenerate_arms_are_refused_or_solved_soon() {
    let start = Instant::now();
    let mut refused = 0;
    for rows in degenerate_arms() {
        let chain = Chain::new(&turning(rows));
        match GeneralSixAxes::new(&chain) {
            Ok(solver) => {
                for k in 0..16 {
                    let wanted = chain.posture(&std::array::from_fn(|i| (i * k) as f64 * 0.37));
                    let flange = chain.forward(&wanted);
                    let mut scratch = chain.zero_posture();
                    solver.solve(&flange, &mut scratch, &mut |_, found| {
                        let held = chain.forward(found);
                        let error = (held.translation - flange.translation).norm()
                            + (held.rotation - flange.rotation).norm();
                        assert!(error < 1e-9, "{rows:?}: {error:e}");
                    });
                }
            }
            Err(why) => {
                assert!(why.contains("trial postures"), "{why}");
                refused += 1;
            }
        }
    }
    assert!(refused >= 6, "{refused} arms are refused");
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

#[test]
fn arms_without_six_revolute_joints_are_refused_with_a_reason() {
    let rows: Vec<Row> = crx().map(|row| (R, row)).into();
    let refusal = |rows: &[Row]| GeneralSixAxes::new(&Chain::new(&robot(rows))).unwrap_err();
    assert!(refusal(&rows[..5]).contains("5 joints"));
    assert!(refusal(&[&rows[..], &rows[..1]].concat()).contains("7 joints"));
    let mut slide = rows.clone();
    slide[2].0 = P;
    let why = refusal(&slide);
    assert!(why.contains("joint 3 is prismatic"), "{why}");
}
