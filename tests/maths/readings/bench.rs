//! Helpers that these tests share: robots in a cell with one operation, and random error sets.

use crate::common::{from_text, root, shipped};
use nalgebra::Vector3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::cell::*;
use sweetspot::pose::Pose;
use sweetspot::reading::{ErrorEvaluator, WorkContext, WorkFrame};
use sweetspot::robot::{Chain, Frames};

/// Returns the shipped cell of the paper with another robot, tolerance and sense.
pub fn cell_of(robot: Robot, tolerance: Tolerance, sense: Sense) -> Cell {
    let mut cell = shipped("hitachi_paper.toml");
    cell.robot = robot;
    cell.robot.errors = vec![ErrorSet::Tolerance(tolerance)];
    (cell.errors, cell.reading, cell.model) = (0, Reading::WorstCase, Model::Linear);
    cell.operations[0].sense = sense;
    cell
}

pub fn gauge_of(cell: &Cell) -> ErrorEvaluator {
    ErrorEvaluator::new(cell, &cell.operations[0])
}

/// Returns a sample with errors of every rigid parameter of a robot. `turned` is the largest error of an
/// angle, rad. Lengths are wrong by less than 0.3 mm, and frames are displaced by 0.2 mm along each axis.
pub fn random_errors(rng: &mut ChaCha8Rng, axes: usize, turned: f64) -> ErrorSet {
    let value = |p: Parameter| match p {
        _ if p.is_elastic() => 0.0,
        Parameter::Dl(_) | Parameter::Dr(_) => rng.random_range(0.0..3e-4),
        Parameter::Tool(component) | Parameter::Base(component) | Parameter::Joint(_, component)
            if component < 3 =>
        {
            2e-4
        }
        _ => rng.random_range(0.0..turned),
    };
    let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
    ErrorSet::Signed(SignedErrors::of_values("drawn".into(), axes, &values))
}

/// Returns a work context without a taught frame and without a pick.
pub fn alone() -> WorkContext {
    WorkContext {
        site: WorkFrame {
            equipment: 0,
            work: Pose::identity(),
            world: nalgebra::Matrix3::identity(),
            taught: None,
        },
        reference: None,
    }
}

/// Returns a robot of revolute and prismatic joints with right angles and a tool.
pub fn random_robot(rng: &mut ChaCha8Rng, axes: usize) -> Robot {
    let mut robot = shipped("hitachi_paper.toml").robot;
    let joint = |k: usize, rng: &mut ChaCha8Rng| {
        let kind = if rng.random_bool(0.2) { JointKind::Prismatic } else { JointKind::Revolute };
        let right = FRAC_PI_2 * f64::from(rng.random_range(-1..3));
        let alpha = if rng.random_bool(0.6) { right } else { rng.random_range(-PI..PI) };
        let mut length = || rng.random_range(-1.0..1.0);
        let (r, l) = (length(), length());
        let (name, theta) = (format!("q{k}"), rng.random_range(-PI..PI));
        Joint { name, kind, theta, r, l, alpha, limits: (-PI, PI), rates: Default::default() }
    };
    robot.joints = (0..axes).map(|k| joint(k, rng)).collect();
    robot.coupling = (0..axes)
        .map(|i| {
            let factor = |j: usize, rng: &mut ChaCha8Rng| match i.cmp(&j) {
                std::cmp::Ordering::Equal => 1.0,
                std::cmp::Ordering::Greater if rng.random_bool(0.2) => rng.random_range(-1.0..1.0),
                _ => 0.0,
            };
            (0..axes).map(|j| factor(j, rng)).collect()
        })
        .collect();
    let mut three = |bound: f64| Vector3::from_fn(|_, _| rng.random_range(-bound..bound));
    robot.tool = Pose::from_translation_rpy(three(0.3), three(PI));
    robot.joint_frames = (0..axes).map(|_| Pose::from_translation_rpy(three(0.3), three(PI))).collect();
    robot.solids.clear();
    robot
}

/// Returns a robot of the test data.
pub fn robot_from(name: &str) -> Robot {
    let text = std::fs::read_to_string(root().join(format!("tests/data/{name}.toml"))).unwrap();
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot
}

/// Returns a tolerance of up to `length` and `angle` on a number of random parameters.
pub fn random_tolerance(
    rng: &mut ChaCha8Rng,
    axes: usize,
    wrong: usize,
    (length, angle): (f64, f64),
    distributions: &[Distribution],
) -> Tolerance {
    let count = Parameter::count(axes);
    let rigid = Parameter::first_elastic(axes);
    let mut chosen: Vec<usize> = (0..rigid).collect();
    (0..wrong).for_each(|k| chosen.swap(k, rng.random_range(k..rigid)));
    let mut spreads = vec![Spread::of_magnitude(0.0); count];
    for (place, parameter) in Parameter::of_robot(axes).enumerate() {
        let turns = match parameter {
            Parameter::Dq(_) | Parameter::Dalpha(_) | Parameter::Dbeta(_) => true,
            Parameter::Base(c) | Parameter::Tool(c) | Parameter::Joint(_, c) => c >= 3,
            _ => false,
        };
        if chosen[..wrong].contains(&place) {
            let bound = if turns { angle } else { length };
            let plus_minus = rng.random_range(0.1..1.0) * bound;
            let distribution = distributions[rng.random_range(0..distributions.len())];
            spreads[place] = Spread { plus_minus, distribution, sigmas: 3.0 };
        }
    }
    Tolerance { name: "random".into(), spreads, covariance: None, costs: Vec::new() }
}

pub fn random_joints(rng: &mut ChaCha8Rng, robot: &Robot) -> JointVector {
    from_fn(|i| robot.joints.get(i).map_or(0.0, |j| rng.random_range(j.limits.0..=j.limits.1)))
}

pub fn frames_at(robot: &Robot, q: &JointVector) -> Frames {
    let chain = Chain::new(robot);
    chain.frames(&chain.posture(q))
}
