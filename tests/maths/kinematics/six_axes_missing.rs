//! Tests the distance by which a pose of a six-axis arm is out of reach, against brute force.

use crate::common::cases;
use crate::kinematics::six_axes::*;
use crate::kinematics::six_axes_edges::centred;
use nalgebra::{Matrix3, Vector3, vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};
use sweetspot::pose::Pose;

fn random_rotation(rng: &mut ChaCha8Rng) -> Matrix3<f64> {
    let mut angle = || rng.random_range(-PI..PI);
    Pose::from_translation_rpy(Vector3::zeros(), vector![angle(), angle() / 2.0, angle()]).rotation
}

/// Returns the least distance of the wrist centre (frame 4) from `p` by brute force. Joints 2 and 3 are on a
/// grid, the best points are refined by ever smaller steps, and joint 1 has its best angle.
fn brute(bench: &InverseBench, p: &Vector3<f64>) -> f64 {
    let distance = |a: f64, b: f64| {
        let c = bench.chain.frames(&bench.chain.posture(&[0.0, a, b, 0.0, 0.0, 0.0, 0.0, 0.0])).links[4]
            .translation;
        (c.x.hypot(c.y) - p.x.hypot(p.y)).hypot(c.z - p.z)
    };
    const N: usize = 60;
    let step = TAU / N as f64;
    let mut grid: Vec<_> = (0..N * N).map(|k| ((k % N) as f64 * step, (k / N) as f64 * step)).collect();
    grid.sort_by(|a, b| distance(a.0, a.1).total_cmp(&distance(b.0, b.1)));
    let refined = |&(mut a, mut b): &(f64, f64)| {
        let (mut least, mut step) = (distance(a, b), step);
        while step > 1e-8 {
            let around =
                (0..16).map(|k| (step * (k as f64 * TAU / 16.0).cos(), step * (k as f64 * TAU / 16.0).sin()));
            let tried = around.map(|(x, y)| (distance(a + x, b + y), a + x, b + y));
            match tried.min_by(|s, t| s.0.total_cmp(&t.0)) {
                Some(best) if best.0 < least => (least, a, b) = best,
                _ => step *= 0.5,
            }
        }
        least
    };
    grid[..12].iter().map(refined).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_reach_gap_is_the_least_distance() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut general = turning([
        [0.0, 100.0, 90.0, 50.0],
        [20.0, 60.0, 400.0, -40.0],
        [0.0, 50.0, 120.0, 90.0],
        [0.0, 350.0, 0.0, 90.0],
        [0.0, 0.0, 0.0, -90.0],
        [0.0, 80.0, 0.0, 0.0],
    ]);
    let mut benches = vec![puma560(), irb140(), centred(), InverseBench::wrist(general.clone())];
    general.joints[0].l = 0.0;
    benches.push(InverseBench::wrist(general));
    for bench in &benches {
        let (mut out, mut within) = (0, 0);
        while out < cases(15, 60) {
            let mut side = || rng.random_range(-1.3..1.3);
            let p = vector![side(), side(), side()];
            // Some targets are near the base axis.
            let p = if out % 3 == 0 { vector![0.1 * p.x, 0.1 * p.y, p.z] } else { p };
            let rotation = random_rotation(&mut rng);
            let r6 = bench.robot.joints[5].r;
            let answer = bench.solve(&Pose { rotation, translation: p + rotation.column(2) * r6 });
            let least = brute(bench, &p);
            assert_eq!(answer.missing > 0.0, answer.found.is_empty(), "{p}");
            assert!(
                (answer.missing - least).abs() < 1e-6,
                "{p} {}: {} or {least}",
                bench.robot.joints[0].r,
                answer.missing
            );
            if answer.missing > 0.0 { out += 1 } else { within += 1 }
        }
        assert!(within > 0, "none in reach");
    }
}

/// Near the base axis, the gap is the distance outwards to the reachable region. Beyond the reach, some move
/// of the flange by the gap makes the pose reachable, and no move by a tenth of the gap does.
#[test]
fn the_reach_gap_of_three_parallel_axes_is_the_least_distance() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let bench = ur5();
    for _ in 0..1_000 {
        let (rotation, radius, turn) =
            (random_rotation(&mut rng), rng.random_range(0.0..0.109), rng.random_range(-PI..PI));
        let centre = vector![radius * turn.cos(), radius * turn.sin(), rng.random_range(-1.0..1.0)];
        let translation = centre + rotation.column(2) * 0.0823;
        // Axes 1 and 5 are 109.15 mm apart, and the wrist centre keeps this distance along axis 2.
        let answer = bench.solve(&Pose { rotation, translation });
        assert!(answer.found.is_empty() && (answer.missing - (0.10915 - radius)).abs() < 1e-12);
    }
    for bench in [ur5(), offsets()] {
        let mut far = 0;
        while far < 40 {
            let mut side = || rng.random_range(-1.2..1.2);
            let p = vector![side(), side(), 0.3 * side()];
            let flange = Pose { rotation: random_rotation(&mut rng), translation: p };
            let answer = bench.solve(&flange);
            if answer.missing == 0.0 || p.x.hypot(p.y) < 0.7 {
                continue;
            }
            let reaches = |size: f64| {
                (0..4_000).any(|k| {
                    // The directions cover the sphere evenly.
                    let (z, turn) = (1.0 - (2.0 * k as f64 + 1.0) / 4_000.0, 2.399963229728653 * k as f64);
                    let r = (1.0 - z * z).sqrt();
                    let translation = p + vector![r * turn.cos(), r * turn.sin(), z] * size;
                    !bench.solve(&Pose { translation, ..flange }).found.is_empty()
                })
            };
            assert!(answer.found.is_empty() && !reaches(0.1 * answer.missing));
            assert!(reaches(1.02 * answer.missing + 1e-6), "{p}: {}", answer.missing);
            far += 1;
        }
    }
}
