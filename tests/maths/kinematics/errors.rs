//! Tests the linear and the nonlinear error model: derivatives, a reference with 60 digits, extreme sizes,
//! signs calculated by hand, and the base frame.

use crate::common::{root, shipped, signed};
use crate::kinematics::product::{no_errors, position, random_joints, rotation, tcp};
use nalgebra::{Rotation3, Vector3, vector};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::array::from_fn;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::cell::{
    Convention, Coordinate, Joint, JointKind, JointVector, Model, Parameter, Placement, Rectangle, Robot,
    SignedErrors,
};
use sweetspot::kinematic_error::{Perturbation, TwoValuedWalk, pose_error, position_error};
use sweetspot::layout::Workcell;
use sweetspot::pose::{Displacement, Pose};
use sweetspot::robot::Chain;

/// Returns a robot with the given rows. The joint limits do not matter.
pub fn robot(joints: Vec<Joint>, coupling: Vec<Vec<f64>>, tool: Pose) -> Robot {
    let (footprint, text) = (Rectangle { centre: (0.0, 0.0), size: (1.0, 1.0) }, || "test".to_string());
    let (tool_axis, solids, tool_solids, errors) = (Vector3::x(), vec![], 0, vec![]);
    let (convention, mount) = (Convention::Standard, Pose::identity());
    Robot {
        home: [0.0; sweetspot::cell::MAX_JOINTS],
        name: text(),
        source: text(),
        convention,
        mount,
        self_collision: Default::default(),
        full_speed_after: None,
        joint_frames: vec![Pose::identity(); joints.len()],
        joints,
        coupling,
        tool,
        tool_axis,
        solids,
        tool_solids,
        masses: vec![],
        footprint,
        errors,
        urdf: None,
    }
}

pub fn joint(kind: JointKind, theta: f64, r: f64, l: f64, alpha: f64) -> Joint {
    Joint { name: "q".into(), kind, theta, r, l, alpha, limits: (-PI, PI), rates: Default::default() }
}

/// Returns a random robot with couplings, prismatic joints and right angles. If `flat` is true, every angle
/// is 0 and all axes are parallel.
pub fn random_robot(rng: &mut ChaCha8Rng, n: usize, flat: bool) -> Robot {
    let joints = (0..n).map(|_| {
        let kind = if rng.random_bool(0.25) { JointKind::Prismatic } else { JointKind::Revolute };
        let right = FRAC_PI_2 * f64::from(rng.random_range(-1..3));
        let alpha = if rng.random_bool(0.5) { right } else { rng.random_range(-PI..PI) };
        let (theta, alpha) = if flat { (0.0, 0.0) } else { (rng.random_range(-PI..PI), alpha) };
        joint(kind, theta, rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0), alpha)
    });
    let joints = joints.collect();
    let factor = |i, j| {
        if i == j {
            1.0
        } else if j < i && rng.random_bool(0.3) {
            rng.random_range(-1.0..1.0)
        } else {
            0.0
        }
    };
    let mut factor = factor;
    let coupling = (0..n).map(|i| (0..n).map(|j| factor(i, j)).collect()).collect();
    let mut three = |bound: f64| Vector3::from_fn(|_, _| rng.random_range(-bound..bound));
    let tool = Pose::from_translation_rpy(three(0.3), three(PI));
    let frames = (0..n).map(|_| Pose::from_translation_rpy(three(0.3), three(PI))).collect();
    Robot { joint_frames: frames, ..robot(joints, coupling, tool) }
}

pub fn random_errors(rng: &mut ChaCha8Rng, n: usize, length: f64, angle: f64) -> SignedErrors {
    let mut frame = || {
        let components: [f64; 6] = from_fn(|_| rng.random_range(-1.0..1.0));
        from_fn(|k| components[k] * if k < 3 { length } else { angle })
    };
    let (base, tool, joints) = (frame(), frame(), (0..n).map(|_| frame()).collect());
    let mut some = |bound: f64| (0..n).map(|_| rng.random_range(-bound..bound)).collect();
    SignedErrors {
        name: "e".into(),
        dq: some(angle),
        dr: some(length),
        dl: some(length),
        dalpha: some(angle),
        dbeta: some(angle),
        base,
        tool,
        joints,
        elastic: vec![],
        periodic: vec![],
    }
}

pub fn predicted(robot: &Robot, q: &[f64], errors: &SignedErrors, model: Model) -> Displacement {
    let chain = Chain::new(robot);
    let q = from_fn(|i| q.get(i).copied().unwrap_or(0.0));
    pose_error(&chain.frames(&chain.posture(&q)), &Perturbation::new(&chain, errors), model)
}

fn assert_close(got: Vector3<f64>, want: Vector3<f64>, relative: f64, what: &str) {
    let off = (got - want).norm() / want.norm();
    assert!(off <= relative, "{what}: {got:?} instead of {want:?}, off by {off:e}");
}

#[test]
fn the_linearized_model_is_the_derivative() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for k in 0..1_000 {
        let (n, flat) = (1 + k % 8, k % 10 == 9);
        let robot = random_robot(&mut rng, n, flat);
        let errors = random_errors(&mut rng, n, 1e-3, 1e-2);
        let q = if flat { JointVector::default() } else { random_joints(&robot, &mut rng) };
        let got = predicted(&robot, &q, &errors, Model::Linear);
        let t = tcp(&robot, &q, &errors, Dual64::new(0.0, 1.0));
        let (t, dt) = (t.map(|x| x.re), t.map(|x| x.eps));
        let spin = rotation(&dt) * rotation(&t).transpose();
        let turn = vector![spin.m32 - spin.m23, spin.m13 - spin.m31, spin.m21 - spin.m12] / 2.0;
        assert_close(got.position, position(&dt), 1e-12, "position");
        assert_close(got.rotation, turn, 1e-12, "rotation");
    }
}

/// The reference from tests/data/nonlinear_mpmath.py has errors of up to 1 mm and 0.5 degrees, and a
/// thousandth and a millionth of these errors.
#[test]
fn the_nonlinear_model_keeps_its_digits_down_to_nanometres() {
    let text = std::fs::read_to_string(root().join("tests/data/nonlinear_mpmath.json")).unwrap();
    let chains: Vec<Value> = serde_json::from_str(&text).unwrap();
    let numbers = |v: &Value| -> Vec<f64> {
        v.as_array().unwrap().iter().map(|x| x.as_str().unwrap().parse().unwrap()).collect()
    };
    let three = |v: &Value| Vector3::from_vec(numbers(v));
    for c in &chains {
        let rows = ["theta", "r", "l", "alpha"].map(|key| numbers(&c[key]));
        let kind = |slides: &Value| if slides == true { JointKind::Prismatic } else { JointKind::Revolute };
        let row = |(i, slides)| joint(kind(slides), rows[0][i], rows[1][i], rows[2][i], rows[3][i]);
        let joints: Vec<_> = c["prismatic"].as_array().unwrap().iter().enumerate().map(row).collect();
        let coupling = c["coupling"].as_array().unwrap().iter().map(numbers).collect();
        // The orientation of the tool relative to the flange changes neither error.
        let mut robot =
            robot(joints, coupling, Pose::from_translation_rpy(three(&c["tool"]), vector![0.3, -0.8, 2.0]));
        for (frame, given) in
            robot.joint_frames.iter_mut().zip(c["joint_frames"].as_array().into_iter().flatten())
        {
            let given = numbers(given);
            let [position, rpy] = [&given[..3], &given[3..]].map(Vector3::from_column_slice);
            *frame = Pose::from_translation_rpy(position, rpy);
        }
        for case in c["cases"].as_array().unwrap() {
            let [dq, dr, dl, dalpha] = ["dq", "dr", "dl", "dalpha"].map(|key| numbers(&case[key]));
            let mut errors = SignedErrors { dq, dr, dl, dalpha, ..no_errors(rows[0].len()) };
            let joints = case.get("joints").map(numbers).unwrap_or_default();
            errors.joints.iter_mut().zip(joints.chunks(6)).for_each(|(to, given)| to.copy_from_slice(given));
            let got = predicted(&robot, &numbers(&c["q"]), &errors, Model::Nonlinear);
            assert_close(got.position, three(&case["position"]), 1e-12, "position");
            assert_close(got.rotation, three(&case["rotation"]), 1e-12, "rotation");
        }
    }
    assert_eq!(chains.len(), 72);
}

#[test]
fn zero_errors_give_exactly_zero() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for (n, model) in (1..=8).flat_map(|n| Model::ALL.map(|m| (n, m))) {
        let robot = random_robot(&mut rng, n, false);
        let e = predicted(&robot, &random_joints(&robot, &mut rng), &no_errors(n), model);
        assert_eq!((e.position, e.rotation), (Vector3::zeros(), Vector3::zeros()));
    }
}

/// A tiny twist rotates all following links about the x axis of its link.
#[test]
fn tiny_twists_keep_their_digits() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for (k, size) in (0..6).flat_map(|k| [1e-8, 1e-12].map(|size| (k, size))) {
        let whole = random_robot(&mut rng, 6, false);
        let q = random_joints(&whole, &mut rng);
        let mut errors = no_errors(6);
        errors.dalpha[k] = size;
        let front = robot(whole.joints[..=k].to_vec(), whole.coupling[..=k].to_vec(), Pose::identity());
        let bent = tcp(&front, &q, &no_errors(6), 0.0);
        let arm = position(&tcp(&whole, &q, &no_errors(6), 0.0)) - position(&bent);
        let turn = rotation(&bent).column(0) * size;
        for model in Model::ALL {
            let e = predicted(&whole, &q, &errors, model);
            assert_close(e.rotation, turn, 1e-14, "rotation");
            // In the nonlinear model, the displacement is the chord of the arc.
            assert_close(e.position, turn.cross(&arm), 1e-13 + size, "position");
        }
    }
}

/// The rotation vector equals the rotation vector of the matrix product for angles up to and beyond half a
/// turn, where it takes the shorter way.
#[test]
fn large_twists_give_the_rotation_of_the_matrix_product() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for k in 0..200 {
        let robot = random_robot(&mut rng, 5, false);
        let q = random_joints(&robot, &mut rng);
        let mut errors = random_errors(&mut rng, 5, 1e-3, if k % 2 == 0 { 1e-3 } else { 2.0 });
        errors.dalpha[k % 5] = if k % 3 == 0 { -3.1 } else { 3.1 };
        let got = predicted(&robot, &q, &errors, Model::Nonlinear).rotation;
        let [before, after] = [0.0, 1.0].map(|unit| rotation(&tcp(&robot, &q, &errors, unit)));
        let off = Rotation3::new(got).into_inner() - after * before.transpose();
        assert!(off.norm() < 1e-13 && got.norm() <= PI, "{got:?} is off by {off}");
    }
}

/// One joint at 90 degrees points its link along y, with r = 0.2, l = 0.5, alpha = 90 degrees. Rx(90) puts
/// the tool offset (0.1, 0.2, 0.3) at (0.1, -0.3, 0.2). With l and r it lies at (0.6, -0.3, 0.4), which
/// Rz(90) turns to (0.3, 0.6, 0.4).
#[test]
fn error_signs_match_hand_calculation() {
    let tool = Pose::from_translation_rpy(vector![0.1, 0.2, 0.3], Vector3::zeros());
    let link = |kind| robot(vec![joint(kind, 0.0, 0.2, 0.5, FRAC_PI_2)], vec![vec![1.0]], tool);
    let (revolute, none) = (link(JointKind::Revolute), || no_errors(1));
    let t = tcp(&revolute, &[FRAC_PI_2], &none(), 0.0);
    assert_close(position(&t), vector![0.3, 0.6, 0.4], 1e-15, "TCP");
    let check =
        |robot: &Robot, errors: &SignedErrors, q: f64, model, d: Vector3<f64>, delta: Vector3<f64>| {
            let e = predicted(robot, &[q], errors, model);
            assert!(
                (e.position - d).norm() < 1e-15 && (e.rotation - delta).norm() < 1e-15,
                "{errors:?} {e:?}"
            );
        };
    let (zero, h) = (Vector3::zeros(), FRAC_PI_2);
    let dq = |x| SignedErrors { dq: vec![x], ..none() };
    let dalpha = |x| SignedErrors { dalpha: vec![x], ..none() };
    for model in Model::ALL {
        // dl acts along the link, dr along the joint axis, like the slide of a prismatic joint.
        check(
            &revolute,
            &SignedErrors { dl: vec![0.001], ..none() },
            h,
            model,
            vector![0.0, 0.001, 0.0],
            zero,
        );
        check(
            &revolute,
            &SignedErrors { dr: vec![0.001], ..none() },
            h,
            model,
            vector![0.0, 0.0, 0.001],
            zero,
        );
        check(&link(JointKind::Prismatic), &dq(0.001), 0.7, model, vector![0.0, 0.0, 0.001], zero);
    }
    // dq: z x (0.3, 0.6, 0.4); by 90 degrees the TCP goes to (-0.6, 0.3, 0.4).
    check(&revolute, &dq(0.01), h, Model::Linear, vector![-0.006, 0.003, 0.0], vector![0.0, 0.0, 0.01]);
    check(&revolute, &dq(h), h, Model::Nonlinear, vector![-0.9, -0.3, 0.0], vector![0.0, 0.0, h]);
    // dalpha: x x (0.1, -0.3, 0.2) = (0, -0.2, -0.3), turned to (0.2, 0, -0.3); by 90 degrees
    // (-0.3, 0.2) goes to (-0.2, -0.3) in y and z, that is by (0.1, -0.5), turned to (-0.1, 0, -0.5).
    check(&revolute, &dalpha(0.01), h, Model::Linear, vector![0.002, 0.0, -0.003], vector![0.0, 0.01, 0.0]);
    check(&revolute, &dalpha(h), h, Model::Nonlinear, vector![-0.1, 0.0, -0.5], vector![0.0, h, 0.0]);
}

/// The whole cell is moved and rotated by 90 degrees, so (x, y) becomes (-y, x) in errors and in positions.
#[test]
fn error_maps_turn_with_the_base() {
    let mut cell = shipped("hitachi_paper.toml");
    let (robot, mut start) = (cell.robot.clone(), cell.start());
    start.placements[0].x = 0.15;
    let still = Workcell::new(cell.clone()).unwrap().maps(&start).remove(0);
    cell.base = Placement { x: 0.1, y: -0.2, z: 0.3, yaw: FRAC_PI_2 }.values().map(Coordinate::Fixed);
    let base = cell.start().base;
    let (mut layout, errors) = (sweetspot::cell::Layout { base, ..start }, signed(&cell).clone());
    let turned = |v: Vector3<f64>| vector![-v.y, v.x, v.z];
    let moved = |v| turned(v) + vector![0.1, -0.2, 0.3];
    let Placement { x, y, z, .. } = layout.placements[0];
    let at: Vector3<f64> = moved(vector![x, y, z]);
    layout.placements[0] = Placement { x: at.x, y: at.y, z: at.z, yaw: FRAC_PI_2 };
    let map = Workcell::new(cell).unwrap().maps(&layout).remove(0);
    assert_eq!(map.nodes.len(), 99);
    for (a, b) in still.nodes.iter().zip(&map.nodes) {
        assert!((moved(a.position) - b.position).norm() < 1e-12);
        let (Some(pa), Some(pb)) = (&a.posture, &b.posture) else {
            assert_eq!((a.posture.is_some(), a.status.name()), (b.posture.is_some(), b.status.name()));
            continue;
        };
        let [nominal, perturbed] = [0.0, 1.0].map(|unit| position(&tcp(&robot, &pb.joints, &errors, unit)));
        assert!((moved(nominal) - b.position).norm() < 1e-12);
        assert!((turned(perturbed - nominal) - pb.nonlinear).norm() < 1e-12);
        let pairs = [(pa.nonlinear, pb.nonlinear), (pa.linear, pb.linear), (pa.rotation, pb.rotation)];
        assert!(pairs.iter().all(|(a, b)| (turned(*a) - b).norm() < 1e-12));
    }
}

/// A walk over corners keeps the part that did not change. Every corner has the bits of the position error
/// that is computed anew. A motion that several errors cause is not supported.
#[test]
fn the_walk_over_corners_has_the_bits_of_the_position_error() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    let (mut walks, mut refused) = (0, 0);
    for n in 2..=8 {
        for _ in 0..30 {
            let robot = random_robot(&mut rng, n, false);
            let chain = Chain::new(&robot);
            let count = Parameter::first_elastic(n);
            let parameters: Vec<usize> = (0..count).filter(|_| rng.random_bool(0.2)).collect();
            let Some(mut walk) = TwoValuedWalk::new(&chain, &parameters) else {
                refused += 1;
                continue;
            };
            for _ in 0..3 {
                let q = random_joints(&robot, &mut rng);
                let frames = chain.frames(&chain.posture(&q));
                let ends = |_: &usize| {
                    let mean = if rng.random_bool(0.5) { 0.0 } else { rng.random_range(-1e-2..1e-2) };
                    let size = rng.random_range(1e-4..1e-2);
                    [mean + size, mean - size]
                };
                let ends: Vec<[f64; 2]> = parameters.iter().map(ends).collect();
                walk.set_posture(&frames, ends.iter().copied());
                let mut second = rng.random_range(0..1u128 << parameters.len().min(100));
                for _ in 0..40 {
                    let mut values = vec![0.0; count];
                    for (k, (parameter, ends)) in parameters.iter().zip(&ends).enumerate() {
                        values[*parameter] = ends[(second >> k & 1) as usize];
                    }
                    let want =
                        position_error(&frames, &Perturbation::of_values(&chain, &values), Model::Nonlinear);
                    assert_eq!(walk.position_error(&frames.tcp.translation, second), want, "{parameters:?}");
                    for _ in 0..rng.random_range(0..3).min(parameters.len()) {
                        second ^= 1 << rng.random_range(0..parameters.len());
                    }
                }
                walks += 1;
            }
        }
    }
    assert!(walks > 200 && refused > 20, "{walks} walks, {refused} chains refused");
}
