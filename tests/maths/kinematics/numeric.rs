//! Tests the numeric inverse kinematics: the solver finds poses that an independent D-H product makes, and
//! its reasons agree with geometry.

use crate::common::{data, from_text, root, shipped};
use crate::kinematics::errors::{joint, random_robot, robot};
use crate::kinematics::product::{no_errors, position, product, random_joints, rotation, tcp};
use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3, vector};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::cell::{Attitude, JointKind, JointVector, MAX_JOINTS, Parameter, Robot};
use sweetspot::pose::Pose;
use sweetspot::reach::{AttitudeGoal, Inverse, Numeric, Reach, Shortfall, TcpGoal, jacobian};
use sweetspot::robot::Chain;
use sweetspot::units::wrapped;

const TURN: JointKind = JointKind::Revolute;
const SLIDE: JointKind = JointKind::Prismatic;

/// Row of an arm: kind, r, l, alpha in degrees, limits in rad or m.
type Row = (JointKind, f64, f64, f64, (f64, f64));

/// Writes the joint coordinates of all solutions to `out`, and tests that each solution is found again from
/// its start posture.
fn all_of(solver: &Numeric, goal: &TcpGoal, out: &mut Vec<JointVector>) -> Shortfall {
    let mut found = Vec::new();
    let missing = solver.all(goal, &mut found);
    assert!(found.iter().all(|f| solver.again(goal, f.start) == Some(f.joints)));
    *out = found.iter().map(|f| f.joints).collect();
    missing
}

/// Returns a robot with the given rows and without coupling.
fn serial(rows: &[Row], tool: Pose) -> Robot {
    let joints = rows.iter().map(|&(kind, r, l, alpha, limits)| {
        let mut row = joint(kind, 0.0, r, l, alpha.to_radians());
        row.limits = limits;
        row
    });
    let n = rows.len();
    let unit = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    robot(joints.collect(), unit, tool)
}

fn catalogue(name: &str) -> Robot {
    let text = std::fs::read_to_string(root().join(format!("tests/data/{name}.toml"))).unwrap();
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot
}

fn five_axes() -> Robot {
    let rows = [
        (TURN, 0.4, 0.1, 90.0, (-2.9, 2.9)),
        (TURN, 0.0, 0.5, 0.0, (-1.0, 2.5)),
        (TURN, 0.0, 0.4, 0.0, (-2.6, 2.6)),
        (TURN, 0.0, 0.0, 90.0, (-2.0, 2.0)),
        (TURN, 0.2, 0.0, 0.0, (-3.1, 3.1)),
    ];
    let tool = Pose::from_translation_rpy(vector![0.05, 0.0, 0.1], vector![0.3, -0.8, 0.2]);
    serial(&rows, tool)
}

/// Returns the Franka Emika Panda. The manufacturer states modified rows (a and alpha before the joint). Here
/// a and alpha are moved to the row of the previous joint.
fn panda() -> Robot {
    let rows = [
        (TURN, 0.333, 0.0, -90.0, (-2.8973, 2.8973)),
        (TURN, 0.0, 0.0, 90.0, (-1.7628, 1.7628)),
        (TURN, 0.316, 0.0825, 90.0, (-2.8973, 2.8973)),
        (TURN, 0.0, -0.0825, -90.0, (-3.0718, -0.0698)),
        (TURN, 0.384, 0.0, 90.0, (-2.8973, 2.8973)),
        (TURN, 0.0, 0.088, 90.0, (-0.0175, 3.7525)),
        (TURN, 0.107, 0.0, 0.0, (-2.8973, 2.8973)),
    ];
    serial(&rows, Pose::identity())
}

fn scara(last: f64) -> Robot {
    let rows = [
        (TURN, 0.5, 0.35, 0.0, (-2.3, 2.3)),
        (TURN, 0.0, 0.3, 0.0, (-2.5, 2.5)),
        (SLIDE, 0.0, 0.0, 0.0, (-0.2, 0.0)),
        (TURN, 0.0, 0.0, 0.0, (-last, last)),
    ];
    serial(&rows, Pose::identity())
}

/// Returns `arm` on slides that are perpendicular to each other.
fn on_slides(slides: usize, arm: &Robot) -> Robot {
    let rows = [(SLIDE, 0.0, 0.0, 90.0, (-1.0, 1.5)), (SLIDE, 0.2, 0.1, -90.0, (0.0, 0.8))];
    let mut robot = serial(&rows[..slides], arm.tool);
    robot.joints.extend(arm.joints.clone());
    robot.joint_frames.extend(arm.joint_frames.clone());
    let n = robot.axes();
    robot.coupling = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    robot
}

fn robots() -> Vec<(&'static str, Robot)> {
    vec![
        ("puma560", catalogue("puma560")),
        ("ur5", catalogue("ur5")),
        ("five axes", five_axes()),
        ("panda", panda()),
        ("scara", scara(6.0)),
        ("puma560 on a track", on_slides(1, &catalogue("puma560"))),
        ("puma560 on two", on_slides(2, &catalogue("puma560"))),
        ("pw10 parallelogram", shipped("hitachi_paper_parallelogram.toml").robot),
    ]
}

fn fk(robot: &Robot, q: &JointVector) -> Matrix4<f64> {
    tcp(robot, q, &no_errors(robot.axes()), 0.0)
}

/// Returns the goal at `q` with the full orientation or a part of it.
fn goal_at(robot: &Robot, q: &JointVector, rows: usize) -> TcpGoal {
    let t = fk(robot, q);
    let axis = rotation(&t) * robot.tool_axis;
    let attitude = match rows {
        3 => AttitudeGoal::Any,
        4 => AttitudeGoal::Elevation(axis.z.atan2(axis.x.hypot(axis.y))),
        5 => AttitudeGoal::Axis(axis),
        _ => AttitudeGoal::Rotation(rotation(&t)),
    };
    TcpGoal { position: position(&t), attitude }
}

/// Returns the distance (m) and the angle (rad) of a posture from a goal.
fn off(robot: &Robot, q: &JointVector, goal: &TcpGoal) -> (f64, f64) {
    let t = fk(robot, q);
    let axis = rotation(&t) * robot.tool_axis;
    // The chord is used instead of the arc cosine, which is inaccurate near 0.
    let between = |a: Vector3<f64>, b: Vector3<f64>| 2.0 * ((a - b).norm() / 2.0).min(1.0).asin();
    let angle = match goal.attitude {
        AttitudeGoal::Any => 0.0,
        AttitudeGoal::Elevation(angle) => (axis.z.atan2(axis.x.hypot(axis.y)) - angle).abs(),
        AttitudeGoal::Axis(wanted) => between(axis, wanted),
        AttitudeGoal::Rotation(wanted) => {
            2.0 * ((rotation(&t) - wanted).norm() / 8f64.sqrt()).min(1.0).asin()
        }
    };
    ((position(&t) - goal.position).norm(), angle)
}

fn check(robot: &Robot, q: &JointVector, goal: &TcpGoal) {
    let (distance, angle) = off(robot, q, goal);
    assert!(distance < 1e-9 && angle < 1e-9, "{}: {distance:e} m, {angle:e} rad at {q:?}", robot.name);
    for (j, q) in robot.joints.iter().zip(q) {
        assert!(j.limits.0 <= *q && *q <= j.limits.1, "{}: {q} outside {:?}", robot.name, j.limits);
    }
    assert!(q[robot.axes()..].iter().all(|q| *q == 0.0), "{q:?}");
}

/// Returns the number of poses that are not found among `count` poses of postures inside the limits. Checks
/// every solution found.
fn missed(robot: &Robot, rows: usize, count: usize) -> usize {
    let (solver, mut rng) = (Numeric::new(&Chain::new(robot)), ChaCha8Rng::seed_from_u64(7));
    let goals: Vec<_> = (0..count).map(|_| goal_at(robot, &random_joints(robot, &mut rng), rows)).collect();
    let miss = |goal: &TcpGoal| match solver.one(goal) {
        Some(q) => {
            check(robot, &q, goal);
            0
        }
        None => 1,
    };
    goals.par_iter().map(miss).sum()
}

#[test]
fn poses_of_every_robot_are_solved_numerically() {
    for (name, robot) in robots() {
        let missed = missed(&robot, 6, 10_000);
        println!("{name}: {missed} missed");
        assert!(missed <= 10, "{name}: {missed} of 10000 missed");
    }
}

/// The chain of an imported arm may begin far from the origin of the base frame.
#[test]
fn a_chain_that_begins_away_from_the_base_is_solved() {
    let robot = five_axes();
    let shift = vector![0.4, -0.3, 5.0];
    let mounted = Robot { mount: Pose { translation: shift, ..Pose::identity() }, ..robot.clone() };
    let (solver, mut rng) = (Numeric::new(&Chain::new(&mounted)), ChaCha8Rng::seed_from_u64(8));
    let mut missed = 0;
    for _ in 0..100 {
        let goal = goal_at(&robot, &random_joints(&robot, &mut rng), 6);
        let moved = TcpGoal { position: goal.position + shift, ..goal };
        let mut all = Vec::new();
        all_of(&solver, &moved, &mut all);
        all.extend(solver.one(&moved));
        missed += usize::from(all.len() < 2);
        all.iter().for_each(|q| check(&robot, q, &goal));
    }
    assert!(missed <= 1, "{missed} of 100 missed");
}

#[test]
fn a_goal_with_a_free_orientation_is_found() {
    for ((name, robot), rows) in robots().into_iter().flat_map(|r| [3, 4, 5].map(|rows| (r.clone(), rows))) {
        let missed = missed(&robot, rows, 2_000);
        println!("{name}, {rows} rows: {missed} missed");
        assert!(missed <= 2, "{name}, {rows} rows: {missed} of 2000 missed");
    }
}

/// Fractional couplings, slides and revolute joints occur in any order, as in a file.
#[test]
fn poses_of_random_chains_are_solved_numerically() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let robots: Vec<_> = (0..300).map(|k| random_robot(&mut rng, 3 + k % 6, k % 10 == 0)).collect();
    let missed: usize = robots.iter().map(|robot| missed(robot, 6, 40)).sum();
    println!("{missed} of 12000 missed");
    assert!(missed <= 12, "{missed} of 12000 missed");
}

/// Another program made the poses of peer set B and their mean number of closed-form solutions.
#[test]
fn one_and_all_solutions_of_peer_set_b_are_found() {
    for (name, mean) in [("puma560", 3.702), ("ur5", 7.120)] {
        let robot = catalogue(name);
        let solver = Numeric::new(&Chain::new(&robot));
        let poses = data(&format!("b_{name}_T.bin"));
        let goals = poses.par_chunks_exact(16).map(|t| {
            let t = Matrix4::from_row_slice(t);
            TcpGoal { position: position(&t), attitude: AttitudeGoal::Rotation(rotation(&t)) }
        });
        let counts: Vec<usize> = goals
            .map(|goal| {
                check(&robot, &solver.one(&goal).unwrap(), &goal);
                let mut all = Vec::new();
                assert_eq!(all_of(&solver, &goal, &mut all), Shortfall::None);
                all.iter().for_each(|q| check(&robot, q, &goal));
                all.len()
            })
            .collect();
        let got = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
        println!("{name}: {got} solutions on average");
        assert_eq!(counts.len(), 1000);
        assert!((got / mean - 1.0).abs() < 0.01, "{name}: {got} solutions on average, not {mean}");
    }
}

/// The paper's arm has a closed form with the same postures.
#[test]
fn all_numeric_solutions_agree_with_the_closed_form() {
    let robot = shipped("hitachi_paper.toml").robot;
    let chain = Chain::new(&robot);
    let (solver, arm) = (Numeric::new(&chain), Inverse::new(&chain));
    let (mut rng, mut out, mut branches, mut lost) = (ChaCha8Rng::seed_from_u64(3), Vec::new(), 0, 0);
    for _ in 0..500 {
        let goal = goal_at(&robot, &random_joints(&robot, &mut rng), 4);
        let AttitudeGoal::Elevation(bend) = goal.attitude else { panic!() };
        let Reach::Branches(closed) =
            arm.branches(&goal.position, &arm.tool_attitudes(&Attitude::elevation(bend), 0.0))
        else {
            panic!()
        };
        let closed: Vec<_> = closed.iter().filter(|b| b.violation.is_none()).map(|b| b.joints).collect();
        assert_eq!(all_of(&solver, &goal, &mut out), Shortfall::None);
        let same =
            |a: &JointVector, b: &JointVector| a.iter().zip(b).all(|(a, b)| wrapped(a - b).abs() < 1e-5);
        assert!(out.iter().all(|q| closed.iter().any(|c| same(q, c))), "{out:?} {closed:?}");
        branches += closed.len();
        lost += closed.iter().filter(|c| !out.iter().any(|q| same(q, c))).count();
    }
    println!("{lost} of {branches} branches lost");
    assert!(lost * 100 <= branches, "{lost} of {branches} lost");
}

#[test]
fn the_jacobian_agrees_with_dual_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for k in 0..200 {
        let robot = random_robot(&mut rng, 3 + k % 6, k % 10 == 0);
        let (q, chain) = (random_joints(&robot, &mut rng), Chain::new(&robot));
        let columns = jacobian(&chain, &chain.frames(&chain.posture(&q)));
        for j in 0..robot.axes() {
            let mut values = vec![Dual64::from(0.0); Parameter::first_elastic(robot.axes())];
            values[5 * j].eps = 1.0;
            let t = product(&robot, &q, &values);
            let spin =
                Matrix3::from_fn(|r, c| t[(r, c)].eps) * Matrix3::from_fn(|r, c| t[(r, c)].re).transpose();
            let moved = Vector3::from_fn(|r, _| t[(r, 3)].eps);
            let turned = vector![spin.m32, spin.m13, spin.m21];
            let off = (columns[j].position - moved).norm() + (columns[j].rotation - turned).norm();
            assert!(off < 1e-13 * (1.0 + moved.norm()), "{off:e}");
        }
        assert!(columns[robot.axes()..].iter().all(|c| c.position.norm() + c.rotation.norm() == 0.0));
    }
}

/// Returns a planar arm of revolute joints in the xy plane.
fn planar(links: &[f64], limits: &[(f64, f64)]) -> Robot {
    let rows: Vec<_> = links.iter().zip(limits).map(|(l, limits)| (TURN, 0.0, *l, 0.0, *limits)).collect();
    serial(&rows, Pose::identity())
}

fn reason(robot: &Robot, goal: &TcpGoal) -> Shortfall {
    let solver = Numeric::new(&Chain::new(robot));
    let mut out = vec![[0.0; MAX_JOINTS]];
    let missing = all_of(&solver, goal, &mut out);
    assert_eq!(out.is_empty(), missing != Shortfall::None);
    assert_eq!(solver.one(goal).is_some(), missing == Shortfall::None);
    missing
}

#[test]
fn an_unreachable_goal_reports_the_distance() {
    let free = [(-3.2, 3.2); 3];
    let (long, short) = (planar(&[0.5, 0.4, 0.3], &free), planar(&[1.0, 0.3, 0.2], &free));
    let still = planar(&[0.5, 0.4, 0.3], &[(-FRAC_PI_2, FRAC_PI_2), (-1e-12, 1e-12), (-1e-12, 1e-12)]);
    let cases = [
        // The nearest posture is the stretched arm, or the target lies above or below the plane of the arm.
        (&long, vector![2.0, 0.0, 0.0], 0.8),
        (&long, vector![-1.2, -0.9, 0.0], 0.3),
        (&long, vector![1.2, 0.9, 0.4], 0.5),
        (&long, vector![0.3, 0.2, -0.07], 0.07),
        (&long, vector![0.0, 1.2 + 2e-6, 0.0], 2e-6),
        // The target lies in the central hole.
        (&short, vector![0.0, 0.0, 0.0], 0.5),
        (&short, vector![0.0, 0.4, 0.0], 0.1),
        // The rod turns by up to a right angle to each side, so it is nearest to a point behind it at one of
        // its limits.
        (&still, vector![-0.5, 0.0, 0.0], 1.3),
        (&still, vector![-0.5, -1.2, 0.0], 0.5),
        (&long, vector![1e9, 0.0, 0.0], 1e9 - 1.2),
    ];
    for (robot, position, want) in cases {
        for attitude in [AttitudeGoal::Any, AttitudeGoal::Rotation(Matrix3::identity())] {
            let Shortfall::OutOfReach { by } = reason(robot, &TcpGoal { position, attitude }) else {
                panic!("{position:?}: {:?}", reason(robot, &TcpGoal { position, attitude }))
            };
            assert!((by - want).abs() < 1e-9 + want * 1e-15, "{position:?}: {by} instead of {want}");
        }
    }
}

/// For both elbow configurations, the wrist of a SCARA would have to make the remaining rotation, which its
/// limits forbid.
#[test]
fn a_joint_limit_that_forbids_the_orientation_is_named() {
    let (limit, mut rng, mut told) = (0.2, ChaCha8Rng::seed_from_u64(9), 0);
    let robot = scara(limit);
    for _ in 0..200 {
        let mut q = random_joints(&robot, &mut rng);
        // For neither elbow configuration, the first two joints are near their limits.
        q[0] *= 0.3;
        q[1] = (0.5 + 1.2 * rng.random::<f64>()) * q[1].signum();
        q[3] = rng.random_range(-PI..PI);
        let goal = goal_at(&robot, &q, 6);
        // For the other elbow configuration, the triangle of the two links is mirrored about the line to the
        // wrist.
        let (l1, l2) = (0.35, 0.3);
        let line = (l2 * q[1].sin()).atan2(l1 + l2 * q[1].cos());
        let other = [q[0] + 2.0 * line, -q[1]];
        let left = |q0: f64, q1: f64| (wrapped(q[0] + q[1] + q[3] - q0 - q1).abs() - limit).max(0.0);
        let want = left(q[0], q[1]).min(left(other[0], other[1]));
        match reason(&robot, &goal) {
            Shortfall::None => assert_eq!(want, 0.0),
            Shortfall::Attitude { by, joint } => {
                told += 1;
                assert_eq!(joint, Some(3));
                assert!((by - want).abs() < 1e-5, "{by} instead of {want}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(told > 100, "{told}");
}

/// The paper's arm holds its tool in the vertical plane through its base axis.
#[test]
fn an_orientation_that_the_geometry_forbids_names_no_joint() {
    let robot = shipped("hitachi_paper.toml").robot;
    for tilt in [0.1, 0.4, 0.9] {
        let goal = goal_at(&robot, &[0.2, 0.3, -0.4, 0.2, 0.0, 0.0, 0.0, 0.0], 5);
        let AttitudeGoal::Axis(axis) = goal.attitude else { panic!() };
        let across = Vector3::z().cross(&vector![goal.position.x, goal.position.y, 0.0]).normalize();
        assert!(axis.dot(&across).abs() < 1e-12);
        let tilted = AttitudeGoal::Axis(axis * f64::cos(tilt) + across * f64::sin(tilt));
        match reason(&robot, &TcpGoal { attitude: tilted, ..goal }) {
            Shortfall::Attitude { by, joint: None } => assert!((by - tilt).abs() < 1e-5, "{by} for {tilt}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn numeric_solutions_are_deterministic() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for (_, robot) in robots() {
        let (chain, q) = (Chain::new(&robot), random_joints(&robot, &mut rng));
        let (first, second) = (Numeric::new(&chain), Numeric::new(&chain));
        for rows in 3..=6 {
            let (mut a, mut b, other) = (Vec::new(), Vec::new(), goal_at(&robot, &[0.1; MAX_JOINTS], 6));
            let goal = goal_at(&robot, &q, rows);
            all_of(&first, &goal, &mut a);
            let one = first.one(&goal);
            // Earlier goals must not matter.
            all_of(&second, &other, &mut b);
            all_of(&second, &goal, &mut b);
            assert_eq!((a, one), (b, second.one(&goal)));
        }
    }
}

/// A robot with seven axes reaches a pose in a continuum of postures.
#[test]
fn a_continuum_of_solutions_is_sampled_evenly() {
    let (robot, mut rng, mut out) = (panda(), ChaCha8Rng::seed_from_u64(17), Vec::new());
    let solver = Numeric::new(&Chain::new(&robot));
    let mut count = 0;
    for _ in 0..50 {
        let goal = goal_at(&robot, &random_joints(&robot, &mut rng), 6);
        assert_eq!(all_of(&solver, &goal, &mut out), Shortfall::None);
        assert!(out.is_sorted_by(|a, b| a.partial_cmp(b).unwrap().is_lt()) && out.len() <= 16);
        for (i, q) in out.iter().enumerate() {
            check(&robot, q, &goal);
            let apart = |o: &JointVector| o.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(out[..i].iter().all(|o| apart(o) > 0.1));
        }
        count += out.len();
    }
    println!("{} points of each continuum", count / 50);
    assert!(count > 50 * 8, "{count}");
}

#[test]
fn nearly_vertical_tools_and_half_turns_are_solved() {
    let (robot, solver) = (catalogue("ur5"), Numeric::new(&Chain::new(&catalogue("ur5"))));
    for rest in [0.0, 1e-10, 1e-9, 1e-8, 1e-7, 1e-5, 1e-3, 0.1] {
        for sign in [1.0, -1.0] {
            let (position, elevation) = (vector![0.4, 0.2, 0.3], sign * (FRAC_PI_2 - rest));
            let goal = TcpGoal { position, attitude: AttitudeGoal::Elevation(elevation) };
            let q = solver.one(&goal).unwrap_or_else(|| panic!("{rest:e}"));
            check(&robot, &q, &goal);
        }
    }
    // The start is rotated by half a turn, nearly half a turn, or not at all.
    let q = [0.3, -1.2, 1.4, -0.5, 0.9, 0.2, 0.0, 0.0];
    for angle in [0.0, 1e-12, 1e-8, PI - 1e-8, PI, -PI] {
        for axis in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()] {
            let t = fk(&robot, &q);
            let turned = Rotation3::from_axis_angle(&axis, angle).into_inner() * rotation(&t);
            let goal = TcpGoal { position: position(&t), attitude: AttitudeGoal::Rotation(turned) };
            if let Some(found) = solver.from(&goal, &q) {
                check(&robot, &found, &goal);
            } else {
                check(&robot, &solver.one(&goal).unwrap_or_else(|| panic!("{angle} {axis:?}")), &goal);
            }
        }
    }
}

/// A start near a solution leads to that solution.
#[test]
fn a_start_leads_to_the_nearest_solution() {
    let (robot, mut rng) = (catalogue("ur5"), ChaCha8Rng::seed_from_u64(19));
    let solver = Numeric::new(&Chain::new(&robot));
    let mut beside = 0;
    for _ in 0..1000 {
        let q = random_joints(&robot, &mut rng);
        let start = q.map(|q| if q == 0.0 { 0.0 } else { q + rng.random_range(-0.01..0.01) });
        let goal = goal_at(&robot, &q, 6);
        if let Some(found) = solver.from(&goal, &start) {
            check(&robot, &found, &goal);
            beside += usize::from(found.iter().zip(&q).all(|(a, b)| wrapped(a - b).abs() < 0.05));
        }
    }
    println!("{beside} of 1000 beside");
    assert!(beside > 970, "{beside}");
}

#[test]
fn no_input_breaks_numeric_inverse_kinematics() {
    let rows = [(TURN, 0.0, 0.0, 0.0, (-1.0, 1.0)); 4];
    let nothing = serial(&rows, Pose::identity());
    let slides = serial(&[(SLIDE, 0.0, 0.0, 0.0, (0.0, 1.0)); 3], Pose::identity());
    let one = planar(&[0.5], &[(-1.0, 1.0)]);
    let attitudes = [
        AttitudeGoal::Any,
        AttitudeGoal::Elevation(-0.3),
        AttitudeGoal::Elevation(1e9),
        AttitudeGoal::Axis(Vector3::zeros()),
        AttitudeGoal::Axis(-Vector3::x()),
        AttitudeGoal::Rotation(Matrix3::identity()),
        AttitudeGoal::Rotation(Matrix3::zeros()),
        AttitudeGoal::Rotation(Rotation3::from_euler_angles(PI, 0.0, 0.3).into_inner()),
    ];
    for robot in [&nothing, &slides, &one, &panda()] {
        for at in [0.0, 0.3, 1e9, 1e160, 1e300, -f64::MAX, f64::NAN, f64::INFINITY] {
            for attitude in attitudes {
                let goal = TcpGoal { position: vector![at, 0.0, 0.0], attitude };
                let left = match reason(robot, &goal) {
                    Shortfall::None => vec![],
                    Shortfall::OutOfReach { by } | Shortfall::Attitude { by, .. } => vec![by],
                    Shortfall::NotConverged { position, angle } => vec![position, angle],
                };
                assert!(left.iter().all(|x| *x >= 0.0), "{} {goal:?}: {left:?}", robot.name);
            }
        }
    }
    assert_eq!(
        reason(&nothing, &TcpGoal { position: Vector3::zeros(), attitude: AttitudeGoal::Any }),
        Shortfall::None
    );
}
