//! Tests the condition number of the identification Jacobian: with parallel axes, four parameters per link
//! fail, but five parameters do not.
//!
//! `cargo test --test maths kinematics::identification -- --nocapture` prints the numbers.

use crate::common::ur::CalibratedArm;
use crate::common::{root, shipped};
use crate::kinematics::errors::{joint, random_robot, robot};
use crate::kinematics::product::{product, random_joints};
use nalgebra::{DMatrix, Vector3, vector};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::cell::{Joint, JointKind, JointVector, Parameter, Robot};
use sweetspot::kinematic_error::ParameterSet::{FiveParameter, FourParameter};
use sweetspot::kinematic_error::{condition, identifiable, identification_jacobian};
use sweetspot::pose::Pose;
use sweetspot::robot::{Chain, Posture};

const POSTURES: usize = 200;
/// Length (m) that weighs as much as 1 rad.
const LENGTH: f64 = 1.0;

fn joints(robot: &Robot) -> Vec<JointVector> {
    let mut rng = ChaCha8Rng::seed_from_u64(30);
    (0..POSTURES).map(|_| random_joints(robot, &mut rng)).collect()
}

fn postures(robot: &Robot) -> Vec<Posture> {
    let chain = Chain::new(robot);
    joints(robot).iter().map(|q| chain.posture(q)).collect()
}

fn conditions(robot: &Robot, length: f64) -> [f64; 2] {
    let (chain, postures) = (Chain::new(robot), postures(robot));
    [FourParameter, FiveParameter].map(|set| condition(&chain, &postures, set, length))
}

fn from_data(name: &str) -> Robot {
    crate::common::load_from(&root().join("tests/data"), name).unwrap().cell.robot
}

/// Returns four arms with three, three, three and two parallel axes.
fn arms() -> [(&'static str, Robot); 4] {
    [
        ("Hitachi PW 10-II", shipped("hitachi_paper.toml").robot),
        ("UR10", CalibratedArm::new("ur10").robot),
        ("UR5", from_data("ur5.toml")),
        ("PUMA 560", from_data("puma560.toml")),
    ]
}

#[test]
fn four_parameters_are_singular_at_parallel_axes_and_five_are_not() {
    for (name, robot) in arms() {
        let reach = robot.reach();
        for (length, of) in [(LENGTH, "1 m"), (reach, "the reach")] {
            let [four, five] = conditions(&robot, length);
            println!("{name}, a rad as {of} ({length:.2} m): four parameters {four:.1e}, five {five:.1}");
            assert!(four > 1e12 && five < 1000.0, "{name}: {four:e}, {five:e}");
        }
    }
}

/// Returns a robot whose parallel axes deviate by an angle, as in a manufactured arm.
fn bent(robot: &Robot, angle: f64) -> Robot {
    let mut robot = robot.clone();
    let inner = robot.axes() - 1;
    let parallel = robot.joints[..inner].iter_mut().filter(|j| j.alpha == 0.0);
    for (i, joint) in parallel.enumerate() {
        joint.alpha = if i % 2 == 0 { angle } else { -angle };
    }
    robot
}

/// Let two axes at an angle a have the distance l. A rotation b about y (dbeta) equals dq = b / a of one
/// joint, which the next joint undoes. The remaining sideways shift l b / a equals dr = l b / a^2 along one
/// axis and back along the other axis.
#[test]
fn near_to_parallel_four_parameters_grow_with_the_square_of_one_over_the_angle() {
    for (name, robot) in arms() {
        let parallel = conditions(&robot, LENGTH)[1];
        let [small, large] =
            [0.001f64, 0.1].map(|angle| conditions(&bent(&robot, angle.to_radians()), LENGTH));
        println!(
            "{name}, axes out of parallel by 0.001 and 0.1 deg: four parameters {:.2e} and {:.2e}, five {:.1} and {:.1}",
            small[0], large[0], small[1], large[1]
        );
        let growth = small[0] / large[0];
        assert!((growth / 1e4 - 1.0).abs() < 0.02, "{name}: {growth}");
        assert!([small[1], large[1]].iter().all(|five| (five / parallel - 1.0).abs() < 0.02), "{name}");
    }
}

/// The references are the D-H product in dual numbers and the eigenvalues of `J^T J`, with another length
/// scale.
#[test]
fn the_identification_condition_agrees_with_the_matrix_product() {
    for (name, robot) in arms() {
        let length = 2.0 * LENGTH;
        let parameters = identifiable(&Chain::new(&robot), FiveParameter);
        let mut jacobian = of_product(&robot, &parameters, length);
        let got = identification_jacobian(&Chain::new(&robot), &postures(&robot), &parameters, length);
        assert!((&got - &jacobian).iter().all(|x| x.abs() < 1e-13), "{name}");
        jacobian.column_iter_mut().for_each(|mut c| _ = c.normalize_mut());
        let squares = (jacobian.transpose() * jacobian).symmetric_eigenvalues();
        let want = (squares.max() / squares.min()).sqrt();
        let got = conditions(&robot, length)[1];
        assert!((got / want - 1.0).abs() < 1e-9, "{name}: {got} instead of {want}");
    }
}

fn of_product(robot: &Robot, parameters: &[Parameter], length: f64) -> DMatrix<f64> {
    let all = Parameter::of_robot(robot.axes()).take(Parameter::first_elastic(robot.axes()));
    let all: Vec<_> = all.collect();
    let joints = joints(robot);
    let mut jacobian = DMatrix::zeros(6 * POSTURES, parameters.len());
    for (c, parameter) in parameters.iter().enumerate() {
        let values: Vec<_> =
            all.iter().map(|p| Dual64::new(0.0, f64::from(u8::from(p == parameter)))).collect();
        for (i, q) in joints.iter().enumerate() {
            let t = product(robot, q, &values);
            let (r, dr) = (t.map(|x| x.re).remove_row(3).remove_column(3), t.map(|x| x.eps));
            let spin = dr.remove_row(3).remove_column(3) * r.transpose();
            let rows = [dr.m14, dr.m24, dr.m34, spin.m32 * length, spin.m13 * length, spin.m21 * length];
            rows.into_iter().enumerate().for_each(|(k, x)| jacobian[(6 * i + k, c)] = x);
        }
    }
    jacobian
}

/// Returns the number of independent columns.
fn rank(robot: &Robot, parameters: &[Parameter]) -> usize {
    let mut jacobian = identification_jacobian(&Chain::new(robot), &postures(robot), parameters, LENGTH);
    jacobian.column_iter_mut().for_each(|mut c| _ = c.try_normalize_mut(1e-12));
    let values = jacobian.singular_values();
    values.iter().filter(|v| **v > 1e-9 * values.max()).count()
}

fn links(robot: &Robot, of: impl Fn(&Parameter) -> bool) -> Vec<Parameter> {
    Parameter::of_robot(robot.axes()).take(5 * robot.axes()).filter(of).collect()
}

/// The five-parameter set is complete: no further parameter is independent of it. It has 4 n parameters for n
/// revolute joints, and the sixth motion of the last link belongs to the tool.
#[test]
fn five_parameters_per_link_are_complete_and_minimal() {
    for (name, robot) in arms() {
        let five = identifiable(&Chain::new(&robot), FiveParameter);
        let last = robot.axes() - 1;
        let every = links(&robot, |p| *p != Parameter::Dbeta(last));
        assert!(five.len() == 4 * robot.axes() && five.iter().all(|p| every.contains(p)), "{name}: {five:?}");
        assert_eq!((rank(&robot, &five), rank(&robot, &every)), (five.len(), five.len()), "{name}");
    }
}

/// Without parallel axes, but with couplings and adjacent prismatic joints, the set contains as many
/// parameters as are independent.
#[test]
fn prismatic_joints_have_no_redundant_parameter() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for k in 0..160 {
        let mut robot = random_robot(&mut rng, 1 + k % 8, false);
        for joint in &mut robot.joints {
            joint.alpha =
                rng.random_range(PI / 6.0..PI / 2.0) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        }
        let four = identifiable(&Chain::new(&robot), FourParameter);
        let all = links(&robot, |p| !matches!(p, Parameter::Dbeta(_)));
        let kinds: Vec<_> = robot.joints.iter().map(|j| j.kind).collect();
        assert_eq!((rank(&robot, &four), rank(&robot, &all)), (four.len(), four.len()), "{kinds:?} {four:?}");
    }
}

/// The prismatic joints are between parallel axes, and the axes of two of them cross.
#[test]
fn prismatic_joints_beside_parallel_axes_have_five_parameters() {
    let slide =
        |r: f64, alpha: f64| Joint { limits: (0.1, 0.4), ..joint(JointKind::Prismatic, 0.0, r, 0.0, alpha) };
    let turn = |r: f64, l: f64, alpha: f64| joint(JointKind::Revolute, 0.0, r, l, alpha);
    let scara = vec![turn(0.4, 0.35, 0.0), turn(0.0, 0.3, PI), slide(0.0, 0.0), turn(0.1, 0.0, 0.0)];
    let right = FRAC_PI_2;
    let stanford = vec![
        turn(0.4, 0.0, -right),
        turn(0.15, 0.0, right),
        slide(0.2, 0.0),
        turn(0.0, 0.0, -right),
        turn(0.0, 0.0, right),
        turn(0.26, 0.0, 0.0),
    ];
    let across = |alpha: f64| Joint { theta: right, ..slide(0.2, alpha) };
    let crossed = vec![across(right), across(0.0), turn(0.1, 0.3, right), turn(0.0, 0.2, 0.0)];
    let tool = Pose::from_translation_rpy(vector![0.05, 0.0, 0.1], Vector3::zeros());
    for (name, rows) in [("SCARA", scara), ("Stanford arm", stanford), ("crossed slides", crossed)] {
        let serial = |i| (0..rows.len()).map(|j| f64::from(u8::from(i == j))).collect();
        let coupling = (0..rows.len()).map(serial).collect();
        let robot = robot(rows, coupling, tool);
        let five = conditions(&robot, LENGTH)[1];
        println!("{name}: five parameters {five:.1} {:?}", identifiable(&Chain::new(&robot), FiveParameter));
        assert!(five < 1000.0, "{name}: {five:e}");
    }
}

#[test]
fn too_few_postures_make_identification_singular() {
    let robot = CalibratedArm::new("ur10").robot;
    let (chain, all) = (Chain::new(&robot), postures(&robot));
    // There are 24 parameters and six rows per posture. A repeated posture adds nothing.
    for few in [&all[..0], &all[..3], &[all[0]; 50]] {
        assert!(condition(&chain, few, FiveParameter, LENGTH) > 1e12);
    }
    assert!(condition(&chain, &all[..20], FiveParameter, LENGTH) < 1000.0);
    // The flange lies on the last axis, so positions alone do not show its rotation.
    assert_eq!(condition(&chain, &all, FiveParameter, 0.0), f64::INFINITY);
}
