//! Tests cycle times against closed forms, numerical integration, a linear program and laws of scaling.

use crate::common::{from_text, shipped};
use crate::kinematics::errors::{joint, robot};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT};
use nalgebra::vector;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::cell::{Cell, Goal, Goals, Joint, JointKind, JointVector, MAX_JOINTS, Robot};
use sweetspot::cycle_time::{
    ASSUMED_FULL_SPEED_AFTER, CyclePhase, RateBounds, line_time, path_of_legs_time, rest_to_rest,
    straight_move_time,
};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::motion::straight;
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

fn bounds(limits: &[(f64, f64)]) -> RateBounds {
    let (mut velocity, mut acceleration) = ([f64::INFINITY; MAX_JOINTS], [f64::INFINITY; MAX_JOINTS]);
    for (j, (v, a)) in limits.iter().enumerate() {
        (velocity[j], acceleration[j]) = (*v, *a);
    }
    RateBounds { velocity, acceleration, is_assumed: false }
}

fn posture(values: &[f64]) -> JointVector {
    std::array::from_fn(|j| values.get(j).copied().unwrap_or(0.0))
}

/// Returns the time by integration over the phase plane. The speed at every point is the maximum speed that
/// the motion can have reached and from which it can still stop. The points are denser at the ends, where the
/// motion is slow.
fn integrated(distance: f64, velocity: f64, acceleration: f64) -> f64 {
    let steps = 100_000;
    let width = PI / f64::from(steps);
    let part = |k: i32| {
        let angle = (f64::from(k) + 0.5) * width;
        let at = distance * (1.0 - angle.cos()) / 2.0;
        let reached = (2.0 * acceleration * at.min(distance - at)).sqrt();
        distance * angle.sin() / 2.0 * width / reached.min(velocity)
    };
    (0..steps).map(part).sum()
}

#[test]
fn a_motion_from_rest_to_rest_has_a_triangular_or_trapezoidal_profile() {
    // 180 degrees per s and 600 degrees per s^2: the ramps take 0.3 s and 54 degrees.
    assert!((rest_to_rest(90.0, 180.0, 600.0) - 0.8).abs() < 1e-12);
    assert!((rest_to_rest(24.0, 180.0, 600.0) - 0.4).abs() < 1e-12);
    assert!((rest_to_rest(54.0, 180.0, 600.0) - 0.6).abs() < 1e-12);
    assert_eq!(rest_to_rest(0.0, 180.0, 600.0), 0.0);
    for (distance, velocity, acceleration) in
        [(0.3, 1.0, 2.0), (2.0, 1.0, 2.0), (1.7, 0.4, 7.0), (0.01, 3.0, 9.0)]
    {
        let closed = rest_to_rest(distance, velocity, acceleration);
        let summed = integrated(distance, velocity, acceleration);
        assert!((closed - summed).abs() < 1e-6 * closed, "{closed} {summed}");
    }
}

#[test]
fn the_slowest_joint_sets_the_time_of_a_straight_move() {
    let limits = bounds(&[(1.0, 10.0), (2.0, 1.0)]);
    // Alone, joint 1 needs 1 / 1 + 1 / 10 s, and joint 2 needs 2 sqrt(0.25) s.
    let one = straight_move_time(&posture(&[0.0]), &posture(&[1.0]), &limits);
    assert!((one - 1.1).abs() < 1e-12, "{one}");
    let two = straight_move_time(&posture(&[0.0, 0.25]), &posture(&[0.0, 0.0]), &limits);
    assert!((two - 1.0).abs() < 1e-12, "{two}");
    // In a common motion, joint 1 limits the rate of the path parameter to 1, and joint 2 limits its
    // acceleration to 4.
    let both = straight_move_time(&posture(&[0.0, 0.25]), &posture(&[1.0, 0.0]), &limits);
    assert!((both - 1.25).abs() < 1e-12, "{both}");
    assert_eq!(straight_move_time(&posture(&[0.3]), &posture(&[0.3]), &limits), 0.0);
    // A joint without an actuator, whose limits are infinite, does not count.
    assert_eq!(straight_move_time(&posture(&[0.0; 3]), &posture(&[0.0, 0.0, 5.0]), &limits), 0.0);
}

/// Returns an arm with the given joints, without coupling and without a tool.
fn arm(joints: Vec<Joint>) -> Robot {
    let row = |i: usize| (0..joints.len()).map(|j| f64::from(u8::from(i == j))).collect();
    let coupling = (0..joints.len()).map(row).collect();
    robot(joints, coupling, Pose::identity())
}

#[test]
fn a_line_of_a_gantry_has_the_trapezoidal_profile_of_its_slowest_axis() {
    // The axes point along z, -y and x.
    let slide = |theta: f64, alpha: f64| joint(JointKind::Prismatic, theta, 0.0, 0.0, alpha);
    let gantry = arm(vec![slide(0.0, FRAC_PI_2), slide(FRAC_PI_2, FRAC_PI_2), slide(0.0, 0.0)]);
    let chain = Chain::new(&gantry);
    let limits = bounds(&[(0.5, 2.0), (1.0, 2.0), (0.25, 4.0)]);
    for (way, speed) in [
        (vector![0.0, 0.0, 0.4], f64::INFINITY),
        (vector![0.3, 0.2, -0.1], f64::INFINITY),
        (vector![0.05, 0.0, 0.0], f64::INFINITY),
        (vector![0.3, 0.2, -0.1], 0.1),
        (vector![0.0, 0.004, 0.0], 0.02),
    ] {
        let from = posture(&[0.1, 0.2, 0.3]);
        let knots = straight(&chain, &from, &way, gantry.reach()).unwrap();
        let (last, length) = (knots[knots.len() - 1], way.norm());
        let (mut velocity, mut acceleration) = (speed / length, f64::INFINITY);
        for j in 0..3 {
            let travel = (last[j] - from[j]).abs().max(1e-15);
            velocity = velocity.min(limits.velocity[j] / travel);
            acceleration = acceleration.min(limits.acceleration[j] / travel);
        }
        let (closed, time) =
            (rest_to_rest(1.0, velocity, acceleration), line_time(&chain, &knots, &limits, speed));
        // A ramp that is shorter than a step of the path counts as one step.
        assert!((time - closed).abs() <= 1e-2 * closed, "{way:?}: {time} and not {closed}");
        assert!(time >= closed * (1.0 - 1e-9), "{way:?}: {time} is below the least time {closed}");
    }
}

/// Lengths of the two links of the planar arm, m.
const LINKS: (f64, f64) = (0.4, 0.3);

/// Returns the joint angles of the planar arm with its TCP at (x, y), elbow down, in closed form.
fn planar_inverse(x: f64, y: f64) -> [f64; 2] {
    let (a, b) = LINKS;
    let cos = (x * x + y * y - a * a - b * b) / (2.0 * a * b);
    let second = cos.acos();
    [y.atan2(x) - (b * second.sin()).atan2(a + b * second.cos()), second]
}

/// Solves the linear program of the fastest profile along the line from `from` to `to`: the greatest sum of
/// the squared speeds at the samples. Returns the time.
fn by_linear_program(from: (f64, f64), to: (f64, f64), limits: &[(f64, f64); 2], steps: usize) -> f64 {
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    let at = |s: f64| {
        let share = s / length;
        planar_inverse(from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share)
    };
    let (h, d) = (length / steps as f64, length * 1e-4);
    let (mut rows, mut columns, mut values, mut right) = (vec![], vec![], vec![], vec![]);
    let mut add = |terms: &[(usize, f64)], bound: f64| {
        for (column, value) in terms {
            rows.push(right.len());
            columns.push(*column);
            values.push(*value);
        }
        right.push(bound);
    };
    for k in 0..=steps {
        add(&[(k, -1.0)], 0.0);
        if k == 0 || k == steps {
            add(&[(k, 1.0)], 0.0);
        }
        // Central differences within the line.
        let s = (k as f64 * h).clamp(d, length - d);
        let [before, here, after] = [at(s - d), at(s), at(s + d)];
        for j in 0..2 {
            let first = (after[j] - before[j]) / (2.0 * d);
            let second = (after[j] - 2.0 * here[j] + before[j]) / (d * d);
            add(&[(k, first * first)], limits[j].0 * limits[j].0);
            if k < steps {
                let forward = first / (2.0 * h);
                let terms = [(k, second - forward), (k + 1, forward)];
                add(&terms, limits[j].1);
                add(&terms.map(|(c, v)| (c, -v)), limits[j].1);
            }
        }
    }
    let n = steps + 1;
    let a = CscMatrix::new_from_triplets(right.len(), n, rows, columns, values);
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(right.len())];
    let none = CscMatrix::zeros((n, n));
    let mut solver = DefaultSolver::new(&none, &vec![-1.0; n], &a, &right, &cones, settings).unwrap();
    solver.solve();
    let x: Vec<f64> = solver.solution.x.iter().map(|x| x.max(0.0)).collect();
    x.windows(2).map(|x| 2.0 * h / (x[0].sqrt() + x[1].sqrt())).sum()
}

#[test]
fn a_line_of_a_planar_arm_takes_the_time_of_a_linear_program() {
    let (a, b) = LINKS;
    let link = |l: f64| joint(JointKind::Revolute, 0.0, 0.0, l, 0.0);
    let robot = arm(vec![link(a), link(b), link(0.0)]);
    let chain = Chain::new(&robot);
    // The last joint keeps the orientation and is so fast that it does not limit the motion.
    let cases = [
        ((0.5, -0.2), (0.5, 0.2), [(1.0, 5.0), (2.0, 5.0)]),
        ((0.2, 0.25), (0.6, 0.3), [(3.0, 4.0), (1.5, 8.0)]),
        // The line passes near the base, where the first joint must turn fast.
        ((0.3, 0.13), (-0.25, 0.13), [(2.0, 6.0), (2.0, 6.0)]),
        ((0.55, 0.1), (0.52, 0.13), [(9.0, 9.0), (9.0, 9.0)]),
    ];
    for (from, to, limits) in cases {
        let [first, second] = planar_inverse(from.0, from.1);
        let start = posture(&[first, second, 1.5 - first - second]);
        let tcp = chain.forward(&chain.posture(&start)).translation;
        assert!((tcp - vector![from.0, from.1, 0.0]).norm() < 1e-12);
        let knots =
            straight(&chain, &start, &vector![to.0 - from.0, to.1 - from.1, 0.0], robot.reach()).unwrap();
        let joints = bounds(&[limits[0], limits[1], (1e3, 1e6)]);
        let time = line_time(&chain, &knots, &joints, f64::INFINITY);
        let least = by_linear_program(from, to, &limits, 400);
        assert!(
            (time / least - 1.0).abs() < 5e-3,
            "{from:?} to {to:?}: {time} s, the program finds {least} s"
        );
        // The limits of the speeds alone give a lower bound of the time.
        let end = knots[knots.len() - 1];
        let slowest = (0..2).map(|j| (end[j] - start[j]).abs() / limits[j].0).fold(0.0, f64::max);
        assert!(time > slowest, "{time} {slowest}");
    }
}

/// If a motion is k times as fast, its speeds are k times and its accelerations k^2 times as large.
#[test]
fn times_scale_with_speeds_and_accelerations() {
    let robot = shipped("panda_cell.toml").robot;
    let chain = Chain::new(&robot);
    let one = RateBounds::new(&robot).unwrap();
    let faster = RateBounds {
        velocity: one.velocity.map(|v| v * 3.0),
        acceleration: one.acceleration.map(|a| a * 9.0),
        is_assumed: false,
    };
    for way in [vector![0.0, 0.0, 0.12], vector![0.07, -0.05, 0.02], vector![0.2, 0.0, -0.1]] {
        let knots = straight(&chain, &robot.home, &way, robot.reach()).unwrap();
        let [slow, fast] = [&one, &faster].map(|bounds| line_time(&chain, &knots, bounds, f64::INFINITY));
        assert!((slow - 3.0 * fast).abs() < 1e-9 * slow && slow > 0.05, "{way:?}: {slow} {fast}");
        // The way back takes the same time, because the limits have no direction.
        let reversed: Vec<JointVector> = knots.iter().rev().copied().collect();
        let back = line_time(&chain, &reversed, &one, f64::INFINITY);
        assert!((back - slow).abs() < 5e-3 * slow, "{way:?}: {slow} there, {back} back");
        let crawling = line_time(&chain, &knots, &one, 0.01);
        assert!((crawling - way.norm() / 0.01).abs() < 0.05 * crawling, "{way:?}: {crawling}");
        let stops: Vec<usize> = (0..knots.len()).collect();
        let stopping = path_of_legs_time(&chain, &knots, &stops, &one);
        assert!(stopping > slow, "{way:?}: {stopping} with a stop at every vector, {slow} without");
    }
}

#[test]
fn the_bounds_of_a_robot_say_what_is_assumed_and_what_is_missing() {
    let panda = RateBounds::new(&shipped("panda_cell.toml").robot).unwrap();
    assert!(!panda.is_assumed);
    assert!((panda.velocity[0] - 2.175).abs() < 1e-5 && (panda.acceleration[1] - 7.5).abs() < 1e-5);
    let mut robot = shipped("ur_cell.toml").robot;
    let assumed = RateBounds::new(&robot).unwrap();
    assert!(assumed.is_assumed);
    assert!((assumed.acceleration[5] - PI / ASSUMED_FULL_SPEED_AFTER).abs() < 1e-12);
    robot.full_speed_after = Some(0.25);
    let stated = RateBounds::new(&robot).unwrap();
    assert!(!stated.is_assumed && (stated.acceleration[5] - 4.0 * PI).abs() < 1e-12);
    robot.joints[2].rates.velocity = None;
    robot.joints[4].rates.velocity = None;
    assert_eq!(RateBounds::new(&robot), Err(vec![2, 4]));
    // The passive joints of a palletizer have no actuator, and so no speed.
    let palletizer = shipped("palletizer_cell.toml").robot;
    assert!(palletizer.joints.iter().any(|joint| joint.is_passive()));
    assert!(!palletizer.joints_without_speed().iter().any(|k| palletizer.joints[*k].is_passive()));
}

/// Returns the shipped cell with accelerations, and lines at the first operation; `transfer` are its transfer
/// rules.
fn cell_with_lines(transfer: &str) -> Cell {
    let rate =
        |k: usize| format!("[[robot.rate]]\njoint = {}\nmax_acceleration_deg_s2 = {}\n", k + 1, 150 + 50 * k);
    let text = format!(
        "from = \"ur_cell.toml\"\n{}[operation.assembly]\napproach_mm = 50\nretract_mm = 40\n\
         dwell_s = 2\nline_speed_mm_s = 100\n{transfer}",
        (0..6).map(rate).collect::<String>()
    );
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

#[test]
fn the_cycle_of_a_layout_is_the_sum_of_its_steps() {
    use CyclePhase::{Approach, DirectMove, Dwell, Retract, Transfer};
    let rules = "[transfer]\ncheck = true\nlift_mm = 100\n";
    for (transfer, phases) in [
        (format!("{rules}cycle = true\n"), vec![Approach, Dwell, Retract, Transfer, Dwell, Transfer]),
        (rules.to_string(), vec![Approach, Dwell, Retract, Transfer, Dwell]),
        (String::new(), vec![Approach, Dwell, Retract, DirectMove, Dwell]),
    ] {
        let workcell = Workcell::new(cell_with_lines(&transfer)).unwrap();
        let (cell, layout) = (&workcell.cell, workcell.cell.start());
        let evaluation = evaluate(&workcell, &layout);
        let cycle = workcell.cycle_time(&layout, &evaluation).unwrap();
        assert_eq!(cycle.steps.iter().map(|step| step.phase).collect::<Vec<_>>(), phases);
        assert_eq!((cycle.is_cycle, cycle.is_assumed), (transfer.contains("cycle"), false));
        let time = |k: usize| cycle.steps[k].time;
        assert_eq!((time(1), time(4)), (2.0, 0.0));
        // Moves of 50 mm and 40 mm at 100 mm/s, plus the time of the speed ramps.
        assert!(time(0) > 0.5 && time(0) < 0.7 && time(2) > 0.4 && time(2) < 0.6, "{cycle:?}");
        let bounds = RateBounds::new(&cell.robot).unwrap();
        for (transfer, step) in evaluation.transfers.iter().zip([3, 5]) {
            let (path, corners) = (&transfer.path, &transfer.corners);
            assert_eq!((corners[0], corners[corners.len() - 1]), (0, path.len() - 1));
            // With a stop at every joint vector, a path takes at least as long.
            let stops: Vec<usize> = (0..path.len()).collect();
            let chain = Chain::new(&cell.robot);
            let longest = path_of_legs_time(&chain, path, &stops, &bounds);
            assert!(time(step) > 0.5 && time(step) <= longest + 1e-9, "{} {longest}", time(step));
            let fastest = path.windows(2).map(|ends| {
                let travel = (0..6).map(|j| (ends[1][j] - ends[0][j]).abs() / bounds.velocity[j]);
                travel.fold(0.0, f64::max)
            });
            assert!(time(step) > fastest.sum::<f64>(), "{}", time(step));
        }
        let sum: f64 = (0..phases.len()).map(time).sum();
        let goals = workcell.goals(&layout, &evaluation, &Goals::of(&[Goal::Time]).unwrap()).unwrap();
        assert!((goals[0] - sum).abs() < 1e-12 && (cycle.total() - sum).abs() < 1e-12);
        // Joints with twice the speed and four times the acceleration halve the times of the moves, but not
        // the dwell times.
        let mut faster = cell.clone();
        for joint in &mut faster.robot.joints {
            joint.rates.velocity = joint.rates.velocity.map(|v| 2.0 * v);
            joint.rates.acceleration = joint.rates.acceleration.map(|a| 4.0 * a);
        }
        let faster = Workcell::new(faster).unwrap();
        let halved = faster.cycle_time(&layout, &evaluate(&faster, &layout)).unwrap();
        assert!((halved.steps[3].time - time(3) / 2.0).abs() < 1e-9, "{halved:?}");
        assert_eq!(halved.steps[1].time, 2.0);
    }
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let (layout, goals) = (workcell.cell.start(), Goals::of(&[Goal::Time]).unwrap());
    let evaluation = evaluate(&workcell, &layout);
    assert_eq!(workcell.cycle_time(&layout, &evaluation), None);
    assert!(workcell.goals(&layout, &evaluation, &goals).unwrap()[0].is_nan());
}
