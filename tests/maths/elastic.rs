//! Tests elastic errors (deflections under gravity) against closed forms, finite differences, an independent
//! spring model, Monte Carlo and plain searches.

use crate::common::{cases, robots, shipped};
use crate::kinematics::errors::{joint, random_errors, random_robot, robot};
use crate::kinematics::product::{no_errors, random_joints};
use crate::readings::bench::{alone, cell_of, gauge_of};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::calibration::{Deformed, Unknown};
use sweetspot::cell::*;
use sweetspot::kinematic_error::{Expansion, Perturbation, pose_error};
use sweetspot::pose::{Displacement, Pose};
use sweetspot::reading::monte_carlo;
use sweetspot::robot::Chain;

const GRAVITY: f64 = 9.80665;

/// Returns an arm with two links in a vertical plane: link lengths 0.8 m and 0.5 m.
fn planar_arm() -> Robot {
    let rows = [0.8, 0.5].map(|l| joint(JointKind::Revolute, 0.0, 0.0, l, 0.0));
    let mount = Pose::from_translation_rpy(Vector3::zeros(), Vector3::new(FRAC_PI_2, 0.0, 0.0));
    let coupling = vec![vec![1.0, 0.0], vec![0.0, 1.0]];
    Robot { mount, ..robot(rows.to_vec(), coupling, Pose::identity()) }
}

/// Returns the index of a parameter in the list of all parameters of a robot.
fn place(axes: usize, parameter: Parameter) -> usize {
    Parameter::of_robot(axes).position(|p| p == parameter).unwrap()
}

/// Returns values of all parameters of a robot: the given values, and 0 for all other parameters.
fn values(axes: usize, given: &[(Parameter, f64)]) -> Vec<f64> {
    let mut all = vec![0.0; Parameter::count(axes)];
    given.iter().for_each(|(parameter, value)| all[place(axes, *parameter)] = *value);
    all
}

fn error(robot: &Robot, q: &[f64], values: &[f64], model: Model) -> Displacement {
    let chain = Chain::new(robot);
    let q = std::array::from_fn(|i| q.get(i).copied().unwrap_or(0.0));
    pose_error(&chain.frames(&chain.posture(&q)), &Perturbation::of_values(&chain, values), model)
}

/// The torques of a planar arm with a mass on each link have a closed form.
#[test]
fn a_planar_arm_sags_by_the_torques_of_its_masses() {
    let mut arm = planar_arm();
    // Centres of mass in the frames at the ends of the links, and a mass at the tip.
    let mass = |link, mass, x| LinkMass { link, mass, centre: Vector3::new(x, 0.0, 0.0) };
    arm.masses = vec![mass(1, 10.0, -0.3), mass(2, 4.0, -0.1), mass(2, 2.0, 0.0)];
    let compliances = [1e-5, 3e-5];
    let terms = [(Parameter::Compliance(0), compliances[0]), (Parameter::Compliance(1), compliances[1])];
    for (q1, q2) in [(0.0, 0.0), (0.4, -1.1), (2.0, 0.3), (-FRAC_PI_2, 0.0)] {
        let tip = |q1: f64, q2: f64| {
            Vector3::new(0.8 * q1.cos() + 0.5 * (q1 + q2).cos(), 0.0, 0.8 * q1.sin() + 0.5 * (q1 + q2).sin())
        };
        let (c1, c12) = (q1.cos(), (q1 + q2).cos());
        let second = GRAVITY * (4.0 * 0.4 + 2.0 * 0.5) * c12;
        let first = GRAVITY * (10.0 * 0.5 + (4.0 + 2.0) * 0.8) * c1 + second;
        let sagged = tip(q1 - compliances[0] * first, q2 - compliances[1] * second);
        let got = error(&arm, &[q1, q2], &values(2, &terms), Model::Nonlinear);
        let off = (got.position - (sagged - tip(q1, q2))).norm();
        assert!(off < 1e-15, "{q1}, {q2}: {off:e}");
    }
}

/// A term turns its joint by its value times the horizontal distance between the ends of its link.
#[test]
fn an_elastic_term_deflects_by_the_horizontal_lever_of_its_link() {
    let arm = planar_arm();
    let terms = [
        (Parameter::Elastic(0, 0), 2e-3),
        (Parameter::Elastic(0, 1), -1e-3),
        (Parameter::Elastic(1, 1), 5e-4),
    ];
    let (q1, q2) = (0.7_f64, -1.9_f64);
    let (near, far) = (0.8 * q1.cos(), 0.5 * (q1 + q2).cos());
    let turned = [-(2e-3 * near - 1e-3 * far), -5e-4 * far];
    let got = error(&arm, &[q1, q2], &values(2, &terms), Model::Nonlinear);
    let dq = [(Parameter::Dq(0), turned[0]), (Parameter::Dq(1), turned[1])];
    let want = error(&arm, &[q1, q2], &values(2, &dq), Model::Nonlinear);
    assert!((got.position - want.position).norm() < 1e-16 && (got.rotation - want.rotation).norm() < 1e-16);
}

/// Mass points on the links of a chain of springs, posed without the code of the program.
struct SpringChain<'a> {
    robot: &'a Robot,
    compliances: Vec<f64>,
}

impl SpringChain<'_> {
    /// Returns the frames after every row at Denavit-Hartenberg angles `theta`.
    fn frames(&self, theta: &[f64]) -> Vec<Isometry3<f64>> {
        let about = |axis: Vector3<f64>, angle: f64| {
            Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(axis * angle))
        };
        let along = |x: f64, z: f64| Isometry3::translation(x, 0.0, z);
        let mount = &self.robot.mount;
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(mount.rotation));
        let mut at = Isometry3::from_parts(Translation3::from(mount.translation), rotation);
        let rows = self.robot.joints.iter().zip(theta);
        rows.map(|(row, theta)| {
            let turned = about(Vector3::z(), row.theta + theta) * along(row.l, row.r);
            at = at * turned * about(Vector3::x(), row.alpha);
            at
        })
        .collect()
    }

    fn tcp(&self, theta: &[f64]) -> Vector3<f64> {
        (self.frames(theta)[theta.len() - 1] * nalgebra::Point3::from(self.robot.tool.translation)).coords
    }

    /// Returns the potential energy of all masses, J.
    fn potential(&self, theta: &[f64]) -> f64 {
        let frames = self.frames(theta);
        let height = |m: &LinkMass| (frames[m.link - 1] * nalgebra::Point3::from(m.centre)).z;
        self.robot.masses.iter().map(|m| m.mass * GRAVITY * height(m)).sum()
    }

    /// Returns the angles at rest for the actuator angles `q`: the springs hold the torques of gravity.
    fn at_rest(&self, q: &[f64]) -> Vec<f64> {
        let mut theta = q.to_vec();
        for _ in 0..60 {
            let slope = |i: usize| {
                let at = |by: f64| {
                    let mut moved = theta.clone();
                    moved[i] += by;
                    self.potential(&moved)
                };
                (at(1e-5) - at(-1e-5)) / 2e-5
            };
            theta = (0..q.len()).map(|i| q[i] - self.compliances[i] * slope(i)).collect();
        }
        theta
    }
}

/// Random arms with tilted mounts, revolute joints and masses.
fn heavy_arm(rng: &mut ChaCha8Rng, axes: usize) -> Robot {
    let mut arm = random_robot(rng, axes, false);
    arm.joints.iter_mut().for_each(|joint| joint.kind = JointKind::Revolute);
    arm.coupling = (0..axes).map(|i| (0..axes).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let mut three = |bound: f64| Vector3::from_fn(|_, _| rng.random_range(-bound..bound));
    arm.mount = Pose::from_translation_rpy(three(0.5), three(PI));
    let centres: Vec<_> = (0..axes).map(|_| three(0.3)).collect();
    let mass =
        |(k, centre): (usize, &Vector3<f64>)| LinkMass { link: k + 1, mass: 3.0 + k as f64, centre: *centre };
    arm.masses = centres.iter().enumerate().map(mass).collect();
    arm
}

/// The model takes the torques of the undeformed chain, so the difference is of second order: half the
/// compliance leaves a quarter of the difference.
#[test]
fn deflections_are_those_of_a_chain_of_springs_to_first_order() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for case in 0..40 {
        let axes = 2 + case % 5;
        let arm = heavy_arm(&mut rng, axes);
        let q = random_joints(&arm, &mut rng);
        let full: Vec<f64> = (0..axes).map(|_| rng.random_range(1e-6..2e-5)).collect();
        let off = |share: f64| {
            let compliances: Vec<f64> = full.iter().map(|c| c * share).collect();
            let given: Vec<_> =
                compliances.iter().enumerate().map(|(i, c)| (Parameter::Compliance(i), *c)).collect();
            let springs = SpringChain { robot: &arm, compliances };
            let moved = springs.tcp(&springs.at_rest(&q[..axes])) - springs.tcp(&q[..axes]);
            let got = error(&arm, &q, &values(axes, &given), Model::Nonlinear).position;
            ((got - moved).norm(), moved.norm())
        };
        let ((whole, moved), (half, _)) = (off(1.0), off(0.5));
        assert!(whole < 0.05 * moved + 1e-9, "case {case}: {whole:e} of {moved:e}");
        assert!(half < 0.3 * whole + 2e-10, "case {case}: {half:e} is not a quarter of {whole:e}");
    }
}

/// Returns a periodic error of three orders for every revolute joint of an arm; `size` bounds its
/// coefficients, rad.
pub fn random_waves(rng: &mut ChaCha8Rng, arm: &Robot, size: f64) -> Vec<PeriodicError> {
    let mut wave = |joint| {
        let [cos, sin] = [(); 2].map(|()| (0..3).map(|_| rng.random_range(-size..size)).collect());
        PeriodicError { joint, cos, sin }
    };
    let turning = arm.joints.iter().enumerate().filter(|(_, j)| j.kind == JointKind::Revolute);
    turning.map(|(joint, _)| wave(joint)).collect()
}

/// The reference rotates every joint by the sum of its waves, with other code: the forward kinematics of the
/// calibration.
#[test]
fn periodic_errors_of_a_chain_turn_its_joints() {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    let mut uncoupled = 0;
    for (name, mut arm) in robots() {
        if arm.coupling.iter().enumerate().any(|(i, row)| row[..i].iter().any(|c| *c != 0.0)) {
            continue;
        }
        uncoupled += 1;
        arm.tool = Pose::identity();
        let waves = random_waves(&mut rng, &arm, 0.01);
        let wave = |joint, k, sine| Unknown::Harmonic { joint, order: k + 1, sine };
        let (unknowns, sizes): (Vec<_>, Vec<_>) = waves
            .iter()
            .flat_map(|w| (0..3).flat_map(move |k| [(w, k, false, w.cos[k]), (w, k, true, w.sin[k])]))
            .map(|(w, k, sine, size)| (wave(w.joint, k, sine), size))
            .unzip();
        let sample = no_errors(arm.joints.len()).with_periodic(waves);
        let chain = Chain::new(&arm).with_errors(&ErrorSet::Signed(sample.clone()));
        let errors = Perturbation::new(&chain, &sample);
        for _ in 0..10 {
            let q = random_joints(&arm, &mut rng);
            let nominal = chain.frames(&chain.posture(&q));
            let turned = Deformed::new(&chain, &q, &unknowns, &sizes).interface;
            let error = pose_error(&nominal, &errors, Model::Nonlinear);
            let off = turned.translation - nominal.tcp.translation - error.position;
            assert!(error.position.norm() > 1e-6 && off.norm() < 1e-12, "{name}: {:e} m", off.norm());
        }
    }
    assert!(uncoupled > 12, "{uncoupled} robots");
}

/// Every derivative, together with the derivatives of other errors, agrees with central differences of the
/// nonlinear model.
#[test]
fn derivatives_of_elastic_errors_agree_with_differences() {
    let [mut rng, mut others] = [32, 35].map(ChaCha8Rng::seed_from_u64);
    for case in 0..cases(20, 100) {
        let axes = 1 + case % 7;
        let mut arm = random_robot(&mut rng, axes, false);
        arm.masses = vec![LinkMass { link: axes, mass: 0.3, centre: Vector3::new(0.1, -0.2, 0.3) }];
        let q = random_joints(&arm, &mut rng);
        let sample = no_errors(axes).with_periodic(random_waves(&mut others, &arm, 0.2));
        let chain = Chain::new(&arm).with_errors(&ErrorSet::Signed(sample));
        let frames = chain.frames(&chain.posture(&q));
        let mut expansion = Expansion::new(&chain);
        expansion.set(&frames);
        let at = |given: &[(usize, f64)]| {
            let mut values = vec![0.0; Parameter::count(axes)];
            given.iter().for_each(|(k, v)| values[*k] += v);
            pose_error(&frames, &Perturbation::of_values(&chain, &values), Model::Nonlinear)
        };
        let size = |d: Displacement| d.position.norm() + d.rotation.norm();
        for a in Parameter::first_elastic(axes)..Parameter::count(axes) {
            let step = 1e-5;
            let slope = (at(&[(a, step)]) - at(&[(a, -step)])) * (0.5 / step);
            let off = size(expansion.first(a) - slope);
            assert!(off < 1e-8, "case {case}, parameter {a}: {off:e}");
            let b = rng.random_range(0..Parameter::count(axes));
            let step = 1e-3;
            let corner = |x: f64, y: f64| at(&[(a, x * step), (b, y * step)]);
            let both = (corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0))
                * (0.25 / (step * step));
            let off = size(expansion.second(a, b) - both) / (1.0 + size(both));
            assert!(off < 2e-5, "case {case}, parameters {a} and {b}: {off:e}");
        }
    }
}

/// The linear model differs from the nonlinear model by terms of second order, and the second-order model by
/// terms of third order.
#[test]
fn models_of_elastic_errors_converge_with_their_order() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    for case in 0..40 {
        let axes = 3 + case % 4;
        let arm = heavy_arm(&mut rng, axes);
        let q = random_joints(&arm, &mut rng);
        let mut all = random_errors(&mut rng, axes, 1e-3, 1e-3).values();
        let terms = Parameter::first_elastic(axes)..Parameter::count(axes) - 2 * axes;
        all[terms].fill_with(|| rng.random_range(-1e-3..1e-3));
        let off = |share: f64, model: Model| {
            let values: Vec<f64> = all.iter().map(|v| v * share).collect();
            let exact = error(&arm, &q, &values, Model::Nonlinear);
            (error(&arm, &q, &values, model).position - exact.position).norm()
        };
        let ratio = |model: Model| off(0.5, model) / off(1.0, model);
        assert!((ratio(Model::Linear) - 0.25).abs() < 0.02, "case {case}: {}", ratio(Model::Linear));
        assert!(
            (ratio(Model::SecondOrder) - 0.125).abs() < 0.02,
            "case {case}: {}",
            ratio(Model::SecondOrder)
        );
    }
}

/// Returns an arm of the library in the paper's cell, with a normal tolerance of some elastic terms.
fn elastic_cell() -> Cell {
    let robot = shipped("ur_cell.toml").robot;
    let axes = robot.axes();
    let mut spreads = vec![Spread::of_magnitude(0.0); Parameter::count(axes)];
    let mut set = |parameter, plus_minus| spreads[place(axes, parameter)] = Spread::of_magnitude(plus_minus);
    set(Parameter::Dl(1), 5e-4);
    set(Parameter::Dalpha(0), 1e-3);
    set(Parameter::Elastic(1, 1), 3e-3);
    set(Parameter::Elastic(1, 2), 2e-3);
    set(Parameter::Elastic(2, 2), 4e-3);
    set(Parameter::Elastic(3, 5), 6e-3);
    let tolerance = Tolerance { name: "elastic".into(), spreads, covariance: None, costs: Vec::new() };
    cell_of(robot, tolerance, Sense::plain("xyz").unwrap())
}

#[test]
fn statistics_of_elastic_errors_agree_with_monte_carlo() {
    let mut cell = elastic_cell();
    (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
    let evaluator = gauge_of(&cell);
    let chain = Chain::new(&cell.robot);
    for k in 0..6 {
        let frames = chain.frames(&chain.posture(&chain.halton_sample(3 + 7 * k)));
        let judged = evaluator.judge(&alone(), &frames, &mut evaluator.memory());
        let first = judged.figures[evaluator.own()];
        let sampled = monte_carlo(&evaluator, &alone(), &frames, 1 << 16, 5, first.p95);
        assert!(sampled.confirms(&first), "{first:?} {sampled:?}");
    }
}

/// The reference evaluates the nonlinear model at every corner of the tolerance box.
#[test]
fn the_worst_case_of_elastic_errors_agrees_with_all_corners() {
    let mut cell = elastic_cell();
    cell.model = Model::Nonlinear;
    let evaluator = gauge_of(&cell);
    let chain = Chain::new(&cell.robot);
    let list = &evaluator.sources.list;
    for k in 0..6 {
        let frames = chain.frames(&chain.posture(&chain.halton_sample(2 + 5 * k)));
        let worst = (0..1usize << list.len()).map(|corner| {
            let sign = |i: usize| if corner >> i & 1 == 1 { 1.0 } else { -1.0 };
            let given: Vec<_> =
                list.iter().enumerate().map(|(i, s)| (s.parameter, sign(i) * s.plus_minus)).collect();
            let errors = Perturbation::of_values(&chain, &values(cell.robot.axes(), &given));
            pose_error(&frames, &errors, Model::Nonlinear).position.norm()
        });
        let worst = worst.fold(0.0, f64::max);
        let got = evaluator.value(&alone(), &frames, &mut evaluator.memory());
        assert!((got - worst).abs() < 1e-12, "{got} instead of {worst}");
    }
}

/// A part weighs like a mass of the last link, at its centre in the frame of the TCP.
#[test]
fn a_held_part_weighs_like_a_mass_of_the_last_link() {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    let mut arm = heavy_arm(&mut rng, 5);
    let q = random_joints(&arm, &mut rng);
    let centre = Vector3::new(0.05, -0.02, 0.11);
    let part = HeldPart { mass: 7.0, centre, ..HeldPart::default() };
    let carrying = Chain::new(&arm).carrying(&part);
    arm.masses.push(LinkMass { link: 5, mass: 7.0, centre: arm.tool.transform(&centre) });
    let values = values(5, &[(Parameter::Compliance(0), 1e-5), (Parameter::Compliance(3), 2e-5)]);
    let frames = carrying.frames(&carrying.posture(&q));
    let got = pose_error(&frames, &Perturbation::of_values(&carrying, &values), Model::Nonlinear);
    let want = error(&arm, &q, &values, Model::Nonlinear);
    assert!((got.position - want.position).norm() < 1e-15 && want.position.norm() > 1e-6);
}

/// The reference is a least-squares fit over many random postures.
#[test]
fn a_best_fit_of_elastic_errors_agrees_with_least_squares() {
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    let mut cell = elastic_cell();
    let set = cell.error_set().tolerance();
    let signed: Vec<f64> = set.spreads.iter().map(|s| s.plus_minus).collect();
    let axes = cell.robot.axes();
    cell.robot.errors = vec![ErrorSet::Signed(SignedErrors::of_values("elastic".into(), axes, &signed))];
    (cell.reading, cell.model) = (Reading::Signed, Model::Nonlinear);
    cell.registration = Registration::BestFit;
    let (evaluator, chain) = (gauge_of(&cell), Chain::new(&cell.robot));
    let errors = Perturbation::of_values(&chain, &signed);
    let at = |q: &JointVector| {
        let frames = chain.frames(&chain.posture(q));
        (frames, pose_error(&frames, &errors, Model::Nonlinear).position)
    };
    let (mut left, mut right) = (nalgebra::Matrix6::zeros(), nalgebra::Vector6::zeros());
    let mut size = 0.0;
    let count = 40_000;
    for _ in 0..count {
        let (frames, e) = at(&random_joints(&cell.robot, &mut rng));
        let p = frames.tcp.translation;
        let mut rows = nalgebra::Matrix3x6::zeros();
        rows.fixed_view_mut::<3, 3>(0, 0).copy_from(&nalgebra::Matrix3::identity());
        rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&-p.cross_matrix());
        left += rows.transpose() * rows;
        right += rows.transpose() * e;
        size += e.norm_squared() / f64::from(count);
    }
    let twist = left.cholesky().unwrap().solve(&right);
    let (v, w) = (twist.fixed_rows::<3>(0).into_owned(), twist.fixed_rows::<3>(3).into_owned());
    assert!(v.norm() > 0.1 * size.sqrt(), "the fit must remove much: {v}");
    for k in 0..8 {
        let (frames, e) = at(&chain.halton_sample(5 + 3 * k));
        let want = (e - v - w.cross(&frames.tcp.translation)).norm();
        let got = evaluator.value(&alone(), &frames, &mut evaluator.memory());
        assert!((got - want).abs() < 0.03 * size.sqrt(), "{got} instead of {want} of {}", size.sqrt());
    }
}
