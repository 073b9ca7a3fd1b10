//! Inverse kinematics of six-axis arms: all postures at 1000 poses (tests/data/b_*).
//!
//! One iteration solves all 1000 poses on one thread, so a time of 1 us per iteration is 1 ns per pose.
//! For comparison, the crate rs-opw-kinematics solves the poses of the PUMA 560.

#![allow(clippy::expect_used)] // without its data, a benchmark has nothing to measure

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix3, Vector3};
use rs_opw_kinematics::constraints::{BY_PREV, Constraints};
use rs_opw_kinematics::kinematic_traits::Kinematics;
use rs_opw_kinematics::kinematics_impl::OPWKinematics;
use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use sweetspot::cell::Robot;
use sweetspot::pose::Pose;
use sweetspot::reach::{GeneralSixAxes, RefinedSolver, SphericalWrist, ThreeParallel};
use sweetspot::robot::{Chain, Posture};
use sweetspot::{cell, files};

fn folder() -> std::path::PathBuf {
    std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("tests/data")
}

fn robot(name: &str) -> Robot {
    let read = &mut |path: &str| std::fs::read(folder().join(path)).map_err(|e| e.to_string());
    files::load(name, read).expect("a cell").cell.robot
}

fn data(name: &str) -> Vec<f64> {
    let bytes = std::fs::read(folder().join(name)).expect("reference data");
    bytes.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().expect("8 bytes"))).collect()
}

fn poses(name: &str) -> Vec<Pose> {
    let pose = |t: &[f64]| Pose {
        rotation: Matrix3::new(t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]),
        translation: Vector3::new(t[3], t[7], t[11]),
    };
    data(name).chunks_exact(16).map(pose).collect()
}

/// Returns for each joint the cosine and sine of the middle of its range, and the cosine of half the
/// width of the range.
///
/// A joint is within its limits if the cosine of its distance from the middle is at least the third value.
/// That value is -2 for a range of a full turn or more.
fn arcs(robot: &Robot) -> [[f64; 3]; 6] {
    std::array::from_fn(|k| {
        let joint = &robot.joints[k];
        let (middle, half) =
            ((joint.limits.0 + joint.limits.1) / 2.0 + joint.theta, (joint.limits.1 - joint.limits.0) / 2.0);
        let cosine = if half >= std::f64::consts::PI { -2.0 } else { half.cos() };
        [middle.cos(), middle.sin(), cosine]
    })
}

fn allowed(arcs: &[[f64; 3]; 6], posture: &Posture) -> bool {
    (0..6).all(|k| posture.cos[k] * arcs[k][0] + posture.sin[k] * arcs[k][1] >= arcs[k][2])
}

/// Measures three uses of the postures: counting all postures, counting the postures within the joint
/// limits, and computing the joint angles of the postures within the limits.
fn ways(
    c: &mut Criterion,
    name: &str,
    robot: &Robot,
    solve: impl Fn(usize, &mut Posture, &mut dyn FnMut(&Posture)),
) {
    let (arcs, mut scratch) = (arcs(robot), Chain::new(robot).posture(&[0.0; cell::MAX_JOINTS]));
    let mut run = |what: &str, visit: &dyn Fn(&Posture) -> f64| {
        c.bench_function(&format!("{name}, {what}: 1000 poses"), |b| {
            b.iter(|| {
                let mut sum = 0.0;
                (0..1000)
                    .for_each(|k| solve(k, &mut scratch, &mut |posture| sum += visit(black_box(posture))));
                sum
            })
        });
    };
    run("all", &|_| 1.0);
    run("within limits", &|posture| f64::from(allowed(&arcs, posture)));
    run("angles within limits", &|posture| match allowed(&arcs, posture) {
        true => (0..6).map(|k| posture.sin[k].atan2(posture.cos[k])).sum(),
        false => 0.0,
    });
}

fn puma560(c: &mut Criterion) {
    let robot = robot("puma560.toml");
    let (arm, poses) = (SphericalWrist::new(&Chain::new(&robot)).expect("a wrist"), poses("b_puma560_T.bin"));
    ways(c, "PUMA 560", &robot, |k, scratch, visit| {
        arm.solve(black_box(&poses[k]), scratch, &mut |_, posture| visit(posture));
    });
}

fn ur5(c: &mut Criterion) {
    let robot = robot("ur5.toml");
    let (arm, poses) = (ThreeParallel::new(&Chain::new(&robot)).expect("a UR"), poses("b_ur5_T.bin"));
    ways(c, "UR5", &robot, |k, scratch, visit| {
        arm.solve(black_box(&poses[k]), scratch, &mut |_, posture| visit(posture));
    });
}

/// Measures arms whose inverse kinematics has no closed form. Each arm has the D-H rows of a PUMA 560 or a
/// UR5, with every value changed by up to `size` (rad and m).
///
/// If `size` is small, Newton's method refines the closed-form solutions of a similar arm. If `size` is
/// large, only the elimination method for general six-axis arms can be used. About half of the poses are then
/// out of reach.
fn disturbed(c: &mut Criterion) {
    for (name, data) in [("puma560.toml", "b_puma560_T.bin"), ("ur5.toml", "b_ur5_T.bin")] {
        let poses = poses(data);
        for size in [1e-4, 1e-3, 0.3] {
            let mut robot = robot(name);
            for (k, joint) in (0..).zip(&mut robot.joints) {
                for (m, entry) in (0..).zip([&mut joint.theta, &mut joint.r, &mut joint.l, &mut joint.alpha])
                {
                    *entry += size * f64::from(4 * k + m + 1).sin();
                }
            }
            let chain = Chain::new(&robot);
            let mut scratch = chain.zero_posture();
            let refined = RefinedSolver::new(&chain);
            let general = GeneralSixAxes::new(&chain).expect("six axes");
            if let Some(arm) = refined {
                c.bench_function(&format!("{name} disturbed by {size}, refined: 1000 poses"), |b| {
                    b.iter(|| {
                        let mut count = 0;
                        poses.iter().for_each(|pose| {
                            arm.solve(black_box(pose), &mut scratch, &mut |_, _| count += 1);
                        });
                        count
                    })
                });
            }
            c.bench_function(&format!("{name} disturbed by {size}, elimination: 1000 poses"), |b| {
                b.iter(|| {
                    let mut count = 0;
                    poses.iter().for_each(|pose| {
                        general.solve(black_box(pose), &mut scratch, &mut |_, _| count += 1);
                    });
                    count
                })
            });
        }
    }
}

/// Measures rs-opw-kinematics at the poses of the function `puma560`. The forward kinematics of the
/// crate computes these poses from the same joint angles.
fn peer(c: &mut Criterion) {
    let robot = robot("puma560.toml");
    let offsets = [0.0, -FRAC_PI_2, FRAC_PI_2, 0.0, 0.0, 0.0];
    let (a2, b, c1, c2, c3) = (0.0203, -0.15005, 0.67183, 0.4318, 0.4318);
    let sign_corrections = [1, -1, -1, 1, -1, 1];
    let parameters = Parameters { a1: 0.0, a2, b, c1, c2, c3, c4: 0.0, offsets, sign_corrections, dof: 6 };
    let limit = |f: fn(&(f64, f64)) -> f64| std::array::from_fn(|k| f(&robot.joints[k].limits));
    let limits = Constraints::new(limit(|l| l.0), limit(|l| l.1), BY_PREV);
    let within = OPWKinematics::new_with_constraints(parameters, limits);
    let all = OPWKinematics::new(parameters);
    let (joints, poses) = (data("b_puma560_q.bin"), poses("b_puma560_T.bin"));
    let targets: Vec<_> =
        joints.chunks_exact(6).map(|q| all.forward(&q.try_into().expect("6 joints"))).collect();
    for (pose, target) in poses.iter().zip(&targets) {
        let there = [target.translation.x, target.translation.y, target.translation.z];
        assert!((pose.translation - Vector3::from(there)).norm() < 1e-9, "another arm");
    }
    for (what, peer) in [("all", &all), ("within limits", &within)] {
        c.bench_function(&format!("PUMA 560, {what}, rs-opw-kinematics: 1000 poses"), |b| {
            b.iter(|| targets.iter().map(|t| peer.inverse(black_box(t)).len()).sum::<usize>())
        });
    }
}

criterion_group! {
    name = inverse;
    config = Criterion::default().sample_size(50);
    targets = puma560, peer, ur5, disturbed
}
criterion_main!(inverse);
