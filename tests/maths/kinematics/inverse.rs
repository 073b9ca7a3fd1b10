//! Tests the inverse of the forward kinematics for the paper's robot and similar arms.

use crate::common::{from_text, shipped};
use crate::kinematics::product::{no_errors, position, random_joints, rotation, tcp};
use nalgebra::{Vector3, vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use sweetspot::cell::{Attitude, Joint, JointVector, Robot};
use sweetspot::reach::{Inverse, Reach};
use sweetspot::robot::Chain;
use sweetspot::units::wrapped;

/// Returns the position of the TCP and the elevation of the tool axis in the base frame.
fn held(robot: &Robot, q: &[f64]) -> (Vector3<f64>, f64) {
    let t = tcp(robot, q, &no_errors(robot.axes()), 0.0);
    (position(&t), elevation(&(rotation(&t) * robot.tool_axis)))
}

fn elevation(axis: &Vector3<f64>) -> f64 {
    axis.z.atan2(axis.x.hypot(axis.y))
}

/// Returns the distance of each joint beyond its limits, which is negative inside the limits.
fn outside(robot: &Robot, q: &JointVector) -> Vec<f64> {
    robot.joints.iter().zip(q).map(|(j, q)| (j.limits.0 - q).max(q - j.limits.1)).collect()
}

/// Returns the largest difference of a joint between two postures. Full turns do not count if the range of
/// the joint exceeds one turn.
fn apart(robot: &Robot, a: &JointVector, b: &JointVector) -> f64 {
    let turns = |j: &Joint| j.limits.1 - j.limits.0 > TAU;
    let each = robot.joints.iter().zip(a.iter().zip(b));
    each.map(|(j, (a, b))| if turns(j) { wrapped(a - b).abs() } else { (a - b).abs() }).fold(0.0, f64::max)
}

/// Checks that every branch has the tool pose of `q`. Also checks that both functions judge the limits
/// equally and rightly, and that the allowed posture `q` is among the branches.
fn check_inverse(robot: &Robot, q: &JointVector, tolerance: f64) {
    let (chain, (target, bend)) = (Chain::new(robot), held(robot, q));
    let arm = Inverse::new(&chain);
    let approach = arm.tool_attitudes(&Attitude::elevation(bend), 0.0);
    let Reach::Branches(branches) = arm.branches(&target, &approach) else { panic!("{q:?} out of reach") };
    for b in &branches {
        let (p, e) = held(robot, &b.joints);
        let pose = chain.forward(&b.posture);
        let same =
            (pose.translation - target).norm() + (elevation(&(pose.rotation * robot.tool_axis)) - bend).abs();
        assert!((p - target).norm() < 1e-12 && (e - bend).abs() < 1e-12 && same < 1e-12, "{q:?} {b:?}");
        let outside = outside(robot, &b.joints);
        let worst = outside.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let rightly = b.violation.map_or(worst < 1e-10, |v| {
            v.by > -1e-10 && (v.by - outside[v.joint]).abs() < 1e-10 && (v.by - worst).abs() < 1e-10
        });
        assert!(rightly, "{q:?} {b:?}: limits are passed by {worst}");
    }
    let inside = || branches.iter().filter(|b| b.violation.is_none());
    assert!(inside().any(|b| apart(robot, q, &b.joints) < tolerance), "{q:?} is not among {branches:?}");
    let mut visited = Vec::new();
    arm.visit(&target, &approach, &mut arm.scratch(), |index, posture| visited.push((index, *posture)));
    assert_eq!(visited, inside().map(|b| (b.index, b.posture)).collect::<Vec<_>>(), "{q:?}");
}

fn check_inverse_at_random(robot: &Robot, configurations: usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..configurations {
        // The sine of joint 3 determines the condition. It is at least 2e-4 here, which leaves five digits.
        check_inverse(robot, &random_joints(robot, &mut rng), 1e-9);
    }
}

#[test]
fn the_inverse_recovers_postures_of_the_robot_of_the_paper() {
    check_inverse_at_random(&shipped("hitachi_paper.toml").robot, 10_000);
    check_inverse_at_random(&shipped("hitachi_paper_parallelogram.toml").robot, 10_000);
}

/// Rows (q_offset, r, l, alpha; degrees, mm) of an arm with all offsets that its kinematic family allows.
const OFFSETS: [[f64; 4]; 4] = [
    [20.0, 700.0, 150.0, 90.0],
    [30.0, 120.0, 600.0, 0.0],
    [0.0, -80.0, 500.0, 0.0],
    [-40.0, 45.0, 300.0, 0.0],
];
/// Rows of an arm without offsets.
const PLAIN: [[f64; 4]; 4] =
    [[0.0, 700.0, 0.0, 90.0], [0.0, 0.0, 600.0, 0.0], [0.0, 0.0, 500.0, 0.0], [0.0, 0.0, 300.0, 0.0]];
const TOOL: &str = "tool = { position_mm = [30, 70, -110], axis = [1, 0, 0] }";
const AT_FLANGE: &str = "tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }";
const SERIAL: &str = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]";

/// Returns a robot read from text. Every joint has the limits `limits` (degrees).
fn arm(rows: [[f64; 4]; 4], limits: [f64; 2], coupling: &str, tool: &str) -> Robot {
    let row = |(i, [q, r, l, a]): (usize, &[f64; 4])| {
        format!(
            "{{ name = \"q{i}\", q_offset_deg = {q}, r_mm = {r}, l_mm = {l}, alpha_deg = {a}, limits_deg = {limits:?} }}"
        )
    };
    let text = format!(
        r#"
        schema = "sweetspot/cell/1"
        units = {{ length = "mm", angle = "deg" }}
        errors = "none"
        [robot]
        name = "arm"
        source = "tests/kinematics"
        footprint = {{ size_mm = [400, 400] }}
        {tool}
        coupling = {coupling}
        joint = [{}]
        errors.none = {{ kind = "signed", source = "-", dr_mm = [0, 0, 0, 0], dl_mm = [0, 0, 0, 0], dalpha_deg = [0, 0, 0, 0] }}
        [equipment.table]
        surface = {{ size_mm = [1000, 1000] }}
        placement = {{ x_mm = 900, y_mm = 0, z_mm = 0 }}
        [operation.map]
        on = "table"
        grid = [2, 2]
        bend_deg = 0
        sense = "xyz""#,
        rows.iter().enumerate().map(row).collect::<Vec<_>>().join(", ")
    );
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot
}

#[test]
fn the_inverse_recovers_postures_of_arms_like_the_paper() {
    let with = |joint: usize, column: usize, value: f64| {
        let mut rows = OFFSETS;
        rows[joint][column] = value;
        rows
    };
    let turn = [-180.0, 180.0];
    let tilted = "tool = { position_mm = [30, 70, -110], rpy_deg = [0, 90, 30], axis = [0, 0, 1] }";
    let sideways = "tool = { position_mm = [30, 70, -110], axis = [0, 1, 0] }";
    let across = "tool = { position_mm = [30, 70, -110], axis = [0, 0, 1] }";
    let whole = "[[1, 0, 0, 0], [1, 1, 0, 0], [0, -2, 1, 0], [3, 0, -1, 1]]";
    let fraction = "[[1, 0, 0, 0], [0.5, 1, 0, 0], [0, -0.5, 1, 0], [0.3, 0, -1, 1]]";
    let robots = [
        arm(PLAIN, turn, SERIAL, TOOL),
        arm(OFFSETS, turn, SERIAL, TOOL),
        arm(with(0, 3, -90.0), turn, SERIAL, tilted),
        arm(with(2, 2, -500.0), turn, SERIAL, sideways),
        arm(with(3, 3, 90.0), turn, SERIAL, across),
        arm(OFFSETS, [-400.0, 300.0], SERIAL, TOOL),
        arm(OFFSETS, [-400.0, 300.0], whole, TOOL),
        // The limits include 180 degrees, where atan2 jumps.
        arm(OFFSETS, [100.0, 260.0], SERIAL, TOOL),
        arm(OFFSETS, [100.0, 260.0], whole, TOOL),
        arm(OFFSETS, [-70.0, 110.0], fraction, TOOL),
    ];
    for robot in robots {
        check_inverse_at_random(&robot, 2_000);
    }
}

#[test]
fn the_inverse_finds_postures_at_the_joint_limits() {
    let paper = ["hitachi_paper.toml", "hitachi_paper_parallelogram.toml"].map(|name| shipped(name).robot);
    for robot in paper.into_iter().chain([arm(OFFSETS, [100.0, 260.0], SERIAL, TOOL)]) {
        // Every joint is at its lower limit, between, or at its upper limit.
        for k in 0..3usize.pow(4) {
            let choice = |i, (lo, hi): (f64, f64)| [lo, 0.6 * lo + 0.4 * hi, hi][k / 3usize.pow(i) % 3];
            let q = from_fn(|i| robot.joints.get(i).map_or(0.0, |j| choice(i as u32, j.limits)));
            check_inverse(&robot, &q, 1e-7);
        }
    }
}

/// At a joint limit, search and map give the same verdict despite rounding.
#[test]
fn map_and_search_agree_at_the_tolerance_of_a_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let robot = shipped("hitachi_paper.toml").robot;
    let (chain, half) = (Chain::new(&robot), |(lo, hi): (f64, f64)| (hi - lo) / 2.0);
    let arm = Inverse::new(&chain);
    for _ in 0..2_000 {
        let (mut q, joint) = (random_joints(&robot, &mut rng), rng.random_range(0..4));
        let limits = robot.joints[joint].limits;
        // A limit counts as met up to 1e-12 in the cosine of the angle from its middle.
        q[joint] = limits.1 + 1e-12 * rng.random_range(0.999..1.001) / half(limits).sin();
        let (target, bend) = held(&robot, &q);
        let approach = arm.tool_attitudes(&Attitude::elevation(bend), 0.0);
        let Reach::Branches(branches) = arm.branches(&target, &approach) else {
            panic!("{q:?} out of reach")
        };
        let mut visited = Vec::new();
        arm.visit(&target, &approach, &mut arm.scratch(), |index, _| visited.push(index));
        let inside = branches.iter().filter(|b| b.violation.is_none()).map(|b| b.index);
        assert_eq!(visited, inside.collect::<Vec<_>>(), "{q:?}");
    }
}

/// For a stretched arm or a vertical tool, the accuracy of the joints is only the square root of the rounding
/// error.
#[test]
fn the_inverse_handles_singular_postures() {
    let robot = arm(OFFSETS, [-180.0, 180.0], SERIAL, AT_FLANGE);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..1_000 {
        let random = random_joints(&robot, &mut rng);
        let stretched = from_fn(|i| if i == 2 { 0.0 } else { random[i] });
        check_inverse(&robot, &stretched, 1e-7);
        let mut vertical = random;
        vertical[3] = wrapped(FRAC_PI_2.copysign(random[3]) + 10f64.to_radians() - random[1] - random[2]);
        check_inverse(&robot, &vertical, 1e-7);
    }
}

#[test]
fn an_arm_straight_up_beside_its_base_axis_is_in_reach() {
    let mut rows = OFFSETS;
    (rows[0][2], rows[1][0], rows[3][0]) = (0.0, 90.0, 0.0);
    let robot = arm(rows, [-180.0, 180.0], SERIAL, AT_FLANGE);
    for k in -17..18 {
        let mut q = JointVector::default();
        q[0] = f64::from(k) / 6.0;
        check_inverse(&robot, &q, 1e-7);
    }
}

#[test]
fn a_folded_arm_of_equal_links_holds_the_tool() {
    let mut rows = PLAIN;
    rows[2][2] = rows[1][2];
    let robot = arm(rows, [-180.0, 180.0], SERIAL, TOOL);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for fold in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 0.0] {
        for _ in 0..100 {
            let mut q = random_joints(&robot, &mut rng);
            q[2] = PI - fold;
            // The upper arm may point anywhere, so only the tool is compared.
            check_inverse(&robot, &q, f64::INFINITY);
        }
    }
}

#[test]
fn the_base_yaw_keeps_its_limits_on_the_base_axis() {
    for (offset, limits) in [(0.0, (-60.0, 60.0)), (90.0, (-60.0, 60.0)), (45.0, (100.0, 260.0))] {
        let mut robot = arm(PLAIN, [-180.0, 180.0], SERIAL, AT_FLANGE);
        robot.joints[0].theta = f64::to_radians(offset);
        robot.joints[0].limits = (f64::to_radians(limits.0), f64::to_radians(limits.1));
        let arm = Inverse::new(&Chain::new(&robot));
        let approach = arm.tool_attitudes(&Attitude::elevation(0.0), 0.0);
        let Reach::Branches(branches) = arm.branches(&vector![0.0, 0.0, 1.4], &approach) else { panic!() };
        assert!(branches.iter().all(|b| b.violation.is_none()), "{branches:?}");
    }
}

/// Two turns of joint 2 are possible, which differ by half a turn of joint 3. The posture alone does not
/// decide whether joint 2 is within its limits, so the numeric solver is used.
#[test]
fn a_fractional_gear_over_several_turns_is_solved_on_the_actuators() {
    let gear = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, -0.5, 1, 0], [0, 0, 0, 1]]";
    let mut robot = arm(OFFSETS, [-400.0, 300.0], gear, TOOL);
    robot.joints[2].limits = (-0.7, 0.7);
    let inverse = Inverse::new(&Chain::new(&robot));
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..100 {
        let (target, bend) = held(&robot, &random_joints(&robot, &mut rng));
        let approach = inverse.tool_attitudes(&Attitude::elevation(bend), 0.0);
        let Reach::Branches(branches) = inverse.branches(&target, &approach) else {
            panic!("{target:?} {bend}")
        };
        for b in branches {
            let (p, e) = held(&robot, &b.joints);
            assert!((p - target).norm() < 1e-9 && (e - bend).abs() < 1e-9, "{b:?}");
            assert!(outside(&robot, &b.joints).into_iter().all(|by| by < 1e-9), "{b:?}");
        }
    }
}
