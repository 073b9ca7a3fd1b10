//! Tests six-axis arms at poses where solutions meet or end (singular and boundary poses), and limits,
//! refusals and branch numbers.

use crate::common::data;
use crate::kinematics::six_axes::*;
use nalgebra::{Matrix3, vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use sweetspot::cell::{JointKind, JointVector};
use sweetspot::pose::Pose;
use sweetspot::reach::{SphericalWrist, ThreeParallel};
use sweetspot::robot::{Chain, Posture};
use sweetspot::units::wrapped;

/// Returns the singular angle `angle`, or an angle at any distance from it down to rounding.
fn nearly(rng: &mut ChaCha8Rng, angle: f64) -> f64 {
    let off = match rng.random_range(0..4) {
        0 => 0.0,
        _ => 10f64.powf(rng.random_range(-17.0..-4.0)),
    };
    angle + if rng.random() { off } else { -off }
}

/// Sets joint 2 so that the origin of `frame` lies on axis 1, apart from an offset along axis 2. Returns
/// whether this is possible.
fn above(bench: &InverseBench, q: &mut JointVector, frame: usize) -> bool {
    q[1] = -bench.robot.joints[1].theta;
    let frames = bench.chain.frames(&bench.chain.posture(q));
    let c = frames.links[1].inverse().transform(&frames.links[frame].translation);
    let cosine = -bench.robot.joints[0].l / c.x.hypot(c.y);
    q[1] += cosine.acos() - c.y.atan2(c.x);
    cosine.abs() <= 1.0
}

/// Returns an arm without offsets from its base axis. If the wrist is on this axis, theta_1 is free.
pub fn centred() -> InverseBench {
    InverseBench::wrist(turning([
        [0.0, 400.0, 60.0, 90.0],
        [0.0, 30.0, 500.0, 180.0],
        [0.0, 30.0, 20.0, -90.0],
        [0.0, 480.0, 0.0, 90.0],
        [0.0, 0.0, 0.0, -90.0],
        [0.0, 80.0, 0.0, 0.0],
    ]))
}

/// Returns an arm whose oblique wrist lets the flange align with axis 4.
fn oblique() -> InverseBench {
    InverseBench::wrist(turning([
        [0.0, 400.0, 60.0, 90.0],
        [0.0, 30.0, 500.0, 0.0],
        [0.0, 10.0, 20.0, -90.0],
        [0.0, 480.0, 0.0, 60.0],
        [0.0, 0.0, 0.0, -60.0],
        [0.0, 80.0, 30.0, 20.0],
    ]))
}

#[test]
fn singular_wrists_have_a_representative() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for (bench, joint) in [
        (puma560(), 4),
        (irb140(), 4),
        (stanford(), 4),
        (oblique(), 4),
        (ur5(), 4),
        (offsets(), 4),
        (panda(), 1),
    ] {
        for _ in 0..2_500 {
            let mut q = bench.random(&mut rng);
            let half_turn = if rng.random() { PI } else { 0.0 };
            q[joint] = nearly(&mut rng, half_turn);
            bench.check(&q);
        }
    }
    // If the wrist axes are in line, the free angle theta_4 is 0.
    let bench = puma560();
    let answer = bench.check(&from_fn(|k| [0.3, -0.5, 0.7, 1.1, 0.0, -0.4, 0.0, 0.0][k]));
    assert!(answer.found.iter().any(|(_, p)| (p.cos[3], p.sin[3]) == (1.0, 0.0)));
}

#[test]
fn wrist_centres_on_or_next_to_the_base_axis_are_solved() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for (bench, frame) in [(puma560(), 4), (irb140(), 4), (centred(), 4), (ur5(), 5), (offsets(), 5)] {
        let mut checked = 0;
        while checked < 2_500 {
            let mut q = bench.random(&mut rng);
            if above(&bench, &mut q, frame) {
                q[1] = nearly(&mut rng, q[1]);
                bench.check(&q);
                checked += 1;
            }
        }
    }
    // Axes 1, 5 and 6 of this arm meet, so theta_1 is free.
    let mut bench = offsets();
    bench.robot.joints[0].alpha = PI / 2.0;
    bench.robot.joints[1].r = -0.025 - 0.110 - 0.095 * 80f64.to_radians().cos();
    let bench = InverseBench::parallel(bench.robot);
    let mut checked = 0;
    while checked < 2_500 {
        let mut q = bench.random(&mut rng);
        if above(&bench, &mut q, 5) {
            bench.check(&q);
            checked += 1;
        }
    }
}

#[test]
fn stretched_and_folded_arms_are_found() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    // If the arm is stretched, the wrist centre lies in the direction of the upper arm, seen from axis 3.
    for (bench, stretched) in [
        (puma560(), -0.4318f64.atan2(0.0203)),
        (irb140(), -0.380f64.atan2(0.015)),
        (centred(), 0.480f64.atan2(0.020)),
        (ur5(), 0.0),
        (offsets(), -30f64.to_radians()),
    ] {
        for _ in 0..2_500 {
            let mut q = bench.random(&mut rng);
            let folded = if rng.random() { PI } else { 0.0 };
            // In one of ten poses, the wrist axes are also in line.
            if rng.random_range(0..10) == 0 {
                q[4] = 0.0;
            }
            q[2] = nearly(&mut rng, stretched + folded);
            bench.check(&q);
        }
    }
}

/// Returns the determinant of the first three joints at the wrist centre.
fn span(bench: &InverseBench, q: &JointVector) -> f64 {
    let frames = bench.chain.frames(&bench.chain.posture(q));
    let centre = frames.links[4].translation;
    let column = |k: usize| {
        let axis = frames.links[k].rotation.column(2).into_owned();
        match bench.robot.joints[k].kind {
            JointKind::Revolute => axis.cross(&(centre - frames.links[k].translation)),
            JointKind::Prismatic => axis,
        }
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)]).determinant()
}

#[test]
fn double_roots_of_general_arms_are_found() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut checked = 0;
    for k in 0..400 {
        let kinds = from_fn(|j| if (k >> j) & 1 == 1 { P } else { R });
        let bench = InverseBench::wrist(robot(&random_chain(&mut rng, kinds)));
        for _ in 0..100 {
            let (mut q, other) = (bench.random(&mut rng), bench.random(&mut rng));
            let (mut lo, mut hi) = (q, other);
            (hi[0], hi[3], hi[4], hi[5]) = (q[0], q[3], q[4], q[5]);
            if span(&bench, &lo) * span(&bench, &hi) > 0.0 {
                continue;
            }
            for _ in 0..80 {
                q = from_fn(|j| (lo[j] + hi[j]) / 2.0);
                if span(&bench, &lo) * span(&bench, &q) <= 0.0 { hi = q } else { lo = q }
            }
            bench.check(&q);
            checked += 1;
        }
    }
    assert!(checked > 6_000, "only {checked}");
}

/// Returns the poses of peer set B in frames of the reference data.
fn reference(name: &str) -> Vec<Pose> {
    let pose = |t: &[f64]| Pose {
        rotation: Matrix3::new(t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]),
        translation: vector![t[3], t[7], t[11]],
    };
    data(name).chunks_exact(16).map(pose).collect()
}

#[test]
fn solution_counts_inside_the_limits_match_the_reference() {
    for (bench, name, mean) in [(puma560(), "puma560", 3.702), (ur5(), "ur5", 7.120)] {
        let joints = data(&format!("b_{name}_q.bin"));
        let (mut count, mut solved) = (0, 0);
        for (pose, q) in reference(&format!("b_{name}_T.bin")).iter().zip(joints.chunks_exact(6)) {
            let answer = bench.solve(pose);
            let allowed = |p: &Posture| {
                bench.robot.joints.iter().enumerate().all(|(k, j)| {
                    let middle = (j.limits.0 + j.limits.1) / 2.0;
                    let from_middle = wrapped(p.sin[k].atan2(p.cos[k]) - j.theta - middle);
                    from_middle.abs() <= (j.limits.1 - j.limits.0) / 2.0 + 1e-9
                })
            };
            let here = answer.found.iter().filter(|(_, p)| allowed(p)).count();
            (count, solved) = (count + here, solved + usize::from(here > 0));
            let q = from_fn(|k| q.get(k).copied().unwrap_or(0.0));
            assert!(bench.nearest(&q, &answer) < 1e-7, "{q:?}");
        }
        assert_eq!((solved, count as f64 / 1e3), (1_000, mean), "{name}");
    }
}

#[test]
fn a_branch_number_names_one_family_of_postures() {
    // The configuration (wrist flipped, elbow, leaning back) follows from the joints themselves.
    let sides = |bench: &InverseBench, q: &JointVector, frame: usize, elbow: f64| {
        let frames = bench.chain.frames(&bench.chain.posture(q));
        let centre = frames.links[1].inverse().transform(&frames.links[frame].translation);
        [(q[4]).sin(), (q[2] - elbow).sin(), centre.x + bench.robot.joints[0].l].map(|x| x > 0.0)
    };
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let arms =
        [(puma560(), 4, -0.4318f64.atan2(0.0203)), (irb140(), 4, -0.380f64.atan2(0.015)), (ur5(), 5, 0.0)];
    for (bench, frame, elbow) in arms {
        let mut names = BTreeMap::new();
        for _ in 0..2_000 {
            let q = bench.random(&mut rng);
            let answer = bench.check(&q);
            let near = |p: &Posture| {
                (0..6).all(|k| {
                    (p.sin[k].atan2(p.cos[k]) - bench.robot.joints[k].theta - q[k]).sin().abs() < 1e-6
                        && (p.cos[k] - (q[k] + bench.robot.joints[k].theta).cos()).abs() < 1e-6
                })
            };
            let Some(own) = answer.found.iter().find(|(_, p)| near(p)) else { panic!("{q:?}") };
            let name = *names.entry(sides(&bench, &q, frame, elbow)).or_insert(own.0);
            assert_eq!(name, own.0, "{q:?}");
        }
        let distinct: std::collections::BTreeSet<_> = names.values().collect();
        assert_eq!((names.len(), distinct.len()), (8, 8));
    }
}

#[test]
fn a_chain_outside_the_family_is_refused_with_the_reason() {
    let wrist = |bench: InverseBench| SphericalWrist::new(&bench.chain).map(|_| ()).unwrap_err();
    let parallel = |edit: fn(&mut sweetspot::cell::Robot)| {
        let mut robot = ur5().robot;
        edit(&mut robot);
        ThreeParallel::new(&Chain::new(&robot)).map(|_| ()).unwrap_err()
    };
    assert!(wrist(ur5()).contains("do not meet in one point"));
    assert!(parallel(|r| r.joints[1].alpha = 1e-7).contains("not exactly parallel"));
    assert!(parallel(|r| r.joints[2].alpha = PI - 1e-9).contains("not exactly parallel"));
    assert!(parallel(|r| r.joints[4].l = 0.01).contains("do not intersect"));
    assert!(parallel(|r| r.joints[0].alpha = 0.0).contains("are parallel (alpha_1, alpha_4 or alpha_5)"));
    assert!(parallel(|r| r.joints[2].l = 0.0).contains("the length of an arm link is 0"));
    assert!(ThreeParallel::new(&puma560().chain).is_err());
    // Twists from a calibration file, which have nine digits, are accepted.
    let mut robot = ur5().robot;
    for (joint, sign) in [(0, 1.0), (3, 1.0), (4, -1.0)] {
        robot.joints[joint].alpha = sign * (PI / 2.0 + 2.05e-10);
    }
    let bench = InverseBench::parallel(robot);
    bench.check(&from_fn(|k| 0.3 + 0.4 * k as f64));
    // The first three joints cannot move the wrist centre out of a plane or a sphere.
    let mut flat = puma560().robot;
    flat.joints[0].alpha = 0.0;
    assert!(SphericalWrist::new(&Chain::new(&flat)).unwrap_err().contains("cannot move the wrist centre"));
}
