//! Tests the derived rows against the product of the transforms of the URDF.

use crate::common::root;
use crate::urdf::product::{apart, joints, load, poses};
use nalgebra::{Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::fmt::Write;
use sweetspot::cell::{JointKind, MAX_JOINTS, Robot, Shape};
use sweetspot::robot::Chain;

fn shipped(name: &str) -> String {
    std::fs::read_to_string(root().join("tests/data").join(name)).unwrap()
}

fn robot_of(text: &str, axes: usize) -> Robot {
    load(text, axes, "").0.unwrap_or_else(|f| panic!("{f:#?}\n{text}")).cell.robot
}

/// Returns the largest deviation of tip, joint frames and solids from the product of transforms over random
/// postures.
fn worst(text: &str, robot: &Robot, postures: usize, rng: &mut ChaCha8Rng) -> f64 {
    let (chain, joints) = (Chain::new(robot), joints(text));
    let moving: Vec<_> =
        joints.iter().enumerate().filter(|(_, j)| j.kind != "fixed").map(|(k, _)| k).collect();
    assert_eq!(moving.len(), robot.axes());
    assert_eq!(robot.joint_frames.len(), robot.axes());
    let mut worst = 0.0f64;
    for _ in 0..postures {
        let mut q = [0.0; MAX_JOINTS];
        for (q, joint) in q.iter_mut().zip(&robot.joints) {
            *q = rng.random_range(-1.0..1.0) * if joint.kind == JointKind::Revolute { PI } else { 1.0 };
        }
        let frames = chain.frames(&chain.posture(&q));
        let poses = poses(&joints, &q);
        worst = worst.max(apart(&frames.tcp, &poses.last().unwrap().1));
        for (k, &j) in moving.iter().enumerate() {
            worst = worst.max(apart(&(frames.links[k] * robot.joint_frames[k]), &poses[j].0));
        }
        for solid in &robot.solids {
            let Shape::Sphere { centre, .. } = solid.solid.shape else { panic!("no sphere") };
            let ours = if solid.link == 0 { centre } else { frames.links[solid.link].transform(&centre) };
            let link = joints.iter().position(|j| j.child == solid.solid.name);
            let ball = Point3::new(0.1, -0.2, 0.3);
            let theirs = link.map_or(ball, |j| poses[j].1 * ball).coords;
            worst = worst.max((ours - theirs).norm());
        }
    }
    worst
}

const SPHERE: &str =
    "<collision><origin xyz=\"0.1 -0.2 0.3\"/><geometry><sphere radius=\"0.05\"/></geometry></collision>";

/// Returns a URDF of links with one sphere each, joined in series.
fn urdf(joints: &[String]) -> String {
    let mut text = "<robot name=\"random\">\n".to_string();
    for k in 0..=joints.len() {
        writeln!(text, "<link name=\"link {k}\">{SPHERE}</link>").unwrap();
    }
    for (k, inside) in joints.iter().enumerate() {
        writeln!(
            text,
            "<joint name=\"joint {k}\" {inside}<parent link=\"link {k}\"/><child link=\"link {}\"/>\
             <limit lower=\"-3\" upper=\"3\"/></joint>",
            k + 1
        )
        .unwrap();
    }
    text + "</robot>"
}

fn words(v: &Vector3<f64>) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

fn random_vector(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

/// Returns a joint whose row is difficult to derive: coincident, parallel and intersecting axes, right
/// angles, negative axes, and such relations in a rotated frame.
fn random_joint(rng: &mut ChaCha8Rng, fixed: f64, before: &mut Vector3<f64>) -> String {
    let xyz = match rng.random_range(0..4) {
        0 => Vector3::zeros(),
        1 => *before * rng.random_range(-1.0..1.0),
        _ => random_vector(rng),
    };
    let rpy = match rng.random_range(0..3) {
        0 => Vector3::zeros(),
        1 => Vector3::from_fn(|_, _| PI / 2.0 * f64::from(rng.random_range(-2..3))),
        _ => random_vector(rng) * PI,
    };
    let turn = nalgebra::Rotation3::from_euler_angles(rpy.x, rpy.y, rpy.z);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let axis = match rng.random_range(0..3) {
        0 => Vector3::ith(rng.random_range(0..3), sign),
        1 => turn.inverse() * *before * sign,
        _ => random_vector(rng),
    };
    let is_fixed = rng.random_bool(fixed);
    let kind = match rng.random_range(0..5) {
        _ if is_fixed => "fixed",
        0 => "prismatic",
        _ => "revolute",
    };
    *before = if is_fixed { turn.inverse() * *before } else { axis.normalize() };
    let (xyz, rpy, axis) = (words(&xyz), words(&rpy), words(&axis));
    format!("type=\"{kind}\"><origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><axis xyz=\"{axis}\"/>")
}

#[test]
fn catalogue_robots_move_like_their_urdf() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for (name, axes) in [("pw10.urdf", 4), ("puma560.urdf", 6), ("ur5.urdf", 6)] {
        let text = shipped(name);
        let robot = robot_of(&text, axes);
        let worst = worst(&text, &robot, 1000, &mut rng);
        assert!(worst < 1e-12, "{name}: {worst:e}");
    }
}

/// The URDFs were written from catalogue rows. The derived rows must equal them, including the signs.
#[test]
fn dh_rows_of_catalogue_robots_survive_urdf() {
    for (name, axes) in [("puma560", 6), ("ur5", 6)] {
        let robot = robot_of(&shipped(&format!("{name}.urdf")), axes);
        let written = crate::common::load_from(&root().join("tests/data"), &format!("{name}.toml")).unwrap();
        for (ours, row) in robot.joints.iter().zip(&written.cell.robot.joints) {
            let [a, b] = [ours, row].map(|j| [j.theta, j.r, j.l, j.alpha]);
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {a:?} {b:?}");
        }
        assert_eq!(robot.tool, sweetspot::pose::Pose::identity());
    }
}

#[test]
fn random_chains_move_like_their_urdf() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut parallel = 0;
    for round in 0..300 {
        let fixed = if round % 3 == 0 { 0.6 } else { 0.0 };
        let axes = rng.random_range(3..=8);
        let (mut joints, mut before, mut moving) = (Vec::new(), Vector3::z(), 0);
        while moving < axes {
            joints.push(random_joint(&mut rng, fixed, &mut before));
            moving += usize::from(!joints[joints.len() - 1].contains("fixed"));
        }
        if fixed > 0.0 {
            joints.push(random_joint(&mut rng, 1.0, &mut before));
        }
        let text = urdf(&joints);
        let robot = robot_of(&text, axes);
        assert_eq!(robot.solids.len(), joints.len() + 1);
        parallel += robot.joints.iter().filter(|j| j.alpha.sin().abs() < 1e-9).count();
        let worst = worst(&text, &robot, if round < 20 { 1000 } else { 50 }, &mut rng);
        assert!(worst < 1e-12, "round {round}: {worst:e}\n{:#?}\n{text}", robot.joints);
    }
    assert!(parallel > 100, "{parallel}");
}
