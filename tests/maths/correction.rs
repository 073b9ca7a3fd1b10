//! Tests corrected joint coordinates with a product of textbook D-H matrices.

use crate::common::robots;
use crate::kinematics::product::{position, product, random_joints, rotation};
use nalgebra::{DMatrix, Matrix4};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Model, Parameter, Robot};
use sweetspot::correction::{Correction, MAX_STEPS, corrected};
use sweetspot::kinematic_error::{Perturbation, pose_error};
use sweetspot::pose::Pose;
use sweetspot::reach::jacobian;
use sweetspot::robot::Chain;

/// Returns random errors of about 1 mm and 0.1 degrees in the order of the parameters. The base has no
/// errors.
fn random_errors(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let size = |parameter| match parameter {
        // The textbook product has no elastic joints.
        Parameter::Base(_) | Parameter::Elastic(..) | Parameter::Compliance(_) => 0.0,
        Parameter::Dr(_) | Parameter::Dl(_) | Parameter::Tool(0..3) | Parameter::Joint(_, 0..3) => 1e-3,
        _ => 2e-3,
    };
    Parameter::of_robot(robot.axes()).map(|p| size(p) * rng.random_range(-1.0..1.0)).collect()
}

fn corrected_with(robot: &Robot, chain: &Chain, q: &[f64; 8], values: &[f64]) -> (Pose, Correction) {
    let target = chain.forward(&chain.posture(q));
    let errors = Perturbation::of_values(chain, values);
    let found = corrected(chain, q, &target, |frames| pose_error(frames, &errors, Model::Nonlinear));
    assert_eq!(robot.axes(), chain.axes());
    (target, found)
}

/// Returns the pose of an arm with errors, computed by the textbook product.
fn attained(robot: &Robot, q: &[f64], values: &[f64]) -> Matrix4<f64> {
    let mut mount = robot.mount.rotation.to_homogeneous();
    mount.fixed_view_mut::<3, 1>(0, 3).copy_from(&robot.mount.translation);
    mount * product(robot, q, values)
}

/// Returns the least singular value of the Jacobian with lengths divided by the reach.
fn dexterity(robot: &Robot, chain: &Chain, q: &[f64; 8]) -> f64 {
    let columns = jacobian(chain, &chain.frames(&chain.posture(q)));
    let entry = |i: usize, j: usize| match i {
        0..3 => columns[j].position[i] / robot.reach(),
        _ => columns[j].rotation[i - 3],
    };
    DMatrix::from_fn(6, robot.axes(), entry).singular_values().min()
}

/// Least singular value of the Jacobian below which, with errors of this size, possibly no posture reaches
/// the target.
const SINGULAR: f64 = 0.03;

/// Returns the distance (m) of the TCP of an arm with these errors from a target.
fn miss_of(robot: &Robot, q: &[f64; 8], values: &[f64], target: &Pose) -> f64 {
    (position(&attained(robot, q, values)) - target.translation).norm()
}

/// A thousand regular postures reach their targets. Near a singular posture, the correction either reaches
/// the target or reports that it has not converged.
#[test]
fn corrected_joints_of_six_axis_arms_land_on_the_target() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let arms: Vec<_> = robots().into_iter().filter(|(_, robot)| robot.axes() == 6).collect();
    assert!(arms.len() >= 8, "{}", arms.len());
    let mut regular = 0;
    for k in 0.. {
        let (name, robot) = &arms[k % arms.len()];
        let (chain, q) = (Chain::new(robot), random_joints(robot, &mut rng));
        let values = random_errors(robot, &mut rng);
        let (target, found) = corrected_with(robot, &chain, &q, &values);
        if !found.converged {
            // Near a fold, the arm can move outwards by at most half the square of the least singular value
            // times its reach.
            let (least, missed) = (dexterity(robot, &chain, &q), miss_of(robot, &q, &values, &target));
            let fold = least.powi(2) / 2.0 * robot.reach();
            assert!(
                least < SINGULAR || fold < missed,
                "{name} {k}: {least}, {fold} m, {missed} m, {found:?}"
            );
            assert_eq!(found.steps, MAX_STEPS, "{name} {k}");
            continue;
        }
        let t = attained(robot, &found.joints, &values);
        let miss = (position(&t) - target.translation).norm();
        let turn = (rotation(&t) - target.rotation).norm();
        assert!(miss < 1e-9 && turn < 1e-9, "{name} {k}: {miss} m, {turn}");
        assert_eq!(found.command, chain.forward(&chain.posture(&found.joints)), "{name} {k}");
        // Without the correction, the arm misses the target.
        let missed = miss_of(robot, &q, &values, &target);
        assert!(missed > 1e-6, "{name} {k}: {missed}");
        regular += usize::from(dexterity(robot, &chain, &q) >= SINGULAR);
        if regular == 1000 {
            break;
        }
    }
}

/// Arms with other numbers of joints reach the position. The remaining error is a rotation, which is
/// stationary.
#[test]
fn arms_with_fewer_or_more_joints_keep_the_position() {
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    let arms: Vec<_> = robots().into_iter().filter(|(_, robot)| robot.axes() != 6).collect();
    for k in 0..300 {
        let (name, robot) = &arms[k % arms.len()];
        let chain = Chain::new(robot);
        let mut q = robot.home;
        let spread = robot.joints.iter().map(|j| 0.2 * (j.limits.1 - j.limits.0));
        let moved = random_joints(robot, &mut rng);
        q.iter_mut().zip(spread).zip(moved).for_each(|((q, s), to)| *q += (to - *q).clamp(-s, s));
        let values = random_errors(robot, &mut rng);
        let (target, found) = corrected_with(robot, &chain, &q, &values);
        if !found.converged {
            continue;
        }
        let t = attained(robot, &found.joints, &values);
        assert!((position(&t) - target.translation).norm() < 1e-9, "{name} {k}");
        let passive = robot.joints.iter().enumerate().filter(|(_, j)| j.is_passive());
        passive.for_each(|(i, _)| assert_eq!(found.joints[i], q[i], "{name} {k}"));
        let left = found.rest.rotation.norm();
        if robot.axes() > 6 {
            assert!(left < 1e-9, "{name} {k}: {left}");
        } else {
            assert!((rotation(&t) - target.rotation).norm() < 3.0 * left + 1e-9, "{name} {k}");
        }
    }
}

#[test]
fn a_correction_beyond_a_limit_names_the_joint() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "puma560").unwrap();
    let mut chain = Chain::new(&robot);
    let q = [0.3, -0.6, 0.4, 0.5, 0.7, 0.2, 0.0, 0.0];
    let mut values = vec![0.0; Parameter::count(6)];
    // The error of joint 2 is 0.01 rad, so the corrected coordinate is smaller by 0.01 rad.
    values[5] = 0.01;
    let (_, free) = corrected_with(&robot, &chain, &q, &values);
    assert!(free.converged && free.beyond.is_none(), "{free:?}");
    assert!((free.joints[1] - (q[1] - 0.01)).abs() < 1e-9, "{free:?}");
    chain.links[1].limits.0 = q[1] - 0.005;
    let (_, found) = corrected_with(&robot, &chain, &q, &values);
    assert_eq!((found.converged, found.beyond), (true, Some(1)));
}

#[test]
fn a_target_out_of_reach_does_not_converge() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "puma560").unwrap();
    let chain = Chain::new(&robot);
    let far = Pose { translation: nalgebra::vector![0.0, 0.0, 5.0], ..Pose::identity() };
    let none = Perturbation::of_values(&chain, &vec![0.0; Parameter::count(6)]);
    let found = corrected(&chain, &robot.home, &far, |f| pose_error(f, &none, Model::Nonlinear));
    assert!(!found.converged && found.rest.position.norm() > 3.0, "{found:?}");
}

#[test]
fn a_passive_joint_is_never_beyond_its_limits() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let mut count = 0;
    for (name, robot) in robots() {
        let chain = Chain::new(&robot);
        if !chain.links.iter().any(|link| link.is_passive()) {
            continue;
        }
        for _ in 0..200 {
            let q = random_joints(&robot, &mut rng);
            let (_, found) = corrected_with(&robot, &chain, &q, &random_errors(&robot, &mut rng));
            assert!(found.beyond.is_none_or(|joint| !chain.links[joint].is_passive()), "{name}: {found:?}");
            count += usize::from(found.beyond.is_none());
        }
    }
    assert!(count > 20, "{count} corrections within the limits");
}
