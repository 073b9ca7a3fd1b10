//! Tests the inverse kinematics of every robot of the library with poses from the forward kinematics. The
//! setting `SWEETSPOT_POSES=100000` (with `--release`) makes the study of results/inverse.

use crate::common::robots;
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use sweetspot::cell::{Attitude, Azimuth, JointKind, JointVector, Robot, Spin, held, tool_columns};
use sweetspot::pose::Pose;
use sweetspot::reach::{FamilyReach, Inverse, Reach, ToolAttitudes};
use sweetspot::robot::Chain;
use sweetspot::units::wrapped;

/// Largest error of a round trip, m and rad.
const ROUND_TRIP: f64 = 1e-9;

fn poses(default: usize) -> usize {
    std::env::var("SWEETSPOT_POSES").map_or(default, |n| n.parse().unwrap())
}

/// Returns whether the environment variable SWEETSPOT_ROBOT selects a robot. The variable selects robots
/// whose names contain its text. Without it, all robots are selected.
fn is_asked(stem: &str) -> bool {
    std::env::var("SWEETSPOT_ROBOT").map_or(true, |part| stem.contains(&part))
}

fn random_joints(robot: &Robot, rng: &mut ChaCha8Rng) -> JointVector {
    let mut q = JointVector::default();
    for (q, joint) in q.iter_mut().zip(&robot.joints) {
        let (lo, hi) = joint.limits;
        *q = if lo < hi { rng.random_range(lo..hi) } else { lo };
    }
    q
}

/// Returns the orientation of a TCP.
fn attitude_of(columns: &Matrix3<f64>) -> Attitude {
    let [r, d] = [0, 2].map(|k| columns.column(k).into_owned());
    let elevation = d.z.atan2(d.x.hypot(d.y));
    let vertical = elevation.cos().abs() < 1e-12;
    let azimuth = if vertical { 0.0 } else { d.y.atan2(d.x) };
    let plain = held(elevation, azimuth, 0.0);
    let spin = plain.column(1).dot(&r).atan2(plain.column(0).dot(&r));
    Attitude { elevation, azimuth: Azimuth::Surface(azimuth), spin: Spin::At(vec![spin]), tolerance: 0.0 }
}

/// Returns an orientation in which the angles that the arm cannot set are free.
fn asked(inverse: &Inverse, attitude: Attitude) -> Attitude {
    let free_azimuth = Attitude { azimuth: Azimuth::Free, ..attitude.clone() };
    let free = Attitude { spin: Spin::Free, ..free_azimuth.clone() };
    let able = [attitude, free_azimuth, free].into_iter().find(|a| inverse.refusal(a).is_none());
    able.unwrap()
}

/// Returns the angle between two orientations, rad.
fn turn(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let off = (a - b).norm() / 2f64.sqrt();
    2.0 * (off / 2.0).min(1.0).asin()
}

/// Returns the larger deviation of a solution from a TCP in the requested coordinates, m or rad.
fn off(answer: &Pose, wanted: &Pose, attitude: &Attitude, axis: &Vector3<f64>) -> f64 {
    let position = (answer.translation - wanted.translation).norm();
    let [a, b] = [answer, wanted].map(|p| p.rotation * axis);
    let angle = match (&attitude.azimuth, &attitude.spin) {
        (Azimuth::Surface(_), Spin::At(_)) => turn(&answer.rotation, &wanted.rotation),
        (Azimuth::Surface(_), Spin::Free) => (a - b).norm(),
        _ => (a.z.atan2(a.x.hypot(a.y)) - b.z.atan2(b.x.hypot(b.y))).abs(),
    };
    position.max(angle)
}

fn outside(robot: &Robot, q: &JointVector) -> f64 {
    let by = robot.joints.iter().zip(q).map(|(j, q)| (j.limits.0 - q).max(q - j.limits.1));
    by.fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the largest difference of a joint between two postures, rad or m. Full turns do not count if the
/// range of the joint exceeds one turn.
fn apart(robot: &Robot, a: &JointVector, b: &JointVector) -> f64 {
    let each = robot.joints.iter().zip(a.iter().zip(b)).map(|(joint, (a, b))| {
        let turns = joint.kind == JointKind::Revolute && joint.limits.1 - joint.limits.0 > TAU;
        if turns { wrapped(a - b).abs() } else { (a - b).abs() }
    });
    each.fold(0.0, f64::max)
}

/// Statistics of the poses of one robot.
#[derive(Default)]
struct PoseStatistics {
    poses: usize,
    found: usize,
    reached: usize,
    answers: usize,
    outside: usize,
    worst: f64,
}

fn tally(robot: &Robot, poses: usize) -> (PoseStatistics, &'static str) {
    let chain = Chain::new(robot);
    let inverse = Inverse::new(&chain);
    let redundant = inverse.family().contains("redundant ");
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let mut tally = PoseStatistics { poses, ..PoseStatistics::default() };
    let columns = tool_columns(&chain.tool_axis);
    for _ in 0..poses {
        let q = random_joints(robot, &mut rng);
        let tcp = chain.forward(&chain.posture(&q));
        let attitude = asked(&inverse, attitude_of(&(tcp.rotation * columns)));
        let approach = inverse.tool_attitudes(&attitude, 0.0);
        let Reach::Branches(branches) = inverse.branches(&tcp.translation, &approach) else { continue };
        let usable: Vec<_> = branches.iter().filter(|b| b.is_usable()).collect();
        tally.found += usize::from(!usable.is_empty());
        for b in &usable {
            tally.answers += 1;
            tally.outside += usize::from(outside(robot, &b.joints) > 1e-6);
            let answer = chain.forward(&chain.posture(&b.joints));
            tally.worst = tally.worst.max(off(&answer, &tcp, &attitude, &chain.tool_axis));
        }
        // A redundant joint keeps its original value.
        let again = redundant.then(|| inverse.held_at(&q).branches(&tcp.translation, &approach));
        let again = match &again {
            Some(Reach::Branches(branches)) => branches,
            Some(_) => continue,
            None => &branches,
        };
        let nearest = again.iter().map(|b| apart(robot, &q, &b.joints)).fold(f64::INFINITY, f64::min);
        // Near a singular posture, the accuracy is only the square root of the rounding error.
        tally.reached += usize::from(nearest < 1e-5);
    }
    (tally, inverse.family())
}

#[test]
fn the_inverse_finds_poses_of_the_forward_kinematics() {
    println!(
        "robot | inverse kinematics | poses | found | original reached | answers | outside limits | worst (m, rad)"
    );
    for (stem, robot) in robots().into_iter().filter(|(stem, _)| is_asked(stem)) {
        let family = Inverse::new(&Chain::new(&robot)).family();
        let (numeric, scanned) = (family.contains("numeric"), family.contains("scan"));
        let (t, family) = tally(&robot, poses(if numeric { 300 } else { 10_000 }));
        println!(
            "{stem} | {family} | {} | {} | {} | {} | {} | {:.1e}",
            t.poses, t.found, t.reached, t.answers, t.outside, t.worst
        );
        let least = if numeric { (t.poses as f64 * 0.999).floor() as usize } else { t.poses };
        // An arm with more than six joints and no closed form attains a pose in a continuum of postures.
        let reached = if numeric && robot.axes() > 6 { t.found } else { t.reached };
        // A scan may miss one of two postures that nearly coincide.
        let least_reached = if scanned { t.poses - t.poses / 1000 } else { least };
        assert!(
            t.found >= least && reached >= least_reached,
            "{stem}: {} found, {} reached",
            t.found,
            t.reached
        );
        assert!(t.outside == 0 && t.worst < ROUND_TRIP, "{stem}: {} outside, {:e} off", t.outside, t.worst);
    }
}

/// Returns the usable branches of a target, as spin families and values between the samples give them, and
/// whether the families are complete.
fn by_families(arm: &Inverse, target: &Vector3<f64>, attitudes: &ToolAttitudes) -> (Vec<u64>, bool) {
    let (mut families, mut found, mut scratch) = (Vec::new(), Vec::new(), arm.scratch());
    let reach = arm.visit_families(target, attitudes, &mut scratch, |index, posture| {
        families.push((index, *posture));
    });
    match reach {
        FamilyReach::Complete => {
            for (index, posture) in &families {
                let family = (*index, posture);
                arm.members(target, attitudes, &mut scratch, family, |index, _| found.push(index));
            }
        }
        FamilyReach::OnlyBetweenSamples { is_solved } => {
            arm.visit_between_samples(target, attitudes, is_solved, &mut |index, _| found.push(index));
        }
    }
    found.sort_unstable();
    (found, reach == FamilyReach::Complete)
}

/// The faster search of a redundant arm leaves out values that certainly have no usable branch. It finds the
/// branches of the slower search, which also measures how far a target is out of reach.
#[test]
fn both_searches_of_a_redundant_arm_find_the_same_branches() {
    let redundant = ["franka_panda", "kinova_gen3", "kuka_iiwa14", "puma560_on_track"];
    let arms = robots().into_iter().filter(|(stem, _)| redundant.contains(&stem.as_str()));
    let mut rng = ChaCha8Rng::seed_from_u64(19);
    let (mut between, mut nothing, mut count) = (0, 0, 0);
    for (stem, robot) in arms {
        count += 1;
        let chain = Chain::new(&robot);
        let arm = Inverse::new(&chain);
        for k in 0..poses(250) {
            // A pose of the arm may be reached only between the samples. Many other targets are out of reach.
            let (target, attitude) = if k % 2 == 0 {
                let pose = chain.forward(&chain.posture(&random_joints(&robot, &mut rng)));
                let columns = pose.rotation * tool_columns(&robot.tool_axis);
                (pose.translation, asked(&arm, attitude_of(&columns)))
            } else {
                let way = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0f64)).normalize();
                let spin = Spin::At(vec![0.0, rng.random_range(0.0..TAU)]);
                let elevation = rng.random_range(-1.57..0.3f64);
                let attitude = Attitude { spin, ..Attitude::elevation(elevation) };
                (way * robot.reach() * rng.random_range(0.3..1.0), attitude)
            };
            let attitudes = arm.tool_attitudes(&attitude, 0.0);
            let mut all = Vec::new();
            let gap = arm.visit(&target, &attitudes, &mut arm.scratch(), |index, _| all.push(index));
            all.sort_unstable();
            let (found, is_complete) = by_families(&arm, &target, &attitudes);
            assert_eq!(found, all, "{stem} {target} {attitude:?} {gap:?}");
            between += usize::from(!is_complete && !found.is_empty());
            nothing += usize::from(is_complete && found.is_empty());
        }
    }
    println!("{between} targets are reached only between the samples, {nothing} are certainly out of reach");
    assert!(count == redundant.len() && between > 10 && nothing > 100, "{count} {between} {nothing}");
}
